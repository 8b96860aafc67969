//! The linearised model as normal equations, frame by frame, with the poses' errors projected out.
//!
//! In a frame, residuals are `r = J δ + P b + ε`: `J` is the change with the effects' parameters, `P` that of the
//! lines' places with the pose, `b ~ N(0, Λ⁻¹)` the reference pose's error. Marginalising `b` leaves `J̃ᵀ W r = A δ`
//! with `J̃ = J − P (Pᵀ W P + Λ)⁻¹ Pᵀ W J` and `A = J̃ᵀ W J`: all later fits, tests and comparisons need only the sums
//! of `A` and `g = J̃ᵀ W r` over some frames, or over some part of the field.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{DMatrix, DVector, Matrix6, Vector6};
use rayon::prelude::*;

use crate::{
    linear_model::column::ColumnIndex,
    linear_model::normal_equations::NormalEquations,
    measurement::quantity::{Channel, Quantity},
    measurement::scalar::Measurement,
};

/// Residuals beyond this many standard deviations count nothing (Tukey's biweight).
const TUKEY: f64 = 5.0;
/// Rounds in which weights, standard deviations and the poses' scatter are found.
const ROUNDS: usize = 4;
/// Numbers of one frame are not independent: they are worth this part of as many that are.
pub(crate) const INDEPENDENT: f64 = 0.15;
/// Standard deviations of poses' errors at first: rotations (radians), positions (metres).
const WIDE: [f64; 2] = [0.01, 0.02];
/// Those of usual motion capture, which count where the pictures tell little, with this part of a recording's weight.
const USUAL: [f64; 2] = [0.0025, 0.003];
const USUAL_WEIGHT: f64 = 0.3;
/// Poses are never taken to be better than this.
const NARROW: [f64; 2] = [2e-4, 5e-4];
/// Side of a cell of the field, metres.
const CELL_M: f64 = 0.5;
/// Prior precision of a parameter in units of its range.
pub(crate) const PRIOR: f64 = 1.0;

/// A frame's rows with their derivatives.
#[derive(Debug, Clone)]
pub(crate) struct LinearizedFrame {
    pub(crate) measurements: Vec<Measurement>,
    /// Measured minus expected; not a number where there is nothing to compare.
    pub(crate) residuals: Vec<f64>,
    /// Change of what is expected with the columns, row by row: the columns that it changes with.
    pub(crate) jacobian: Vec<Vec<(ColumnIndex, f64)>>,
    /// Change of a line's offset with the pose, see [`crate::linear_model::prediction::pose_gradient`]; zero for other rows.
    pub(crate) pose: Vec<Vector6<f64>>,
}

impl LinearizedFrame {
    /// Compares nothing of a channel.
    pub(crate) fn leave_out(&mut self, channel: Channel) {
        for (row, residual) in self.measurements.iter().zip(&mut self.residuals) {
            if row.quantity.channel() == channel {
                *residual = f64::NAN;
            }
        }
    }
}

/// Whether poses were measured by something else than the pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ReferenceKind {
    /// All six numbers.
    Whole,
    /// Place and heading come from the pictures themselves: they are left free.
    Attitude,
}

/// The whole system.
#[derive(Debug, Clone)]
pub(crate) struct LinearSystem {
    /// Number of columns: the effects' and, behind them, the tolerances'.
    pub(crate) size: usize,
    pub(crate) frames: Vec<NormalEquations>,
    /// The same sums by view: frames in a row from one place show the same errors again and again.
    pub(crate) views: Vec<NormalEquations>,
    /// The same sums by cell of the field.
    pub(crate) cells: Vec<NormalEquations>,
    /// Standard deviations of a row.
    pub(crate) sigmas: BTreeMap<Quantity, f64>,
    /// Standard deviations of the poses' errors, see [`crate::linear_model::prediction::pose_gradient`].
    pub(crate) pose_sigmas: [f64; 6],
    /// Weights of all rows, frame by frame: 0 for what is no measurement.
    pub(crate) weights: Vec<Vec<f64>>,
}

