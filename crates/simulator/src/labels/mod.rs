//! Labels of a picture, from the field's dimensions through the camera's lens: what every pixel shows, and where lines, crossings
//! and things are.

mod extent;
mod goal_view;
mod labeler;
mod overlay;
mod painted_ground;
mod pixels;
mod record;
mod seen_lines;

pub(crate) use self::extent::Extent;
pub use self::{
    labeler::Labeler,
    overlay::Overlay,
    record::{Labels, SeenCrossing, SeenLine},
};

#[cfg(test)]
mod tests;
