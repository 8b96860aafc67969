//! How many sources are mixed, and by what they are weighed against each other.

/// Maximum number of neighbours that are mixed.
pub const MAX_SOURCES: usize = 8;

/// Parameters that weigh the neighbours against each other.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct BlendWeights {
    /// Penalty of a right angle between the lines of sight on the ground.
    pub angle_on_ground: f32,
    /// Penalty of a right angle between the lines of sight above the ground, where the proxy geometry is a guess.
    pub angle_above: f32,
    /// Penalty of a source whose pixels are four times as large as the target's.
    pub resolution: f32,
    /// Distance from a neighbour's border within which its weight falls to 0, pixels.
    pub border_px: f32,
    /// Constant added to all penalties: the smaller it is, the more the best neighbour dominates.
    pub softness: f32,
    /// Difference from the others' colours at which a neighbour has half its weight, grey levels.
    pub disagreement: f32,
}

impl BlendWeights {
    /// Replaces the penalty of a right angle between the lines of sight on the ground.
    pub fn with_angle_on_ground(self, angle_on_ground: f32) -> Self {
        Self { angle_on_ground, ..self }
    }

    /// Replaces the penalty of a right angle between the lines of sight above the ground.
    pub fn with_angle_above(self, angle_above: f32) -> Self {
        Self { angle_above, ..self }
    }

    /// Replaces the penalty of coarse sources.
    pub fn with_resolution(self, resolution: f32) -> Self {
        Self { resolution, ..self }
    }

    /// Replaces the distance from a border within which weights fall to 0, pixels.
    pub fn with_border_px(self, border_px: f32) -> Self {
        Self { border_px, ..self }
    }

    /// Replaces the constant added to all penalties.
    pub fn with_softness(self, softness: f32) -> Self {
        Self { softness, ..self }
    }

    /// Replaces the difference from the others' colours at which a neighbour has half its weight, grey levels.
    pub fn with_disagreement(self, disagreement: f32) -> Self {
        Self { disagreement, ..self }
    }
}

impl Default for BlendWeights {
    fn default() -> Self {
        Self {
            angle_on_ground: 2.0,
            angle_above: 4.0,
            resolution: 1.0,
            border_px: 20.0,
            softness: 0.05,
            disagreement: 20.0,
        }
    }
}
