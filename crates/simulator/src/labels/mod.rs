//! Labels of a picture, from the field's dimensions through the camera's lens: what every pixel shows, and where lines, crossings
//! and things are. [`crate::Camera::with_labels`] labels its frames; a [`Labeler`] labels any picture whose pose is known:
//!
//! ```
//! use reality_sim_core::{
//!     camera::{Camera, Distortion},
//!     field::FieldDimensions,
//!     pose::CameraPose,
//!     warp::{Hall, ProxyGeometry},
//! };
//! use reality_sim_simulator::labels::{Labeler, Labels, Overlay};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let lens = Camera::new([640, 480], [300.0, 300.0, 319.5, 239.5], Distortion::Pinhole)?;
//! let field = FieldDimensions::preset("spl").ok_or("a preset")?;
//! let labeler = Labeler::new(&lens, &field, &ProxyGeometry::new(&Hall::usual(&field), &field));
//! let pose = CameraPose { x_m: 1.0, height_m: 0.5, pitch_rad: 0.3, ..CameraPose::default() };
//! let mut labels = Labels::default();
//! labeler.label(pose, &[], Overlay::default(), &mut labels);
//! assert_eq!(labels.class_picture().dimensions(), (640, 480));
//! assert_eq!(labels.things[1].name, "goal_positive_x");
//! assert_eq!(labels.things[1].visibility(), 1.0);
//! # Ok(())
//! # }
//! ```

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
