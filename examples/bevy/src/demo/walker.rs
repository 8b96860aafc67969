//! A robot that walks.

use std::f64::consts::TAU;

use reality_sim::{
    Pose2,
    glam::DVec2,
    pose::{Motion2, wrap_angle},
};

/// Speed of a robot that walks straight on, metres a second.
const SPEED_M_S: f64 = 0.25;
/// Fastest turn, radians a second.
const TURN_RAD_S: f64 = 1.8;
/// Way of a double step, metres.
const DOUBLE_STEP_M: f64 = 0.16;
/// Distance from its target at which a robot has arrived, metres.
const ARRIVED_M: f64 = 0.04;
/// Difference from its heading at which a robot faces a direction, radians.
const FACING_RAD: f64 = 0.15;

/// Place that a walker keeps away from.
#[derive(Debug, Clone, Copy)]
pub struct Obstacle {
    /// Centre.
    pub place: DVec2,
    /// Distance within which it is avoided, metres.
    pub room_m: f64,
}

/// Robot that walks over the field.
#[derive(Debug, Clone)]
pub struct Walker {
    /// Place and heading.
    pub pose: Pose2,
    /// Phase of its gait, radians.
    pub gait_rad: f64,
    /// Speed, metres a second; zero for one that stands.
    pub speed_m_s: f64,
    is_turning: bool,
}

impl Walker {
    /// Makes a robot that stands.
    pub fn at(pose: Pose2) -> Self {
        Self { pose, gait_rad: 0.0, speed_m_s: 0.0, is_turning: false }
    }

    /// Whether its feet move.
    pub fn is_walking(&self) -> bool {
        self.speed_m_s > 0.0 || self.is_turning
    }

    /// Returns the velocity, metres a second.
    pub fn velocity_in_world(&self) -> DVec2 {
        self.speed_m_s * DVec2::from_angle(self.pose.yaw_rad)
    }

    /// Walks around obstacles to a place, and turns into a direction there. Returns whether it has arrived and faces it.
    pub fn step(&mut self, step_s: f64, target: DVec2, facing: DVec2, obstacles: &[Obstacle]) -> bool {
        let way = target - self.pose.position_in_world();
        let has_arrived = way.length() < ARRIVED_M;
        let wish = if has_arrived { facing } else { self.around(way.normalize_or_zero(), obstacles) };
        let error_rad = wrap_angle(wish.to_angle() - self.pose.yaw_rad);
        let turn_rad = error_rad.clamp(-TURN_RAD_S * step_s, TURN_RAD_S * step_s);
        let is_facing = error_rad.abs() < FACING_RAD;
        self.is_turning = !is_facing;
        self.speed_m_s = if has_arrived { 0.0 } else { SPEED_M_S * error_rad.cos().max(0.0) };
        let forward_m = (self.speed_m_s * step_s).min(way.length());
        self.pose = self.pose.moved(Motion2 { forward_m, left_m: 0.0, turn_rad });
        let pace_m = if self.is_turning { 0.5 * SPEED_M_S * step_s } else { 0.0 };
        self.gait_rad = (self.gait_rad + TAU * forward_m.max(pace_m) / DOUBLE_STEP_M) % TAU;
        has_arrived && is_facing
    }

    /// Bends a direction around obstacles: the nearer one is, the more.
    fn around(&self, direction: DVec2, obstacles: &[Obstacle]) -> DVec2 {
        let position = self.pose.position_in_world();
        obstacles.iter().fold(direction, |wish, obstacle| {
            let away = position - obstacle.place;
            let nearness = (1.0 - away.length() / obstacle.room_m).max(0.0);
            let away = away.normalize_or_zero();
            // Half of it to the side, so that an obstacle straight ahead is passed too.
            let side = if away.perp().dot(direction) < 0.0 { -away.perp() } else { away.perp() };
            wish + 2.0 * nearness * (away + side)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walk(obstacles: &[Obstacle]) -> (Walker, f64) {
        let mut walker = Walker::at(Pose2::default());
        let mut nearest_m = f64::INFINITY;
        for _ in 0..600 {
            if walker.step(0.05, DVec2::new(2.0, 0.0), DVec2::Y, obstacles) {
                break;
            }
            let distances = obstacles.iter().map(|it| it.place.distance(walker.pose.position_in_world()));
            nearest_m = distances.fold(nearest_m, f64::min);
        }
        (walker, nearest_m)
    }

    #[test]
    fn walker_arrives_and_turns_as_it_should() {
        let (walker, _) = walk(&[]);
        assert!(walker.pose.position_in_world().distance(DVec2::new(2.0, 0.0)) < ARRIVED_M);
        assert!((walker.pose.yaw_rad - 0.5 * std::f64::consts::PI).abs() < FACING_RAD);
        assert_eq!(walker.speed_m_s, 0.0);
    }

    #[test]
    fn walker_passes_what_stands_in_its_way() {
        let (walker, nearest_m) = walk(&[Obstacle { place: DVec2::new(1.0, 0.0), room_m: 0.5 }]);
        assert!(walker.pose.position_in_world().distance(DVec2::new(2.0, 0.0)) < ARRIVED_M, "{walker:?}");
        assert!(nearest_m > 0.2, "{nearest_m} m");
    }
}
