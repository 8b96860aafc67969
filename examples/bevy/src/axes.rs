//! Bevy's axes and those of the field. Both are right-handed, in metres, with the origin at the field's centre on the carpet.
//!
//! | frame | axes |
//! |---|---|
//! | Bevy | x right, y up, −z forward |
//! | world | x forward, towards the opponent's goal; y left; z up (REP-103) |
//!
//! An entity that is not turned looks along Bevy's −z, which is the world's x: yaw, pitch and roll are then zero. Bevy's numbers
//! have single precision: poses come back to some micrometres.

use bevy::{
    math::{Mat3, Quat, Vec3},
    transform::components::{GlobalTransform, Transform},
};
use reality_sim::{
    CameraPose, Pose2,
    glam::{DMat3, DQuat, DVec2, DVec3},
};

/// Turns a point or a direction from Bevy's axes into the world's.
pub fn world_from_bevy(in_bevy: Vec3) -> DVec3 {
    DVec3::new(f64::from(-in_bevy.z), f64::from(-in_bevy.x), f64::from(in_bevy.y))
}

/// Turns a point or a direction from the world's axes into Bevy's.
pub fn bevy_from_world(in_world: DVec3) -> Vec3 {
    Vec3::new(-in_world.y as f32, in_world.z as f32, -in_world.x as f32)
}

/// Returns the pose of a camera that looks forward from the place of an entity. Its scale changes nothing; one that is scaled to
/// nothing looks as if it were not turned.
pub fn camera_pose(place: &GlobalTransform) -> CameraPose {
    let axes = place.affine().matrix3;
    let forward = world_from_bevy(Vec3::from(-axes.z_axis)).normalize_or(DVec3::X);
    let up = world_from_bevy(Vec3::from(axes.y_axis)).normalize_or(DVec3::Z);
    let right = forward.cross(up).normalize_or(DVec3::NEG_Y);
    let world_from_camera = DQuat::from_mat3(&DMat3::from_cols(right, forward.cross(right), forward));
    CameraPose::from_world_from_camera(world_from_bevy(place.translation()), world_from_camera)
}

/// Returns the place of an entity whose camera has a pose.
pub fn camera_transform(pose: CameraPose) -> Transform {
    let world_from_camera = pose.rotation_world_from_camera();
    let [right, down, forward] =
        [world_from_camera.x_axis, world_from_camera.y_axis, world_from_camera.z_axis].map(bevy_from_world);
    let rotation = Quat::from_mat3(&Mat3::from_cols(right, -down, -forward));
    Transform { translation: bevy_from_world(pose.position_in_world()), rotation, scale: Vec3::ONE }
}

/// Returns the place of an entity on the ground below it, and its heading; zero for one that looks straight up or down.
pub fn ground_pose(place: &GlobalTransform) -> Pose2 {
    let position = world_from_bevy(place.translation());
    let forward = world_from_bevy(Vec3::from(-place.affine().matrix3.z_axis)).normalize_or_zero();
    let heading = forward.truncate();
    let yaw_rad = if heading.length() > 1e-6 { heading.y.atan2(heading.x) } else { 0.0 };
    Pose2::new(position.x, position.y, yaw_rad)
}

/// Returns the place of an entity that stands on the ground.
pub fn ground_transform(pose: Pose2) -> Transform {
    let translation = bevy_from_world(pose.position_in_world().extend(0.0));
    Transform::from_translation(translation).with_rotation(Quat::from_rotation_y(pose.yaw_rad as f32))
}

