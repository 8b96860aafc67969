//! Fits of sets of columns to a linear system, with their covariances and tests.

use nalgebra::{DMatrix, DVector};

use crate::{
    inference::cluster_covariance,
    inference::hypothesis_test::{
        bartlett_degrees, bartlett_interval_factor, hotelling_p_value, independent_interval_factor,
    },
    linear_model::column::ColumnIndex,
    linear_model::normal_equations::NormalEquations,
    linear_model::reduced_equations::{Fit, MOST_PRIOR_SHARE, ReducedEquations},
    linear_model::{normal_equations::PRIOR, system::LinearSystem},
    thresholds::Thresholds,
};

/// Linear system with the present model as its origin.
#[derive(Debug)]
pub(crate) struct Evidence<'a> {
    pub(crate) system: &'a LinearSystem,
    /// Present model in the coordinates of the fitted parameters' columns.
    pub(crate) base: DVector<f64>,
    /// Equations of all training frames.
    total: ReducedEquations,
}

impl<'a> Evidence<'a> {
    /// Creates the evidence of a system. `base` is the present model in the coordinates of the fitted parameters' columns;
    /// the columns of the nuisance parameters follow behind them.
    pub(crate) fn new(system: &'a LinearSystem, base: DVector<f64>) -> Self {
        let total = ReducedEquations::new(system.frames.iter(), system.size, base.len());
        Self { system, base, total }
    }

    /// Number of different views.
    pub(crate) fn views(&self) -> usize {
        self.system.views.len()
    }

    /// Degrees of freedom of the scatter between views. They are fewer than the views because neighbouring views are
    /// correlated.
    pub(crate) fn degrees_of_freedom(&self) -> usize {
        bartlett_degrees(self.views())
    }

    /// Returns the equations of the fitted parameters alone, with the nuisance parameters eliminated.
    pub(crate) fn reduced_system(&self) -> LinearSystem {
        let reduce = |parts: &[NormalEquations]| parts.iter().map(|part| self.total.reduce(part)).collect();
        LinearSystem {
            size: self.base.len(),
            frames: reduce(&self.system.frames),
            views: reduce(&self.system.views),
            cells: reduce(&self.system.cells),
            sigmas: self.system.sigmas.clone(),
            pose_sigmas: self.system.pose_sigmas,
            weights: Vec::new(),
        }
    }

    /// Returns what the nuisance parameters' priors tell of the fitted parameters.
    pub(crate) fn nuisance_priors(&self) -> NormalEquations {
        self.total.nuisance_priors()
    }

    /// Returns the scatter of the scores of these columns that the nuisance parameters' priors make.
    pub(crate) fn nuisance_scatter(&self, columns: &[ColumnIndex]) -> DMatrix<f64> {
        self.total.nuisance_scatter(columns)
    }

    /// Fits the free columns by least squares with their priors; the other columns are neutral. None if the fit is singular.
    pub(crate) fn fit(&self, free: &[ColumnIndex]) -> Option<Fit> {
        self.total.fit(free, &self.base)
    }

    /// Fits the free columns while the others change by `held`, in the columns' coordinates.
    pub(crate) fn fit_beside(&self, free: &[ColumnIndex], held: &DVector<f64>) -> Option<Fit> {
        self.total.fit_beside(free, &self.base, held)
    }

    /// Returns the gain in log-likelihood on the training frames from moving the model to a fit, with the nuisance
    /// parameters refitted.
    pub(crate) fn improvement(&self, fit: &Fit) -> f64 {
        self.total.gain(&fit.delta)
    }

