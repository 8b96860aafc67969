//! Measurements that the robot and the motion capture log, with their noise.

use glam::{DMat3, DQuat, DVec2, DVec3};
use reality_sim_core::{
    pose::{CameraPose, Pose2},
    sequence::FrameRecord,
};

use crate::{
    clock::Clock,
    nominal::rounded,
    random::Random,
    rig::Station,
    rotation,
    trajectory::{Ground, Trajectory, Walk, wrapped},
    truth::Truth,
};

/// Time in which the odometry's noise below arises, seconds.
const ODOMETRY_STEP_S: f64 = 0.2;
/// Part of the odometry's noise of a robot that stands.
const STANDING: f64 = 0.1;
/// Precision of the files: values are multiples of 1 / `PER_UNIT`.
const PER_UNIT: f64 = 1e5;

/// Errors of what is logged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Errors of the reference poses.
    pub reference: ReferenceErrors,
    /// Noise of IMU and joints, radians.
    pub imu_rad: f64,
    /// Noise of the odometry in a fifth of a second while walking, metres per axis.
    pub odometry_m: f64,
    /// Noise of the odometry's heading in a fifth of a second while walking, radians.
    pub odometry_rad: f64,
}

/// Errors of reference poses, per axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceErrors {
    /// White noise of the positions, metres.
    pub white_m: f64,
    /// White noise of the rotations, radians.
    pub white_rad: f64,
    /// Noise that decays over time, of the positions, metres.
    pub slow_m: f64,
    /// Noise that decays over time, of the rotations, radians.
    pub slow_rad: f64,
    /// Time in which that decays to 1/e, seconds.
    pub decay_s: f64,
    /// Constant offset in the camera frame, metres.
    pub constant_m: DVec3,
    /// Constant rotation in the camera frame, radians.
    pub constant_rad: DVec3,
}

impl ReferenceErrors {
    /// Poses are the true ones.
    pub const NONE: Self = Self {
        white_m: 0.0,
        white_rad: 0.0,
        slow_m: 0.0,
        slow_rad: 0.0,
        decay_s: 1.0,
        constant_m: DVec3::ZERO,
        constant_rad: DVec3::ZERO,
    };
}

impl Errors {
    /// Errors of good motion capture, and of a small humanoid's odometry and IMU.
    pub const STANDARD: Self = Self {
        reference: ReferenceErrors {
            white_m: 0.003,
            white_rad: 0.14_f64.to_radians(),
            ..ReferenceErrors::NONE
        },
        imu_rad: 0.17_f64.to_radians(),
        odometry_m: 0.003,
        odometry_rad: 0.3_f64.to_radians(),
    };
}

/// What there is to log.
pub struct Logger<'a> {
    /// Seed of the recording.
    pub seed: u64,
    /// Motion of the robot.
    pub walk: Walk,
    /// True path of the camera if `turns_poses`, else the believed one.
    pub trajectory: &'a Trajectory,
    /// Values behind the recording.
    pub truth: &'a Truth,
    /// Times of the recording.
    pub clock: Clock,
    /// Errors of what is logged.
    pub errors: Errors,
    /// Whether what is hidden between the believed and the true camera turns the written poses instead of the pictures.
    pub turns_poses: bool,
    /// Ending of the pictures' names.
    pub ending: &'static str,
}

