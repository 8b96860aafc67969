//! Which parts of the picture are composed together.

use crate::pixel_box::PixelBox;

/// Returns the parts of the picture that layers touch, with a margin, as boxes that do not meet.
pub(crate) fn areas(drawn: impl Iterator<Item = PixelBox>, margin: u32, size: [u32; 2]) -> Vec<PixelBox> {
    let mut areas: Vec<PixelBox> = Vec::new();
    for area in drawn.filter(|area| !area.is_empty()) {
        let mut area = area.grown(margin, size);
        while let Some(index) = areas.iter().position(|other| other.meets(area)) {
            area = area.union(areas.swap_remove(index));
        }
        areas.push(area);
    }
    areas
}
