//! Settings of layers.

/// What is done to layers on their way into the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct LayerSettings {
    /// Whether layers are as bright as the recorded ground around them; else the hall's light is the same everywhere.
    pub matches_light: bool,
    /// Whether layers take light from the ground below them.
    pub casts_shadows: bool,
    /// Seed of the noise that layers get; `None` leaves them without.
    pub noise_seed: Option<u64>,
}

impl Default for LayerSettings {
    fn default() -> Self {
        Self { matches_light: true, casts_shadows: true, noise_seed: Some(0) }
    }
}

impl LayerSettings {
    /// Sets whether layers are as bright as the recorded ground around them.
    pub fn with_matched_light(self, matches_light: bool) -> Self {
        Self { matches_light, ..self }
    }

    /// Sets whether layers take light from the ground below them.
    pub fn with_shadows(self, casts_shadows: bool) -> Self {
        Self { casts_shadows, ..self }
    }

    /// Sets the seed of the noise that layers get; `None` leaves them without.
    pub fn with_noise_seed(self, noise_seed: Option<u64>) -> Self {
        Self { noise_seed, ..self }
    }
}
