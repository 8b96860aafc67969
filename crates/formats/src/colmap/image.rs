//! COLMAP's images: pictures with their poses.

use glam::{DQuat, DVec2, DVec3};
use reality_sim_core::pose::CameraPose;

use crate::{
    model_error::{ModelFault, excerpt},
    pixels::HALF_PIXEL,
    posed::PosedPicture,
};

/// Smallest length of a quaternion that still has a direction.
const SMALLEST_QUATERNION: f64 = 1e-9;

/// Picture as COLMAP's files hold it.
#[derive(Debug, Clone, PartialEq)]
pub struct ColmapImage {
    /// Number in the model, from 1.
    pub id: u32,
    /// Rotation of the camera's axes from the world's, as w, x, y, z.
    pub rotation_wxyz: [f64; 4],
    /// Place of the world's origin in the camera's axes, metres.
    pub translation: [f64; 3],
    /// Camera that took it.
    pub camera_id: u32,
    /// File, relative to the pictures' folder.
    pub name: String,
    /// Points that it shows; not read, only written.
    pub keypoints: Vec<Keypoint>,
}

/// Place in a picture at which a point is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Keypoint {
    /// Place in COLMAP's pixels.
    pub pixel: [f64; 2],
    /// Point that is seen.
    pub point_id: u64,
}

impl ColmapImage {
    /// Makes the record of a picture, with the points that it shows: their places in the list of points, and our pixels.
    pub(super) fn new(id: u32, picture: &PosedPicture, seen: &[(usize, DVec2)]) -> Self {
        let camera_from_world = picture.pose.quaternion_world_from_camera().normalize().conjugate();
        // COLMAP's own files have w ≥ 0.
        let DQuat { x, y, z, w } =
            if camera_from_world.w < 0.0 { -camera_from_world } else { camera_from_world };
        let keypoint = |(point, pixel): &(usize, DVec2)| Keypoint {
            pixel: (*pixel + HALF_PIXEL).to_array(),
            point_id: *point as u64 + 1,
        };
        Self {
            id,
            rotation_wxyz: [w, x, y, z],
            translation: picture.pose.camera_from_world(DVec3::ZERO).to_array(),
            camera_id: u32::try_from(picture.camera.0 + 1).unwrap_or(u32::MAX),
            name: picture.file_name.clone(),
            keypoints: seen.iter().map(keypoint).collect(),
        }
    }

    /// Returns the camera's pose. Fails if the quaternion is zero, or a number is not finite.
    pub fn pose(&self) -> Result<CameraPose, ModelFault> {
        let [w, x, y, z] = self.rotation_wxyz;
        let length = [w, x, y, z].iter().fold(0.0_f64, |length, part| length.hypot(*part));
        let translation = DVec3::from_array(self.translation);
        if !(length.is_finite() && length > SMALLEST_QUATERNION && translation.is_finite()) {
            return Err(ModelFault::NoRotation { picture: excerpt(&self.name) });
        }
        let world_from_camera = DQuat::from_xyzw(x / length, y / length, z / length, w / length).conjugate();
        Ok(CameraPose::from_world_from_camera(-(world_from_camera * translation), world_from_camera))
    }
}
