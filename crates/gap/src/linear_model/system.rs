//! The linearised model of a recording as normal equations, frame by frame, with the pose errors marginalised.
//!
//! The residuals of a frame are `r = J δ + P b + ε`, where `J` is the Jacobian of the predictions in the columns, `P` that
//! of the line offsets in the pose, and `b ~ N(0, Λ⁻¹)` the error of the reference pose. Marginalising `b` gives
//! `J̃ᵀ W r = A δ` with `J̃ = J − P (Pᵀ W P + Λ)⁻¹ Pᵀ W J` and `A = J̃ᵀ W J`. Sums of `A` and `g = J̃ᵀ W r` over frames, or
//! over a part of the field, suffice for all later fits, tests and comparisons.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use reality_sim_sensor::Surface;

use crate::{
    frame_index::ViewIndex,
    linear_model::{
        assembly::{by_cell, by_frame, by_view},
        column::{ColumnIndex, Columns},
        fitted_residuals::FittedResiduals,
        linearized_frame::LinearizedFrame,
        normal_equations::NormalEquations,
        pose_error::pose_sigmas,
        reduced_equations::ReducedEquations,
        reflectance::{IncrementVariances, ReflectanceField},
        robust_weights::{first_residuals, sigmas_by_quantity, weigh, with_residuals},
    },
    measurement::quantity::Quantity,
    recording::ReferenceKind,
    thresholds::Thresholds,
};

/// Number of iterations of reweighted least squares.
const ITERATIONS: usize = Thresholds::DEFAULT.linear_model.reweighting_rounds;

/// Normal equations of a recording's training frames.
#[derive(Debug, Clone)]
pub(crate) struct LinearSystem {
    /// Columns, with the prior of the reflectance.
    pub(crate) columns: Columns,
    /// Normal equations by frame.
    pub(crate) frames: Vec<NormalEquations>,
    /// Normal equations by view. Successive frames from one place share their errors and form one cluster.
    pub(crate) views: Vec<NormalEquations>,
    /// Normal equations by cell of the field.
    pub(crate) cells: Vec<NormalEquations>,
    /// Standard deviations of the residuals.
    pub(crate) sigmas: BTreeMap<Quantity, f64>,
    /// Standard deviations of the pose errors, slow ones included, in the order of
    /// [`crate::linear_model::pose_gradient::pose_gradient`].
    pub(crate) pose_sigmas: [f64; 6],
    /// Weights of the measurements of each frame; 0 for outliers and missing residuals.
    pub(crate) weights: Vec<Vec<f64>>,
    /// Scatter of the sum of all scores by the priors of nuisance parameters and of reflectance that are no columns of this
    /// system; None where there are no others.
    pub(crate) prior_scatter: Option<[DMatrix<f64>; 2]>,
    /// The same system without the levels of lines, and without those of carpet; empty in these systems themselves.
    pub(crate) of_one_surface: Vec<Self>,
}

impl LinearSystem {
    /// Assembles the normal equations with these weights. `views` gives each frame's view.
    pub(crate) fn new(
        frames: &[&LinearizedFrame],
        columns: Columns,
        weighting: &Weighting,
        views: &[ViewIndex],
    ) -> Self {
        let field = ReflectanceField { variances: weighting.variances.clone(), ..columns.field };
        let columns = Columns { field: field.of_shared_brightness(), ..columns };
        Self::with_each_surface(frames, weighting, &columns, views)
    }

    /// Assembles the normal equations with these weights, and those without the levels of each surface.
    fn with_each_surface(
        frames: &[&LinearizedFrame],
        weighting: &Weighting,
        columns: &Columns,
        views: &[ViewIndex],
    ) -> Self {
        let alone = |without| {
            let weights = weighting.without_levels_of(frames, without);
            let weighting = Weighting { weights, ..weighting.clone() };
            Self { weights: Vec::new(), ..Self::assembled(frames, &weighting, columns, views) }
        };
        let of_one_surface = Surface::ALL.map(alone).into();
        Self { of_one_surface, ..Self::assembled(frames, weighting, columns, views) }
    }

    /// Creates the system of equations that depend on a few fitted parameters alone. `views` gives each frame's view.
    pub(crate) fn of_equations(
        parameters: usize,
        frames: Vec<NormalEquations>,
        cells: Vec<NormalEquations>,
        views: &[ViewIndex],
    ) -> Self {
        Self {
            columns: Columns::of_parameters(parameters),
            views: by_view(&frames, views),
            frames,
            cells,
            sigmas: BTreeMap::new(),
            pose_sigmas: [1.0; 6],
            weights: Vec::new(),
            prior_scatter: None,
            of_one_surface: Vec::new(),
        }
    }

