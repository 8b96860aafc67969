//! The linearised model of a recording as normal equations, frame by frame, with the poses' errors marginalised.
//!
//! In a frame, residuals are `r = J δ + P b + ε`: `J` is the Jacobian of the predictions in the parameters, `P` that of the
//! lines' offsets in the pose, and `b ~ N(0, Λ⁻¹)` the reference pose's error. Marginalising `b` leaves `J̃ᵀ W r = A δ`
//! with `J̃ = J − P (Pᵀ W P + Λ)⁻¹ Pᵀ W J` and `A = J̃ᵀ W J`. All later fits, tests and comparisons need no more than the
//! sums of `A` and `g = J̃ᵀ W r` over some frames, or over some part of the field.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use crate::{
    linear_model::{
        assembly::{by_cell, by_frame, by_view},
        fitted_residuals::FittedResiduals,
        linearized_frame::LinearizedFrame,
        normal_equations::{NormalEquations, PRIOR},
        pose_error::pose_sigmas,
        robust_weights::{all_of, first_residuals, sigmas_by_quantity, weigh},
    },
    measurement::quantity::Quantity,
    recording::ReferenceKind,
    thresholds::Thresholds,
};

const ROUNDS: usize = Thresholds::DEFAULT.linear_model.reweighting_rounds;

/// Normal equations of a recording.
#[derive(Debug, Clone)]
pub(crate) struct LinearSystem {
    /// Number of columns: the fitted parameters' and, behind them, the nuisance parameters'.
    pub(crate) size: usize,
    pub(crate) frames: Vec<NormalEquations>,
    /// Normal equations by view: successive frames from one place repeat the same errors, and form one cluster.
    pub(crate) views: Vec<NormalEquations>,
    /// Normal equations by cell of the field.
    pub(crate) cells: Vec<NormalEquations>,
    /// Standard deviations of residuals.
    pub(crate) sigmas: BTreeMap<Quantity, f64>,
    /// Standard deviations of the poses' errors, in the order of
    /// [`crate::linear_model::pose_gradient::pose_gradient`].
    pub(crate) pose_sigmas: [f64; 6],
    /// Weights of all measurements, frame by frame; 0 for outliers and what was not measured.
    pub(crate) weights: Vec<Vec<f64>>,
}

impl LinearSystem {
    /// Assembles the normal equations by iteratively reweighted least squares. `views` gives each frame's view.
    pub(crate) fn new(
        frames: &[&LinearizedFrame],
        size: usize,
        reference: ReferenceKind,
        views: &[usize],
    ) -> Self {
        let mut estimate = Weighting::new(frames, &first_residuals(frames), pose_sigmas(None, reference));
        for _ in 0..ROUNDS {
            estimate = estimate.improved(frames, size, reference);
        }
        let Weighting { sigmas, weights, pose_sigmas } = estimate;
        let (equations, projections) = by_frame(frames, &weights, &pose_sigmas);
        let cells = by_cell(frames, &weights, &projections);
        let views = by_view(&equations, views);
        Self { size, frames: equations, views, cells, sigmas, pose_sigmas, weights }
    }
}

/// Standard deviations and weights, found in turn with the fit that they are used in.
struct Weighting {
    sigmas: BTreeMap<Quantity, f64>,
    weights: Vec<Vec<f64>>,
    pose_sigmas: [f64; 6],
}

impl Weighting {
    /// Weights by the residuals of each frame.
    fn new(frames: &[&LinearizedFrame], residuals: &[Vec<f64>], pose_sigmas: [f64; 6]) -> Self {
        let sigmas = sigmas_by_quantity(all_of(frames, residuals.iter()));
        let weights =
            frames.iter().zip(residuals).map(|(frame, residuals)| weigh(frame, residuals, &sigmas)).collect();
        Self { sigmas, weights, pose_sigmas }
    }

    /// Weights by the residuals of a fit with these ones.
    fn improved(&self, frames: &[&LinearizedFrame], size: usize, reference: ReferenceKind) -> Self {
        let (equations, _) = by_frame(frames, &self.weights, &self.pose_sigmas);
        let delta = solve(&equations, size);
        let fits: Vec<FittedResiduals> = frames
            .iter()
            .zip(&self.weights)
            .map(|(frame, weights)| FittedResiduals::new(frame, weights, &delta, &self.pose_sigmas))
            .collect();
        let pose_sigmas = pose_sigmas(Some(&fits), reference);
        let residuals: Vec<Vec<f64>> = fits.into_iter().map(|fit| fit.residuals).collect();
        Self::new(frames, &residuals, pose_sigmas)
    }
}

