//! Normal equations of some measurements, stored for the columns that these depend on: of hundreds of patches of carpet a
//! picture shows a few, and a place on the field one.

use nalgebra::{DMatrix, DVector};

use crate::linear_model::column::ColumnIndex;

/// Prior precision of a column, in units of its scale.
pub(crate) const PRIOR: f64 = 1.0;

/// `A = J̃ᵀ W J` and `g = J̃ᵀ W r` of some measurements, see [`crate::linear_model::system`].
#[derive(Debug, Clone)]
pub(crate) struct NormalEquations {
    /// The columns that are stored, in order.
    columns: Vec<ColumnIndex>,
    a: DMatrix<f64>,
    g: DVector<f64>,
}

impl NormalEquations {
    /// Normal equations of no measurements yet, for these columns, in order.
    pub(crate) fn zero(columns: Vec<ColumnIndex>) -> Self {
        let count = columns.len();
        Self { columns, a: DMatrix::zeros(count, count), g: DVector::zeros(count) }
    }

    /// The sum of several normal equations.
    pub(crate) fn together<'a>(sums: impl Iterator<Item = &'a Self> + Clone) -> Self {
        let mut columns: Vec<ColumnIndex> = sums.clone().flat_map(|sums| &sums.columns).copied().collect();
        columns.sort_unstable();
        columns.dedup();
        let mut all = Self::zero(columns);
        for sums in sums {
            let places: Vec<usize> = sums.columns.iter().map(|column| all.place(*column)).collect();
            sums.put(&places, &mut all.a, &mut all.g);
        }
        all
    }

    /// Position of a column, which has to be stored, among the stored ones.
    pub(crate) fn place(&self, column: ColumnIndex) -> usize {
        self.columns.partition_point(|&other| other < column)
    }

    /// Whether nothing was added.
    pub(crate) fn is_empty(&self) -> bool {
        self.g.iter().all(|value| *value == 0.0)
    }

    /// Adds the part of one measurement that has this derivative `changed` in `J̃` at one position; `plain` is its row of `J`.
    pub(crate) fn add(
        &mut self,
        place: usize,
        changed: f64,
        plain: &[(usize, f64)],
        weight: f64,
        residual: f64,
    ) {
        self.g[place] += weight * changed * residual;
        for &(other, change) in plain {
            self.a[(place, other)] += weight * changed * change;
        }
    }

    /// Adds these to dense normal equations of all columns.
    pub(crate) fn add_to(&self, a: &mut DMatrix<f64>, g: &mut DVector<f64>) {
        let places: Vec<usize> = self.columns.iter().map(|column| column.0).collect();
        self.put(&places, a, g);
    }

    fn put(&self, places: &[usize], a: &mut DMatrix<f64>, g: &mut DVector<f64>) {
        for (i, &row) in places.iter().enumerate() {
            g[row] += self.g[i];
            for (j, &column) in places.iter().enumerate() {
                a[(row, column)] += self.a[(i, j)];
            }
        }
    }

    /// Score `g − A δ` in all columns.
    pub(crate) fn score(&self, delta: &DVector<f64>) -> DVector<f64> {
        let left = &self.g - &self.a * self.of(delta);
        let mut score = DVector::zeros(delta.len());
        for (&column, value) in self.columns.iter().zip(left.iter()) {
            score[column.0] = *value;
        }
        score
    }

    /// Gain in log-likelihood by a change of the columns: `gᵀ δ − ½ δᵀ A δ`.
    pub(crate) fn gain(&self, delta: &DVector<f64>) -> f64 {
        let delta = self.of(delta);
        self.g.dot(&delta) - 0.5 * delta.dot(&(&self.a * &delta))
    }

    fn of(&self, delta: &DVector<f64>) -> DVector<f64> {
        DVector::from_iterator(self.columns.len(), self.columns.iter().map(|column| delta[column.0]))
    }

    /// Dense normal equations of all columns.
    #[cfg(test)]
    pub(crate) fn whole(a: DMatrix<f64>, g: DVector<f64>) -> Self {
        Self { columns: ColumnIndex::first(g.len()).collect(), a, g }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Noise;

    const SIZE: usize = 7;

    /// Sums of rows with some of the columns, and the same with all.
    fn pair(seed: u64, columns: &[usize]) -> (NormalEquations, DMatrix<f64>, DVector<f64>) {
        let mut noise = Noise(seed);
        let mut sums = NormalEquations::zero(columns.iter().copied().map(ColumnIndex).collect());
        let (mut a, mut g) = (DMatrix::zeros(SIZE, SIZE), DVector::zeros(SIZE));
        for _ in 0..5 {
            let values: Vec<f64> = columns.iter().map(|_| noise.next()).collect();
            let (weight, residual) = (noise.next().abs(), noise.next());
            let plain: Vec<(usize, f64)> = values.iter().copied().enumerate().collect();
            for &(place, value) in &plain {
                sums.add(place, value, &plain, weight, residual);
            }
            let mut row = DVector::zeros(SIZE);
            columns.iter().zip(&values).for_each(|(&column, &value)| row[column] = value);
            a.ger(weight, &row, &row, 1.0);
            g.axpy(weight * residual, &row, 1.0);
        }
        (sums, a, g)
    }

    #[test]
    fn some_columns_do_as_all_of_them_would() {
        for (seed, columns) in [(1, vec![0, 3, 6]), (2, vec![2]), (3, (0..SIZE).collect())] {
            let (sums, a, g) = pair(seed, &columns);
            let delta = DVector::from_fn(SIZE, |i, _| 0.3 * i as f64 - 1.0);
            assert!((sums.score(&delta) - (&g - &a * &delta)).norm() < 1e-12);
            assert!((sums.gain(&delta) - (g.dot(&delta) - 0.5 * delta.dot(&(&a * &delta)))).abs() < 1e-12);
        }
    }

    #[test]
    fn sums_together_are_those_of_all_rows() {
        let ((one, a, g), (other, b, h)) = (pair(4, &[0, 2, 5]), pair(5, &[1, 2]));
        let (mut sum, mut right) = (DMatrix::zeros(SIZE, SIZE), DVector::zeros(SIZE));
        let together = NormalEquations::together([&one, &other].into_iter());
        together.add_to(&mut sum, &mut right);
        assert_eq!(together.columns, [0, 1, 2, 5].map(ColumnIndex));
        assert!((sum - (a + b)).norm() < 1e-12 && (right - (g + h)).norm() < 1e-12);
    }
}