/// Returns the part of a velocity along the ground, world axes.
pub(crate) fn ground_velocity(velocity_in_bevy: Vec3) -> DVec2 {
    world_from_bevy(velocity_in_bevy).truncate()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use reality_sim::pose::wrap_angle;

    use super::*;

    fn pose(x_m: f64, y_m: f64, yaw_rad: f64, height_m: f64, pitch_rad: f64, roll_rad: f64) -> CameraPose {
        CameraPose::new(Pose2::new(x_m, y_m, yaw_rad), height_m, pitch_rad, roll_rad)
    }

    fn assert_close(found: CameraPose, expected: CameraPose) {
        let differences = [
            found.x_m - expected.x_m,
            found.y_m - expected.y_m,
            wrap_angle(found.yaw_rad - expected.yaw_rad),
            found.height_m - expected.height_m,
            found.pitch_rad - expected.pitch_rad,
            wrap_angle(found.roll_rad - expected.roll_rad),
        ];
        assert!(
            differences.iter().all(|difference| difference.abs() < 1e-5),
            "{found:?} is not {expected:?}"
        );
    }

    #[test]
    fn axes_point_where_the_table_says() {
        assert_eq!(world_from_bevy(Vec3::NEG_Z), DVec3::X, "forward");
        assert_eq!(world_from_bevy(Vec3::NEG_X), DVec3::Y, "left");
        assert_eq!(world_from_bevy(Vec3::Y), DVec3::Z, "up");
        let point = Vec3::new(1.0, -2.0, 3.0);
        assert_eq!(bevy_from_world(world_from_bevy(point)), point);
    }

    #[test]
    fn entity_that_is_not_turned_looks_at_the_opponents_goal() {
        let place = Transform::from_xyz(-0.5, 0.6, 2.0);
        assert_close(camera_pose(&place.into()), pose(-2.0, 0.5, 0.0, 0.6, 0.0, 0.0));
    }

    #[test]
    fn turns_of_an_entity_are_yaw_pitch_and_roll_with_the_right_sign() {
        // Counter-clockwise seen from above: to the left.
        let left = Transform::from_rotation(Quat::from_rotation_y(0.4));
        assert_close(camera_pose(&left.into()), pose(0.0, 0.0, 0.4, 0.0, 0.0, 0.0));
        // A positive turn about Bevy's x lifts −z; a positive pitch looks down.
        let down = Transform::from_rotation(Quat::from_rotation_x(-0.3));
        assert_close(camera_pose(&down.into()), pose(0.0, 0.0, 0.0, 0.0, 0.3, 0.0));
        // Clockwise seen from behind is a negative turn about z, which points at who stands behind.
        let clockwise = Transform::from_rotation(Quat::from_rotation_z(-0.2));
        assert_close(camera_pose(&clockwise.into()), pose(0.0, 0.0, 0.0, 0.0, 0.0, 0.2));
    }

    #[test]
    fn camera_that_looks_at_a_point_of_the_ground_has_the_pose_of_the_triangle() {
        // From 1 m above (−1, −1), the centre mark lies 45° to the left, √2 m away and 1 m below.
        let place = Transform::from_translation(bevy_from_world(DVec3::new(-1.0, -1.0, 1.0)))
            .looking_at(Vec3::ZERO, Vec3::Y);
        let pitch_rad = 1.0_f64.atan2(2.0_f64.sqrt());
        assert_close(camera_pose(&place.into()), pose(-1.0, -1.0, PI / 4.0, 1.0, pitch_rad, 0.0));
    }

    #[test]
    fn poses_come_back() {
        for yaw_rad in [-3.0, -1.2, 0.0, 0.7, 2.9] {
            for pitch_rad in [-1.2, 0.0, 0.42, 1.3] {
                for roll_rad in [-2.5, 0.0, 0.1, 1.4] {
                    let expected = pose(-2.1, 1.4, yaw_rad, 0.52, pitch_rad, roll_rad);
                    assert_close(camera_pose(&camera_transform(expected).into()), expected);
                }
            }
        }
    }

    #[test]
    fn camera_is_seen_at_the_same_pixel_from_both_frames() {
        let expected = pose(-2.1, 1.4, 2.0, 0.52, 0.42, 0.1);
        let point_in_world = DVec3::new(-1.0, 0.5, 0.3);
        let place = GlobalTransform::from(camera_transform(expected));
        let point = place.affine().inverse().transform_point3(bevy_from_world(point_in_world)).as_dvec3();
        let point_in_camera = expected.camera_from_world(point_in_world);
        assert!((point.x - point_in_camera.x).abs() < 1e-5, "right");
        assert!((point.y + point_in_camera.y).abs() < 1e-5, "down");
        assert!((point.z + point_in_camera.z).abs() < 1e-5, "forward");
    }

    #[test]
    fn places_on_the_ground_come_back_and_scale_changes_nothing() {
        for yaw_rad in [-2.0, 0.0, FRAC_PI_2, 3.0] {
            let place = ground_transform(Pose2::new(1.5, -0.7, yaw_rad)).with_scale(Vec3::splat(2.5));
            let found = ground_pose(&place.into());
            assert!((found.x_m - 1.5).abs() < 1e-5 && (found.y_m + 0.7).abs() < 1e-5);
            assert!(wrap_angle(found.yaw_rad - yaw_rad).abs() < 1e-5);
            let camera = camera_pose(&place.into());
            assert!(wrap_angle(camera.yaw_rad - yaw_rad).abs() < 1e-5);
        }
    }

    #[test]
    fn mirrored_and_vanished_entities_have_poses() {
        let turned = Transform::from_xyz(0.0, 0.5, 0.0).with_rotation(Quat::from_rotation_y(0.4));
        let mirrored = turned.with_scale(Vec3::new(-1.0, 1.0, 1.0));
        assert_close(camera_pose(&mirrored.into()), pose(0.0, 0.0, 0.4, 0.5, 0.0, 0.0));
        let vanished = turned.with_scale(Vec3::ZERO);
        assert_close(camera_pose(&vanished.into()), pose(0.0, 0.0, 0.0, 0.5, 0.0, 0.0));
        assert_eq!(ground_pose(&vanished.into()).yaw_rad, 0.0);
    }

    #[test]
    fn robot_that_lies_on_its_back_has_no_heading() {
        let up = Transform::from_rotation(Quat::from_rotation_x(FRAC_PI_2 as f32));
        assert_eq!(ground_pose(&up.into()).yaw_rad, 0.0);
    }
}
