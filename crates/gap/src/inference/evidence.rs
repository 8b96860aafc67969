//! Fits of sets of columns to a linear system, with their covariances and tests.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::{
    inference::cluster_covariance,
    inference::hypothesis_test::{
        bartlett_degrees, bartlett_interval_factor, hotelling_p_value, independent_interval_factor,
        multiple_p_value,
    },
    linear_model::column::ColumnIndex,
    linear_model::reduced_equations::{Fit, MOST_PRIOR_SHARE, ProjectedEquations, ReducedEquations},
    linear_model::{normal_equations::PRIOR, system::LinearSystem},
    thresholds::Thresholds,
};

/// Degrees of freedom from which on more do not change a p-value.
const MOST_DEGREES: f64 = 1e4;
const SURFACE_AGREEMENT: f64 = Thresholds::DEFAULT.inference.surface_agreement;

/// Linear system with the present model as its origin.
#[derive(Debug)]
pub(crate) struct Evidence<'a> {
    pub(crate) system: &'a LinearSystem,
    /// Present model in the coordinates of the fitted parameters' columns.
    pub(crate) base: DVector<f64>,
    /// Equations of all training frames.
    total: ReducedEquations,
    /// Evidence of the levels of one surface alone, beside everything else.
    of_one_surface: Vec<Self>,
    /// Equations by view and by cell of the field.
    views: Vec<ProjectedEquations>,
    cells: Vec<ProjectedEquations>,
}

/// Equations of the fitted parameters alone in the parts of a recording, with all else projected out.
pub(crate) struct ReducedRecording {
    pub(crate) frames: Vec<ProjectedEquations>,
    pub(crate) cells: Vec<ProjectedEquations>,
    /// Equations that the priors of nuisance parameters and reflectance add to the sum of all frames.
    pub(crate) priors: ProjectedEquations,
    /// Scatter of the scores that the priors of nuisance parameters make, and of that by the reflectance.
    pub(crate) prior_scatter: [DMatrix<f64>; 2],
}

