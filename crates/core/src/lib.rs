//! Where a camera was when it took a picture of a soccer field: camera models, the field, recordings,
//! preprocessing, observation models and the particle filter of Reality Sim, on the CPU.
//!
//! Metres, radians and seconds everywhere; the unit is part of the name. The frames are those of [`pose`].

pub mod backend;
mod backend_error;
pub mod camera;
pub mod field;
pub mod filter;
mod goal_colors;
mod isometry;
pub mod localization;
pub mod mount;
pub mod observation;
pub mod pose;
pub mod preprocess;
pub mod refine;
pub mod search;
pub mod sequence;
pub mod warp;

#[cfg(test)]
mod test_scene;
