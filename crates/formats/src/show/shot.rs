//! What is shown of a recorded picture.

use reality_sim_core::{camera::Camera, field::FieldDimensions, pose::CameraPose};

/// Picture with everything that is shown of it.
#[derive(Debug, Clone, Copy)]
pub struct Shot<'a> {
    /// Time at which it was taken, seconds.
    pub timestamp_s: f64,
    /// JPEG or PNG file.
    pub picture: &'a [u8],
    /// Camera that took it.
    pub camera: &'a Camera,
    /// Field on which it was taken.
    pub field: &'a FieldDimensions,
    /// Pose of the camera.
    pub pose: CameraPose,
    /// Particles; none if they are not known.
    pub particles: &'a [CameraPose],
}