    /// Returns the part of [`Self::prior_scatter`] that belongs to these columns.
    pub(crate) fn prior_scatter(&self, free: &[ColumnIndex]) -> [DMatrix<f64>; 2] {
        let size = free.len();
        match &self.prior_scatter {
            Some(scatter) => scatter
                .each_ref()
                .map(|scatter| DMatrix::from_fn(size, size, |i, j| scatter[(free[i].0, free[j].0)])),
            None => [DMatrix::zeros(size, size), DMatrix::zeros(size, size)],
        }
    }

    /// Assembles the normal equations with these weights.
    fn assembled(
        frames: &[&LinearizedFrame],
        weighting: &Weighting,
        columns: &Columns,
        views: &[ViewIndex],
    ) -> Self {
        let Weighting { sigmas, weights, pose_sigmas, .. } = weighting.clone();
        let (equations, projections) = by_frame(frames, &weights, &pose_sigmas);
        let cells = by_cell(frames, &weights, &projections);
        let views = by_view(&equations, views);
        Self {
            columns: columns.clone(),
            frames: equations,
            views,
            cells,
            sigmas,
            pose_sigmas,
            weights,
            prior_scatter: None,
            of_one_surface: Vec::new(),
        }
    }

    /// Returns the system of frames with other columns, with the weights of this one.
    pub(crate) fn with_columns(
        &self,
        frames: &[&LinearizedFrame],
        columns: &Columns,
        views: &[ViewIndex],
    ) -> Self {
        let weighting = Weighting {
            sigmas: self.sigmas.clone(),
            weights: self.weights.clone(),
            pose_sigmas: self.pose_sigmas,
            variances: columns.field.variances.clone(),
        };
        Self::with_each_surface(frames, &weighting, columns, views)
    }

    /// Returns the values of nuisance parameters that fit the levels of these frames beside the reflectance of all places.
    /// `columns` are those of the frames, without fitted parameters.
    pub(crate) fn nuisances_of_levels(&self, frames: &[&LinearizedFrame], columns: &Columns) -> DVector<f64> {
        let mut values = DVector::zeros(columns.len());
        // What is an outlier is seen after the first time.
        for _ in 0..2 {
            let weigh = |frame: &&LinearizedFrame| -> Vec<f64> {
                let unweighted = vec![0.0; frame.residuals.len()];
                let fit = FittedResiduals::new(frame, &unweighted, &values, columns, &self.pose_sigmas);
                let weights = weigh(frame, &fit.residuals, &self.sigmas).into_iter();
                let of_level = frame.measurements.iter().zip(weights);
                of_level.map(|(row, weight)| if row.quantity.is_level() { weight } else { 0.0 }).collect()
            };
            let weights: Vec<Vec<f64>> = frames.iter().map(weigh).collect();
            let (equations, _) = by_frame(frames, &weights, &self.pose_sigmas);
            (values, _) = solve(&equations, columns);
        }
        values
    }

    /// Returns the gain in log-likelihood by a fit of these frames' own columns, with the weights of the system.
    pub(crate) fn gain_of(&self, frames: &[&LinearizedFrame], parameters: usize) -> f64 {
        let (equations, _) = by_frame(frames, &self.weights, &self.pose_sigmas);
        let columns = Columns::of_parameters(parameters);
        let (delta, _) = solve(&equations, &columns);
        equations.iter().map(|equations| equations.gain(&delta, &columns)).sum()
    }
}

/// Standard deviations and weights, estimated in turn with the fit that uses them.
#[derive(Debug, Clone)]
pub(crate) struct Weighting {
    sigmas: BTreeMap<Quantity, f64>,
    weights: Vec<Vec<f64>>,
    pub(crate) pose_sigmas: [f64; 6],
    /// Variances of the reflectance.
    variances: IncrementVariances,
}

impl Weighting {
    /// Estimates them by iteratively reweighted least squares; returns them with the frames' residuals in the last fit.
    pub(crate) fn estimate(
        frames: &[&LinearizedFrame],
        columns: &Columns,
        reference: ReferenceKind,
    ) -> (Self, Vec<FittedResiduals>) {
        let variances = columns.field.variances.clone();
        let first = Self::new(frames, &first_residuals(frames), pose_sigmas(None, reference), variances);
        first.refine(frames, columns, reference)
    }

