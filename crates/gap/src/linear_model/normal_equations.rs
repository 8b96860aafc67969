//! Normal equations of some measurements, stored only for the columns that these depend on: of hundreds of patches of
//! carpet, a picture shows a few and a cell of the field one.

use nalgebra::{DMatrix, DVector};

use crate::linear_model::column::ColumnIndex;

/// Prior precision of a column's coordinate.
pub(crate) const PRIOR: f64 = 1.0;

/// `A = J̃ᵀ W J` and `g = J̃ᵀ W r` of some measurements, see [`crate::linear_model::system`].
#[derive(Debug, Clone)]
pub(crate) struct NormalEquations {
    /// Stored columns, in order.
    columns: Vec<ColumnIndex>,
    a: DMatrix<f64>,
    g: DVector<f64>,
}

impl NormalEquations {
    /// Creates the normal equations of no measurements, for these columns in order.
    pub(crate) fn zero(columns: Vec<ColumnIndex>) -> Self {
        let count = columns.len();
        Self { columns, a: DMatrix::zeros(count, count), g: DVector::zeros(count) }
    }

    /// Adds up normal equations, which may have different columns.
    pub(crate) fn sum<'a>(terms: impl Iterator<Item = &'a Self> + Clone) -> Self {
        let mut columns: Vec<ColumnIndex> = terms.clone().flat_map(|term| &term.columns).copied().collect();
        columns.sort_unstable();
        columns.dedup();
        let mut sum = Self::zero(columns);
        for term in terms {
            let positions: Vec<usize> = term.columns.iter().map(|column| sum.position(*column)).collect();
            term.scatter(&positions, &mut sum.a, &mut sum.g);
        }
        sum
    }

    /// Returns the position of a stored column among the stored ones.
    pub(crate) fn position(&self, column: ColumnIndex) -> usize {
        self.columns.partition_point(|&other| other < column)
    }

    /// Whether they hold no information.
    pub(crate) fn is_empty(&self) -> bool {
        self.g.iter().all(|value| *value == 0.0)
    }

    /// Adds the contribution of one measurement to the row at `position`. `projected` is its derivative there in `J̃`, or a term
    /// of it; `derivatives` are those in `J`, by position.
    pub(crate) fn add(
        &mut self,
        position: usize,
        projected: f64,
        derivatives: &[(usize, f64)],
        weight: f64,
        residual: f64,
    ) {
        self.g[position] += weight * projected * residual;
        for &(other, derivative) in derivatives {
            self.a[(position, other)] += weight * projected * derivative;
        }
    }

    /// Adds them to dense normal equations of all columns.
    pub(crate) fn add_to(&self, a: &mut DMatrix<f64>, g: &mut DVector<f64>) {
        let positions: Vec<usize> = self.columns.iter().map(|column| column.0).collect();
        self.scatter(&positions, a, g);
    }

    /// Adds them to larger normal equations, in which the stored columns have these positions.
    fn scatter(&self, positions: &[usize], a: &mut DMatrix<f64>, g: &mut DVector<f64>) {
        for (i, &row) in positions.iter().enumerate() {
            g[row] += self.g[i];
            for (j, &column) in positions.iter().enumerate() {
                a[(row, column)] += self.a[(i, j)];
            }
        }
    }

    /// Returns the score `g − A δ` in all columns.
    pub(crate) fn score(&self, delta: &DVector<f64>) -> DVector<f64> {
        let stored = &self.g - &self.a * self.gather(delta);
        let mut score = DVector::zeros(delta.len());
        for (&column, value) in self.columns.iter().zip(stored.iter()) {
            score[column.0] = *value;
        }
        score
    }

    /// Returns the equations of linear combinations of the columns: `Vᵀ A V` and `Vᵀ (g − A δ)`, where `V` has a row for each column
    /// and `δ` is a change of the columns.
    pub(crate) fn combined(&self, combinations: &DMatrix<f64>, delta: &DVector<f64>) -> Self {
        let entry = |row: usize, column: usize| combinations[(self.columns[row].0, column)];
        let stored = DMatrix::from_fn(self.columns.len(), combinations.ncols(), entry);
        let left = &self.g - &self.a * self.gather(delta);
        Self {
            columns: ColumnIndex::first(combinations.ncols()).collect(),
            a: stored.transpose() * &self.a * &stored,
            g: stored.transpose() * left,
        }
    }

    /// Returns the equations of some columns, renumbered in their order. All columns are stored.
    pub(crate) fn of_columns(&self, columns: &[ColumnIndex]) -> Self {
        Self {
            columns: ColumnIndex::first(columns.len()).collect(),
            a: DMatrix::from_fn(columns.len(), columns.len(), |i, j| self.a[(columns[i].0, columns[j].0)]),
            g: DVector::from_iterator(columns.len(), columns.iter().map(|column| self.g[column.0])),
        }
    }

    /// Returns the equations with another right side, of which all columns are stored: `A δ` and an error.
    pub(crate) fn with_score(&self, delta: &DVector<f64>, error: &DVector<f64>) -> Self {
        Self { g: &self.a * delta + error, ..self.clone() }
    }

    /// Returns the gain in log-likelihood by a change of the columns, `gᵀ δ − ½ δᵀ A δ`.
    pub(crate) fn gain(&self, delta: &DVector<f64>) -> f64 {
        let delta = self.gather(delta);
        self.g.dot(&delta) - 0.5 * delta.dot(&(&self.a * &delta))
    }

    /// Returns the entries of the stored columns.
    fn gather(&self, delta: &DVector<f64>) -> DVector<f64> {
        DVector::from_iterator(self.columns.len(), self.columns.iter().map(|column| delta[column.0]))
    }

    /// Creates normal equations that store all columns.
    pub(crate) fn of_all(a: DMatrix<f64>, g: DVector<f64>) -> Self {
        Self { columns: ColumnIndex::first(g.len()).collect(), a, g }
    }

    /// Returns the equations of measurements with this multiple of the weight.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self { columns: self.columns.clone(), a: &self.a * factor, g: &self.g * factor }
    }

    #[cfg(test)]
    pub(crate) fn dense(a: DMatrix<f64>, g: DVector<f64>) -> Self {
        Self::of_all(a, g)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Noise;

    const SIZE: usize = 7;

    /// Returns the normal equations of five random measurements, stored for some columns and dense.
    fn stored_and_dense(seed: u64, columns: &[usize]) -> (NormalEquations, DMatrix<f64>, DVector<f64>) {
        let mut noise = Noise(seed);
        let mut stored = NormalEquations::zero(columns.iter().copied().map(ColumnIndex).collect());
        let (mut a, mut g) = (DMatrix::zeros(SIZE, SIZE), DVector::zeros(SIZE));
        for _ in 0..5 {
            let values: Vec<f64> = columns.iter().map(|_| noise.next()).collect();
            let (weight, residual) = (noise.next().abs(), noise.next());
            let derivatives: Vec<(usize, f64)> = values.iter().copied().enumerate().collect();
            for &(position, derivative) in &derivatives {
                stored.add(position, derivative, &derivatives, weight, residual);
            }
            let mut row = DVector::zeros(SIZE);
            columns.iter().zip(&values).for_each(|(&column, &value)| row[column] = value);
            a.ger(weight, &row, &row, 1.0);
            g.axpy(weight * residual, &row, 1.0);
        }
        (stored, a, g)
    }

    #[test]
    fn scores_and_gains_are_those_of_the_dense_equations() {
        for (seed, columns) in [(1, vec![0, 3, 6]), (2, vec![2]), (3, (0..SIZE).collect())] {
            let (stored, a, g) = stored_and_dense(seed, &columns);
            let delta = DVector::from_fn(SIZE, |i, _| 0.3 * i as f64 - 1.0);
            assert!((stored.score(&delta) - (&g - &a * &delta)).norm() < 1e-12);
            assert!((stored.gain(&delta) - (g.dot(&delta) - 0.5 * delta.dot(&(&a * &delta)))).abs() < 1e-12);
        }
    }

    #[test]
    fn a_sum_has_the_columns_and_the_entries_of_all_terms() {
        let ((one, a, g), (other, b, h)) = (stored_and_dense(4, &[0, 2, 5]), stored_and_dense(5, &[1, 2]));
        let (mut dense_a, mut dense_g) = (DMatrix::zeros(SIZE, SIZE), DVector::zeros(SIZE));
        let sum = NormalEquations::sum([&one, &other].into_iter());
        sum.add_to(&mut dense_a, &mut dense_g);
        assert_eq!(sum.columns, [0, 1, 2, 5].map(ColumnIndex));
        assert!((dense_a - (a + b)).norm() < 1e-12 && (dense_g - (g + h)).norm() < 1e-12);
    }
}
