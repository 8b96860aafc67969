//! Changes to a pose or a lens that several effects share.

use glam::DQuat;
use reality_sim_core::{
    camera::{Camera, Distortion, InvalidCamera},
    pose::CameraPose,
};

/// Returns the pose turned about the camera's own axes.
pub(super) fn turned(pose: CameraPose, true_from_nominal: DQuat) -> CameraPose {
    let rotation = pose.quaternion_world_from_camera() * true_from_nominal;
    CameraPose::from_world_from_camera(pose.position_in_world(), rotation)
}

/// Returns the camera with other intrinsics and the same field of view: up to where its distortion stops growing, or up to
/// the limit that it was given.
pub(super) fn with_intrinsics(
    camera: &Camera,
    intrinsics: [f64; 4],
    distortion: Distortion,
) -> Result<Camera, InvalidCamera> {
    let size = [camera.width, camera.height];
    let nominal = [camera.fx, camera.fy, camera.cx, camera.cy];
    let is_limited = camera.max_angle_rad() < Camera::new(size, nominal, camera.distortion)?.max_angle_rad();
    let changed = Camera::new(size, intrinsics, distortion)?.with_image_circle(camera.image_circle);
    if is_limited {
        let limit_rad = camera.max_angle_rad().min(changed.max_angle_rad());
        changed.with_max_angle_rad(limit_rad)
    } else {
        Ok(changed)
    }
}
