//! Sums over some frames, the tolerances solved for once: fits of any set of effects are then small.
//!
//! With the columns in two blocks, effects `p` and tolerances `t`, the tolerances of a fit are `δt = y − X δp` with
//! `X = (A_tt + I)⁻¹ A_tp` and `y = (A_tt + I)⁻¹ g_t`; what is left for the effects is the Schur complement
//! `A_pp − A_pt X` and `g_p − A_pt y`.

use nalgebra::{DMatrix, DVector};

use crate::{
    linear_model::column::ColumnIndex,
    linear_model::normal_equations::{NormalEquations, PRIOR},
    thresholds::Thresholds,
};

/// Largest part of a column's prior variance that a fit may leave where the recording shows the column at all.
pub(crate) const UNSEEN: f64 = Thresholds::DEFAULT.linear_model.most_prior_share;

/// A set of columns fitted to some frames; the other effects are held where they vanish.
#[derive(Debug, Clone)]
pub(crate) struct Fit {
    /// The effects' columns that are free.
    pub(crate) free: Vec<ColumnIndex>,
    /// Change of every column from where the model is.
    pub(crate) delta: DVector<f64>,
    /// Inverse of the information on the free columns.
    pub(crate) inverse: DMatrix<f64>,
}

impl Fit {
    /// Whether a free column is hardly better known than before.
    pub(crate) fn tells_nothing(&self, column: ColumnIndex) -> bool {
        self.place(column).is_some() && self.prior_share(column) > UNSEEN
    }

    /// Where a column is among those that are free.
    pub(crate) fn place(&self, column: ColumnIndex) -> Option<usize> {
        self.free.iter().position(|&free| free == column)
    }

    /// What a fit leaves of what was known of a free column before, as a part of its variance: 1 where it tells nothing.
    pub(crate) fn prior_share(&self, column: ColumnIndex) -> f64 {
        self.place(column).map_or(1.0, |place| self.inverse[(place, place)] * PRIOR)
    }
}

/// Sums over some frames.
#[derive(Debug, Clone)]
pub(crate) struct ReducedEquations {
    /// Left for the effects.
    a: DMatrix<f64>,
    g: DVector<f64>,
    /// The tolerances that follow from the effects.
    x: DMatrix<f64>,
    y: DVector<f64>,
}

