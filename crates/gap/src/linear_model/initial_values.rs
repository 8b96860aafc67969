//! Initial values of effects, and models in which one of them is changed.

use reality_sim_sensor::{Effect, Model, Role};

use crate::{linear_model::parameters::FittedParameter, recording::Recording};

/// Returns the neutral values of an effect's parameters. Fixed parameters, which no fit changes, take the times of the
/// recording's first and last frame.
pub(crate) fn starting_values(effect: &'static dyn Effect, recording: &Recording<'_>) -> Vec<f64> {
    let frames = recording.frames.as_slice();
    values_between(effect, [frames.first(), frames.last()].map(|frame| frame.map(|frame| frame.time_s)))
}

/// Returns the neutral values of an effect's parameters in a recording from one time to another, seconds.
pub(crate) fn values_between(effect: &'static dyn Effect, [first_s, last_s]: [Option<f64>; 2]) -> Vec<f64> {
    let given = |name: &str| match name {
        "from_s" => first_s.unwrap_or(0.0),
        "to_s" => last_s.unwrap_or(1.0),
        _ => 0.0,
    };
    let value = |parameter: &reality_sim_sensor::Parameter| match parameter.role {
        Role::Fixed => given(parameter.name),
        Role::Size | Role::Shape => parameter.neutral,
    };
    effect.parameters().iter().map(value).collect()
}

/// Returns the model with these values of a parameter's effect, in which that of the parameter is replaced.
pub(crate) fn with_value(model: &Model, parameter: &FittedParameter, values: &[f64], value: f64) -> Model {
    let mut values = values.to_vec();
    values[parameter.parameter] = value;
    model.with(parameter.effect(), values)
}