impl<'a> Evidence<'a> {
    /// Creates the evidence of a system. `base` is the present model in the coordinates of the fitted parameters' columns;
    /// the columns of the nuisance parameters follow behind them.
    pub(crate) fn new(system: &'a LinearSystem, base: DVector<f64>) -> Self {
        let total = ReducedEquations::new(system.frames.iter(), &system.columns);
        let alone = |system: &'a LinearSystem| Self::new(system, base.clone());
        let of_one_surface = system.of_one_surface.iter().map(alone).collect();
        let (views, cells) = (total.projected(&system.views), total.projected(&system.cells));
        Self { system, base, total, of_one_surface, views, cells }
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

    /// Returns the evidence without the levels of lines and that without those of carpet.
    pub(crate) fn of_one_surface(&self) -> &[Self] {
        &self.of_one_surface
    }

    /// Returns the equations of the fitted parameters alone, part by part.
    pub(crate) fn reduced(&self) -> ReducedRecording {
        ReducedRecording {
            frames: self.total.projected(&self.system.frames),
            cells: self.cells.clone(),
            priors: self.total.nuisance_priors(),
            prior_scatter: self
                .total
                .prior_scatter(&ColumnIndex::first(self.total.parameters()).collect::<Vec<_>>()),
        }
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
    fn covariances(&self, fit: &Fit) -> [Covariance; 2] {
        let scores = |clusters: &[ProjectedEquations]| -> Vec<DVector<f64>> {
            clusters.iter().map(|cluster| cluster.score(fit)).collect()
        };
        let sandwich = |scatter: DMatrix<f64>| &fit.inverse * scatter * &fit.inverse;
        let [of_nuisances, of_reflectance] = self.total.prior_scatter(&fit.free);
        let [given_of_nuisances, given_of_reflectance] = self.system.prior_scatter(&fit.free);
        let of_priors = sandwich(of_nuisances + given_of_nuisances);
        let of_reflectance = sandwich(of_reflectance + given_of_reflectance);
        let size = fit.free.len();
        let scatter = [
            cluster_covariance::of_neighbours(&scores(&self.views), size),
            cluster_covariance::of_independent(&scores(&self.cells), size),
        ];
        scatter.map(|scatter| Covariance {
            sampled: sandwich(scatter),
            of_reflectance: of_reflectance.clone(),
            of_priors: of_priors.clone(),
        })
    }

    /// P-value of Wald's test that the effect vanishes in the columns `tested`, a subset of the free ones: the larger of the
    /// p-values by the two covariances.
    pub(crate) fn p_value(&self, fit: &Fit, tested: &[ColumnIndex]) -> f64 {
        self.larger_p_value(fit, tested, |seen, covariance, count| {
            hotelling_p_value(covariance, &self.values(fit, seen), count)
        })
    }

    /// Larger of the p-values by the two covariances of those of the tested columns that are seen. `test` takes these, their
    /// covariance and the number of clusters that it is as sure as.
    fn larger_p_value(
        &self,
        fit: &Fit,
        tested: &[ColumnIndex],
        test: impl Fn(&[ColumnIndex], &DMatrix<f64>, usize) -> f64,
    ) -> f64 {
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
        let seen = |covariance: &Covariance| {
            let ratio = |i: usize| covariance.sampled[(i, i)] / covariances[0].sampled[(i, i)];
            let on_field = tested.iter().filter_map(place).map(ratio);
            on_field.fold(0.0, f64::max) > Thresholds::DEFAULT.inference.least_field_variance_ratio
        };
        let with_counts = covariances.iter().zip(counts).filter(|(covariance, _)| seen(covariance));
        let places: Vec<usize> = tested.iter().filter_map(place).collect();
        let p_of = |(covariance, count): (&Covariance, usize)| {
            let part = covariance.of(&places);
            test(tested, &part.total(), part.effective_count(count, self.system.cells.len()))
        };
        with_counts.map(p_of).fold(0.0, f64::max)
    }

    /// Returns the fitted values of these columns.
    fn values(&self, fit: &Fit, columns: &[ColumnIndex]) -> DVector<f64> {
        DVector::from_fn(columns.len(), |i, _| self.base[columns[i].0] + fit.delta[columns[i].0])
    }

    /// P-value of Wald's test by the fit's own covariance, which holds the priors of nuisance parameters and reflectance: they
    /// are the same in all frames, so that no scatter between frames shows them.
    pub(crate) fn p_value_by_priors(&self, fit: &Fit, tested: &[ColumnIndex]) -> f64 {
        let places: Vec<usize> = tested.iter().filter_map(|&column| fit.position(column)).collect();
        let number = places.len();
        let part = DMatrix::from_fn(number, number, |i, j| fit.inverse[(places[i], places[j])]);
        let value = self.values(fit, tested);
        let Some(solved) = part.cholesky().map(|factor| factor.solve(&value)) else { return 1.0 };
        ChiSquared::new(number.max(1) as f64).map_or(1.0, |distribution| distribution.sf(value.dot(&solved)))
    }

    /// Largest p-value by the levels of lines and by those of carpet, each without the other's, that the tested columns are
    /// about what both together tell. Light acts on both alike; the reflectance of paint and that of
    /// carpet have nothing to do with each other (intersection-union test: Berger 1982).
    pub(crate) fn p_value_of_both_surfaces(&self, free: &[ColumnIndex], tested: &[ColumnIndex]) -> f64 {
        let Some(together) = self.fit(free) else { return 1.0 };
        let p_value = |alone: &Self| {
            let Some(fit) = alone.fit(free) else { return 1.0 };
            alone.larger_p_value(&fit, tested, |seen, covariance, count| {
                let [alone, wanted] = [alone.values(&fit, seen), self.values(&together, seen)];
                multiple_p_value(covariance, &alone, &wanted, SURFACE_AGREEMENT, count)
            })
        };
        self.of_one_surface.iter().map(p_value).fold(0.0, f64::max)
    }

    /// Standard deviation of a free column, of which 1.96 make a 95 % interval although the clusters are few. A column held only by
    /// its prior scatters little between frames, so the prior's variance is added.
    pub(crate) fn sigma(&self, fit: &Fit, column: ColumnIndex) -> f64 {
        let Some(place) = fit.position(column) else { return 0.0 };
        let covariances = self.covariances(fit);
        let [by_views, by_cells] = [0, 1].map(|by| covariances[by].sampled[(place, place)]);
        let variances = [
            by_views * bartlett_interval_factor(self.views()).powi(2),
            by_cells * independent_interval_factor(self.system.cells.len()).powi(2),
        ];
        let of_priors = PRIOR * fit.inverse.column(place).norm_squared()
            + covariances[0].of_reflectance[(place, place)]
            + covariances[0].of_priors[(place, place)];
        (variances.into_iter().fold(0.0, f64::max) + of_priors).sqrt()
    }

    /// Correlation of the errors of two free columns, from their scatter between views and from their priors.
    pub(crate) fn correlation(&self, fit: &Fit, columns: [ColumnIndex; 2]) -> f64 {
        let [Some(i), Some(j)] = columns.map(|column| fit.position(column)) else { return 0.0 };
        let [scatter, _] = self.covariances(fit);
        let covariance = scatter.total() + &fit.inverse * &fit.inverse * PRIOR;
        let scale = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
        if scale > 0.0 { (covariance[(i, j)] / scale).clamp(-1.0, 1.0) } else { 0.0 }
    }
}

/// Covariance of estimates: what clusters scatter by, what the reflectance of places makes, and what the priors of nuisance
/// parameters allow, which is the same in all clusters.
#[derive(Debug, Clone)]
struct Covariance {
    sampled: DMatrix<f64>,
    of_reflectance: DMatrix<f64>,
    of_priors: DMatrix<f64>,
}

impl Covariance {
    fn total(&self) -> DMatrix<f64> {
        &self.sampled + &self.of_reflectance + &self.of_priors
    }

    /// Returns the covariance of some of the estimates.
    fn of(&self, places: &[usize]) -> Self {
        let part = |of: &DMatrix<f64>| {
            DMatrix::from_fn(places.len(), places.len(), |i, j| of[(places[i], places[j])])
        };
        Self {
            sampled: part(&self.sampled),
            of_reflectance: part(&self.of_reflectance),
            of_priors: part(&self.of_priors),
        }
    }

    /// Returns the number of clusters that would give a covariance as sure as this one: the sampled part was estimated from
    /// `count` clusters and that of the reflectance from `places`; what nominal values are trusted is known (Satterthwaite,
    /// Biometrics Bulletin 2, 1946; for several estimates with the mean squares of the parts' shares).
    fn effective_count(&self, count: usize, places: usize) -> usize {
        let size = self.sampled.nrows();
        let scale = self.total().diagonal().map(|variance| variance.max(f64::MIN_POSITIVE).sqrt());
        let scaled =
            |of: &DMatrix<f64>| DMatrix::from_fn(size, size, |i, j| of[(i, j)] / (scale[i] * scale[j]));
        // As in Hotelling's test, nearly equal parameters are kept apart.
        let total = scaled(&self.total()) + DMatrix::identity(size, size) * 1e-9;
        let Some(total) = total.cholesky() else { return count };
        let over_degrees = |part: &DMatrix<f64>, count: usize| {
            let share = total.solve(&scaled(part));
            (&share * &share).trace() / size.max(1) as f64 / count.saturating_sub(1).max(1) as f64
        };
        let inverse = over_degrees(&self.sampled, count) + over_degrees(&self.of_reflectance, places);
        inverse.max(1.0 / MOST_DEGREES).recip().round() as usize + 1
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
