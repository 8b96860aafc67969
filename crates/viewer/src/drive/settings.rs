//! Settings of the panel that are kept from one start to the next.

use serde::{Deserialize, Serialize};

use super::{
    kind::{Aspect, Pane, PictureKind},
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
    pub aspect: Aspect,
    /// Position of the line of a wipe, 0 to 1 from the left.
    pub wipe_share: f32,
    pub is_best_effort: bool,
    /// Whether pictures are those of the clean stage, where the database has one.
    pub is_clean: bool,
    /// Whether labels are drawn over the pictures.
    pub is_labelled: bool,
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
            aspect: Aspect::default(),
            wipe_share: 0.5,
            is_best_effort: false,
            is_clean: false,
            is_labelled: false,
            layers: Layers::default(),
            device: String::new(),
            map_share: 0.37,
        }
    }
}

impl DriveSettings {
    /// Returns the panes of the chosen arrangement, from left to right.
    pub fn panes(&self) -> Vec<Pane> {
        let left = Pane { kind: self.left, aspect: self.aspect };
        let right = Pane::picture(self.right);
        match self.layout {
            Layout::One => vec![left],
            Layout::Side | Layout::Wipe => vec![left, right],
            // Auto repeats one of the other methods.
            Layout::All => PictureKind::ALL[1..].iter().map(|&kind| Pane::picture(kind)).collect(),
        }
    }
}
