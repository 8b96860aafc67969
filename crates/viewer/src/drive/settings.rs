//! What is remembered of the panel from one start to the next.

use serde::{Deserialize, Serialize};

use super::{
    kind::{PictureKind, Shown, View},
    layout::Layout,
    map::Layers,
};

/// Choices that are kept from one start to the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DriveSettings {
    pub layout: Layout,
    /// The picture alone or on the left, and the one on the right.
    pub left: PictureKind,
    pub right: PictureKind,
    /// What is shown of the left one.
    pub shown: Shown,
    /// Where the line of a wipe is, 0 to 1 from the left.
    pub wipe_share: f32,
    pub is_best_effort: bool,
    pub layers: Layers,
    /// Name of the device that draws and finds poses; where there is no such one, the first.
    pub device: String,
    /// How much of the window's width the field has.
    pub map_share: f32,
}

impl Default for DriveSettings {
    fn default() -> Self {
        Self {
            layout: Layout::default(),
            left: PictureKind::Auto,
            right: PictureKind::Simulated,
            shown: Shown::default(),
            wipe_share: 0.5,
            is_best_effort: false,
            layers: Layers::default(),
            device: String::new(),
            map_share: 0.37,
        }
    }
}

impl DriveSettings {
    /// Pictures of the chosen arrangement, from left to right.
    pub fn views(&self) -> Vec<View> {
        let left = View { kind: self.left, shown: self.shown };
        let right = View::picture(self.right);
        match self.layout {
            Layout::One => vec![left],
            Layout::Side | Layout::Wipe => vec![left, right],
            // Auto is one of the others.
            Layout::All => PictureKind::ALL[1..].iter().map(|&kind| View::picture(kind)).collect(),
        }
    }
}
