//! What is drawn on the field, and what there is to draw.

use std::sync::Arc;

use eframe::egui::Color32;
use reality_sim_synthesis::UsedImage;
use serde::{Deserialize, Serialize};

use super::super::{
    painter::Around,
    source::{Probes, Source},
};

/// Recorded pictures' places.
pub const IMAGES: Color32 = Color32::from_rgb(200, 205, 210);
/// The triangulation.
pub const EDGES: Color32 = Color32::from_rgb(120, 215, 190);
/// What is drawn on the field.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layers {
    /// Where pictures were recorded.
    pub images: bool,
    pub coverage: CoverageLayer,
    /// The Delaunay triangulation of the sectors around the heading.
    pub triangulation: bool,
    /// The natural neighbours and their weights.
    pub neighbours: bool,
    /// The images that the picture is made of.
    pub used: bool,
    /// The ground in the picture.
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

/// What the carpet is coloured by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CoverageLayer {
    #[default]
    Off,
    /// How many pictures were taken there.
    Pictures,
    /// How far the nearest picture is.
    Distance,
}

impl CoverageLayer {
    pub const ALL: [Self; 3] = [Self::Off, Self::Pictures, Self::Distance];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "no coverage",
            Self::Pictures => "pictures taken there",
            Self::Distance => "pixels to the nearest picture",
        }
    }
}

/// What there is to draw.
pub struct MapContent<'a> {
    pub source: &'a Arc<Source>,
    pub layers: Layers,
    pub around: Option<&'a Around>,
    /// The images that a picture is made of.
    pub used: &'a [UsedImage],
    /// Which picture.
    pub used_by: &'static str,
    pub probes: Option<&'a Probes>,
}
