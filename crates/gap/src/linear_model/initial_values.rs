//! Initial values of effects, and models in which one of them is changed.

use glam::DVec2;
use reality_sim_core::pose::CameraPose;
use reality_sim_sensor::{Effect, Model, Parameter, Role};

use crate::{
    linear_model::{fixed_values::fixed_value, parameters::FittedParameter},
    recording::Recording,
    thresholds::{LinearModelThresholds, Thresholds},
};

const THRESHOLDS: LinearModelThresholds = Thresholds::DEFAULT.linear_model;
/// Number of places along each axis of the field of which it is asked whether they were seen.
const PLACES: i32 = 24;

/// Returns the neutral values of an effect's parameters. Fixed parameters, which no fit changes, are the times of the
/// recording's first and last frame, the part of the field that it shows, or what a search has found.
pub(crate) fn starting_values(effect: &'static dyn Effect, recording: &Recording<'_>) -> Vec<f64> {
    let is_fixed = |parameter: &&Parameter| parameter.role == Role::Fixed;
    let seen = effect.parameters().iter().find(is_fixed).map(|_| seen_part(recording));
    let frames = recording.frames.as_slice();
    let (first, last) = (frames.first(), frames.last());
    let given = |name: &str| match (name, seen) {
        ("from_s", _) => first.map_or(0.0, |frame| frame.time_s),
        ("to_s", _) => last.map_or(1.0, |frame| frame.time_s),
        ("from_x", Some([from, _])) => from.x,
        ("to_x", Some([_, to])) => to.x,
        ("from_y", Some([from, _])) => from.y,
        ("to_y", Some([_, to])) => to.y,
        (searched, _) => fixed_value(recording, searched),
    };
    let value = |parameter: &Parameter| match parameter.role {
        Role::Fixed => given(parameter.name),
        Role::Size | Role::Shape => parameter.neutral,
    };
    effect.parameters().iter().map(value).collect()
}

/// Returns the corners of the part of the field that the recording shows, in units of half the field's length and width.
fn seen_part(recording: &Recording<'_>) -> [DVec2; 2] {
    let field = &recording.sequence.field;
    let unit = 0.5 * DVec2::new(field.length_m, field.width_m);
    let place = |index: i32| f64::from(index) * 2.4 / f64::from(PLACES) - 1.2;
    let all = || (0..=PLACES).flat_map(|x| (0..=PLACES).map(move |y| DVec2::new(place(x), place(y))));
    let poses: Vec<CameraPose> =
        recording.frames.iter().map(|frame| recording.trajectory.at(frame.time_s)).collect();
    let lens = &recording.sequence.setup.camera;
    let sees = |pose: &CameraPose, ground: DVec2| {
        let point_in_camera = pose.camera_from_world(ground.extend(0.0));
        point_in_camera.length() < THRESHOLDS.light_range_m && lens.project(point_in_camera).is_ok()
    };
    // Each place counts as often as it was seen.
    let views = |share: &DVec2| poses.iter().filter(|pose| sees(pose, *share * unit)).count();
    let seen: Vec<(DVec2, usize)> = all().map(|share| (share, views(&share))).collect();
    let sum: usize = seen.iter().map(|(_, count)| count).sum();
    let least = THRESHOLDS.light_seen_share * sum as f64;
    // Returns the edges beyond which this part of all views lies.
    let edges = |coordinate: fn(DVec2) -> f64| {
        let beyond = |edge: &f64, sign: f64| {
            let outside = seen.iter().filter(|(share, _)| sign * coordinate(*share) <= sign * edge);
            outside.map(|(_, count)| *count as f64).sum::<f64>() > least
        };
        let places = || (0..=PLACES).map(place);
        let from = places().find(|edge| beyond(edge, 1.0));
        [from, places().rev().find(|edge| beyond(edge, -1.0))].map(Option::unwrap_or_default)
    };
    let ([from_x, to_x], [from_y, to_y]) = (edges(|place| place.x), edges(|place| place.y));
    [DVec2::new(from_x, from_y), DVec2::new(to_x, to_y)]
}

/// Returns the model with these values of a parameter's effect, in which that of the parameter is replaced.
pub(crate) fn with_value(model: &Model, parameter: &FittedParameter, values: &[f64], value: f64) -> Model {
    let mut values = values.to_vec();
    values[parameter.parameter] = value;
    model.with(parameter.effect(), values)
}
