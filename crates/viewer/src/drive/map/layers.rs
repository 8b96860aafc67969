//! Layers that can be drawn on the field, and their data.

use std::sync::Arc;

use eframe::egui::Color32;
use reality_sim_synthesis::UsedImage;
use serde::{Deserialize, Serialize};

use super::super::{
    answer::Around,
    source::{Probes, Source},
};

/// Colour of the positions of recorded pictures.
pub const IMAGES: Color32 = Color32::from_rgb(200, 205, 210);
/// Colour of the triangulation.
pub const EDGES: Color32 = Color32::from_rgb(120, 215, 190);
/// Layers drawn on the field.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layers {
    /// Positions of recorded pictures.
    pub images: bool,
    pub coverage: CoverageLayer,
    /// The Delaunay triangulation of the sectors around the heading.
    pub triangulation: bool,
    /// The natural neighbours and their weights.
    pub neighbours: bool,
    /// Images from which the picture is made.
    pub used: bool,
    /// Footprint of the picture on the ground.
    pub footprint: bool,
    /// True pictures to compare with.
    pub probes: bool,
}

impl Default for Layers {
    fn default() -> Self {
        Self {
            images: true,
            coverage: CoverageLayer::Off,
            triangulation: false,
            neighbours: false,
            used: true,
            footprint: true,
            probes: true,
        }
    }
}

/// Quantity shown by the carpet's colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CoverageLayer {
    #[default]
    Off,
    /// Number of pictures taken in a cell.
    Pictures,
    /// Distance to the nearest picture.
    Distance,
}

impl CoverageLayer {
    pub const ALL: [Self; 3] = [Self::Off, Self::Pictures, Self::Distance];

    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "no coverage",
            Self::Pictures => "pictures taken there",
            Self::Distance => "pixels to the nearest picture",
        }
    }
}

/// Data to draw.
pub struct MapContent<'a> {
    pub source: &'a Arc<Source>,
    pub layers: Layers,
    pub around: Option<&'a Around>,
    /// Images from which a picture is made.
    pub used: &'a [UsedImage],
    /// Name of that picture.
    pub used_by: &'static str,
    pub probes: Option<&'a Probes>,
}
