//! Columns of the fitted parameters against central differences of the full prediction.

use std::collections::BTreeMap;

use glam::DVec3;
use reality_sim_core::pose::{CameraPose, Pose2};
use reality_sim_sensor::{Changes, Growth, Model, Role, Stage, Trajectory};

use super::{recording, sequence};
use crate::{
    frame_index::{FrameIndex, PerFrame},
    linear_model::{
        initial_values::starting_values,
        linearization::{Others, linearise, measure_frames},
        linearized_frame::LinearizedFrame,
        parameters::{FittedParameter, fitted_parameters},
        reflectance::Tree,
    },
    measurement::{
        frame::FrameMeasurements,
        quantity::{Channel, Quantity},
        scalar::Measurement,
    },
    recording::Recording,
};

/// Half the width of a central difference, as a fraction of the step of the forward difference in the column.
const WIDTH: f64 = 0.05;
/// Allowed error of a derivative, as a fraction of the largest derivative of the same quantity: columns are forward
/// differences.
const TOLERANCE: f64 = 0.04;
/// The same where a change of either sign has the same result, so that the slope at zero vanishes: red and blue that are
/// apart blur luma, and the tone curve amplifies noise at some levels and attenuates it at others.
const BENT_TOLERANCE: f64 = 0.12;
/// Rounding error, in the unit of the measurement per range of the parameter.
const ROUNDING: f64 = 1e-9;

/// Whether a column has the tolerance [`BENT_TOLERANCE`] at a measurement.
fn is_bent(column: &FittedParameter, measurement: &Measurement) -> bool {
    match column.effect().id() {
        "chromatic_aberration" => measurement.quantity == Quantity::LineBlur,
        "tone_curve" => measurement.quantity == Quantity::NoiseVariance,
        _ => false,
    }
}

/// Whether the linearised model ignores a change on purpose: an effect of the noise also shifts the mean of dark areas slightly.
fn is_ignored(column: &FittedParameter, measurement: &Measurement) -> bool {
    let is_of_noise = matches!(column.effect().about().changes, Changes::Noise);
    is_of_noise && measurement.quantity.channel() != Channel::Noise
}

/// Returns values of an effect, all parameters at this fraction of the way from neutral to the upper end of their range.
fn values_at(recording: &Recording<'_>, column: &FittedParameter, part: f64) -> Vec<f64> {
    let parameters = column.effect().parameters().iter().zip(starting_values(column.effect(), recording));
    parameters
        .map(|(parameter, value)| match parameter.role {
            Role::Fixed => value,
            _ => parameter.neutral + part * (parameter.range[1] - parameter.neutral),
        })
        .collect()
}

/// Recording linearised in one column at some values of its effect, with the central differences there.
struct Compared {
    column: FittedParameter,
    frames: PerFrame<LinearizedFrame>,
    /// Central differences by frame and measurement.
    differences: Vec<Vec<f64>>,
}

impl Compared {
    fn new(
        recording: &Recording<'_>,
        measurements: &PerFrame<FrameMeasurements>,
        column: FittedParameter,
        values: &[f64],
    ) -> Self {
        let value = values[column.parameter];
        let half = WIDTH * column.parameter().step;
        let linearised = |value: f64, columns: &[FittedParameter]| {
            let mut values = values.to_vec();
            values[column.parameter] = value;
            let model = Model::default().with(column.effect(), values);
            let others = Others { nuisances: &[], patches: &Tree::default() };
            linearise(recording, measurements, &model, columns, others).unwrap()
        };
        let [minus, plus] = [value - half, value + half].map(|value| linearised(value, &[]));
        let width = column.coordinate(value + half) - column.coordinate(value - half);
        // Residuals are measured minus predicted.
        let change = |(minus, plus): (&LinearizedFrame, &LinearizedFrame)| {
            let residuals = minus.residuals.iter().zip(&plus.residuals);
            residuals.map(|(minus, plus)| (minus - plus) / width).collect()
        };
        let differences = minus.iter().zip(&plus).map(change).collect();
        Self { column, frames: linearised(value, &[column]), differences }
    }

    /// Iterates over the measurements that are compared, with derivative and difference. The odometry step of the last frame,
    /// which ends where the trajectory ends, is left out.
    fn rows(&self) -> impl Iterator<Item = (&Measurement, f64, f64)> {
        let last = self.frames.len() - 1;
        self.frames.iter().zip(&self.differences).enumerate().flat_map(
            move |(index, (frame, differences))| {
                let derivatives = frame.jacobian.iter().map(|row| row.first().map_or(0.0, |entry| entry.1));
                let all = frame.measurements.iter().zip(derivatives).zip(differences);
                all.map(|((row, derivative), difference)| (row, derivative, *difference)).filter(
                    move |(row, _, difference)| {
                        difference.is_finite()
                            && !(index == last && row.quantity.channel() == Channel::Motion)
                    },
                )
            },
        )
    }