    /// Returns two cluster-robust covariances of the free columns: one from the scatter of scores between views, one from
    /// their scatter between cells of the field.
    pub(crate) fn covariances(&self, fit: &Fit) -> [DMatrix<f64>; 2] {
        let scores = |sums: &'a [NormalEquations]| -> Vec<DVector<f64>> {
            let score = |sums: &NormalEquations| self.total.projected(&sums.score(&fit.delta), &fit.free);
            sums.iter().map(score).collect()
        };
        let nuisances = self.total.nuisance_scatter(&fit.free);
        let sandwich = |scatter: DMatrix<f64>| &fit.inverse * (scatter + &nuisances) * &fit.inverse;
        let size = fit.free.len();
        [
            sandwich(cluster_covariance::of_neighbours(&scores(&self.system.views), size)),
            sandwich(cluster_covariance::of_independent(&scores(&self.system.cells), size)),
        ]
    }

    /// P-value of Wald's test that the effect vanishes in the columns `tested`, a subset of the free ones: the larger of the
    /// p-values by the two covariances.
    pub(crate) fn p_value(&self, fit: &Fit, tested: &[ColumnIndex]) -> f64 {
        // Columns that cannot be seen have no scatter either.
        let tested: Vec<ColumnIndex> =
            tested.iter().copied().filter(|&column| fit.prior_share(column) < MOST_PRIOR_SHARE).collect();
        let tested = tested.as_slice();
        if tested.is_empty() {
            return 1.0;
        }
        let counts = [self.degrees_of_freedom() + 1, self.system.cells.len()];
        let covariances = self.covariances(fit);
        let place = |column: &ColumnIndex| fit.position(*column);
        // Parameters that are not observed on the field, such as those of the odometry, have no scatter between cells.
        let seen = |covariance: &DMatrix<f64>| {
            let on_field =
                tested.iter().filter_map(place).map(|i| covariance[(i, i)] / covariances[0][(i, i)]);
            on_field.fold(0.0, f64::max) > Thresholds::DEFAULT.inference.least_field_variance_ratio
        };
        let with_counts = covariances.iter().zip(counts).filter(|(covariance, _)| seen(covariance));
        with_counts.map(|(covariance, count)| self.p_of(fit, tested, covariance, count)).fold(0.0, f64::max)
    }

    /// P-value of the tested columns by one covariance, which was estimated from `count` clusters.
    fn p_of(&self, fit: &Fit, tested: &[ColumnIndex], covariance: &DMatrix<f64>, count: usize) -> f64 {
        let places: Vec<usize> = tested.iter().filter_map(|&column| fit.position(column)).collect();
        let number = places.len();
        let part = DMatrix::from_fn(number, number, |i, j| covariance[(places[i], places[j])]);
        let value = DVector::from_fn(number, |i, _| self.base[tested[i].0] + fit.delta[tested[i].0]);
        hotelling_p_value(&part, &value, count)
    }

    /// Standard deviation of a free column, of which 1.96 make a 95 % interval although the clusters are few. A column held only by
    /// its prior scatters little between frames, so the prior's variance is added.
    pub(crate) fn sigma(&self, fit: &Fit, column: ColumnIndex) -> f64 {
        let Some(place) = fit.position(column) else { return 0.0 };
        let [by_views, by_cells] = self.covariances(fit).map(|covariance| covariance[(place, place)]);
        let variances = [
            by_views * bartlett_interval_factor(self.views()).powi(2),
            by_cells * independent_interval_factor(self.system.cells.len()).powi(2),
        ];
        let of_prior = PRIOR * fit.inverse.column(place).norm_squared();
        (variances.into_iter().fold(0.0, f64::max) + of_prior).sqrt()
    }

    /// Correlation of the errors of two free columns, from their scatter between views and from their priors.
    pub(crate) fn correlation(&self, fit: &Fit, columns: [ColumnIndex; 2]) -> f64 {
        let [Some(i), Some(j)] = columns.map(|column| fit.position(column)) else { return 0.0 };
        let [scatter, _] = self.covariances(fit);
        let covariance = scatter + &fit.inverse * &fit.inverse * PRIOR;
        let scale = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
        if scale > 0.0 { (covariance[(i, j)] / scale).clamp(-1.0, 1.0) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{system_of, two_column_frames};

    const BOTH: [ColumnIndex; 2] = [ColumnIndex(0), ColumnIndex(1)];

    fn system(seed: u64, truth: [f64; 2], shared: f64) -> LinearSystem {
        system_of(two_column_frames(seed, truth, shared))
    }

    #[test]
    fn without_an_effect_p_values_are_uniform_although_measurements_of_a_frame_share_errors() {
        let p_values: Vec<f64> = (0..400)
            .map(|seed| {
                let system = system(seed, [0.0, 0.0], 1.0);
                let evidence = Evidence::new(&system, DVector::zeros(2));
                evidence.p_value(&evidence.fit(&BOTH).unwrap(), &BOTH[..1])
            })
            .collect();
        let below = |p: f64| p_values.iter().filter(|value| **value < p).count() as f64 / 400.0;
        // If the measurements were taken as independent, about 60 % of the tests would be significant at 5 %.
        assert!(below(0.05) < 0.12, "{}", below(0.05));
        assert!(below(0.005) < 0.03, "{}", below(0.005));
        assert!((below(0.5) - 0.5).abs() < 0.12, "{}", below(0.5));
    }

    #[test]
    fn an_effect_is_significant_and_intervals_of_95_percent_contain_the_true_size_as_often() {
        let mut inside = 0;
        for seed in 0..2000 {
            let system = system(seed, [0.6, -0.2], 0.5);
            let evidence = Evidence::new(&system, DVector::zeros(2));
            let fit = evidence.fit(&BOTH).unwrap();
            assert!(evidence.p_value(&fit, &BOTH[..1]) < 1e-3);
            let sigma = evidence.sigma(&fit, BOTH[0]);
            inside += usize::from((fit.delta[0] - 0.6).abs() < 1.96 * sigma);
        }
        assert!((1880..=1960).contains(&inside), "{inside} of 2000");
    }

    #[test]
    fn a_column_with_hardly_any_information_keeps_the_sigma_of_its_prior() {
        let mut frames = two_column_frames(1, [0.5, 0.0], 0.5);
        // The second column has almost no influence.
        for (a, g) in &mut frames {
            a.row_mut(1).scale_mut(1e-3);
            a.column_mut(1).scale_mut(1e-3);
            g[1] *= 1e-3;
        }
        let system = system_of(frames);
        let evidence = Evidence::new(&system, DVector::zeros(2));
        let fit = evidence.fit(&BOTH).unwrap();
        assert!(evidence.sigma(&fit, BOTH[1]) > 0.99 && evidence.sigma(&fit, BOTH[0]) < 0.1);
    }
}
