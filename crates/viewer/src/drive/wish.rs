//! Requests for pictures.

use reality_sim_core::pose::CameraPose;

use super::{edges::Region, kind::Pane, source::Probes, things::PlacedThing};
use crate::device::Device;

/// Request for pictures at a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Wish {
    pub pose: CameraPose,
    pub panes: Vec<Pane>,
    /// Whether pictures are also drawn where little was recorded.
    pub is_best_effort: bool,
    /// Whether pictures are those of the clean stage, without what stood there while recording.
    pub is_clean: bool,
    /// Things in the pictures.
    pub things: Vec<PlacedThing>,
    /// Whether labels are drawn over the pictures.
    pub is_labelled: bool,
    /// Region in which the triangulation's edges are requested.
    pub edges_in: Option<Region>,
    pub probes: Option<Probes>,
    /// Device that draws; the processor if there is none.
    pub device: Option<Device>,
}

impl Wish {
    /// Whether the pictures of another request are equally valid.
    pub fn has_pictures_of(&self, other: &Self) -> bool {
        self.has_scenes_of(other) && self.things == other.things && self.is_labelled == other.is_labelled
    }

    /// Whether the scenes of another request, pictures without things and labels, are equally valid.
    pub fn has_scenes_of(&self, other: &Self) -> bool {
        let Self { pose, is_best_effort, is_clean, probes, device, .. } = self;
        *pose == other.pose
            && *is_best_effort == other.is_best_effort
            && *is_clean == other.is_clean
            && *probes == other.probes
            && *device == other.device
    }
}