impl LinearSystem {
    pub(crate) fn new(
        frames: &[&LinearizedFrame],
        size: usize,
        reference: ReferenceKind,
        views: &[usize],
    ) -> Self {
        let first = first_residuals(frames);
        let mut sigmas = group_sigmas(all_of(frames, first.iter()));
        let mut weights: Vec<Vec<f64>> =
            frames.iter().zip(&first).map(|(frame, first)| weigh(frame, first, &sigmas)).collect();
        let mut pose_sigmas = pose_sigmas(None, reference);
        for _ in 0..ROUNDS {
            let (sums, _) = by_frame(frames, &weights, &pose_sigmas);
            let all = solve(&sums, size);
            let left: Vec<FittedResiduals> = frames
                .iter()
                .zip(&weights)
                .map(|(frame, weights)| FittedResiduals::new(frame, weights, &all, &pose_sigmas))
                .collect();
            sigmas = group_sigmas(all_of(frames, left.iter().map(|left| &left.residuals)));
            weights = frames
                .iter()
                .zip(&left)
                .map(|(frame, left)| weigh(frame, &left.residuals, &sigmas))
                .collect();
            pose_sigmas = self::pose_sigmas(Some(&left), reference);
        }
        let (sums, projections) = by_frame(frames, &weights, &pose_sigmas);
        let cells = by_cell(frames, &weights, &projections);
        let views = by_view(&sums, views);
        Self { size, frames: sums, views, cells, sigmas, pose_sigmas, weights }
    }
}

/// What a fit leaves of a frame.
pub(crate) struct FittedResiduals {
    pub(crate) residuals: Vec<f64>,
    /// The pose's error, and how well that is known: its variances.
    pose: Vector6<f64>,
    pose_variance: Vector6<f64>,
}

impl FittedResiduals {
    pub(crate) fn new(
        frame: &LinearizedFrame,
        weights: &[f64],
        delta: &DVector<f64>,
        pose_sigmas: &[f64; 6],
    ) -> Self {
        let change = |row: &Vec<(ColumnIndex, f64)>| {
            row.iter().map(|(column, value)| value * delta[column.0]).sum::<f64>()
        };
        let mut residuals: Vec<f64> = frame
            .residuals
            .iter()
            .zip(&frame.jacobian)
            .map(|(residual, row)| residual - change(row))
            .collect();
        let (mut normal, mut gradient) = (prior(pose_sigmas), Vector6::zeros());
        for ((pose, &weight), residual) in frame.pose.iter().zip(weights).zip(&residuals) {
            if weight > 0.0 {
                normal.ger(weight, pose, pose, 1.0);
                gradient += weight * residual * pose;
            }
        }
        // A sum of squares and a prior: positive definite but for rounding.
        let covariance = normal.cholesky().map_or_else(Matrix6::zeros, |normal| normal.inverse());
        let pose = covariance * gradient;
        for (residual, row) in residuals.iter_mut().zip(&frame.pose) {
            *residual -= row.dot(&pose);
        }
        Self { residuals, pose, pose_variance: covariance.diagonal() }
    }
}

fn prior(sigmas: &[f64; 6]) -> Matrix6<f64> {
    Matrix6::from_diagonal(&Vector6::from(sigmas.map(|sigma| sigma.powi(-2))))
}

/// Least squares over all columns, each held by its prior.
fn solve(sums: &[NormalEquations], size: usize) -> DVector<f64> {
    let (mut a, mut g) = (DMatrix::identity(size, size) * PRIOR, DVector::zeros(size));
    sums.iter().for_each(|sums| sums.add_to(&mut a, &mut g));
    a.cholesky().map_or_else(|| DVector::zeros(size), |held| held.solve(&g))
}

/// Sums of each frame, and the pose's change in it.
fn by_frame(
    frames: &[&LinearizedFrame],
    weights: &[Vec<f64>],
    pose_sigmas: &[f64; 6],
) -> (Vec<NormalEquations>, Vec<Projection>) {
    let of_frame = |(frame, weights): (&&LinearizedFrame, &Vec<f64>)| {
        let projection = Projection::new(frame, weights, pose_sigmas);
        let rows: Vec<usize> = (0..frame.measurements.len()).collect();
        (sums_of(&[Part { frame, weights, projection: &projection, rows }]), projection)
    };
    frames.par_iter().zip(weights).map(of_frame).unzip()
}

fn by_view(frames: &[NormalEquations], views: &[usize]) -> Vec<NormalEquations> {
    let count = views.iter().max().map_or(0, |last| last + 1);
    let of_view = |view: usize| {
        let frames = frames.iter().zip(views).filter(move |(_, of)| **of == view);
        NormalEquations::together(frames.map(|(frame, _)| frame))
    };
    (0..count).map(of_view).filter(|sums| !sums.is_empty()).collect()
}

/// Frames, by their indices, with some of their rows.
type RowsOfFrames = Vec<(usize, Vec<usize>)>;

