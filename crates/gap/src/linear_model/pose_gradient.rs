//! Derivative of a line offset with respect to the camera pose.

use glam::{DVec2, DVec3};

use crate::measurement::camera::FrameCamera;

/// Returns the gradient of a ground point's pixel, along a normal in the picture, with respect to the pose.
///
/// The first three components are for rotations about axes to the right, down and forward of the heading (pixels per
/// radian); for a level camera these are pitch, yaw and roll. The other three are for the position in the world (pixels per
/// metre). None if the camera does not see the point.
pub(crate) fn pose_gradient(camera: &FrameCamera<'_>, ground: DVec2, normal: DVec2) -> Option<[f64; 6]> {
    let pose = camera.pose;
    let rotation = pose.rotation_world_from_camera();
    let point = rotation.transpose() * (ground.extend(0.0) - pose.position_in_world());
    let (_, [du, dv]) = camera.chain.camera().project_with_gradients(point).ok()?;
    let across = normal.x * du + normal.y * dv;
    // A rotation of the camera by ω moves a point in its frame by −ω × p, and a · (−ω × p) = ω · (a × p).
    let turn = rotation * across.cross(point);
    let (sin, cos) = pose.yaw_rad.sin_cos();
    let axes = [DVec3::new(sin, -cos, 0.0), DVec3::NEG_Z, DVec3::new(cos, sin, 0.0)];
    let [pitch, yaw, roll] = axes.map(|axis| turn.dot(axis));
    // A translation by t moves it by −Rᵀ t.
    let shift = -(rotation * across);
    Some([pitch, yaw, roll, shift.x, shift.y, shift.z])
}
