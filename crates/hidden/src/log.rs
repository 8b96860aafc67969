//! Measurements that the robot and the motion capture log, with their noise.

use glam::{DQuat, DVec2, DVec3};
use reality_sim_core::{
    pose::{CameraPose, Pose2},
    sequence::{FrameRecord, StampedPose},
};

use crate::{
    nominal::rounded,
    random::Random,
    rotation,
    trajectory::{Trajectory, Walk, wrapped},
    truth::Truth,
};

/// Time between pictures, seconds.
pub const PERIOD_S: f64 = 0.2;
/// Noise of the motion capture, per axis.
const CAPTURE_M: f64 = 0.003;
const CAPTURE_RAD: f64 = 0.14_f64.to_radians();
/// Noise of IMU and joints.
const IMU_RAD: f64 = 0.17_f64.to_radians();
/// Noise of one step of the odometry while walking; standing has a tenth of it.
const ODOMETRY_M: f64 = 0.003;
const ODOMETRY_RAD: f64 = 0.3_f64.to_radians();
/// Time for which motion capture goes on before the first picture and after the last, seconds.
const LEAD_S: f64 = 0.5;
/// Precision of the files: values are multiples of 1 / `PER_UNIT`.
const PER_UNIT: f64 = 1e5;

/// Returns the time of a frame (from 0), seconds.
pub fn timestamp_s(frame: usize) -> f64 {
    (frame + 1) as f64 / (1.0 / PERIOD_S).round()
}

/// Returns the lines of `frames.csv`, without reference poses.
pub fn frames(
    seed: u64,
    count: usize,
    walk: Walk,
    trajectory: &Trajectory,
    truth: &Truth,
) -> Vec<FrameRecord> {
    let random = &mut Random::stream(seed, "robot", 0);
    let mut odometry = Odometry { position: DVec2::ZERO, yaw_rad: 0.0 };
    (0..count)
        .map(|frame| {
            let time_s = timestamp_s(frame) + truth.offset_s;
            if frame > 0 {
                odometry.step(random, walk, trajectory, truth, time_s);
            }
            let [_, pitch_rad, roll_rad] = trajectory.angles(time_s);
            let mut noisy = |angle_rad| rounded(angle_rad + IMU_RAD * random.normal(), PER_UNIT);
            FrameRecord {
                timestamp_s: timestamp_s(frame),
                image: format!("images/{frame:06}.jpg").into(),
                odometry: Some(odometry.pose()),
                pitch_rad: noisy(pitch_rad),
                roll_rad: noisy(roll_rad),
                reference_pose: None,
            }
        })
        .collect()
}

/// Dead-reckoned pose since the first frame.
struct Odometry {
    position: DVec2,
    yaw_rad: f64,
}

impl Odometry {
    /// Adds the step that ends at a time, seconds.
    fn step(&mut self, random: &mut Random, walk: Walk, trajectory: &Trajectory, truth: &Truth, time_s: f64) {
        let (from, to) = (trajectory.ground(time_s - PERIOD_S), trajectory.ground(time_s));
        let way = DVec2::from_angle(-from.yaw_rad).rotate(to.position - from.position);
        let slipped = DVec2::new(way.x, way.y + truth.odometry_slip * way.x) * truth.odometry_scale;
        let shake = if walk == Walk::Standing { 0.1 } else { 1.0 };
        let measured = slipped + shake * ODOMETRY_M * DVec2::new(random.normal(), random.normal());
        self.position += DVec2::from_angle(self.yaw_rad).rotate(measured);
        self.yaw_rad += to.yaw_rad - from.yaw_rad
            + truth.odometry_drift_rad_per_s * PERIOD_S
            + shake * ODOMETRY_RAD * random.normal();
    }

    fn pose(&self) -> Pose2 {
        let [x, y, yaw] = [self.position.x, self.position.y, wrapped(self.yaw_rad)];
        Pose2::new(rounded(x, PER_UNIT), rounded(y, PER_UNIT), rounded(yaw, PER_UNIT))
    }
}

/// Returns the poses that motion capture measured at each frame.
pub fn references(seed: u64, count: usize, trajectory: &Trajectory) -> Vec<CameraPose> {
    let random = &mut Random::stream(seed, "capture", 0);
    (0..count).map(|frame| reference(random, trajectory, timestamp_s(frame))).collect()
}

/// Returns the poses that motion capture measured between the frames, from half a second before the first to half a second
/// after the last. None of them is at a frame's time.
pub fn references_between(
    seed: u64,
    count: usize,
    rate_hz: f64,
    trajectory: &Trajectory,
) -> Vec<StampedPose> {
    let random = &mut Random::stream(seed, "capture", 1);
    let (from_s, to_s) = (timestamp_s(0) - LEAD_S, timestamp_s(count - 1) + LEAD_S);
    let poses = 0..((to_s - from_s) * rate_hz) as usize;
    poses
        .map(|pose| {
            let timestamp_s = from_s + (pose as f64 + 0.5) / rate_hz;
            StampedPose { timestamp_s, pose: reference(random, trajectory, timestamp_s) }
        })
        .collect()
}

fn reference(random: &mut Random, trajectory: &Trajectory, time_s: f64) -> CameraPose {
    let mut noise = || DVec3::new(random.normal(), random.normal(), random.normal());
    let station = trajectory.station(time_s);
    let position = station.position + CAPTURE_M * noise();
    let turn = glam::DMat3::from_quat(DQuat::from_scaled_axis(CAPTURE_RAD * noise()));
    let [yaw_rad, pitch_rad, roll_rad] = rotation::to_angles(station.world_from_camera * turn);
    CameraPose { x_m: position.x, y_m: position.y, yaw_rad, height_m: position.z, pitch_rad, roll_rad }
}

/// Returns the start pose that the robot states.
pub fn start(trajectory: &Trajectory) -> Pose2 {
    let station = trajectory.station(timestamp_s(0));
    let [x, y, yaw] = [station.position.x, station.position.y, trajectory.angles(timestamp_s(0))[0]];
    Pose2::new(rounded(x, 1e3), rounded(y, 1e3), rounded(wrapped(yaw), 1e3))
}
