//! Arrangements of the pictures.

use serde::{Deserialize, Serialize};

/// Arrangement of the pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Layout {
    One,
    #[default]
    Side,
    Wipe,
    All,
}

impl Layout {
    /// All arrangements, each with its name and a description.
    pub const ALL: [(Self, &'static str, &'static str); 4] = [
        (Self::One, "One", "One picture"),
        (Self::Side, "Side by side", "Two pictures beside each other"),
        (Self::Wipe, "Wipe", "Two pictures at one place, with a line between them to drag"),
        (Self::All, "All methods", "Every method's picture, the simulated and the true one"),
    ];
}