    /// Asserts that the derivatives equal the differences, except for measurements that are left out.
    fn assert_same(&self, is_left_out: impl Fn(&Measurement) -> bool) {
        let mut largest: BTreeMap<Quantity, f64> = BTreeMap::new();
        for (row, _, difference) in self.rows() {
            let largest = largest.entry(row.quantity).or_default();
            *largest = largest.max(difference.abs());
        }
        let name = format!("{} {}", self.column.effect().id(), self.column.parameter().name);
        let most = largest.values().copied().fold(0.0, f64::max);
        assert!(most > 1e-3, "{name} changes nothing that is compared");
        for (row, derivative, difference) in self.rows().filter(|(row, ..)| !is_left_out(row)) {
            let part = if is_bent(&self.column, row) { BENT_TOLERANCE } else { TOLERANCE };
            let allowed = part * largest[&row.quantity] + ROUNDING;
            let off = (derivative - difference).abs();
            assert!(off <= allowed, "{name}, {:?}: {derivative} for {difference}", row.quantity);
        }
    }
}

fn is_of_odometry(column: &FittedParameter) -> bool {
    column.effect().stage() == Stage::Odometry
}

#[test]
fn every_column_is_the_derivative_of_the_prediction() {
    let sequence = sequence();
    let recording = recording(&sequence);
    let measurements = measure_frames(&recording, &Model::default(), 20.0).unwrap();
    for column in fitted_parameters(&[]).into_iter().filter(|column| !is_of_odometry(column)) {
        let is_left_out = |measurement: &Measurement| is_ignored(&column, measurement);
        // Colours must be clearly apart for a slope. Large changes of a lens or a lamp make the camera invalid or clip.
        let part = if column.effect().id() == "chromatic_aberration" { 0.1 } else { 0.02 };
        let values = values_at(&recording, &column, part);
        Compared::new(&recording, &measurements, column, &values).assert_same(is_left_out);
    }
}

#[test]
fn every_column_is_the_derivative_of_the_prediction_at_neutral_values() {
    let sequence = sequence();
    let recording = recording(&sequence);
    let measurements = measure_frames(&recording, &Model::default(), 20.0).unwrap();
    let has_slope = |column: &FittedParameter| {
        column.parameter().growth == Growth::Linear && column.is_size() && !is_of_odometry(column)
    };
    for column in fitted_parameters(&[]).into_iter().filter(has_slope) {
        let is_left_out =
            |measurement: &Measurement| is_bent(&column, measurement) || is_ignored(&column, measurement);
        let values = values_at(&recording, &column, 0.0);
        Compared::new(&recording, &measurements, column, &values).assert_same(is_left_out);
    }
}

#[test]
fn during_a_steady_walk_the_columns_of_the_odometry_are_the_derivatives_of_its_own_steps() {
    let sequence = sequence();
    let mut recording = recording(&sequence);
    // A walk in a circle: all steps are alike, so that the neighbours of a step stand for it exactly.
    let pose = |time_s: f64| {
        let yaw_rad = 0.4 * time_s;
        let place = Pose2::new(1.5 * yaw_rad.sin(), -1.5 * yaw_rad.cos(), yaw_rad);
        CameraPose::new(place, 0.5, 0.4, 0.0)
    };
    let times_s: Vec<f64> = recording.frames.iter().map(|frame| frame.time_s).collect();
    let until_s = recording.frames.as_slice().last().unwrap().step.unwrap().until_s;
    let poses: Vec<(f64, CameraPose)> =
        times_s.into_iter().chain([until_s]).map(|time_s| (time_s, pose(time_s))).collect();
    recording.trajectory = Trajectory::new(&poses).unwrap();
    let nothing = FrameMeasurements {
        camera_in_world: DVec3::ZERO,
        lines: Vec::new(),
        expected_lines: Vec::new(),
        blocks: Vec::new(),
        noise_steps: Vec::new(),
        mean_linear_rgb: [0.0; 3],
    };
    for frame in FrameIndex::first(recording.frames.len()) {
        recording.frames[frame].stated_attitude_rad = None;
    }
    let measurements = PerFrame::from(vec![nothing; recording.frames.len()]);
    // Delays do not show in a walk in which all steps are alike.
    let scales = |column: &FittedParameter| is_of_odometry(column) && column.parameter().unit != "s";
    for column in fitted_parameters(&[]).into_iter().filter(scales) {
        for part in [0.0, 0.1] {
            let values = values_at(&recording, &column, part);
            let compared = Compared::new(&recording, &measurements, column, &values);
            compared.assert_same(|_| false);
            assert_eq!(compared.rows().count(), 3 * (recording.frames.len() - 1));
        }
    }
}