fn by_cell(
    frames: &[&LinearizedFrame],
    weights: &[Vec<f64>],
    projections: &[Projection],
) -> Vec<NormalEquations> {
    // In each cell the frames that see it, with their rows.
    let mut members: BTreeMap<(i32, i32), RowsOfFrames> = BTreeMap::new();
    for (index, frame) in frames.iter().enumerate() {
        for (row, _) in frame.measurements.iter().enumerate().filter(|(_, row)| !row.quantity.is_odometry()) {
            let cell = (frame.measurements[row].ground / CELL_M).floor();
            let lists = members.entry((cell.x as i32, cell.y as i32)).or_default();
            match lists.last_mut() {
                Some((last, rows)) if *last == index => rows.push(row),
                _ => lists.push((index, vec![row])),
            }
        }
    }
    let of_cell = |lists: RowsOfFrames| {
        let part = |(index, rows): (usize, Vec<usize>)| Part {
            frame: frames[index],
            weights: &weights[index],
            projection: &projections[index],
            rows,
        };
        sums_of(&lists.into_iter().map(part).collect::<Vec<_>>())
    };
    members.into_values().collect::<Vec<_>>().into_par_iter().map(of_cell).collect()
}

/// `(Pᵀ W P + Λ)⁻¹ Pᵀ W J`: the pose's change that imitates each column, for those that move lines.
struct Projection {
    /// In order.
    columns: Vec<ColumnIndex>,
    changes: Vec<Vector6<f64>>,
}

impl Projection {
    fn new(frame: &LinearizedFrame, weights: &[f64], pose_sigmas: &[f64; 6]) -> Self {
        let mut normal = prior(pose_sigmas);
        let mut cross: BTreeMap<ColumnIndex, Vector6<f64>> = BTreeMap::new();
        for (row, (pose, &weight)) in frame.pose.iter().zip(weights).enumerate() {
            if weight > 0.0 && frame.measurements[row].quantity == Quantity::LineOffset {
                normal.ger(weight, pose, pose, 1.0);
                for &(column, change) in &frame.jacobian[row] {
                    *cross.entry(column).or_insert_with(Vector6::zeros) += weight * change * pose;
                }
            }
        }
        // A sum of squares and a prior: positive definite but for rounding.
        let normal = normal.cholesky();
        let solve = |right: Vector6<f64>| match &normal {
            Some(normal) => normal.solve(&right),
            None => Vector6::zeros(),
        };
        let (columns, changes) = cross.into_iter().map(|(column, cross)| (column, solve(cross))).unzip();
        Self { columns, changes }
    }
}

/// Some rows of a frame.
struct Part<'a> {
    frame: &'a LinearizedFrame,
    weights: &'a [f64],
    projection: &'a Projection,
    rows: Vec<usize>,
}

impl Part<'_> {
    fn counted(&self) -> impl Iterator<Item = usize> {
        self.rows.iter().copied().filter(|&row| self.weights[row] > 0.0)
    }

    fn is_line(&self, row: usize) -> bool {
        self.frame.measurements[row].quantity == Quantity::LineOffset
    }

    /// Columns that its rows change with, and those that change with the pose.
    fn columns(&self) -> BTreeSet<ColumnIndex> {
        let plain = self.counted().flat_map(|row| &self.frame.jacobian[row]).map(|(column, _)| *column);
        let lines = self.counted().any(|row| self.is_line(row));
        let imitated = self.projection.columns.iter().copied().filter(|_| lines);
        plain.chain(imitated).collect()
    }
}

