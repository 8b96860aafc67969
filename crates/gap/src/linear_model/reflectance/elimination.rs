//! Elimination of the patches' values from normal equations, from the smallest patches up.
//!
//! With the information `a`, the score `g` and the cross terms `c` of a patch with the other columns `δ`, all of what was
//! eliminated before included, and the precision `q` of its increment, the value given that of the containing patch is
//! `f = (g + q f_parent − cᵀ δ) / (a + q)`.

use nalgebra::{DMatrix, DVector};

use super::{PatchIndex, ReflectanceField};

/// Normal equations of the patches' values: of each, the information, the score, and the cross terms with the other columns.
#[derive(Debug, Clone)]
pub(crate) struct PatchEquations {
    pub(crate) information: Vec<f64>,
    pub(crate) score: Vec<f64>,
    /// One column for each patch, one row for each other column.
    pub(crate) cross: DMatrix<f64>,
}

impl PatchEquations {
    /// Creates the equations of no measurements for this number of patches and of other columns.
    pub(crate) fn zero(patches: usize, others: usize) -> Self {
        Self {
            information: vec![0.0; patches],
            score: vec![0.0; patches],
            cross: DMatrix::zeros(others, patches),
        }
    }
}

/// Equations after the patches' values were eliminated.
#[derive(Debug, Clone)]
pub(crate) struct Eliminated {
    patches: PatchEquations,
}

impl Eliminated {
    /// Eliminates the values of all patches, whose priors are those of the field, from the equations `a`, `g` of the other
    /// columns.
    pub(crate) fn new(
        field: &ReflectanceField,
        mut patches: PatchEquations,
        a: &mut DMatrix<f64>,
        g: &mut DVector<f64>,
    ) -> Self {
        for patch in field.tree.patches() {
            let precision = field.precision(patch);
            let information = patches.information[patch.0] + precision;
            patches.information[patch.0] = information;
            let cross = patches.cross.column(patch.0).clone_owned();
            let score = patches.score[patch.0];
            a.ger(-1.0 / information, &cross, &cross, 1.0);
            g.axpy(-score / information, &cross, 1.0);
            if let Some(parent) = field.tree.parent(patch) {
                let share = precision / information;
                patches.information[parent.0] += precision * (1.0 - share);
                patches.score[parent.0] += share * score;
                patches.cross.column_mut(parent.0).axpy(share, &cross, 1.0);
            }
        }
        Self { patches }
    }

    /// Returns `X` and `y` of the patches' values `f = y − X δ`, for the other columns `δ_n = y_n − X_n δ` whose first entries
    /// are free and whose others are themselves eliminated: `x` and `y` are those of the latter.
    pub(crate) fn solution(
        &self,
        field: &ReflectanceField,
        x: &DMatrix<f64>,
        y: &DVector<f64>,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let (count, free, others) = (field.tree.len(), x.ncols(), x.nrows());
        // One column for each patch, so that patches are in one piece in memory.
        let (mut values_x, mut values_y) = (DMatrix::zeros(free, count), DVector::zeros(count));
        let x_transposed = x.transpose();
        for patch in field.tree.patches().rev() {
            let information = self.patches.information[patch.0];
            let cross = self.patches.cross.column(patch.0);
            let eliminated = cross.rows(free, others);
            let mut of_x = cross.rows(0, free) - &x_transposed * eliminated;
            let mut of_y = self.patches.score[patch.0] - eliminated.dot(y);
            if let Some(parent) = field.tree.parent(patch) {
                let precision = field.precision(patch);
                of_x.axpy(precision, &values_x.column(parent.0), 1.0);
                of_y += precision * values_y[parent.0];
            }
            values_x.set_column(patch.0, &(of_x / information));
            values_y[patch.0] = of_y / information;
        }
        (values_x.transpose(), values_y)
    }