/// Least squares over all columns, each with its prior `N(0, 1 / PRIOR)`.
fn solve(equations: &[NormalEquations], size: usize) -> DVector<f64> {
    let (mut a, mut g) = (DMatrix::identity(size, size) * PRIOR, DVector::zeros(size));
    equations.iter().for_each(|equations| equations.add_to(&mut a, &mut g));
    a.cholesky().map_or_else(|| DVector::zeros(size), |held| held.solve(&g))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector6;

    use super::*;
    use crate::{
        linear_model::{column::ColumnIndex, robust_weights::INDEPENDENT},
        testing::{Noise, measurement},
    };

    /// Frames of lines seen from a pose that is wrong by its own amount in each. The first column looks like a turn of the
    /// camera in all of them; the second does not; neither is at work but for `size` of the second.
    fn frames(seed: u64, pose_sigma: f64, size: f64) -> Vec<LinearizedFrame> {
        let mut noise = Noise(seed);
        (0..30)
            .map(|_| {
                let wrong = Vector6::from_fn(|_, _| pose_sigma * noise.next());
                let mut frame = LinearizedFrame {
                    measurements: Vec::new(),
                    residuals: Vec::new(),
                    jacobian: Vec::new(),
                    pose: Vec::new(),
                };
                for _ in 0..60 {
                    let pose = Vector6::from_fn(|_, _| 100.0 * noise.next());
                    let other = noise.next();
                    frame.measurements.push(measurement(Quantity::LineOffset));
                    frame.residuals.push(pose.dot(&wrong) + size * other + 0.3 * noise.next());
                    frame.jacobian.push(vec![(ColumnIndex(0), pose[0]), (ColumnIndex(1), other)]);
                    frame.pose.push(pose);
                }
                frame
            })
            .collect()
    }

    fn system(frames: &[LinearizedFrame]) -> LinearSystem {
        let views: Vec<usize> = (0..frames.len()).collect();
        LinearSystem::new(&frames.iter().collect::<Vec<_>>(), 2, ReferenceKind::Whole, &views)
    }

    /// All sums added up, of all columns.
    fn whole(sums: &[NormalEquations]) -> (DMatrix<f64>, DVector<f64>) {
        let (mut a, mut g) = (DMatrix::zeros(2, 2), DVector::zeros(2));
        sums.iter().for_each(|sums| sums.add_to(&mut a, &mut g));
        (a, g)
    }

    #[test]
    fn what_a_pose_can_imitate_tells_little_and_what_it_cannot_tells_all() {
        let system = system(&frames(1, 0.01, 0.0));
        let whole = whole(&system.frames).0;
        let total = |i: usize| whole[(i, i)];
        // Without a pose's error both columns would have 1800 rows' information, in their own units 100² and 1.
        let kept = [total(0) / 1e4, total(1)].map(|information| information / (INDEPENDENT * 1800.0 / 0.09));
        assert!(kept[0] < 0.05, "{kept:?}");
        assert!(kept[1] > 0.7, "{kept:?}");
    }

    #[test]
    fn the_poses_scatter_is_found_and_effects_are_measured_through_it() {
        for seed in 0..8 {
            let system = system(&frames(seed, 0.005, 0.2));
            let mean = system.pose_sigmas.iter().sum::<f64>() / 6.0;
            assert!((0.0035..0.006).contains(&mean), "{:?}", system.pose_sigmas);
            let sigma = system.sigmas[&Quantity::LineOffset];
            assert!((sigma - 0.3).abs() < 0.05, "{sigma}");
            let delta = solve(&system.frames, 2);
            assert!((delta[1] - 0.2).abs() < 0.05, "{delta}");
        }
    }

    #[test]
    fn steps_ahead_tell_of_the_odometrys_scale_and_the_references_errors_aside_do_not() {
        let mut noise = Noise(5);
        let truth = 0.5;
        let frames: Vec<LinearizedFrame> = (0..40)
            .map(|_| {
                // The reference's own error is in what is expected of a step, and with it in the step's change with scale.
                let [ahead_m, aside_m] = [0.05 + 0.003 * noise.next(), 0.006 * noise.next()];
                LinearizedFrame {
                    measurements: vec![
                        measurement(Quantity::OdometryForward),
                        measurement(Quantity::OdometryLeft),
                    ],
                    residuals: vec![(1.0 + truth) * 0.05 - ahead_m, -aside_m],
                    jacobian: vec![vec![(ColumnIndex(0), ahead_m)], vec![(ColumnIndex(0), aside_m)]],
                    pose: vec![Vector6::zeros(); 2],
                }
            })
            .collect();
        let views: Vec<usize> = (0..frames.len()).collect();
        let system = LinearSystem::new(&frames.iter().collect::<Vec<_>>(), 1, ReferenceKind::Whole, &views);
        let delta = solve(&system.frames, 1);
        assert!((delta[0] - truth).abs() < 0.1, "{delta}");
    }

    #[test]
    fn outliers_do_not_decide() {
        let mut frames = frames(3, 0.005, 0.2);
        for frame in &mut frames {
            for residual in frame.residuals.iter_mut().step_by(9) {
                *residual += 12.0;
            }
        }
        let system = system(&frames);
        let delta = solve(&system.frames, 2);
        assert!((delta[1] - 0.2).abs() < 0.06, "{delta}");
        let zero = system.weights[0].iter().step_by(9).filter(|weight| **weight == 0.0).count();
        assert_eq!(zero, 7);
    }

    #[test]
    fn sums_by_frame_view_and_cell_are_of_the_same_rows() {
        let system = system(&frames(4, 0.005, 0.1));
        let sum = |sums: &[NormalEquations]| whole(sums).1;
        let (of_frames, of_views, of_cells) = (sum(&system.frames), sum(&system.views), sum(&system.cells));
        assert!((&of_frames - of_views).norm() < 1e-9 * of_frames.norm());
        assert!((&of_frames - of_cells).norm() < 1e-9 * of_frames.norm());
    }
}
