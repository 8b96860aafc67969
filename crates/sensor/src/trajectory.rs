//! Where a camera is at any time, from its poses at some.

mod spline;

use glam::{DMat3, DVec3};
use reality_sim_core::pose::{CameraPose, wrap_angle};

use self::spline::{Coordinates, Spline};

/// Poses farther apart in time are joined by a straight line: a curve through them would be a guess.
const LONGEST_STEP_S: f64 = 0.6;

/// For this long the camera goes on as it moved at the trajectory's end; then it stands.
const CONTINUATION_S: f64 = 0.2;

/// Poses that give no trajectory.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrajectoryError {
    /// There is none.
    #[error("a trajectory needs poses: give at least one")]
    NoPoses,
    /// A time or a coordinate is NaN or infinite.
    #[error("pose {index} (from 0) or its time is not made of finite numbers: correct it, or leave it out")]
    NotFinite {
        /// Which pose.
        index: usize,
    },
    /// A pose is not later than the one before.
    #[error("time {time_s} s does not follow {previous_s} s: sort the poses by time and remove doubles")]
    NotIncreasing {
        /// Of the pose before, seconds.
        previous_s: f64,
        /// Of this pose, seconds.
        time_s: f64,
    },
}

/// How a camera moves.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Twist {
    /// World axes, metres per second.
    pub velocity_in_world: DVec3,
    /// About the camera's axes, right-handed, radians per second.
    pub angular_velocity_in_camera: DVec3,
}

/// A camera's way: natural cubic splines through its poses, straight lines where they are more than 0.6 s apart.
#[derive(Debug, Clone)]
pub struct Trajectory {
    /// Time and coordinates of every pose, the angles unwrapped.
    spline: Spline,
    is_still: bool,
}

impl Trajectory {
    /// The way through poses with their times, seconds, in the order of time.
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

    /// A camera that stands at a pose for ever.
    pub fn still(pose: CameraPose) -> Self {
        Self { spline: Spline::new(vec![0.0], &[coordinates(pose)], LONGEST_STEP_S), is_still: true }
    }

    /// Whether nothing ever moves.
    pub fn is_still(&self) -> bool {
        self.is_still
    }

    /// The pose at a time, seconds. Before the first pose and after the last one the camera goes on for at most 0.2 s
    /// as it moved there. The yaw may lie outside −π to π: it runs on where the camera turns on.
    pub fn at(&self, time_s: f64) -> CameraPose {
        pose(self.spline.at(time_s, CONTINUATION_S))
    }

    /// How the camera moves at a time, seconds: the derivative of [`Trajectory::at`].
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

/// Yaw turns about the world's z; pitch, positive down, about the level left; roll about the optical axis.
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

/// Coordinates whose angles change by no more than half a turn from pose to pose.
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