impl ReducedEquations {
    /// Of frames, with `parameters` columns of effects before those of the tolerances.
    pub(crate) fn of<'a>(
        sums: impl Iterator<Item = &'a NormalEquations>,
        size: usize,
        parameters: usize,
    ) -> Self {
        let (mut a, mut g) = (DMatrix::zeros(size, size), DVector::zeros(size));
        sums.for_each(|sums| sums.add_to(&mut a, &mut g));
        let count = size - parameters;
        let across = a.view((0, parameters), (parameters, count)).clone_owned();
        let mut tolerances = a.view((parameters, parameters), (count, count)).clone_owned();
        tolerances += DMatrix::identity(count, count) * PRIOR;
        // Sums of squares and a prior: positive definite but for rounding.
        let solve = |right: &DMatrix<f64>| match tolerances.clone().cholesky() {
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

    /// Least squares over the free columns. `base` is where the model is, in the effects' coordinates.
    pub(crate) fn fit(&self, free: &[ColumnIndex], base: &DVector<f64>) -> Option<Fit> {
        self.fit_beside(free, base, &-base)
    }

    /// Least squares over the free columns, the others changed by what is held.
    pub(crate) fn fit_beside(
        &self,
        free: &[ColumnIndex],
        base: &DVector<f64>,
        held: &DVector<f64>,
    ) -> Option<Fit> {
        let mut effects = held.clone();
        for &column in free {
            effects[column.0] = 0.0;
        }
        let held = &self.g - &self.a * &effects;
        let count = free.len();
        let information = DMatrix::from_fn(count, count, |i, j| {
            let both = 0.5 * (self.a[(free[i].0, free[j].0)] + self.a[(free[j].0, free[i].0)]);
            both + if i == j { PRIOR } else { 0.0 }
        });
        let right = DVector::from_fn(count, |i, _| held[free[i].0] - PRIOR * base[free[i].0]);
        let inverse = information.try_inverse()?;
        let solved = &inverse * right;
        for (i, &column) in free.iter().enumerate() {
            effects[column.0] = solved[i];
        }
        let tolerances = &self.y - &self.x * &effects;
        let delta = DVector::from_iterator(
            effects.len() + tolerances.len(),
            effects.iter().chain(tolerances.iter()).copied(),
        );
        Some(Fit { free: free.to_vec(), delta, inverse })
    }

    /// What moving by this gains, the tolerances solved for; up to a constant.
    pub(crate) fn gain(&self, delta: &DVector<f64>) -> f64 {
        let effects = delta.rows(0, self.g.len());
        self.g.dot(&effects) - 0.5 * effects.dot(&(&self.a * effects))
    }

    /// The free effects' part of scores of all columns, the tolerances projected out.
    pub(crate) fn projected(&self, scores: &DVector<f64>, free: &[ColumnIndex]) -> DVector<f64> {
        let parameters = self.g.len();
        let tolerances = scores.rows(parameters, scores.len() - parameters);
        DVector::from_fn(free.len(), |i, _| scores[free[i].0] - self.x.column(free[i].0).dot(&tolerances))
    }

    /// What the tolerances' own prior adds to the scatter of scores: no frame shows it.
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

    /// A well-conditioned system: two effects and two tolerances.
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

    fn sums() -> NormalEquations {
        let (a, g) = equations();
        NormalEquations::whole(a, g)
    }

    /// All four columns solved for at once.
    fn at_once(base: &DVector<f64>) -> DVector<f64> {
        let (a, g) = equations();
        let held = a + DMatrix::identity(4, 4) * PRIOR;
        let prior = DVector::from_vec(vec![base[0], base[1], 0.0, 0.0]) * PRIOR;
        held.try_inverse().unwrap() * (g - prior)
    }

    #[test]
    fn tolerances_solved_for_once_give_the_fit_of_all_at_once() {
        let base = DVector::from_vec(vec![0.3, -0.2]);
        let total = ReducedEquations::of([sums()].iter(), 4, 2);
        let fit = total.fit(&BOTH, &base).unwrap();
        assert!((fit.delta - at_once(&base)).norm() < 1e-12);
    }

    #[test]
    fn an_effect_that_is_not_free_goes_to_where_it_vanishes() {
        let base = DVector::from_vec(vec![0.3, -0.2]);
        let fit = ReducedEquations::of([sums()].iter(), 4, 2).fit(&BOTH[1..], &base).unwrap();
        assert_eq!(fit.delta[0], -0.3);
        assert!(fit.prior_share(BOTH[1]) < 1.0 && fit.prior_share(BOTH[0]) == 1.0);
    }

    #[test]
    fn what_is_held_stays_there_and_the_others_are_best_beside_it() {
        let base = DVector::from_vec(vec![0.3, -0.2]);
        let total = ReducedEquations::of([sums()].iter(), 4, 2);
        let held = DVector::from_vec(vec![0.25, 7.0]);
        let fit = total.fit_beside(&BOTH[1..], &base, &held).unwrap();
        assert_eq!(fit.delta[0], 0.25);
        let gain = |second: f64| {
            let delta = DVector::from_vec(vec![0.25, second]);
            total.gain(&delta) - 0.5 * PRIOR * (base[1] + second).powi(2)
        };
        let best = fit.delta[1];
        assert!(gain(best) > gain(best + 0.05) && gain(best) > gain(best - 0.05));
    }

    #[test]
    fn a_fit_gains_most() {
        let base = DVector::zeros(2);
        let total = ReducedEquations::of([sums()].iter(), 4, 2);
        let gain = |delta: &DVector<f64>| total.gain(delta) - 0.5 * PRIOR * delta.rows(0, 2).norm_squared();
        let best = total.fit(&BOTH, &base).unwrap().delta;
        for step in [[0.1, 0.0], [-0.1, 0.0], [0.0, 0.1], [0.0, -0.1]] {
            let mut other = best.clone();
            (other[0], other[1]) = (other[0] + step[0], other[1] + step[1]);
            assert!(gain(&other) < gain(&best));
        }
    }
}
