//! Where to walk: towards the ball, and only where pictures were recorded.

use std::sync::Arc;

use reality_sim::{Archive, CameraPose, Pose2, glam::DVec2, pose::wrap_angle};

use crate::{ball_track::BallTrack, senses::Command};

/// Time that the plan looks ahead, seconds.
const HORIZON_S: f64 = 0.8;
/// Velocities that are tried: those of a small humanoid.
const FORWARD_M_S: [f64; 6] = [-0.15, -0.07, 0.0, 0.07, 0.15, 0.25];
const LEFT_M_S: [f64; 3] = [-0.08, 0.0, 0.08];
const TURN_RAD_S: [f64; 7] = [-0.9, -0.5, -0.2, 0.0, 0.2, 0.5, 0.9];
/// Distance at which the robot follows the ball, metres.
const FOLLOWED_M: f64 = 0.9;
/// Deviations that cost as much as each other: in distance to the ball, metres, in its bearing, radians, and of the nearest
/// picture, pixels.
const DISTANCE_M: f64 = 0.3;
const BEARING_RAD: f64 = 0.35;
const PICTURE_PX: f64 = 70.0;
/// Distance of the nearest picture from which a pose is not walked to if there is another choice, pixels: half of the
/// picture's height, where recorded pictures still show most of what is in view.
const FARTHEST_PX: f64 = 200.0;
/// Cost of such a pose.
const FORBIDDEN: f64 = 1e3;

/// Plan that knows where pictures were recorded.
#[derive(Debug, Clone)]
pub struct Plan {
    archive: Arc<Archive>,
}

impl Plan {
    /// Makes a plan for the places of an archive.
    pub fn new(archive: Arc<Archive>) -> Self {
        Self { archive }
    }

    /// Chooses the velocity that leads to the best pose from one where the robot believes to be.
    pub fn command(&self, pose: CameraPose, ball: Option<&BallTrack>) -> Command {
        let Some(ball) = ball else { return Command::default() };
        let ball_then = ball.place_in_world + HORIZON_S * ball.velocity_in_world;
        let mut best = (f64::INFINITY, Command::default());
        for forward_m_s in FORWARD_M_S {
            for left_m_s in LEFT_M_S {
                for turn_rad_s in TURN_RAD_S {
                    let command = Command { forward_m_s, left_m_s, turn_rad_s };
                    let then = command.pose_after(pose.planar(), HORIZON_S);
                    let cost = to_ball(then, ball_then) + self.away_from_pictures(then);
                    if cost < best.0 {
                        best = (cost, command);
                    }
                }
            }
        }
        best.1
    }

    fn away_from_pictures(&self, then: Pose2) -> f64 {
        let usual = self.archive.usual_pose().with_planar(then);
        let nearest = self.archive.index().nearest(usual, 1);
        let distance_px = nearest.map_or(f64::INFINITY, |nearest| nearest[0].distance_px);
        let cost = (distance_px / PICTURE_PX).powi(2);
        if distance_px > FARTHEST_PX { FORBIDDEN + cost.min(FORBIDDEN) } else { cost }
    }
}

fn to_ball(robot: Pose2, ball: DVec2) -> f64 {
    let way = ball - robot.position_in_world();
    let bearing_rad = wrap_angle(way.to_angle() - robot.yaw_rad);
    ((way.length() - FOLLOWED_M) / DISTANCE_M).powi(2) + (bearing_rad / BEARING_RAD).powi(2)
}
