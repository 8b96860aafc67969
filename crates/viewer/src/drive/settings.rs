//! Settings of the panel that are kept from one start to the next.

use serde::{Deserialize, Serialize};

use super::{
    kind::{PictureKind, Shown, View},
    layout::Layout,
    map::Layers,
};

/// Settings that are kept from one start to the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DriveSettings {
    pub layout: Layout,
    /// Picture shown alone or on the left, and picture on the right.
    pub left: PictureKind,
    pub right: PictureKind,
    /// Aspect of the left picture to show.
    pub shown: Shown,
    /// Position of the line of a wipe, 0 to 1 from the left.
    pub wipe_share: f32,
    pub is_best_effort: bool,
    pub layers: Layers,
    /// Name of the device that draws and finds poses; the first device if no device has it.
    pub device: String,
    /// Share of the window's width that the field takes.
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
    /// Returns the views of the chosen arrangement, from left to right.
    pub fn views(&self) -> Vec<View> {
        let left = View { kind: self.left, shown: self.shown };
        let right = View::picture(self.right);
        match self.layout {
            Layout::One => vec![left],
            Layout::Side | Layout::Wipe => vec![left, right],
            // Auto repeats one of the other methods.
            Layout::All => PictureKind::ALL[1..].iter().map(|&kind| View::picture(kind)).collect(),
        }
    }
}
