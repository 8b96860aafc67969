//! Models with one parameter changed by a small step, for forward differences.

use reality_sim_sensor::{Chain, Model, ModelError};

use crate::{
    linear_model::{
        initial_values::{starting_values, with_value},
        parameters::FittedParameter,
    },
    recording::Recording,
};

/// Camera chain of a model with one parameter changed by a small step.
pub(super) struct PerturbedModel {
    pub(super) chain: Chain,
    /// Change of the parameter's coordinate.
    pub(super) step: f64,
}

impl PerturbedModel {
    pub(super) fn new(
        recording: &Recording<'_>,
        model: &Model,
        fitted: &FittedParameter,
    ) -> Result<Self, ModelError> {
        let parameter = fitted.parameter();
        let values = model
            .values(fitted.effect().id())
            .map_or_else(|| starting_values(fitted.effect(), recording), <[f64]>::to_vec);
        let value = values[fitted.parameter];
        // At the upper end of the range the step goes inwards.
        let step = if value + parameter.step > parameter.range[1] { -parameter.step } else { parameter.step };
        let perturbed = with_value(model, fitted, &values, value + step);
        let chain = Chain::new(&recording.sequence.setup, &recording.sequence.field, &perturbed)?;
        Ok(Self { chain, step: fitted.coordinate(value + step) - fitted.coordinate(value) })
    }
}
