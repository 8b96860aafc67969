//! `model.toml`: which effects the simulated camera has beside what `camera.toml` says, and how large they are.

mod error;
mod text;

pub use self::error::{ModelError, ModelFault};
use crate::effect::Effect;

/// Effects with their values. The default has none: the nominal camera.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Model {
    /// In the order of the file, no effect twice.
    pub effects: Vec<Used>,
}

/// An effect with its values.
#[derive(Debug, Clone)]
pub struct Used {
    /// What happens.
    pub effect: &'static dyn Effect,
    /// How much, in the order of the effect's parameters.
    pub values: Vec<f64>,
}

impl PartialEq for Used {
    fn eq(&self, other: &Self) -> bool {
        self.effect.id() == other.effect.id() && self.values == other.values
    }
}

impl Used {
    /// Whether all values are neutral: then the effect changes nothing.
    pub fn is_neutral(&self) -> bool {
        self.effect
            .parameters()
            .iter()
            .zip(&self.values)
            .all(|(parameter, value)| *value == parameter.neutral)
    }
}

impl Model {
    /// The same model with an effect at these values, in the order of its parameters; those missing at the end are
    /// neutral. Values that the effect had are replaced.
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

    /// The values of an effect, in the order of its parameters; `None` where the model does not have it.
    pub fn values(&self, id: &str) -> Option<&[f64]> {
        self.effects.iter().find(|used| used.effect.id() == id).map(|used| used.values.as_slice())
    }
}
