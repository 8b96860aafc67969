//! Preset fields of the leagues. Each file names the rule book that its numbers come from.

use super::FieldDimensions;

/// Name and `field.toml` of every preset.
const PRESETS: [(&str, &str); 5] = [
    ("humanoid-kidsize-2010", include_str!("presets/humanoid-kidsize-2010.toml")),
    ("humanoid-kidsize", include_str!("presets/humanoid-kidsize.toml")),
    ("humanoid-adultsize", include_str!("presets/humanoid-adultsize.toml")),
    ("spl", include_str!("presets/spl.toml")),
    ("msl", include_str!("presets/msl.toml")),
];

/// Returns the names that [`FieldDimensions::preset`] knows.
pub fn preset_names() -> impl Iterator<Item = &'static str> {
    PRESETS.iter().map(|(name, _)| *name)
}

impl FieldDimensions {
    /// Returns a league's field by its name: one of [`preset_names`].
    pub fn preset(name: &str) -> Option<Self> {
        toml::from_str(Self::preset_toml(name)?).ok()
    }

    /// Returns the text of a preset's `field.toml` with its sources, as a template for a new field.
    pub fn preset_toml(name: &str) -> Option<&'static str> {
        PRESETS.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
    }
}
