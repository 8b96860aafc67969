//! Fields of the leagues, ready to use. Each file names the rule book that its numbers come from.

use super::FieldDimensions;

/// Name and `field.toml` of every preset.
const PRESETS: [(&str, &str); 5] = [
    ("humanoid-kidsize-2010", include_str!("presets/humanoid-kidsize-2010.toml")),
    ("humanoid-kidsize", include_str!("presets/humanoid-kidsize.toml")),
    ("humanoid-adultsize", include_str!("presets/humanoid-adultsize.toml")),
    ("spl", include_str!("presets/spl.toml")),
    ("msl", include_str!("presets/msl.toml")),
];

/// Names that [`FieldDimensions::preset`] knows.
pub fn preset_names() -> impl Iterator<Item = &'static str> {
    PRESETS.iter().map(|(name, _)| *name)
}

impl FieldDimensions {
    /// A league's field by its name: one of [`preset_names`].
    pub fn preset(name: &str) -> Option<Self> {
        toml::from_str(Self::preset_toml(name)?).ok()
    }

    /// The text of a preset's `field.toml`, with its sources: a start for a file of one's own.
    pub fn preset_toml(name: &str) -> Option<&'static str> {
        PRESETS.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
    }
}
