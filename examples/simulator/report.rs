//! How far what the robot believes is from what is so.

use std::fmt;

use reality_sim::evaluation::{ErrorStatistics, PoseError, percentile};

use crate::{robot::Thought, world::Truth};

/// Largest mean errors that this example aims at, metres.
pub const TARGET_ROBOT_M: f64 = 0.02;
pub const TARGET_BALL_M: f64 = 0.03;

/// Errors at one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Error of the robot's place and heading.
    pub robot: PoseError,
    /// Error of the pose by odometry alone, metres.
    pub odometry_m: f64,
    /// Error of the ball's place where it is seen, metres.
    pub ball_m: Option<f64>,
    /// Whether the robot is sure of its pose.
    pub is_sure: bool,
}

impl Errors {
    /// Compares a thought with the truth.
    pub fn new(thought: &Thought, truth: &Truth) -> Self {
        let by_odometry = truth.camera.with_planar(truth.by_odometry);
        let ball_m = |ball: crate::ball_track::BallTrack| ball.place_in_world.distance(truth.ball_in_world);
        Self {
            robot: PoseError::new(thought.camera, truth.camera),
            odometry_m: PoseError::new(by_odometry, truth.camera).distance_m,
            ball_m: thought.ball.map(ball_m),
            is_sure: thought.is_sure,
        }
    }
}

/// Report of a run.
#[derive(Debug, Clone, Default)]
pub struct Report {
    /// Errors of all pictures.
    pub errors: Vec<Errors>,
    /// Time that the camera took for all pictures, seconds.
    pub looked_s: f64,
    /// Time that the localization took, seconds.
    pub localized_s: f64,
    /// Sum over all pictures of the share that was recorded.
    pub covered: f64,
    /// Length of the robot's way, metres.
    pub way_m: f64,
}

impl Report {
    /// Returns the statistics of the robot's own pose; `None` without a picture.
    pub fn robot(&self) -> Option<ErrorStatistics> {
        ErrorStatistics::new(&self.errors.iter().map(|errors| errors.robot).collect::<Vec<_>>())
    }

    /// Returns the errors of the ball's place wherever it was seen, smallest first, metres.
    pub fn ball_m(&self) -> Vec<f64> {
        let mut distances_m: Vec<f64> = self.errors.iter().filter_map(|errors| errors.ball_m).collect();
        distances_m.sort_by(f64::total_cmp);
        distances_m
    }

    /// Returns the largest error of the pose by odometry alone, metres.
    pub fn odometry_m(&self) -> f64 {
        self.errors.iter().map(|errors| errors.odometry_m).fold(0.0, f64::max)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(robot) = self.robot() else { return writeln!(f, "no pictures") };
        let pictures = self.errors.len() as f64;
        let sure = self.errors.iter().filter(|errors| errors.is_sure).count();
        writeln!(
            f,
            "way       {:.1} m, {} pictures, of which {:.0} % was recorded",
            self.way_m,
            robot.frames,
            100.0 * self.covered / pictures
        )?;
        writeln!(
            f,
            "robot     mean {}, median {}, 95 % below {}, largest {}; yaw {:.2}° in the mean; sure of {sure} pictures; {}",
            cm(robot.mean_m),
            cm(robot.median_m),
            cm(robot.p95_m),
            cm(robot.max_m),
            robot.mean_yaw_rad.to_degrees(),
            against(robot.mean_m, TARGET_ROBOT_M),
        )?;
        writeln!(f, "          by odometry alone it would be up to {} off", cm(self.odometry_m()))?;
        self.write_ball(f)?;
        writeln!(
            f,
            "time      {:.1} pictures a second by the camera, {:.1} by the localizer",
            pictures / self.looked_s,
            pictures / self.localized_s
        )
    }
}

impl Report {
    fn write_ball(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ball_m = self.ball_m();
        let Some(largest_m) = ball_m.last() else { return writeln!(f, "ball      never seen") };
        let mean_m = ball_m.iter().sum::<f64>() / ball_m.len() as f64;
        let at = |part| cm(percentile(&ball_m, part).unwrap_or(f64::NAN));
        writeln!(
            f,
            "ball      mean {}, median {}, 95 % below {}, largest {}; seen in {} pictures; {}",
            cm(mean_m),
            at(0.5),
            at(0.95),
            cm(*largest_m),
            ball_m.len(),
            against(mean_m, TARGET_BALL_M),
        )
    }
}

fn cm(metres: f64) -> String {
    format!("{:.2} cm", 100.0 * metres)
}

fn against(mean_m: f64, target_m: f64) -> String {
    let word = if mean_m <= target_m { "met" } else { "missed" };
    format!("the aim of {:.0} cm is {word}", 100.0 * target_m)
}
