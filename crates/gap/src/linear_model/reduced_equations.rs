//! Normal equations of the fitted parameters alone, with the nuisance parameters and the reflectance of all places
//! eliminated by Schur complements, so that the fit of any set of effects is small.
//!
//! With the columns in two blocks, fitted parameters `p` and all others `n`, whose prior precision is `Q`, a fit has
//! `δn = y − X δp` with `X = (A_nn + Q)⁻¹ A_np` and `y = (A_nn + Q)⁻¹ g_n`. The reduced equations are `A_pp − A_pn X` and
//! `g_p − A_pn y`.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::{
    linear_model::{
        column::{ColumnIndex, Columns},
        normal_equations::{NormalEquations, PRIOR},
        reflectance::{Eliminated, IncrementVariances, PatchEquations, increment_variances},
    },
    thresholds::Thresholds,
};

/// Largest ratio of a column's posterior variance to its prior variance at which the recording counts as informative on it.
pub(crate) const MOST_PRIOR_SHARE: f64 = Thresholds::DEFAULT.linear_model.most_prior_share;

/// Fit of a set of columns to some frames, with the other fitted parameters held.
#[derive(Debug, Clone)]
pub(crate) struct Fit {
    /// Columns of fitted parameters that are free.
    pub(crate) free: Vec<ColumnIndex>,
    /// Change of every column from the present model.
    pub(crate) delta: DVector<f64>,
    /// Posterior covariance of the free columns: the inverse of their information.
    pub(crate) inverse: DMatrix<f64>,
}

impl Fit {
    /// Whether the fit tells hardly more of a free column than its prior.
    pub(crate) fn is_prior_dominated(&self, column: ColumnIndex) -> bool {
        self.position(column).is_some() && self.prior_share(column) > MOST_PRIOR_SHARE
    }

    /// Returns the position of a column among the free ones.
    pub(crate) fn position(&self, column: ColumnIndex) -> Option<usize> {
        self.free.iter().position(|&free| free == column)
    }

    /// Returns the ratio of a column's posterior variance to its prior variance; 1 if the column is not free.
    pub(crate) fn prior_share(&self, column: ColumnIndex) -> f64 {
        self.position(column).map_or(1.0, |position| self.inverse[(position, position)] * PRIOR)
    }
}

/// Normal equations of the fitted parameters, with the nuisance parameters and the reflectance eliminated.
#[derive(Debug, Clone)]
pub(crate) struct ReducedEquations {
    columns: Columns,
    /// Schur complement `A_pp − A_pn X`.
    a: DMatrix<f64>,
    g: DVector<f64>,
    /// `X` and `y` of the nuisance parameters and of the patches, see the module.
    x: DMatrix<f64>,
    y: DVector<f64>,
    eliminated: Eliminated,
}

