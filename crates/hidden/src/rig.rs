//! Position of the camera relative to the frame whose poses are believed to be the camera's.

use glam::{DMat3, DVec2, DVec3};

use crate::rotation;

/// Camera pose in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    /// Projection centre, metres.
    pub position: DVec3,
    /// Rotation with the columns right, down, forward.
    pub world_from_camera: DMat3,
}

/// True camera in the believed camera's frame: moved and turned about the vertical first, then pitched, then rolled.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rig {
    /// Offset ahead and to the left in the plane of the ground, by the believed heading, metres.
    pub offset_m: DVec2,
    /// Height above the believed one, metres.
    pub raised_m: f64,
    /// Turn about the vertical, counter-clockwise, radians.
    pub yaw_rad: f64,
    /// Pitch in the camera frame, down is positive, radians.
    pub pitch_rad: f64,
    /// Roll about the optical axis, after the pitch, radians.
    pub roll_rad: f64,
}

impl Rig {
    /// Returns the true camera pose for the one that is believed.
    pub fn true_of(&self, believed: Station) -> Station {
        let mut turned = believed.world_from_camera;
        if self.yaw_rad != 0.0 {
            turned = DMat3::from_rotation_z(self.yaw_rad) * turned;
        }
        let pitched = rotation::pitch_in_camera(turned, self.pitch_rad);
        let way = self.way(believed.world_from_camera);
        Station {
            position: believed.position + way,
            world_from_camera: rotation::roll_about_axis(pitched, self.roll_rad),
        }
    }

    /// Returns the camera pose that is believed for the true one.
    pub fn believed_of(&self, truly: Station) -> Station {
        let unrolled = rotation::roll_about_axis(truly.world_from_camera, -self.roll_rad);
        let level = rotation::pitch_in_camera(unrolled, -self.pitch_rad);
        let believed = DMat3::from_rotation_z(-self.yaw_rad) * level;
        Station { position: truly.position - self.way(believed), world_from_camera: believed }
    }

    fn way(&self, believed: DMat3) -> DVec3 {
        if self.offset_m == DVec2::ZERO {
            return DVec3::Z * self.raised_m;
        }
        let [yaw_rad, ..] = rotation::to_angles(believed);
        DVec2::from_angle(yaw_rad).rotate(self.offset_m).extend(self.raised_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIG: Rig = Rig {
        offset_m: DVec2::new(0.05, -0.02),
        raised_m: 0.01,
        yaw_rad: 0.03,
        pitch_rad: 0.02,
        roll_rad: -0.04,
    };

    #[test]
    fn believed_poses_come_back() {
        let believed = Station {
            position: DVec3::new(1.0, -2.0, 0.5),
            world_from_camera: rotation::from_angles(2.1, 0.4, -0.3),
        };
        let again = RIG.believed_of(RIG.true_of(believed));
        assert!(again.position.distance(believed.position) < 1e-12);
        let difference = again.world_from_camera - believed.world_from_camera;
        assert!(difference.to_cols_array().iter().all(|value| value.abs() < 1e-12));
    }

    #[test]
    fn a_level_camera_is_turned_by_the_angles_and_moved_by_its_heading() {
        let believed =
            Station { position: DVec3::Z, world_from_camera: rotation::from_angles(1.0, 0.0, 0.0) };
        let truly = RIG.true_of(believed);
        let angles = rotation::to_angles(truly.world_from_camera);
        for (angle, expected) in angles.iter().zip([1.03, 0.02, -0.04]) {
            assert!((angle - expected).abs() < 1e-12);
        }
        let (sine, cosine) = 1.0_f64.sin_cos();
        let ahead = DVec3::new(0.05 * cosine + 0.02 * sine, 0.05 * sine - 0.02 * cosine, 1.01);
        assert!(truly.position.distance(ahead) < 1e-12);
    }
}