    /// Estimates them further, with columns that may be others than before.
    pub(crate) fn refine(
        mut self,
        frames: &[&LinearizedFrame],
        columns: &Columns,
        reference: ReferenceKind,
    ) -> (Self, Vec<FittedResiduals>) {
        let mut columns = columns.clone();
        let mut fits = Vec::new();
        for _ in 0..ITERATIONS {
            columns.field.variances = self.variances.clone();
            (self, fits) = self.improved(frames, &columns, reference);
        }
        (self, fits)
    }

    /// Estimates standard deviations and weights from the residuals of each frame.
    fn new(
        frames: &[&LinearizedFrame],
        residuals: &[Vec<f64>],
        pose_sigmas: [f64; 6],
        variances: IncrementVariances,
    ) -> Self {
        let sigmas = sigmas_by_quantity(with_residuals(frames, residuals.iter()));
        let weights =
            frames.iter().zip(residuals).map(|(frame, residuals)| weigh(frame, residuals, &sigmas)).collect();
        Self { sigmas, weights, pose_sigmas, variances }
    }

    /// Returns the weights with those of one surface's levels set to 0.
    fn without_levels_of(&self, frames: &[&LinearizedFrame], surface: Surface) -> Vec<Vec<f64>> {
        let without = |(frame, weights): (&&LinearizedFrame, &Vec<f64>)| {
            let rows = frame.measurements.iter().zip(weights);
            rows.map(|(row, weight)| if row.quantity.surface() == Some(surface) { 0.0 } else { *weight })
                .collect()
        };
        frames.iter().zip(&self.weights).map(without).collect()
    }

    /// Estimates them anew from the residuals of a fit with these weights.
    fn improved(
        &self,
        frames: &[&LinearizedFrame],
        columns: &Columns,
        reference: ReferenceKind,
    ) -> (Self, Vec<FittedResiduals>) {
        let (equations, _) = by_frame(frames, &self.weights, &self.pose_sigmas);
        let (delta, variances) = solve(&equations, columns);
        let fits: Vec<FittedResiduals> = frames
            .iter()
            .zip(&self.weights)
            .map(|(frame, weights)| FittedResiduals::new(frame, weights, &delta, columns, &self.pose_sigmas))
            .collect();
        let pose_sigmas = pose_sigmas(Some(&fits), reference);
        let residuals: Vec<Vec<f64>> = fits.iter().map(|fit| fit.residuals.clone()).collect();
        (Self::new(frames, &residuals, pose_sigmas, variances), fits)
    }
}