/// `J̃ᵀ W J` and `J̃ᵀ W r` of some rows of some frames.
fn sums_of(parts: &[Part<'_>]) -> NormalEquations {
    let columns: BTreeSet<ColumnIndex> = parts.iter().flat_map(Part::columns).collect();
    let mut sums = NormalEquations::zero(columns.into_iter().collect());
    for part in parts {
        for row in part.counted() {
            let (weight, residual) = (part.weights[row], part.frame.residuals[row]);
            let plain = part.frame.jacobian[row].iter();
            let plain: Vec<(usize, f64)> =
                plain.map(|(column, value)| (sums.place(*column), *value)).collect();
            for &(place, value) in &plain {
                sums.add(place, value, &plain, weight, residual);
            }
            if part.is_line(row) {
                for (&column, change) in part.projection.columns.iter().zip(&part.projection.changes) {
                    let place = sums.place(column);
                    sums.add(place, -change.dot(&part.frame.pose[row]), &plain, weight, residual);
                }
            }
        }
    }
    sums
}

/// Weights by Tukey's biweight of what a fit leaves.
pub(crate) fn weigh(
    frame: &LinearizedFrame,
    residuals: &[f64],
    sigmas: &BTreeMap<Quantity, f64>,
) -> Vec<f64> {
    let weight = |(row, residual): (&Measurement, &f64)| {
        let Some(&sigma) = sigmas.get(&row.quantity) else { return 0.0 };
        let variance = sigma * sigma + row.sigma * row.sigma;
        let outlying = (residual * residual / (TUKEY * TUKEY * variance)).min(1.0);
        let independent = if row.quantity.is_odometry() { 1.0 } else { INDEPENDENT };
        if residual.is_finite() { independent * (1.0 - outlying).powi(2) / variance } else { 0.0 }
    };
    frame.measurements.iter().zip(residuals).map(weight).collect()
}

/// Residuals of all frames with their rows.
fn all_of<'a>(
    frames: &'a [&'a LinearizedFrame],
    residuals: impl Iterator<Item = &'a Vec<f64>>,
) -> impl Iterator<Item = (&'a Measurement, f64)> {
    frames
        .iter()
        .zip(residuals)
        .flat_map(|(frame, values)| frame.measurements.iter().zip(values.iter().copied()))
}

/// Residuals as weights are found by at first: those of the odometry about their medians. An effect that makes all its steps
/// longer would make them count less than its steps aside, which are little but the reference's errors.
fn first_residuals(frames: &[&LinearizedFrame]) -> Vec<Vec<f64>> {
    let mut groups: BTreeMap<Quantity, Vec<f64>> = BTreeMap::new();
    for (row, value) in all_of(frames, frames.iter().map(|frame| &frame.residuals)) {
        if row.quantity.is_odometry() && value.is_finite() {
            groups.entry(row.quantity).or_default().push(value);
        }
    }
    let medians: BTreeMap<Quantity, f64> =
        groups.into_iter().map(|(group, mut values)| (group, median(&mut values))).collect();
    let about = |(row, value): (&Measurement, &f64)| value - medians.get(&row.quantity).unwrap_or(&0.0);
    frames.iter().map(|frame| frame.measurements.iter().zip(&frame.residuals).map(about).collect()).collect()
}

/// Standard deviations by the median of absolute residuals about zero.
fn group_sigmas<'a>(rows: impl Iterator<Item = (&'a Measurement, f64)>) -> BTreeMap<Quantity, f64> {
    let mut groups: BTreeMap<Quantity, Vec<f64>> = BTreeMap::new();
    for (row, residual) in rows.filter(|(_, residual)| residual.is_finite()) {
        groups.entry(row.quantity).or_default().push(residual.abs());
    }
    groups.into_iter().map(|(group, mut values)| (group, (1.4826 * median(&mut values)).max(1e-6))).collect()
}

pub(crate) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The scatter of the poses' errors from frame to frame: what changes slowly is no error of the reference. What is not known
/// of an error adds to it, or errors that are hardly seen would shrink to nothing; what is usual holds it, or they would
/// stay as wide as they are at first (expectation maximisation with an inverse gamma prior).
fn pose_sigmas(left: Option<&[FittedResiduals]>, reference: ReferenceKind) -> [f64; 6] {
    let mut sigmas = [WIDE[0], WIDE[0], WIDE[0], WIDE[1], WIDE[1], WIDE[1]];
    if let Some(left) = left {
        for (axis, sigma) in sigmas.iter_mut().enumerate() {
            let mut steps: Vec<f64> =
                left.windows(2).map(|pair| (pair[1].pose[axis] - pair[0].pose[axis]).abs()).collect();
            let mut unknown: Vec<f64> = left.iter().map(|left| left.pose_variance[axis]).collect();
            let scatter = 1.4826 * median(&mut steps) / std::f64::consts::SQRT_2;
            let found = scatter * scatter + median(&mut unknown);
            let usual = USUAL[axis / 3].powi(2);
            let variance = (found + USUAL_WEIGHT * usual) / (1.0 + USUAL_WEIGHT);
            *sigma = variance.sqrt().max(NARROW[axis / 3]);
        }
    }
    if reference == ReferenceKind::Attitude {
        // Yaw, x and y.
        (sigmas[1], sigmas[3], sigmas[4]) = (0.1, 0.3, 0.3);
    }
    sigmas
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Noise, measurement};

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