impl Logger<'_> {
    /// Returns the lines of `frames.csv`, without reference poses.
    pub fn frames(&self) -> Vec<FrameRecord> {
        let random = &mut Random::stream(self.seed, "robot", 0);
        let mut odometry = Odometry { position: DVec2::ZERO, yaw_rad: 0.0 };
        let read_s = |frame: usize| self.clock.logged_s(frame) - self.truth.odometry_delay_s;
        (0..self.clock.frames())
            .map(|frame| {
                if frame > 0 {
                    odometry.step(random, self, [read_s(frame - 1), read_s(frame)]);
                }
                let [pitch_rad, roll_rad] =
                    self.attitude(self.clock.logged_s(frame) - self.truth.imu_delay_s);
                let mut noisy =
                    |angle_rad| rounded(angle_rad + self.errors.imu_rad * random.normal(), PER_UNIT);
                FrameRecord {
                    timestamp_s: self.clock.stamp_s(frame),
                    image: format!("images/{frame:06}.{}", self.ending).into(),
                    odometry: Some(odometry.pose()),
                    pitch_rad: noisy(pitch_rad),
                    roll_rad: noisy(roll_rad),
                    reference_pose: None,
                }
            })
            .collect()
    }

    /// Returns the poses that motion capture measured at these timestamps, in order of time.
    pub fn references(&self, stamps_s: &[f64]) -> Vec<CameraPose> {
        let white = &mut Random::stream(self.seed, "capture", 0);
        let slow = &mut Random::stream(self.seed, "capture drift", 0);
        let errors = &self.errors.reference;
        let mut drift = [vector(slow), vector(slow)];
        let mut last_s = None;
        let mut poses = Vec::with_capacity(stamps_s.len());
        for &stamp_s in stamps_s {
            let kept = last_s.map_or(1.0, |last_s: f64| (-(stamp_s - last_s).abs() / errors.decay_s).exp());
            let fresh = (1.0 - kept * kept).sqrt();
            drift = drift.map(|value| kept * value + fresh * vector(slow));
            last_s = Some(stamp_s);
            let station = self.believed(self.clock.reference_s(stamp_s));
            let shift = errors.white_m * vector(white) + errors.slow_m * drift[0];
            let turn = errors.white_rad * vector(white) + errors.slow_rad * drift[1] + errors.constant_rad;
            let position = station.position + shift + station.world_from_camera * errors.constant_m;
            let turn = DMat3::from_quat(DQuat::from_scaled_axis(turn));
            poses.push(pose_of(Station { position, world_from_camera: station.world_from_camera * turn }));
        }
        poses
    }

    /// Returns the start pose that the robot states.
    pub fn start(&self) -> Pose2 {
        let time_s = self.clock.reference_s(self.clock.stamp_s(0));
        let station = self.believed(time_s);
        let yaw_rad = self.ground(time_s).yaw_rad;
        let [x, y] = [station.position.x, station.position.y];
        Pose2::new(rounded(x, 1e3), rounded(y, 1e3), rounded(wrapped(yaw_rad), 1e3))
    }

    /// Returns the pose that is believed to be the camera's at a time, seconds.
    pub fn believed(&self, time_s: f64) -> Station {
        let station = self.trajectory.station(time_s);
        if self.turns_poses { self.rig(time_s).believed_of(station) } else { station }
    }

    fn rig(&self, time_s: f64) -> crate::rig::Rig {
        self.truth.rig(self.trajectory.gait_phase_rad(time_s))
    }

    /// Returns the pose on the ground whose steps the odometry measures.
    fn ground(&self, time_s: f64) -> Ground {
        let ground = self.trajectory.ground(time_s);
        if !self.turns_poses {
            return ground;
        }
        let rig = self.rig(time_s);
        let yaw_rad = ground.yaw_rad - rig.yaw_rad;
        Ground { position: ground.position - DVec2::from_angle(yaw_rad).rotate(rig.offset_m), yaw_rad }
    }

    /// Returns pitch and roll, radians.
    fn attitude(&self, time_s: f64) -> [f64; 2] {
        let [_, pitch_rad, roll_rad] = if self.turns_poses {
            rotation::to_angles(self.believed(time_s).world_from_camera)
        } else {
            self.trajectory.angles(time_s)
        };
        [pitch_rad, roll_rad]
    }
}

/// Converts to the core's angles.
pub fn pose_of(station: Station) -> CameraPose {
    let [yaw_rad, pitch_rad, roll_rad] = rotation::to_angles(station.world_from_camera);
    let DVec3 { x, y, z } = station.position;
    CameraPose { x_m: x, y_m: y, yaw_rad, height_m: z, pitch_rad, roll_rad }
}

/// Draws three normal numbers.
fn vector(random: &mut Random) -> DVec3 {
    DVec3::new(random.normal(), random.normal(), random.normal())
}

/// Dead-reckoned pose since the first frame.
struct Odometry {
    position: DVec2,
    yaw_rad: f64,
}

impl Odometry {
    /// Adds the step between two times, seconds.
    fn step(&mut self, random: &mut Random, logger: &Logger, [from_s, to_s]: [f64; 2]) {
        let truth = logger.truth;
        let (from, to) = (logger.ground(from_s), logger.ground(to_s));
        let way = DVec2::from_angle(-from.yaw_rad).rotate(to.position - from.position);
        let slipped = DVec2::new(way.x, way.y + truth.odometry_slip * way.x) * truth.odometry_scale;
        let shake = if logger.walk == Walk::Standing { STANDING } else { 1.0 };
        let shake = shake * (logger.clock.period_s() / ODOMETRY_STEP_S).sqrt();
        let noise = DVec2::new(random.normal(), random.normal());
        let measured = slipped + shake * logger.errors.odometry_m * noise;
        self.position += DVec2::from_angle(self.yaw_rad).rotate(measured);
        self.yaw_rad += to.yaw_rad - from.yaw_rad
            + truth.odometry_drift_rad_per_s * logger.clock.period_s()
            + shake * logger.errors.odometry_rad * random.normal();
    }

    fn pose(&self) -> Pose2 {
        let [x, y, yaw] = [self.position.x, self.position.y, wrapped(self.yaw_rad)];
        Pose2::new(rounded(x, PER_UNIT), rounded(y, PER_UNIT), rounded(yaw, PER_UNIT))
    }
}
