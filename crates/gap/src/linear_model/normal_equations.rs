//! Normal equations of some measurements, stored only for the columns that these depend on: of hundreds of patches of the
//! field, a picture shows a few.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVector};

use crate::linear_model::{
    column::{ColumnIndex, Columns},
    reflectance::{PatchEquations, PatchIndex},
};

/// Prior precision of the coordinate of a fitted or a nuisance parameter.
pub(crate) const PRIOR: f64 = 1.0;

/// `A = J̃ᵀ W J` and `g = J̃ᵀ W r` of some measurements, see [`crate::linear_model::system`]. A measurement depends on the
/// reflectance of one patch at most, so that their block of `A` is diagonal.
#[derive(Debug, Clone)]
pub(crate) struct NormalEquations {
    /// Stored columns of fitted and nuisance parameters, in order.
    columns: Vec<ColumnIndex>,
    a: DMatrix<f64>,
    g: DVector<f64>,
    /// Stored patches of the field, in order.
    patches: Vec<PatchIndex>,
    of_patches: PatchEquations,
}

/// Measurement as it enters normal equations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WeightedRow<'a> {
    pub(crate) weight: f64,
    pub(crate) residual: f64,
    /// Derivatives by fitted and nuisance parameters, by their positions among the stored ones.
    pub(crate) derivatives: &'a [(usize, f64)],
    /// Derivative by the reflectance of a patch.
    pub(crate) patch: Option<(PatchIndex, f64)>,
}

impl NormalEquations {
    /// Creates the normal equations of no measurements, for these columns and patches in order.
    pub(crate) fn zero(columns: Vec<ColumnIndex>, patches: Vec<PatchIndex>) -> Self {
        let count = columns.len();
        Self {
            a: DMatrix::zeros(count, count),
            g: DVector::zeros(count),
            of_patches: PatchEquations::zero(patches.len(), count),
            columns,
            patches,
        }
    }

