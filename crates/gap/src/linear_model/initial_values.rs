//! Initial values of effects, and models in which one of them is changed.

use reality_sim_sensor::{Effect, Model, Role};

use crate::{
    linear_model::{fixed_values::fixed_value, parameters::FittedParameter},
    recording::Recording,
};

/// Returns the neutral values of an effect's parameters. Fixed parameters, which no fit changes, take the times of the
/// recording's first and last frame, or what a search has found.
pub(crate) fn starting_values(effect: &'static dyn Effect, recording: &Recording<'_>) -> Vec<f64> {
    let frames = recording.frames.as_slice();
    let (first, last) = (frames.first(), frames.last());
    let given = |name: &str| match name {
        "from_s" => first.map_or(0.0, |frame| frame.time_s),
        "to_s" => last.map_or(1.0, |frame| frame.time_s),
        searched => fixed_value(recording, searched),
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