impl ReducedEquations {
    /// Reduces the sum of these equations of `columns`.
    pub(crate) fn new<'a>(equations: impl Iterator<Item = &'a NormalEquations>, columns: &Columns) -> Self {
        let (dense, parameters, nuisances) = (columns.dense(), columns.parameters, columns.nuisances);
        let (mut a, mut g) = (DMatrix::zeros(dense, dense), DVector::zeros(dense));
        let mut patches = PatchEquations::zero(columns.field.tree.len(), dense);
        equations.for_each(|equations| equations.add_to(&mut a, &mut g, &mut patches));
        let eliminated = Eliminated::new(&columns.field, patches, &mut a, &mut g);
        let across = a.view((0, parameters), (parameters, nuisances)).clone_owned();
        let mut of_nuisances = a.view((parameters, parameters), (nuisances, nuisances)).clone_owned();
        of_nuisances += DMatrix::identity(nuisances, nuisances) * PRIOR;
        // A sum of squares and a prior precision is positive definite, except for rounding.
        let cholesky = of_nuisances.cholesky();
        let solve = |right: DMatrix<f64>| match &cholesky {
            Some(cholesky) => cholesky.solve(&right),
            None => right * 0.0,
        };
        let x = solve(a.view((parameters, 0), (nuisances, parameters)).clone_owned());
        let y = solve(DMatrix::from_column_slice(
            nuisances,
            1,
            g.rows(parameters, nuisances).clone_owned().as_slice(),
        ));
        let y = y.column(0).clone_owned();
        let (patches_x, patches_y) = eliminated.solution(&columns.field, &x, &y);
        Self {
            a: a.view((0, 0), (parameters, parameters)).clone_owned() - &across * &x,
            g: g.rows(0, parameters).clone_owned() - &across * &y,
            x: stacked(&x, &patches_x),
            y: DVector::from_iterator(nuisances + patches_y.len(), y.iter().chain(&patches_y).copied()),
            columns: columns.clone(),
            eliminated,
        }
    }

    /// Returns the number of fitted parameters.
    pub(crate) fn parameters(&self) -> usize {
        self.columns.parameters
    }

    /// Returns the equations that the priors of nuisance parameters and reflectance add to those of all parts, as
    /// [`Self::projected`] makes them.
    pub(crate) fn nuisance_priors(&self) -> ProjectedEquations {
        let all: Vec<ColumnIndex> = ColumnIndex::first(self.columns.parameters).collect();
        let score = all.iter().map(|column| {
            self.prior_products(self.of_column(*column), self.y.as_slice()).into_iter().sum::<f64>()
        });
        let [of_nuisances, of_reflectance] = self.prior_scatter(&all);
        ProjectedEquations { a: of_nuisances + of_reflectance, g: DVector::from_iterator(all.len(), score) }
    }

    /// Estimates the variances of the reflectance's increments from a fit to these equations.
    pub(crate) fn increment_variances(&self, fit: &Fit) -> IncrementVariances {
        let values = &fit.delta.as_slice()[self.columns.dense()..];
        increment_variances(&self.columns.field, &self.eliminated, values)
    }

    /// Fits the free columns by least squares; the other fitted parameters become neutral. `base` is the present model in the
    /// coordinates of the fitted parameters. None if the equations are singular.
    pub(crate) fn fit(&self, free: &[ColumnIndex], base: &DVector<f64>) -> Option<Fit> {
        self.fit_beside(free, base, &-base)
    }

    /// Fits the free columns by least squares while the other fitted parameters change by `held`.
    pub(crate) fn fit_beside(
        &self,
        free: &[ColumnIndex],
        base: &DVector<f64>,
        held: &DVector<f64>,
    ) -> Option<Fit> {
        let mut parameters = held.clone();
        for &column in free {
            parameters[column.0] = 0.0;
        }
        let score = &self.g - &self.a * &parameters;
        let count = free.len();
        let information = DMatrix::from_fn(count, count, |i, j| {
            let symmetric = 0.5 * (self.a[(free[i].0, free[j].0)] + self.a[(free[j].0, free[i].0)]);
            symmetric + if i == j { PRIOR } else { 0.0 }
        });
        let right = DVector::from_fn(count, |i, _| score[free[i].0] - PRIOR * base[free[i].0]);
        let inverse = information.try_inverse()?;
        let solved = &inverse * right;
        for (i, &column) in free.iter().enumerate() {
            parameters[column.0] = solved[i];
        }
        let nuisances = &self.y - &self.x * &parameters;
        let delta = DVector::from_iterator(
            parameters.len() + nuisances.len(),
            parameters.iter().chain(nuisances.iter()).copied(),
        );
        Some(Fit { free: free.to_vec(), delta, inverse })
    }

    /// Returns the gain in log-likelihood by a change of the fitted parameters, with the nuisance parameters refitted, up to a
    /// constant.
    pub(crate) fn gain(&self, delta: &DVector<f64>) -> f64 {
        let parameters = delta.rows(0, self.g.len());
        self.g.dot(&parameters) - 0.5 * parameters.dot(&(&self.a * parameters))
    }

    /// Returns the equations of some of the measurements with the nuisance parameters and the reflectance projected out as in
    /// the sum of all. The scores of a fit follow from them, see [`ProjectedEquations::score`].
    pub(crate) fn projected(&self, some: &[NormalEquations]) -> Vec<ProjectedEquations> {
        let parameters = self.g.len();
        // A change δ of the fitted parameters goes with one of y − X δ of the others.
        let mut z_transposed = DMatrix::zeros(parameters, self.columns.len());
        z_transposed.view_mut((0, 0), (parameters, parameters)).fill_with_identity();
        z_transposed.columns_mut(parameters, self.x.nrows()).copy_from(&-self.x.transpose());
        let mut others = DVector::zeros(self.columns.len());
        others.rows_mut(parameters, self.y.len()).copy_from(&self.y);
        let project = |equations: &NormalEquations| {
            let (a, g) = equations.projected(&z_transposed, &others, &self.columns);
            ProjectedEquations { a, g }
        };
        some.par_iter().map(project).collect()
    }

    /// Returns the contributions of the priors of nuisance parameters and of reflectance to the scatter of scores, which no
    /// frame shows.
    pub(crate) fn prior_scatter(&self, free: &[ColumnIndex]) -> [DMatrix<f64>; 2] {
        let mut scatter = [DMatrix::zeros(free.len(), free.len()), DMatrix::zeros(free.len(), free.len())];
        for (i, &one) in free.iter().enumerate() {
            for (j, &other) in free.iter().enumerate().skip(i) {
                let products = self.prior_products(self.of_column(one), self.of_column(other));
                for (scatter, product) in scatter.iter_mut().zip(products) {
                    (scatter[(i, j)], scatter[(j, i)]) = (product, product);
                }
            }
        }
        scatter
    }

    /// Returns the column of `X` that belongs to a fitted parameter.
    fn of_column(&self, column: ColumnIndex) -> &[f64] {
        let rows = self.x.nrows();
        &self.x.as_slice()[column.0 * rows..(column.0 + 1) * rows]
    }

    /// Returns `aᵀ Q b` for values of all nuisance parameters and patches, the part of the former and that of the latter.
    fn prior_products(&self, a: &[f64], b: &[f64]) -> [f64; 2] {
        let [(a, of_patches), (b, others)] = [a, b].map(|values| values.split_at(self.columns.nuisances));
        let nuisances: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        [PRIOR * nuisances, self.columns.field.prior_product(of_patches, others)]
    }
}

