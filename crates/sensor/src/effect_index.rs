//! Indices of the effects in the library.

use crate::{effect::Effect, effects::library};

/// Index of an effect in the [`library`]: smaller and cheaper to compare than the effect itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EffectIndex(usize);

impl EffectIndex {
    /// Iterates over all effects of the library, in its order.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..library().len()).map(Self)
    }

    /// Finds the effect with this id; `None` for an unknown id.
    pub fn find(id: &str) -> Option<Self> {
        Self::all().find(|index| index.effect().id() == id)
    }

    /// Returns the effect at this index.
    pub fn effect(self) -> &'static dyn Effect {
        library()[self.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_is_found_by_its_id() {
        for index in EffectIndex::all() {
            assert_eq!(EffectIndex::find(index.effect().id()), Some(index));
        }
        assert_eq!(EffectIndex::find("no_such_effect"), None);
    }
}
