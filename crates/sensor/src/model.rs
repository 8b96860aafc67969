//! Models, `model.toml`: the effects that the simulated camera has in addition to `camera.toml`, and their sizes.

mod error;
mod text;

pub use self::error::{ModelError, ModelFault};
use crate::effect::Effect;

/// Effects with their values. The default is the nominal camera, without effects.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Model {
    /// Effects in the order of the file, each at most once.
    pub effects: Vec<Used>,
}

/// An effect with its values.
#[derive(Debug, Clone)]
pub struct Used {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Values in the order of the effect's parameters.
    pub values: Vec<f64>,
}

impl PartialEq for Used {
    fn eq(&self, other: &Self) -> bool {
        self.effect.id() == other.effect.id() && self.values == other.values
    }
}

impl Used {
    /// Whether all values are neutral, so that the effect changes nothing.
    pub fn is_neutral(&self) -> bool {
        self.effect
            .parameters()
            .iter()
            .zip(&self.values)
            .all(|(parameter, value)| *value == parameter.neutral)
    }
}

impl Model {
    /// Returns the model with an effect set to these values, in the order of its parameters; values missing at the end are
    /// neutral. Replaces values that the effect already had.
    pub fn with(&self, effect: &'static dyn Effect, values: impl Into<Vec<f64>>) -> Self {
        let mut values = values.into();
        values.truncate(effect.parameters().len());
        values.extend(effect.parameters()[values.len()..].iter().map(|parameter| parameter.neutral));
        let mut changed = self.clone();
        let known = changed.effects.iter_mut().find(|used| used.effect.id() == effect.id());
        match known {
            Some(used) => used.values = values,
            None => changed.effects.push(Used { effect, values }),
        }
        changed
    }

    /// Returns an effect's values in the order of its parameters; `None` where the model does not contain it.
    pub fn values(&self, id: &str) -> Option<&[f64]> {
        self.effects.iter().find(|used| used.effect.id() == id).map(|used| used.values.as_slice())
    }
}