/// Equations of some measurements in the fitted parameters, with everything else projected out.
#[derive(Debug, Clone)]
pub(crate) struct ProjectedEquations {
    pub(crate) a: DMatrix<f64>,
    pub(crate) g: DVector<f64>,
}

impl ProjectedEquations {
    /// Returns the score in the free columns after a fit.
    pub(crate) fn score(&self, fit: &Fit) -> DVector<f64> {
        let parameters = fit.delta.rows(0, self.g.len());
        let score = |column: &ColumnIndex| self.g[column.0] - (self.a.row(column.0) * parameters)[0];
        DVector::from_iterator(fit.free.len(), fit.free.iter().map(score))
    }

    /// Returns the equations of some columns, with this share of the priors' equations.
    pub(crate) fn with_share_of(&self, priors: &Self, share: f64, columns: &[ColumnIndex]) -> Self {
        let entry = |i: usize, j: usize| {
            let place = (columns[i].0, columns[j].0);
            self.a[place] + share * priors.a[place]
        };
        let score = columns.iter().map(|column| self.g[column.0] + share * priors.g[column.0]);
        Self {
            a: DMatrix::from_fn(columns.len(), columns.len(), entry),
            g: DVector::from_iterator(columns.len(), score),
        }
    }
}

/// Returns one matrix above another.
fn stacked(above: &DMatrix<f64>, below: &DMatrix<f64>) -> DMatrix<f64> {
    let mut stacked = DMatrix::zeros(above.nrows() + below.nrows(), above.ncols());
    stacked.rows_mut(0, above.nrows()).copy_from(above);
    stacked.rows_mut(above.nrows(), below.nrows()).copy_from(below);
    stacked
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear_model::reflectance::{ReflectanceField, Tree};

    const BOTH: [ColumnIndex; 2] = [ColumnIndex(0), ColumnIndex(1)];

    /// Returns a well-conditioned system of two fitted and two nuisance parameters.
    fn equations() -> (DMatrix<f64>, DVector<f64>) {
        let factor = DMatrix::from_row_slice(
            5,
            4,
            &[
                1.0, 0.2, 0.5, 0.0, 0.3, 2.0, 0.1, 0.4, 0.0, 0.5, 1.5, 0.2, 0.7, 0.1, 0.3, 1.0, 0.2, 0.9,
                0.0, 0.6,
            ],
        );
        let residuals = DVector::from_vec(vec![0.5, -1.0, 2.0, 0.3, 1.2]);
        (factor.transpose() * &factor, factor.transpose() * residuals)
    }

    fn normal_equations() -> NormalEquations {
        let (a, g) = equations();
        NormalEquations::of_all(a, g)
    }

    /// Returns two fitted and two nuisance parameters.
    fn columns() -> Columns {
        Columns { parameters: 2, nuisances: 2, field: ReflectanceField::new(Tree::default()) }
    }

    /// Solves for all four columns at once.
    fn at_once(base: &DVector<f64>) -> DVector<f64> {
        let (a, g) = equations();
        let information = a + DMatrix::identity(4, 4) * PRIOR;
        let prior = DVector::from_vec(vec![base[0], base[1], 0.0, 0.0]) * PRIOR;
        information.try_inverse().unwrap() * (g - prior)
    }

    #[test]
    fn a_reduced_fit_equals_the_fit_of_all_columns_at_once() {
        let base = DVector::from_vec(vec![0.3, -0.2]);
        let reduced = ReducedEquations::new([normal_equations()].iter(), &columns());
        let fit = reduced.fit(&BOTH, &base).unwrap();
        assert!((fit.delta - at_once(&base)).norm() < 1e-12);
    }

    #[test]
    fn parts_and_priors_without_nuisance_parameters_add_up_to_the_reduced_equations() {
        let parts = [normal_equations(), normal_equations()];
        let all = ReducedEquations::new(parts.iter(), &columns());
        let parameters: Vec<ColumnIndex> = BOTH.to_vec();
        let priors = all.nuisance_priors();
        let sum = all.projected(&parts).into_iter().map(|part| part.with_share_of(&priors, 0.5, &parameters));
        let sum: Vec<NormalEquations> = sum.map(|part| NormalEquations::of_all(part.a, part.g)).collect();
        let alone = ReducedEquations::new(sum.iter(), &Columns { nuisances: 0, ..columns() });
        let base = DVector::zeros(2);
        let [one, other] = [&all, &alone].map(|equations| equations.fit(&BOTH, &base).unwrap());
        assert!((one.delta.rows(0, 2) - other.delta).norm() < 1e-12);
        assert!((one.inverse - other.inverse).norm() < 1e-12);
    }

    #[test]
    fn a_parameter_that_is_not_free_becomes_neutral() {
        let base = DVector::from_vec(vec![0.3, -0.2]);
        let fit =
            ReducedEquations::new([normal_equations()].iter(), &columns()).fit(&BOTH[1..], &base).unwrap();
        assert_eq!(fit.delta[0], -0.3);
        assert!(fit.prior_share(BOTH[1]) < 1.0 && fit.prior_share(BOTH[0]) == 1.0);
    }

    #[test]
    fn a_held_parameter_keeps_its_value_and_the_free_ones_are_optimal_beside_it() {
        let base = DVector::from_vec(vec![0.3, -0.2]);
        let reduced = ReducedEquations::new([normal_equations()].iter(), &columns());
        let held = DVector::from_vec(vec![0.25, 7.0]);
        let fit = reduced.fit_beside(&BOTH[1..], &base, &held).unwrap();
        assert_eq!(fit.delta[0], 0.25);
        let gain = |second: f64| {
            let delta = DVector::from_vec(vec![0.25, second]);
            reduced.gain(&delta) - 0.5 * PRIOR * (base[1] + second).powi(2)
        };
        let best = fit.delta[1];
        assert!(gain(best) > gain(best + 0.05) && gain(best) > gain(best - 0.05));
    }

    #[test]
    fn a_fit_has_the_largest_gain() {
        let base = DVector::zeros(2);
        let reduced = ReducedEquations::new([normal_equations()].iter(), &columns());
        let gain = |delta: &DVector<f64>| reduced.gain(delta) - 0.5 * PRIOR * delta.rows(0, 2).norm_squared();
        let best = reduced.fit(&BOTH, &base).unwrap().delta;
        for step in [[0.1, 0.0], [-0.1, 0.0], [0.0, 0.1], [0.0, -0.1]] {
            let mut other = best.clone();
            (other[0], other[1]) = (other[0] + step[0], other[1] + step[1]);
            assert!(gain(&other) < gain(&best));
        }
    }
}
