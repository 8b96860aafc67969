//! Interpolation of a camera's pose at any time between stamped poses.

mod smoothing;
mod spline;

use glam::{DMat3, DVec3};
use reality_sim_core::pose::{CameraPose, wrap_angle};

use self::{
    smoothing::{are_dense, smoothed},
    spline::{Coordinates, Spline},
};

/// Longest time between poses that a curve connects; over longer gaps it would be a guess, and a straight line is used.
const LONGEST_STEP_S: f64 = 0.6;

/// Time for which the camera keeps its velocity beyond the trajectory's ends; then it stands still.
const CONTINUATION_S: f64 = 0.2;

/// Error of poses that define no trajectory.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrajectoryError {
    /// There are no poses.
    #[error("a trajectory needs poses: give at least one")]
    NoPoses,
    /// A time or a coordinate is NaN or infinite.
    #[error("pose {index} (from 0) or its time is not made of finite numbers: correct it, or leave it out")]
    NotFinite {
        /// Index of the pose.
        index: usize,
    },
    /// A pose is not later than the previous one.
    #[error("time {time_s} s does not follow {previous_s} s: sort the poses by time and remove doubles")]
    NotIncreasing {
        /// Time of the previous pose, seconds.
        previous_s: f64,
        /// Time of this pose, seconds.
        time_s: f64,
    },
}

/// Velocity of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Twist {
    /// Linear velocity in the world frame, metres per second.
    pub velocity_in_world: DVec3,
    /// Angular velocity in the camera frame, right-handed, radians per second.
    pub angular_velocity_in_camera: DVec3,
}

/// Trajectory of a camera: natural cubic splines through its poses, straight lines where they are more than 0.6 s apart.
#[derive(Debug, Clone)]
pub struct Trajectory {
    /// Times and coordinates of every pose, with unwrapped angles.
    spline: Spline,
    is_still: bool,
}

impl Trajectory {
    /// Makes the trajectory through poses in the order of their times, seconds.
    pub fn new(poses: &[(f64, CameraPose)]) -> Result<Self, TrajectoryError> {
        if poses.is_empty() {
            return Err(TrajectoryError::NoPoses);
        }
        check(poses)?;
        let times_s = poses.iter().map(|(time_s, _)| *time_s).collect();
        let places = unwrapped(poses);
        let is_still = places.iter().all(|place| *place == places[0]);
        Ok(Self { spline: Spline::new(times_s, &places, LONGEST_STEP_S), is_still })
    }

    /// Makes the trajectory near noisy poses in the order of their times, seconds. Where they are dense enough, as those of
    /// motion capture are, the noise is smoothed as far as poses left out are predicted the better for it; poses more than
    /// 0.06 s apart stay as they are.
    pub fn near(poses: &[(f64, CameraPose)]) -> Result<Self, TrajectoryError> {
        let raw = Self::new(poses)?;
        if raw.is_still {
            return Ok(raw);
        }
        let times_s: Vec<f64> = poses.iter().map(|(time_s, _)| *time_s).collect();
        let places = smoothed(&times_s, &unwrapped(poses));
        Ok(Self { spline: Spline::new(times_s, &places, LONGEST_STEP_S), is_still: false })
    }

    /// Makes the trajectory of a camera that stands still at a pose.
    pub fn still(pose: CameraPose) -> Self {
        Self { spline: Spline::new(vec![0.0], &[coordinates(pose)], LONGEST_STEP_S), is_still: true }
    }

    /// Whether the camera never moves.
    pub fn is_still(&self) -> bool {
        self.is_still
    }

    /// Whether the poses are as close in time as those of motion capture, at most 0.06 s in the median: then the trajectory shows
    /// a robot's steps.
    pub fn is_dense(&self) -> bool {
        are_dense(self.spline.times_s())
    }

    /// Returns the pose at a time, seconds. Before the first pose and after the last one, the camera keeps its velocity for
    /// at most 0.2 s. The yaw is unwrapped: it may lie outside −π to π.
    pub fn at(&self, time_s: f64) -> CameraPose {
        pose(self.spline.at(time_s, CONTINUATION_S))
    }

    /// Returns the camera's velocity at a time, seconds: the derivative of [`Trajectory::at`].
    pub fn velocity(&self, time_s: f64) -> Twist {
        let [x, y, height, yaw_rate, pitch_rate, roll_rate] = self.spline.slope(time_s, CONTINUATION_S);
        let rotation = self.at(time_s).rotation_world_from_camera();
        Twist {
            velocity_in_world: DVec3::new(x, y, height),
            angular_velocity_in_camera: angular_velocity(
                rotation,
                self.at(time_s).roll_rad,
                [yaw_rate, pitch_rate, roll_rate],
            ),
        }
    }
}

/// Computes the angular velocity: yaw turns about the world's z axis; pitch, positive down, about the horizontal axis to the
/// left; roll about the optical axis.
fn angular_velocity(
    rotation_world_from_camera: DMat3,
    roll_rad: f64,
    [yaw_rate, pitch_rate, roll_rate]: [f64; 3],
) -> DVec3 {
    let up_in_camera = rotation_world_from_camera.transpose() * DVec3::Z;
    let (sin_roll, cos_roll) = roll_rad.sin_cos();
    let left_in_camera = DVec3::new(-cos_roll, sin_roll, 0.0);
    yaw_rate * up_in_camera + pitch_rate * left_in_camera + roll_rate * DVec3::Z
}

fn check(poses: &[(f64, CameraPose)]) -> Result<(), TrajectoryError> {
    if let Some(index) = poses.iter().position(|(time_s, pose)| !(time_s.is_finite() && pose.is_finite())) {
        return Err(TrajectoryError::NotFinite { index });
    }
    for pair in poses.windows(2) {
        let (previous_s, time_s) = (pair[0].0, pair[1].0);
        if time_s <= previous_s {
            return Err(TrajectoryError::NotIncreasing { previous_s, time_s });
        }
    }
    Ok(())
}

/// Returns coordinates whose angles change by at most half a turn from pose to pose.
fn unwrapped(poses: &[(f64, CameraPose)]) -> Vec<Coordinates> {
    let mut places: Vec<Coordinates> = Vec::with_capacity(poses.len());
    for (_, pose) in poses {
        let mut place = coordinates(*pose);
        if let Some(before) = places.last() {
            for (angle_rad, before_rad) in place[3..].iter_mut().zip(&before[3..]) {
                *angle_rad = before_rad + wrap_angle(*angle_rad - before_rad);
            }
        }
        places.push(place);
    }
    places
}

fn coordinates(pose: CameraPose) -> Coordinates {
    [pose.x_m, pose.y_m, pose.height_m, pose.yaw_rad, pose.pitch_rad, pose.roll_rad]
}

fn pose([x_m, y_m, height_m, yaw_rad, pitch_rad, roll_rad]: Coordinates) -> CameraPose {
    CameraPose { x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad }
}
