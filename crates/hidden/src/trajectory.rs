//! True motion of the camera: a walk over the field with a humanoid's gait on top.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec2, DVec3};

use crate::{random::Random, rotation};

/// Time between the computed points of the walk, seconds.
const STEP_S: f64 = 0.005;
/// Time by which the walk begins before the first picture, seconds: effects shift the time.
const LEAD_S: f64 = 1.0;
/// Walking speed of the robot, metres per second.
const SPEED_M_PER_S: f64 = 0.275;
/// Largest turning rate of the robot, radians per second.
const MAX_TURN_RAD_PER_S: f64 = PI / 3.0;
/// Frequency of the steps to the left and right, hertz.
const GAIT_HZ: f64 = 0.83;
const SWAY_ROLL_RAD: f64 = 1.5 * PI / 180.0;
const SWAY_PITCH_RAD: f64 = 1.2 * PI / 180.0;
const SWAY_LATERAL_M: f64 = 0.006;
const BOB_M: f64 = 0.006;

/// Motion of the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Walk {
    /// Walks over the field from one random position to the next.
    #[default]
    Walking,
    /// Stands still at a random position.
    Standing,
}

/// Pose of the robot on the ground, without the sway of its gait: the odometry measures its motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Position in the world, metres.
    pub position: DVec2,
    /// Heading, not wrapped, radians.
    pub yaw_rad: f64,
}

/// Camera pose in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    /// Projection centre, metres.
    pub position: DVec3,
    /// Rotation with the columns right, down, forward.
    pub world_from_camera: DMat3,
}

/// Path of the camera at every time of a recording.
#[derive(Debug, Clone)]
pub struct Trajectory {
    points: Vec<Ground>,
    height_m: f64,
    pitch_rad: f64,
    /// Amplitude of the gait's sway; 0 when standing.
    sway: f64,
    phase_rad: f64,
}

impl Trajectory {
    /// Draws a path inside `half_extent_m` (x and y) for times up to `duration_s`, for a camera carried at a height.
    pub fn new(seed: u64, walk: Walk, duration_s: f64, half_extent_m: DVec2, height_m: f64) -> Self {
        let random = &mut Random::stream(seed, "trajectory", 0);
        let count = ((duration_s + 2.0 * LEAD_S) / STEP_S) as usize + 2;
        let start = Walker::new(random, half_extent_m);
        let phase_rad = random.between(0.0, TAU);
        let pitch_rad = random.between(0.39, 0.45);
        let (points, sway) = match walk {
            Walk::Standing => (vec![start.ground], 0.0),
            Walk::Walking => (start.walk(random, half_extent_m, count), 1.0),
        };
        Self { points, height_m, pitch_rad, sway, phase_rad }
    }

    /// Returns the pose on the ground at a time, seconds.
    pub fn ground(&self, time_s: f64) -> Ground {
        let place = ((time_s + LEAD_S) / STEP_S).clamp(0.0, (self.points.len() - 1) as f64);
        let (index, part) = (place as usize, place.fract());
        let (a, b) = (self.points[index], self.points[(index + 1).min(self.points.len() - 1)]);
        Ground {
            position: a.position.lerp(b.position, part),
            yaw_rad: a.yaw_rad + part * (b.yaw_rad - a.yaw_rad),
        }
    }

    /// Returns yaw, pitch and roll at a time, radians.
    pub fn angles(&self, time_s: f64) -> [f64; 3] {
        let phase = TAU * GAIT_HZ * time_s + self.phase_rad;
        [
            self.ground(time_s).yaw_rad,
            self.pitch_rad + self.sway * SWAY_PITCH_RAD * (2.0 * phase + 0.7).sin(),
            self.sway * SWAY_ROLL_RAD * phase.sin(),
        ]
    }

    /// Returns the camera pose at a time, seconds.
    pub fn station(&self, time_s: f64) -> Station {
        let ground = self.ground(time_s);
        let phase = TAU * GAIT_HZ * time_s + self.phase_rad;
        let left = DVec2::from_angle(ground.yaw_rad + PI / 2.0);
        let position = ground.position + self.sway * SWAY_LATERAL_M * (phase + 0.4).sin() * left;
        let height_m = self.height_m + self.sway * BOB_M * (2.0 * phase).cos();
        let [yaw, pitch, roll] = self.angles(time_s);
        Station {
            position: position.extend(height_m),
            world_from_camera: rotation::from_angles(yaw, pitch, roll),
        }
    }

    /// Returns the smallest distance of the path from a position, metres.
    pub fn clearance_m(&self, place: DVec2) -> f64 {
        let distances = self.points.iter().step_by(20).map(|point| point.position.distance(place));
        distances.fold(f64::INFINITY, f64::min)
    }
}

/// Robot on its way to a target.
struct Walker {
    ground: Ground,
    target: DVec2,
    speed: f64,
    turn: f64,
}

impl Walker {
    fn new(random: &mut Random, half_extent_m: DVec2) -> Self {
        let place = |random: &mut Random| {
            DVec2::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0)) * half_extent_m
        };
        // The robot faces the field from where it stands, more or less, so that there are lines to see.
        let position = place(random);
        let yaw_rad = (-position.y).atan2(-position.x) + random.between(-0.9, 0.9);
        Self { ground: Ground { position, yaw_rad }, target: place(random), speed: 0.0, turn: 0.0 }
    }

    fn walk(mut self, random: &mut Random, half_extent_m: DVec2, count: usize) -> Vec<Ground> {
        (0..count)
            .map(|_| {
                while self.ground.position.distance(self.target) < 0.5 {
                    let place = DVec2::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0));
                    self.target = place * half_extent_m;
                }
                self.step();
                self.ground
            })
            .collect()
    }

    fn step(&mut self) {
        let way = self.target - self.ground.position;
        let error = wrapped(way.y.atan2(way.x) - self.ground.yaw_rad);
        let turn = (2.0 * error).clamp(-MAX_TURN_RAD_PER_S, MAX_TURN_RAD_PER_S);
        self.turn += (turn - self.turn) * STEP_S / 0.25;
        let speed = SPEED_M_PER_S * (1.0 - 0.8 * self.turn.abs() / MAX_TURN_RAD_PER_S);
        self.speed += (speed - self.speed) * STEP_S / 0.3;
        self.ground.yaw_rad += self.turn * STEP_S;
        self.ground.position += self.speed * STEP_S * DVec2::from_angle(self.ground.yaw_rad);
    }
}

/// Wraps an angle to (−π, π].
pub fn wrapped(angle_rad: f64) -> f64 {
    angle_rad.sin().atan2(angle_rad.cos())
}
