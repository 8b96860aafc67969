//! Outcome of the selection of effects.

use std::collections::BTreeMap;

use reality_sim_sensor::EffectIndex;

use super::{
    effect_fit::EffectFits,
    effect_test::{EffectTest, EffectTests},
    linearized_recording::LinearizedRecording,
    split::HeldOutSplit,
};
use crate::linear_model::parameters::FittedParameter;

/// Outcome of the selection: a model with the effects that are supported.
pub(crate) struct SelectedModel {
    /// Fitted parameters, in the order of their columns.
    pub(crate) columns: Vec<FittedParameter>,
    /// Split of the recording's frames.
    pub(crate) split: HeldOutSplit,
    /// Recording linearised at the final model.
    pub(crate) linearized: LinearizedRecording,
    /// Effects that the model had from the start.
    pub(crate) given: Vec<EffectIndex>,
    /// Effects that were added, in the order in which they were added.
    pub(crate) named: Vec<EffectIndex>,
    /// P-values of named effects before they were added to the model.
    pub(crate) p_values: BTreeMap<EffectIndex, f64>,
    /// Pairs of a named effect and another one that fits as well in its place.
    pub(crate) confusable: Vec<(EffectIndex, EffectIndex)>,
}

impl SelectedModel {
    /// Returns all effects of the extended model.
    pub(crate) fn all(&self) -> Vec<EffectIndex> {
        self.given.iter().chain(&self.named).copied().collect()
    }

    /// Returns the fits of effects at the final model.
    pub(crate) fn effect_fits(&self) -> EffectFits<'_> {
        self.linearized.effect_fits(&self.columns)
    }

    /// Returns the tests of effects at the final model.
    pub(crate) fn effect_tests(&self) -> EffectTests<'_> {
        self.linearized.effect_tests(&self.columns)
    }

    /// P-value of a named effect: the smaller one of those before and after it was added, corrected for there being two. Wald's
    /// test loses its power far from zero (Hauck and Donner 1977), hence the one before.
    pub(crate) fn p_value(&self, test: &EffectTest) -> f64 {
        match self.p_values.get(&test.effect) {
            Some(before) => (2.0 * before.min(test.p_value)).min(1.0),
            None => test.p_value,
        }
    }

    /// Returns the effects outside the model that a named one is confusable with.
    pub(crate) fn confusable_with(&self, effect: EffectIndex) -> Vec<EffectIndex> {
        self.confusable.iter().filter(|(of, _)| *of == effect).map(|(_, other)| *other).collect()
    }
}
