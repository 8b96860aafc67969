//! Search for the fixed parameters of effects: of a few values, the one with which the effect's other parameters explain most of
//! the training frames is taken. Tests of the effect are corrected for the number of values.

use std::collections::BTreeMap;

use reality_sim_sensor::{EffectIndex, Model, Role};

use crate::{
    inference::{linearized_recording::LinearizedRecording, split::HeldOutSplit},
    linear_model::{
        fixed_values::{candidates, set_fixed_values},
        initial_values::starting_values,
        linearization::{MeasureError, Others, linearise},
        linearized_frame::LinearizedFrame,
        parameters::FittedParameter,
        reflectance::Tree,
    },
    recording::Recording,
};

/// Searches the fixed parameters of all effects that the model lacks, and sets them for the recording.
pub(super) fn search_fixed_values(
    recording: &Recording<'_>,
    linearized: &LinearizedRecording,
    split: &HeldOutSplit,
) -> Result<(), MeasureError> {
    let mut found = BTreeMap::new();
    let missing = EffectIndex::all().filter(|effect| linearized.model.values(effect.effect().id()).is_none());
    for effect in missing {
        let parameters = effect.effect().parameters();
        let fixed = parameters.iter().enumerate().filter(|(_, parameter)| parameter.role == Role::Fixed);
        for (index, parameter) in fixed {
            let mut best = (0.0, None);
            for value in candidates(recording, parameter.name) {
                let mut values = starting_values(effect.effect(), recording);
                values[index] = value;
                let model = linearized.model.with(effect.effect(), values);
                let gain = gain(recording, linearized, split, (effect, &model))?;
                if gain > best.0 {
                    best = (gain, Some(value));
                }
            }
            found.extend(best.1.map(|value| (parameter.name, value)));
        }
    }
    set_fixed_values(recording, found);
    Ok(())
}

/// Returns the gain in log-likelihood on the training frames by an effect's parameters alone.
fn gain(
    recording: &Recording<'_>,
    linearized: &LinearizedRecording,
    split: &HeldOutSplit,
    (effect, model): (EffectIndex, &Model),
) -> Result<f64, MeasureError> {
    let parameters = effect.effect().parameters().iter().enumerate();
    let fitted = parameters.filter(|(_, parameter)| parameter.role != Role::Fixed);
    let columns: Vec<FittedParameter> =
        fitted.map(|(parameter, _)| FittedParameter { effect, parameter }).collect();
    let nothing = Others { nuisances: &[], patches: &Tree::default() };
    let frames = linearise(recording, &linearized.measurements, model, &columns, nothing)?;
    let training: Vec<&LinearizedFrame> = split.training().map(|frame| &frames[frame]).collect();
    Ok(linearized.system.gain_of(&training, columns.len()))
}
