//! Normal equations of the fitted parameters alone, with the nuisance parameters eliminated by a Schur complement, so that
//! the fit of any set of effects is small.
//!
//! With the columns in two blocks, fitted parameters `p` and nuisance parameters `n`, a fit has `δn = y − X δp` with
//! `X = (A_nn + I)⁻¹ A_np` and `y = (A_nn + I)⁻¹ g_n`. The reduced equations are `A_pp − A_pn X` and `g_p − A_pn y`.

use nalgebra::{DMatrix, DVector};

use crate::{
    linear_model::{
        column::ColumnIndex,
        normal_equations::{NormalEquations, PRIOR},
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

/// Normal equations of the fitted parameters, with the nuisance parameters eliminated.
#[derive(Debug, Clone)]
pub(crate) struct ReducedEquations {
    /// Schur complement `A_pp − A_pn X`.
    a: DMatrix<f64>,
    g: DVector<f64>,
    /// `X` and `y` of the nuisance parameters, see the module.
    x: DMatrix<f64>,
    y: DVector<f64>,
}

impl ReducedEquations {
    /// Reduces the sum of these equations, which have `size` columns: first those of the fitted parameters, `parameters` in
    /// number, then those of the nuisance parameters.
    pub(crate) fn new<'a>(
        equations: impl Iterator<Item = &'a NormalEquations>,
        size: usize,
        parameters: usize,
    ) -> Self {
        let (mut a, mut g) = (DMatrix::zeros(size, size), DVector::zeros(size));
        equations.for_each(|equations| equations.add_to(&mut a, &mut g));
        let count = size - parameters;
        let across = a.view((0, parameters), (parameters, count)).clone_owned();
        let mut nuisances = a.view((parameters, parameters), (count, count)).clone_owned();
        nuisances += DMatrix::identity(count, count) * PRIOR;
        // A sum of squares and a prior precision is positive definite, except for rounding.
        let solve = |right: &DMatrix<f64>| match nuisances.clone().cholesky() {
            Some(cholesky) => cholesky.solve(right),
            None => right * 0.0,
        };
        let x = solve(&a.view((parameters, 0), (count, parameters)).clone_owned());
        let rest = g.rows(parameters, count).clone_owned();
        let y = solve(&DMatrix::from_column_slice(count, 1, rest.as_slice())).column(0).clone_owned();
        Self {
            a: a.view((0, 0), (parameters, parameters)).clone_owned() - &across * &x,
            g: g.rows(0, parameters).clone_owned() - &across * &y,
            x,
            y,
        }
    }

    /// Returns the equations of the fitted parameters in a part of the measurements: the nuisance parameters follow them as in
    /// all measurements together.
    pub(crate) fn reduce(&self, part: &NormalEquations) -> NormalEquations {
        let parameters = self.g.len();
        let size = parameters + self.y.len();
        let combinations =
            DMatrix::from_fn(size, parameters, |row, column| match row.checked_sub(parameters) {
                Some(nuisance) => -self.x[(nuisance, column)],
                None => f64::from(u8::from(row == column)),
            });
        let zeros = DVector::zeros(parameters);
        part.combined(
            &combinations,
            &DVector::from_iterator(size, zeros.iter().chain(self.y.iter()).copied()),
        )
    }

    /// Returns the equations that the nuisance parameters' priors add to those of all parts, as [`Self::reduce`] makes them.
    pub(crate) fn nuisance_priors(&self) -> NormalEquations {
        NormalEquations::of_all(self.x.transpose() * &self.x * PRIOR, self.x.transpose() * &self.y * PRIOR)
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

    /// Returns the free columns' part of a score of all columns, with the nuisance parameters projected out.
    pub(crate) fn projected(&self, scores: &DVector<f64>, free: &[ColumnIndex]) -> DVector<f64> {
        let parameters = self.g.len();
        let nuisances = scores.rows(parameters, scores.len() - parameters);
        DVector::from_fn(free.len(), |i, _| scores[free[i].0] - self.x.column(free[i].0).dot(&nuisances))
    }

    /// Returns the contribution of the nuisance parameters' priors to the scatter of scores, which no frame shows.
    pub(crate) fn nuisance_scatter(&self, free: &[ColumnIndex]) -> DMatrix<f64> {
        DMatrix::from_fn(free.len(), free.len(), |i, j| {
            PRIOR * self.x.column(free[i].0).dot(&self.x.column(free[j].0))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        NormalEquations::dense(a, g)
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
        let reduced = ReducedEquations::new([normal_equations()].iter(), 4, 2);
        let fit = reduced.fit(&BOTH, &base).unwrap();
        assert!((fit.delta - at_once(&base)).norm() < 1e-12);
    }

    #[test]
    fn parts_and_priors_without_nuisance_parameters_add_up_to_the_reduced_equations() {
        let parts = [normal_equations(), normal_equations()];
        let all = ReducedEquations::new(parts.iter(), 4, 2);
        let reduced: Vec<NormalEquations> = parts.iter().map(|part| all.reduce(part)).collect();
        let priors = all.nuisance_priors();
        let sum = NormalEquations::sum(reduced.iter().chain([&priors]));
        let alone = ReducedEquations::new([sum].iter(), 2, 2);
        let base = DVector::zeros(2);
        let [one, other] = [&all, &alone].map(|equations| equations.fit(&BOTH, &base).unwrap());
        assert!((one.delta.rows(0, 2) - other.delta).norm() < 1e-12);
        assert!((one.inverse - other.inverse).norm() < 1e-12);
    }

    #[test]
    fn a_parameter_that_is_not_free_becomes_neutral() {
        let base = DVector::from_vec(vec![0.3, -0.2]);
        let fit = ReducedEquations::new([normal_equations()].iter(), 4, 2).fit(&BOTH[1..], &base).unwrap();
        assert_eq!(fit.delta[0], -0.3);
        assert!(fit.prior_share(BOTH[1]) < 1.0 && fit.prior_share(BOTH[0]) == 1.0);
    }

    #[test]
    fn a_held_parameter_keeps_its_value_and_the_free_ones_are_optimal_beside_it() {
        let base = DVector::from_vec(vec![0.3, -0.2]);
        let reduced = ReducedEquations::new([normal_equations()].iter(), 4, 2);
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
        let reduced = ReducedEquations::new([normal_equations()].iter(), 4, 2);
        let gain = |delta: &DVector<f64>| reduced.gain(delta) - 0.5 * PRIOR * delta.rows(0, 2).norm_squared();
        let best = reduced.fit(&BOTH, &base).unwrap().delta;
        for step in [[0.1, 0.0], [-0.1, 0.0], [0.0, 0.1], [0.0, -0.1]] {
            let mut other = best.clone();
            (other[0], other[1]) = (other[0] + step[0], other[1] + step[1]);
            assert!(gain(&other) < gain(&best));
        }
    }
}
