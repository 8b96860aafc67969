//! From a recorded picture to what the observation models read: grey values, blur, the field's border, the evidence
//! for white lines.

mod blur;
mod border;
mod carpet;
mod distance;
mod grey;
mod prepared;
mod texture;
mod white_line;

pub use self::{
    blur::{gaussian_blur, gaussian_kernel},
    border::{BorderDetector, CELL_PX, FieldBorder},
    carpet::CarpetColor,
    distance::{DISTANCE_RADIUS_PX, DISTANCE_UNITS_PER_PX, distance_field},
    grey::{luma, whiteness},
    prepared::{Prepared, Preprocessor},
    texture::Texture,
    white_line::{LineScale, WhiteLevels, white_levels, white_line_evidence},
};
use crate::pose::CameraPose;

/// How the camera stands above the ground, whatever its place and heading: what joints and IMU tell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attitude {
    /// Above the carpet, metres.
    pub height_m: f64,
    /// Depression of the optical axis, radians.
    pub pitch_rad: f64,
    /// Clockwise about the optical axis seen from behind, radians.
    pub roll_rad: f64,
}

impl Attitude {
    /// Height, pitch and roll of a pose.
    pub fn of(pose: CameraPose) -> Self {
        Self { height_m: pose.height_m, pitch_rad: pose.pitch_rad, roll_rad: pose.roll_rad }
    }

    /// Rotation from the camera's axes to x along the heading, y left, z up.
    pub(crate) fn rotation_heading_from_camera(self) -> glam::DMat3 {
        self.at(crate::pose::Pose2::default()).rotation_world_from_camera()
    }

    /// The camera with this attitude at a planar pose.
    pub fn at(self, planar: crate::pose::Pose2) -> CameraPose {
        CameraPose::new(planar, self.height_m, self.pitch_rad, self.roll_rad)
    }
}
