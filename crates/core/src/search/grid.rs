//! Grid of poses with which a search begins.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::{
    field::FieldDimensions,
    pose::{Pose2, wrap_angle},
};

/// Grid of places and headings over the whole carpet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchGrid {
    /// Maximum distance between neighbouring places along x and y, metres: a little less if the carpet's size is no
    /// multiple of it.
    pub step_m: f64,
    /// Number of headings at every place.
    pub headings: u32,
}

impl SearchGrid {
    /// Returns a grid as fine as the grid's score needs on this field: two line widths, but at least 0.1 m, and 120 headings,
    /// one every 3°.
    pub fn new(field: &FieldDimensions) -> Self {
        Self { step_m: (2.0 * field.line_width_m).max(0.1), headings: 120 }
    }

    /// Returns all places, column after column.
    pub fn places(&self, field: &FieldDimensions) -> Vec<DVec2> {
        let half_extent = field.carpet_half_extent_m();
        let along = |half: f64| {
            let steps = (2.0 * half / self.step_m).ceil().max(1.0);
            (0..=steps as u32).map(move |index| -half + 2.0 * half * f64::from(index) / steps)
        };
        along(half_extent.x).flat_map(|x| along(half_extent.y).map(move |y| DVec2::new(x, y))).collect()
    }

    /// Returns the poses with all headings at a place.
    pub(crate) fn poses_at(&self, place: DVec2) -> impl Iterator<Item = Pose2> {
        (0..self.headings).map(move |heading| {
            let yaw_rad = wrap_angle(TAU * f64::from(heading) / f64::from(self.headings));
            Pose2::new(place.x, place.y, yaw_rad)
        })
    }
}
