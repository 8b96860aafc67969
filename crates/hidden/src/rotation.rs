//! Rotations from camera to world, implemented from the conventions of the file formats: forward, right and down from yaw,
//! pitch (down is positive) and roll (right turns towards down).

use glam::{DMat3, DVec3};

/// Returns the rotation whose columns are right, down and forward in the world.
pub fn from_angles(yaw_rad: f64, pitch_rad: f64, roll_rad: f64) -> DMat3 {
    let forward =
        DVec3::new(yaw_rad.cos() * pitch_rad.cos(), yaw_rad.sin() * pitch_rad.cos(), -pitch_rad.sin());
    let level_right = DVec3::new(yaw_rad.sin(), -yaw_rad.cos(), 0.0);
    let level_down = forward.cross(level_right);
    roll_about_axis(DMat3::from_cols(level_right, level_down, forward), roll_rad)
}

/// Returns yaw, pitch and roll in radians of a rotation that does not look straight up or down.
pub fn to_angles(world_from_camera: DMat3) -> [f64; 3] {
    let forward = world_from_camera.z_axis;
    let yaw_rad = forward.y.atan2(forward.x);
    let pitch_rad = (-forward.z).atan2(forward.x.hypot(forward.y));
    let level = from_angles(yaw_rad, pitch_rad, 0.0);
    let right = world_from_camera.x_axis;
    [yaw_rad, pitch_rad, right.dot(level.y_axis).atan2(right.dot(level.x_axis))]
}

/// Turns the camera in its own frame so that its optical axis goes down by an angle.
pub fn pitch_in_camera(world_from_camera: DMat3, angle_rad: f64) -> DMat3 {
    let (right, down, forward) =
        (world_from_camera.x_axis, world_from_camera.y_axis, world_from_camera.z_axis);
    let (sine, cosine) = angle_rad.sin_cos();
    DMat3::from_cols(right, cosine * down - sine * forward, cosine * forward + sine * down)
}

/// Turns the camera about its optical axis so that its x axis goes towards its y axis by an angle.
pub fn roll_about_axis(world_from_camera: DMat3, angle_rad: f64) -> DMat3 {
    let (right, down, forward) =
        (world_from_camera.x_axis, world_from_camera.y_axis, world_from_camera.z_axis);
    let (sine, cosine) = angle_rad.sin_cos();
    DMat3::from_cols(cosine * right + sine * down, cosine * down - sine * right, forward)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_come_back() {
        let angles = [2.1, 0.4, -0.3];
        for (again, given) in to_angles(from_angles(2.1, 0.4, -0.3)).iter().zip(angles) {
            assert!((again - given).abs() < 1e-12);
        }
    }

    #[test]
    fn a_level_cameras_own_pitch_and_roll_are_those_of_its_pose() {
        let level = from_angles(0.7, 0.0, 0.0);
        let turned = roll_about_axis(pitch_in_camera(level, 0.2), 0.1);
        assert!((turned - from_angles(0.7, 0.2, 0.1)).to_cols_array().iter().all(|d| d.abs() < 1e-12));
        assert!(pitch_in_camera(level, 0.2).z_axis.z < 0.0, "looks down");
    }
}
