//! Where an effect starts from: its neutral values, with what the recording gives.

use reality_sim_sensor::{Effect, Model, Role};

use crate::recording::Recording;

/// Neutral values; parameters that the recording gives are its first and last time.
pub(crate) fn starting_values(effect: &'static dyn Effect, recording: &Recording<'_>) -> Vec<f64> {
    let (first, last) = (recording.frames.first(), recording.frames.last());
    let given = |name: &str| match name {
        "from_s" => first.map_or(0.0, |frame| frame.time_s),
        "to_s" => last.map_or(1.0, |frame| frame.time_s),
        _ => 0.0,
    };
    let value = |parameter: &reality_sim_sensor::Parameter| match parameter.role {
        Role::Fixed => given(parameter.name),
        Role::Size | Role::Shape => parameter.neutral,
    };
    effect.parameters().iter().map(value).collect()
}

/// The model with one value of one effect replaced.
pub(crate) fn with_value(
    model: &Model,
    effect: &'static dyn Effect,
    values: &[f64],
    parameter: usize,
    value: f64,
) -> Model {
    let mut values = values.to_vec();
    values[parameter] = value;
    model.with(effect, values)
}