    /// Returns the posterior variances of all increments, the other columns taken as known.
    pub(super) fn increment_variances(&self, field: &ReflectanceField) -> Vec<f64> {
        let count = field.tree.len();
        let (mut values, mut increments) = (vec![0.0; count], vec![0.0; count]);
        for patch in field.tree.patches().rev() {
            let PatchIndex(index) = patch;
            let information = self.patches.information[index];
            let share = field.precision(patch) / information;
            let parent = field.tree.parent(patch).map_or(0.0, |parent| values[parent.0]);
            values[index] = information.recip() + share * share * parent;
            increments[index] = information.recip() + (1.0 - share).powi(2) * parent;
        }
        increments
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::{
        linear_model::reflectance::Tree,
        measurement::quantity::{ColorChannel, Quantity},
        testing::Noise,
    };

    const OTHERS: usize = 3;

    fn field() -> ReflectanceField {
        let places = [[0.1, 0.1], [0.4, 0.1], [2.2, 0.3], [-1.0, 0.4]].map(DVec2::from);
        let levels = [Quantity::LineLevel(ColorChannel::Red), Quantity::CarpetLevel(ColorChannel::Red)];
        ReflectanceField::new(Tree::new(
            places.into_iter().flat_map(|place| levels.map(|level| (level, place))),
        ))
    }

    /// Returns the prior precision matrix of all values.
    fn prior(field: &ReflectanceField) -> DMatrix<f64> {
        let count = field.tree.len();
        let mut prior = DMatrix::zeros(count, count);
        for patch in field.tree.patches() {
            let precision = field.precision(patch);
            prior[(patch.0, patch.0)] += precision;
            if let Some(parent) = field.tree.parent(patch) {
                prior[(parent.0, parent.0)] += precision;
                prior[(patch.0, parent.0)] -= precision;
                prior[(parent.0, patch.0)] -= precision;
            }
        }
        prior
    }

    /// Returns the normal equations of random measurements, each of one smallest patch and all other columns: of the other
    /// columns and of the patches, and of all together.
    fn equations(
        field: &ReflectanceField,
    ) -> (DMatrix<f64>, DVector<f64>, PatchEquations, DMatrix<f64>, DVector<f64>) {
        let mut noise = Noise(11);
        let count = field.tree.len();
        let (mut dense, mut right) =
            (DMatrix::zeros(OTHERS + count, OTHERS + count), DVector::zeros(OTHERS + count));
        let mut patches = PatchEquations::zero(count, OTHERS);
        let smallest: Vec<PatchIndex> =
            field.tree.patches().filter(|patch| field.tree.scale(*patch).power == 0).collect();
        for index in 0..60 {
            let patch = smallest[index % smallest.len()];
            let mut row = DVector::zeros(OTHERS + count);
            (0..OTHERS).for_each(|other| row[other] = noise.next());
            row[OTHERS + patch.0] = 1.0 + 0.1 * noise.next();
            let (residual, weight) = (noise.next(), 1.0 + noise.next().abs());
            dense.ger(weight, &row, &row, 1.0);
            right.axpy(weight * residual, &row, 1.0);
            let own = row[OTHERS + patch.0];
            patches.information[patch.0] += weight * own * own;
            patches.score[patch.0] += weight * own * residual;
            patches.cross.column_mut(patch.0).axpy(weight * own, &row.rows(0, OTHERS), 1.0);
        }
        let a = dense.view((0, 0), (OTHERS, OTHERS)).clone_owned();
        let g = right.rows(0, OTHERS).clone_owned();
        (a, g, patches, dense, right)
    }

    #[test]
    fn the_solution_is_that_of_all_columns_at_once() {
        let field = field();
        let count = field.tree.len();
        let (mut a, mut g, patches, mut dense, right) = equations(&field);
        let mut of_patches = dense.view_mut((OTHERS, OTHERS), (count, count));
        of_patches += prior(&field);
        let wanted = dense.clone().try_inverse().unwrap() * right;
        let eliminated = Eliminated::new(&field, patches, &mut a, &mut g);
        let others = a.try_inverse().unwrap() * g;
        assert!((&others - wanted.rows(0, OTHERS)).norm() < 1e-9);
        // The last of the other columns is eliminated, too: it is what it is, whatever the first ones are.
        let (x, y) = (DMatrix::zeros(1, OTHERS - 1), DVector::from_element(1, others[OTHERS - 1]));
        let (x, y) = eliminated.solution(&field, &x, &y);
        let values = y - x * others.rows(0, OTHERS - 1);
        assert!((values - wanted.rows(OTHERS, count)).norm() < 1e-9);
    }

    #[test]
    fn posterior_variances_of_increments_are_those_of_the_inverse() {
        let field = field();
        let count = field.tree.len();
        let (mut a, mut g, patches, dense, _) = equations(&field);
        let of_patches = dense.view((OTHERS, OTHERS), (count, count)) + prior(&field);
        let covariance = of_patches.try_inverse().unwrap();
        let found = Eliminated::new(&field, patches, &mut a, &mut g).increment_variances(&field);
        for patch in field.tree.patches() {
            let mut increment = DVector::zeros(count);
            increment[patch.0] = 1.0;
            field.tree.parent(patch).into_iter().for_each(|parent| increment[parent.0] = -1.0);
            let wanted = increment.dot(&(&covariance * &increment));
            assert!((found[patch.0] - wanted).abs() < 1e-9 * wanted, "{} {wanted}", found[patch.0]);
        }
    }
}