    /// Adds up normal equations, which may have different columns.
    pub(crate) fn sum<'a>(terms: impl Iterator<Item = &'a Self> + Clone) -> Self {
        let columns: BTreeSet<ColumnIndex> = terms.clone().flat_map(|term| &term.columns).copied().collect();
        let patches: BTreeSet<PatchIndex> = terms.clone().flat_map(|term| &term.patches).copied().collect();
        let mut sum = Self::zero(columns.into_iter().collect(), patches.into_iter().collect());
        for term in terms {
            let positions: Vec<usize> = term.columns.iter().map(|column| sum.position(*column)).collect();
            let patches: Vec<usize> = term.patches.iter().map(|patch| sum.patch_position(*patch)).collect();
            term.scatter(&positions, &patches, (&mut sum.a, &mut sum.g, &mut sum.of_patches));
        }
        sum
    }

    /// Returns the position of a stored column among the stored ones.
    pub(crate) fn position(&self, column: ColumnIndex) -> usize {
        self.columns.partition_point(|&other| other < column)
    }

    fn patch_position(&self, patch: PatchIndex) -> usize {
        self.patches.partition_point(|&other| other < patch)
    }

    /// Whether they hold no information.
    pub(crate) fn is_empty(&self) -> bool {
        self.g.iter().chain(&self.of_patches.score).all(|value| *value == 0.0)
    }

    /// Adds the contribution of a measurement to the row at `position`. `projected` is its derivative there in `J̃`, or a term
    /// of it.
    pub(crate) fn add(&mut self, position: usize, projected: f64, row: &WeightedRow<'_>) {
        self.g[position] += row.weight * projected * row.residual;
        for &(other, derivative) in row.derivatives {
            self.a[(position, other)] += row.weight * projected * derivative;
        }
    }

    /// Adds the contribution of a measurement to the row of the patch that it depends on, if there is one.
    pub(crate) fn add_to_patch(&mut self, row: &WeightedRow<'_>) {
        let Some((patch, derivative)) = row.patch else { return };
        let patch = self.patch_position(patch);
        let weighted = row.weight * derivative;
        self.of_patches.information[patch] += weighted * derivative;
        self.of_patches.score[patch] += weighted * row.residual;
        for &(position, other) in row.derivatives {
            self.of_patches.cross[(position, patch)] += weighted * other;
        }
    }

    /// Adds them to the equations of all fitted and nuisance parameters and of all patches.
    pub(crate) fn add_to(&self, a: &mut DMatrix<f64>, g: &mut DVector<f64>, patches: &mut PatchEquations) {
        let positions: Vec<usize> = self.columns.iter().map(|column| column.0).collect();
        let places: Vec<usize> = self.patches.iter().map(|patch| patch.0).collect();
        self.scatter(&positions, &places, (a, g, patches));
    }

    /// Adds them to larger normal equations, in which the stored columns and patches have these positions.
    fn scatter(
        &self,
        positions: &[usize],
        patches: &[usize],
        (a, g, of_patches): (&mut DMatrix<f64>, &mut DVector<f64>, &mut PatchEquations),
    ) {
        for (i, &row) in positions.iter().enumerate() {
            g[row] += self.g[i];
            for (j, &column) in positions.iter().enumerate() {
                a[(row, column)] += self.a[(i, j)];
            }
        }
        for (i, &patch) in patches.iter().enumerate() {
            of_patches.information[patch] += self.of_patches.information[i];
            of_patches.score[patch] += self.of_patches.score[i];
            for (j, &row) in positions.iter().enumerate() {
                of_patches.cross[(row, patch)] += self.of_patches.cross[(j, i)];
            }
        }
    }

    /// Returns `Zᵀ A Z` and `Zᵀ (g − A e)` for changes `e + Z δ` of all columns that follow from a change `δ` of the fitted
    /// parameters. `z` has one row for each column, transposed.
    pub(crate) fn projected(
        &self,
        z_transposed: &DMatrix<f64>,
        e: &DVector<f64>,
        all: &Columns,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let parameters = z_transposed.nrows();
        let dense: Vec<usize> = self.columns.iter().map(|column| column.0).collect();
        let patches: Vec<usize> = self.patches.iter().map(|patch| all.of_patch(*patch).0).collect();
        let rows = |places: &[usize]| {
            DMatrix::from_fn(parameters, places.len(), |i, j| z_transposed[(i, places[j])])
        };
        let (z, of_patches) = (rows(&dense), rows(&patches));
        let (own, own_patches) = self.gather(e, all);
        let information = DVector::from_column_slice(&self.of_patches.information);
        let left = &self.g - &self.a * &own - &self.of_patches.cross * &own_patches;
        let left_patches = DVector::from_column_slice(&self.of_patches.score)
            - information.component_mul(&own_patches)
            - self.of_patches.cross.tr_mul(&own);
        let score = &z * left + &of_patches * left_patches;
        let mut weighted = of_patches.clone();
        for (mut column, information) in weighted.column_iter_mut().zip(&self.of_patches.information) {
            column *= *information;
        }
        let across = &z * (&self.of_patches.cross * of_patches.transpose());
        let a =
            &z * (&self.a * z.transpose()) + &across + across.transpose() + weighted * of_patches.transpose();
        (a, score)
    }

    /// Returns the gain in log-likelihood by a change of the columns, `gᵀ δ − ½ δᵀ A δ`.
    pub(crate) fn gain(&self, delta: &DVector<f64>, all: &Columns) -> f64 {
        let (dense, patches) = self.gather(delta, all);
        let across = dense.dot(&(&self.of_patches.cross * &patches));
        let of_patches = patches.iter().zip(&self.of_patches.score).zip(&self.of_patches.information);
        let of_patches =
            of_patches.map(|((value, score), information)| value * (score - 0.5 * information * value));
        self.g.dot(&dense) - 0.5 * dense.dot(&(&self.a * &dense)) - across + of_patches.sum::<f64>()
    }

    /// Returns the entries of the stored columns and of the stored patches.
    fn gather(&self, delta: &DVector<f64>, all: &Columns) -> (DVector<f64>, DVector<f64>) {
        let dense = self.columns.iter().map(|column| delta[column.0]);
        let patches = self.patches.iter().map(|patch| delta[all.of_patch(*patch).0]);
        (
            DVector::from_iterator(self.columns.len(), dense),
            DVector::from_iterator(self.patches.len(), patches),
        )
    }

    /// Creates normal equations that store all columns, without patches.
    pub(crate) fn of_all(a: DMatrix<f64>, g: DVector<f64>) -> Self {
        let columns = ColumnIndex::first(g.len()).collect();
        Self { a, g, ..Self::zero(columns, Vec::new()) }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::{
        linear_model::reflectance::{ReflectanceField, Tree},
        measurement::quantity::{ColorChannel, Quantity},
        testing::Noise,
    };

    const DENSE: usize = 7;

    /// Returns columns of which the last ones are those of a few patches.
    fn columns() -> Columns {
        let level = Quantity::CarpetLevel(ColorChannel::Green);
        let places = [[0.1, 0.1], [0.4, 0.1], [2.2, 0.3]].map(|place| (level, DVec2::from(place)));
        let field = ReflectanceField::new(Tree::new(places.into_iter()));
        Columns { parameters: DENSE, nuisances: 0, field }
    }

    /// Returns the normal equations of five random measurements, stored for some columns and two patches, and dense.
    fn stored_and_dense(seed: u64, stored: &[usize]) -> (NormalEquations, DMatrix<f64>, DVector<f64>) {
        let mut noise = Noise(seed);
        let all = columns();
        let patches = vec![PatchIndex(0), PatchIndex(2)];
        let stored_columns = stored.iter().copied().map(ColumnIndex).collect();
        let mut equations = NormalEquations::zero(stored_columns, patches.clone());
        let (mut a, mut g) = (DMatrix::zeros(all.len(), all.len()), DVector::zeros(all.len()));
        for index in 0..5 {
            let values: Vec<f64> = stored.iter().map(|_| noise.next()).collect();
            let (weight, residual) = (noise.next().abs(), noise.next());
            let derivatives: Vec<(usize, f64)> = values.iter().copied().enumerate().collect();
            let patch = (index < 4).then(|| (patches[index % 2], 1.0 + noise.next()));
            let weighted = WeightedRow { weight, residual, derivatives: &derivatives, patch };
            derivatives
                .iter()
                .for_each(|&(position, derivative)| equations.add(position, derivative, &weighted));
            equations.add_to_patch(&weighted);
            let mut row = DVector::zeros(all.len());
            stored.iter().zip(&values).for_each(|(&column, &value)| row[column] = value);
            patch.into_iter().for_each(|(patch, derivative)| row[all.of_patch(patch).0] = derivative);
            a.ger(weight, &row, &row, 1.0);
            g.axpy(weight * residual, &row, 1.0);
        }
        (equations, a, g)
    }

    #[test]
    fn gains_are_those_of_the_dense_equations() {
        let all = columns();
        for (seed, stored) in [(1, vec![0, 3, 6]), (2, vec![2]), (3, (0..DENSE).collect())] {
            let (stored, a, g) = stored_and_dense(seed, &stored);
            let delta = DVector::from_fn(all.len(), |i, _| 0.3 * i as f64 - 1.0);
            let wanted = g.dot(&delta) - 0.5 * delta.dot(&(&a * &delta));
            assert!((stored.gain(&delta, &all) - wanted).abs() < 1e-10);
        }
    }

    #[test]
    fn projected_equations_are_those_of_the_dense_ones_and_a_sum_has_the_entries_of_all_terms() {
        let all = columns();
        let ((one, a, g), (other, b, h)) = (stored_and_dense(4, &[0, 2, 5]), stored_and_dense(5, &[1, 2]));
        let (a, g) = (a + b, g + h);
        let sum = NormalEquations::sum([&one, &other].into_iter());
        assert_eq!(sum.columns, [0, 1, 2, 5].map(ColumnIndex));
        let mut noise = Noise(9);
        let z = DMatrix::from_fn(all.len(), 3, |_, _| noise.next());
        let e = DVector::from_fn(all.len(), |_, _| noise.next());
        let (information, score) = sum.projected(&z.transpose(), &e, &all);
        assert!((information - z.transpose() * &a * &z).norm() < 1e-10);
        assert!((score - z.transpose() * (g - a * e)).norm() < 1e-10);
    }
}
