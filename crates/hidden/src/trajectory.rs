//! True motion of the camera: a walk over the field with a humanoid's gait on top.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use crate::{random::Random, rig::Station, rotation};

/// Time between the computed points of the walk, seconds.
const STEP_S: f64 = 0.005;
/// Time by which the walk begins before the first picture, seconds: effects shift the time.
const LEAD_S: f64 = 1.0;
/// How a robot walks and looks about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gait {
    /// Walking speed, metres per second.
    pub speed_m_per_s: f64,
    /// Largest turning rate of the robot, radians per second.
    pub max_turn_rad_per_s: f64,
    /// Frequency of the steps to the left and right, hertz.
    pub frequency_hz: f64,
    /// Amplitude of the roll at the gait's frequency, radians.
    pub roll_rad: f64,
    /// Amplitude of the pitch at twice the gait's frequency, radians.
    pub pitch_rad: f64,
    /// Amplitude of the sway to the sides, metres.
    pub lateral_m: f64,
    /// Amplitude of the height at twice the gait's frequency, metres.
    pub bob_m: f64,
    /// Pitch of the camera at rest, radians: one number, or from … to, of which the seed draws one.
    pub look_down_rad: [f64; 2],
    /// Largest turn of the head to the sides, radians.
    pub scan_rad: f64,
    /// Time of one look to the left and right, seconds.
    pub scan_period_s: f64,
}

impl Gait {
    /// Gait of a small humanoid that looks straight ahead.
    pub const STANDARD: Self = Self {
        speed_m_per_s: 0.275,
        max_turn_rad_per_s: PI / 3.0,
        frequency_hz: 0.83,
        roll_rad: 1.5 * PI / 180.0,
        pitch_rad: 1.2 * PI / 180.0,
        lateral_m: 0.006,
        bob_m: 0.006,
        look_down_rad: [0.39, 0.45],
        scan_rad: 0.0,
        scan_period_s: 5.0,
    };
}

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

/// Path of the camera at every time of a recording.
#[derive(Debug, Clone)]
pub struct Trajectory {
    points: Vec<Ground>,
    height_m: f64,
    pitch_rad: f64,
    gait: Gait,
    /// Amplitude of the gait's sway; 0 when standing.
    sway: f64,
    phase_rad: f64,
}

impl Trajectory {
    /// Draws a path inside `half_extent_m` (x and y) for times up to `duration_s`, for a camera carried at a height.
    pub fn new(
        random: &mut Random,
        walk: Walk,
        gait: Gait,
        duration_s: f64,
        half_extent_m: DVec2,
        height_m: f64,
    ) -> Self {
        let count = ((duration_s + 2.0 * LEAD_S) / STEP_S) as usize + 2;
        let start = Walker::new(random, half_extent_m);
        let phase_rad = random.between(0.0, TAU);
        let [least, most] = gait.look_down_rad;
        let pitch_rad = random.between(least, most);
        let (points, sway) = match walk {
            Walk::Standing => (vec![start.ground], 0.0),
            Walk::Walking => (start.walk(random, &gait, half_extent_m, count), 1.0),
        };
        Self { points, height_m, pitch_rad, gait, sway, phase_rad }
    }

    /// Returns the path of a camera that is put at one place after the other, for a period each, seconds: it stands still there, as
    /// high and pitched as this one at rest. The middle of the period of the first place is one period after 0.
    pub fn through(&self, places: &[Ground], period_s: f64) -> Self {
        let place_at = |step: usize| {
            let time_s = step as f64 * STEP_S - LEAD_S;
            let number = (time_s / period_s).round() as usize;
            places[number.clamp(1, places.len()) - 1]
        };
        let count = (((places.len() + 1) as f64 * period_s + 2.0 * LEAD_S) / STEP_S) as usize;
        Self {
            points: (0..count).map(place_at).collect(),
            sway: 0.0,
            gait: Gait { scan_rad: 0.0, ..self.gait },
            ..*self
        }
    }

    /// Returns the pose on the ground at a time, seconds.
    pub fn ground(&self, time_s: f64) -> Ground {
        let place = ((time_s + LEAD_S) / STEP_S).clamp(0.0, (self.points.len() - 1) as f64);
        let (index, part) = (place as usize, place.fract());
        let (a, b) = (self.points[index], self.points[(index + 1).min(self.points.len() - 1)]);
        let scan_rad = self.gait.scan_rad * (TAU * time_s / self.gait.scan_period_s + self.phase_rad).sin();
        Ground {
            position: a.position.lerp(b.position, part),
            yaw_rad: a.yaw_rad + part * (b.yaw_rad - a.yaw_rad) + scan_rad,
        }
    }

    /// Returns the phase of the gait at a time, radians.
    pub fn gait_phase_rad(&self, time_s: f64) -> f64 {
        TAU * self.gait.frequency_hz * time_s + self.phase_rad
    }

    /// Returns yaw, pitch and roll at a time, radians.
    pub fn angles(&self, time_s: f64) -> [f64; 3] {
        let phase = self.gait_phase_rad(time_s);
        [
            self.ground(time_s).yaw_rad,
            self.pitch_rad + self.sway * self.gait.pitch_rad * (2.0 * phase + 0.7).sin(),
            self.sway * self.gait.roll_rad * phase.sin(),
        ]
    }

    /// Returns the camera pose at a time, seconds.
    pub fn station(&self, time_s: f64) -> Station {
        let ground = self.ground(time_s);
        let phase = self.gait_phase_rad(time_s);
        let left = DVec2::from_angle(ground.yaw_rad + PI / 2.0);
        let position = ground.position + self.sway * self.gait.lateral_m * (phase + 0.4).sin() * left;
        let height_m = self.height_m + self.sway * self.gait.bob_m * (2.0 * phase).cos();
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

    fn walk(mut self, random: &mut Random, gait: &Gait, half_extent_m: DVec2, count: usize) -> Vec<Ground> {
        (0..count)
            .map(|_| {
                while self.ground.position.distance(self.target) < 0.5 {
                    let place = DVec2::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0));
                    self.target = place * half_extent_m;
                }
                self.step(gait);
                self.ground
            })
            .collect()
    }

    fn step(&mut self, gait: &Gait) {
        let way = self.target - self.ground.position;
        let error = wrapped(way.y.atan2(way.x) - self.ground.yaw_rad);
        let turn = (2.0 * error).clamp(-gait.max_turn_rad_per_s, gait.max_turn_rad_per_s);
        self.turn += (turn - self.turn) * STEP_S / 0.25;
        let speed = gait.speed_m_per_s * (1.0 - 0.8 * self.turn.abs() / gait.max_turn_rad_per_s);
        self.speed += (speed - self.speed) * STEP_S / 0.3;
        self.ground.yaw_rad += self.turn * STEP_S;
        self.ground.position += self.speed * STEP_S * DVec2::from_angle(self.ground.yaw_rad);
    }
}

/// Wraps an angle to (−π, π].
pub fn wrapped(angle_rad: f64) -> f64 {
    angle_rad.sin().atan2(angle_rad.cos())
}
