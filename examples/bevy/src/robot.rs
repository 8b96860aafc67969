//! A robot of Bevy's world.

use bevy::prelude::*;
use reality_sim::{glam, simulator::Humanoid};

use crate::axes::{ground_pose, ground_velocity};

/// Humanoid robot that every [`RealityCamera`](crate::RealityCamera) sees but those that it carries itself. It stands on the
/// ground at the place of its entity and faces where that looks; its name is that of the entity.
#[derive(Debug, Clone, PartialEq, Component)]
#[require(Transform)]
pub struct RealityRobot {
    /// Height, metres; the entity's scale does not change it.
    pub height_m: f64,
    /// Share of the light that the parts in the team's colour send back, 0 to 1.
    pub team_reflectance: LinearRgba,
    /// Phase of its gait, radians; `None` for one that stands.
    pub gait_rad: Option<f64>,
    /// Velocity along Bevy's axes, metres per second. It blurs the robot where the camera's model has an exposure.
    pub velocity_m_s: Vec3,
}

impl RealityRobot {
    /// Makes a robot that stands.
    pub fn standing(height_m: f64, team_reflectance: impl Into<LinearRgba>) -> Self {
        let team_reflectance = team_reflectance.into();
        Self { height_m, team_reflectance, gait_rad: None, velocity_m_s: Vec3::ZERO }
    }

    /// Returns the robot as cameras draw it.
    pub(crate) fn layer(&self, place: &GlobalTransform, name: &str) -> Humanoid {
        Humanoid {
            name: name.to_owned(),
            place: ground_pose(place),
            height_m: self.height_m,
            team_reflectance: glam::Vec3::from_array(self.team_reflectance.to_f32_array_no_alpha()),
            gait_rad: self.gait_rad,
            velocity_in_world: ground_velocity(self.velocity_m_s),
        }
    }
}
