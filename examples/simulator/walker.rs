//! The true robot: how its legs carry it and its camera.

use std::f64::consts::{PI, TAU};

use reality_sim::{CameraPose, Pose2, glam::DVec2, pose::Motion2};

use crate::{
    noise::{Noise, SLIP, Use},
    senses::Command,
};

/// Time of one step of the simulation, seconds.
const STEP_S: f64 = 0.01;
/// Time in which the robot takes up a new velocity, seconds: that of the recorded walk.
const DELAY_S: f64 = 0.3;
/// Gait of the demonstration walk, by its ground truth: frequency in hertz, and amplitudes of the sway to the sides, of the
/// height, of pitch and of roll. Height and pitch swing twice in a stride.
const FREQUENCY_HZ: f64 = 0.83;
const SWAY_M: f64 = 0.006;
const BOB_M: f64 = 0.008;
const PITCH_RAD: f64 = 0.02;
const ROLL_RAD: f64 = 0.03;
/// Speed from which the gait swings fully, metres per second; a turning rate counts as what it moves feet 0.2 m apart.
const FULL_GAIT_M_S: f64 = 0.05;
const FEET_M: f64 = 0.1;

/// Robot that walks as it is told, more or less.
#[derive(Debug, Clone)]
pub struct Walker {
    /// Place of the body over the ground, without the gait.
    ground: Pose2,
    velocity: Command,
    phase_rad: f64,
    /// How much of the gait swings, 0 to 1.
    swing: f64,
    /// Speed over what was commanded: forward, to the left, turning.
    slip: [f64; 3],
}

impl Walker {
    /// Puts a robot at a place.
    pub fn new(ground: Pose2, noise: Noise) -> Self {
        let [forward, left, turn, phase, ..] = noise.normals(Use::Constant, 0);
        let slip = [forward, left, turn].map(|normal| 1.0 + SLIP * normal);
        Self { ground, velocity: Command::default(), phase_rad: phase, swing: 0.0, slip }
    }

    /// Returns where its body is.
    pub fn ground(&self) -> Pose2 {
        self.ground
    }

    /// Walks for some seconds.
    pub fn walk(&mut self, command: Command, seconds: f64) {
        for _ in 0..(seconds / STEP_S).round() as u32 {
            self.step(command);
        }
    }

    /// Returns the pose of its camera, whose height, pitch and roll are these while it stands.
    pub fn camera_pose(&self, standing: CameraPose) -> CameraPose {
        let (phase, swing) = (self.phase_rad, self.swing);
        let left = DVec2::from_angle(self.ground.yaw_rad + 0.5 * PI);
        let place = self.ground.position_in_world() + swing * SWAY_M * (phase + 0.4).sin() * left;
        CameraPose {
            height_m: standing.height_m + swing * BOB_M * (2.0 * phase).cos(),
            pitch_rad: standing.pitch_rad + swing * PITCH_RAD * (2.0 * phase + 0.7).sin(),
            roll_rad: standing.roll_rad + swing * ROLL_RAD * phase.sin(),
            ..standing.with_planar(Pose2::new(place.x, place.y, self.ground.yaw_rad))
        }
    }

    fn step(&mut self, command: Command) {
        let part = STEP_S / DELAY_S;
        let towards = |now: f64, wanted: f64| now + part * (wanted - now);
        let velocity = &mut self.velocity;
        velocity.forward_m_s = towards(velocity.forward_m_s, self.slip[0] * command.forward_m_s);
        velocity.left_m_s = towards(velocity.left_m_s, self.slip[1] * command.left_m_s);
        velocity.turn_rad_s = towards(velocity.turn_rad_s, self.slip[2] * command.turn_rad_s);
        let speed_m_s = velocity.forward_m_s.hypot(velocity.left_m_s) + FEET_M * velocity.turn_rad_s.abs();
        self.swing = towards(self.swing, (speed_m_s / FULL_GAIT_M_S).min(1.0));
        self.phase_rad = (self.phase_rad + TAU * FREQUENCY_HZ * STEP_S) % TAU;
        self.ground = self.ground.moved(Motion2 {
            forward_m: velocity.forward_m_s * STEP_S,
            left_m: velocity.left_m_s * STEP_S,
            turn_rad: velocity.turn_rad_s * STEP_S,
        });
    }
}