/// Solves for all columns by least squares with their priors; returns them with the variances of the reflectance that this
/// solution suggests.
fn solve(equations: &[NormalEquations], columns: &Columns) -> (DVector<f64>, IncrementVariances) {
    let reduced = ReducedEquations::new(equations.iter(), columns);
    let free: Vec<ColumnIndex> = ColumnIndex::first(columns.parameters).collect();
    match reduced.fit(&free, &DVector::zeros(columns.parameters)) {
        Some(fit) => {
            let variances = reduced.increment_variances(&fit);
            (fit.delta, variances)
        }
        None => (DVector::zeros(columns.len()), columns.field.variances.clone()),
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector6;

    use super::*;
    use crate::{
        linear_model::{reflectance::PatchEquations, robust_weights::INDEPENDENT},
        testing::{Noise, measurement, parameters},
    };

    /// Returns frames of lines, each with a pose error of its own. The first column moves lines as a rotation of the camera
    /// does; the second, which has the true value `size`, does not.
    fn frames(seed: u64, pose_sigma: f64, size: f64) -> Vec<LinearizedFrame> {
        let mut noise = Noise(seed);
        (0..30)
            .map(|_| {
                let pose_error = Vector6::from_fn(|_, _| pose_sigma * noise.next());
                let mut frame = LinearizedFrame {
                    measurements: Vec::new(),
                    residuals: Vec::new(),
                    jacobian: Vec::new(),
                    patches: vec![None; 60],
                    pose_gradients: Vec::new(),
                };
                for _ in 0..60 {
                    let pose_gradient = Vector6::from_fn(|_, _| 100.0 * noise.next());
                    let other = noise.next();
                    frame.measurements.push(measurement(Quantity::LineOffset));
                    frame.residuals.push(pose_gradient.dot(&pose_error) + size * other + 0.3 * noise.next());
                    frame.jacobian.push(vec![(ColumnIndex(0), pose_gradient[0]), (ColumnIndex(1), other)]);
                    frame.pose_gradients.push(pose_gradient);
                }
                frame
            })
            .collect()
    }

    fn system(frames: &[LinearizedFrame]) -> LinearSystem {
        let views: Vec<ViewIndex> = (0..frames.len()).map(ViewIndex).collect();
        let (frames, columns): (Vec<_>, _) = (frames.iter().collect(), parameters(2));
        let (weighting, _) = Weighting::estimate(&frames, &columns, ReferenceKind::Whole);
        LinearSystem::new(&frames, columns, &weighting, &views)
    }

    /// Returns the dense sum of normal equations.
    fn total(equations: &[NormalEquations]) -> (DMatrix<f64>, DVector<f64>) {
        let (mut a, mut g) = (DMatrix::zeros(2, 2), DVector::zeros(2));
        let mut patches = PatchEquations::zero(0, 2);
        equations.iter().for_each(|equations| equations.add_to(&mut a, &mut g, &mut patches));
        (a, g)
    }

    #[test]
    fn a_column_that_pose_errors_can_imitate_has_little_information_and_another_keeps_its_own() {
        let system = system(&frames(1, 0.01, 0.0));
        let information = total(&system.frames).0;
        // Without pose errors both columns would have the information of 1800 measurements, in their units 100² and 1.
        let kept =
            [information[(0, 0)] / 1e4, information[(1, 1)]].map(|kept| kept / (INDEPENDENT * 1800.0 / 0.09));
        assert!(kept[0] < 0.05, "{kept:?}");
        assert!(kept[1] > 0.7, "{kept:?}");
    }

    #[test]
    fn the_size_of_pose_errors_is_estimated_and_effects_are_measured_in_spite_of_them() {
        for seed in 0..8 {
            let system = system(&frames(seed, 0.005, 0.2));
            let mean = system.pose_sigmas.iter().sum::<f64>() / 6.0;
            assert!((0.0035..0.006).contains(&mean), "{:?}", system.pose_sigmas);
            let sigma = system.sigmas[&Quantity::LineOffset];
            assert!((sigma - 0.3).abs() < 0.05, "{sigma}");
            let delta = solve(&system.frames, &system.columns).0;
            assert!((delta[1] - 0.2).abs() < 0.05, "{delta}");
        }
    }

    #[test]
    fn errors_of_the_reference_to_the_side_do_not_bias_the_odometrys_scale() {
        let mut noise = Noise(5);
        let truth = 0.5;
        let frames: Vec<LinearizedFrame> = (0..40)
            .map(|_| {
                // The error of the reference is in the predicted step and hence in its derivative by the scale.
                let [ahead_m, aside_m] = [0.05 + 0.003 * noise.next(), 0.006 * noise.next()];
                LinearizedFrame {
                    measurements: vec![
                        measurement(Quantity::OdometryForward),
                        measurement(Quantity::OdometryLeft),
                    ],
                    residuals: vec![(1.0 + truth) * 0.05 - ahead_m, -aside_m],
                    jacobian: vec![vec![(ColumnIndex(0), ahead_m)], vec![(ColumnIndex(0), aside_m)]],
                    patches: vec![None; 2],
                    pose_gradients: vec![Vector6::zeros(); 2],
                }
            })
            .collect();
        let views: Vec<ViewIndex> = (0..frames.len()).map(ViewIndex).collect();
        let (frames, columns): (Vec<_>, _) = (frames.iter().collect(), parameters(1));
        let (weighting, _) = Weighting::estimate(&frames, &columns, ReferenceKind::Whole);
        let system = LinearSystem::new(&frames, columns, &weighting, &views);
        let delta = solve(&system.frames, &system.columns).0;
        assert!((delta[0] - truth).abs() < 0.1, "{delta}");
    }

    #[test]
    fn outliers_do_not_bias_the_fit() {
        let mut frames = frames(3, 0.005, 0.2);
        for frame in &mut frames {
            for residual in frame.residuals.iter_mut().step_by(9) {
                *residual += 12.0;
            }
        }
        let system = system(&frames);
        let delta = solve(&system.frames, &system.columns).0;
        assert!((delta[1] - 0.2).abs() < 0.06, "{delta}");
        let zero = system.weights[0].iter().step_by(9).filter(|weight| **weight == 0.0).count();
        assert_eq!(zero, 7);
    }

    #[test]
    fn equations_by_frame_by_view_and_by_cell_have_the_same_sum() {
        let system = system(&frames(4, 0.005, 0.1));
        let sum = |equations: &[NormalEquations]| total(equations).1;
        let (of_frames, of_views, of_cells) = (sum(&system.frames), sum(&system.views), sum(&system.cells));
        assert!((&of_frames - of_views).norm() < 1e-9 * of_frames.norm());
        assert!((&of_frames - of_cells).norm() < 1e-9 * of_frames.norm());
    }
}
