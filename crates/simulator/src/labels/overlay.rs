//! What was drawn over the recorded scene.

use crate::seen_object::SeenObject;

/// Objects that were drawn over the recorded scene, as a [`crate::Frame`] has them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Overlay<'a> {
    /// Objects.
    pub objects: &'a [SeenObject],
    /// Object of every pixel, row by row, or [`crate::NO_OBJECT`]; without elements where nothing was drawn.
    pub object_of: &'a [u16],
    /// Distance of the object that each pixel shows, metres; without elements where nothing was drawn.
    pub distance_m: &'a [f32],
}
