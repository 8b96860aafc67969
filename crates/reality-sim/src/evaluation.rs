//! Absolute pose error of estimated against true poses, both in the world frame, without alignment.
//!
//! The error of a place is the distance on the ground (x and y), as in the paper; the error of the yaw is the absolute
//! angle between the two headings. Percentiles are interpolated linearly between the sorted values, as numpy does.

use serde::Serialize;

use crate::{
    pose::{CameraPose, wrap_angle},
    sequence::Sequence,
};

/// Error of the place above which a frame is lost, metres.
pub const LOST_DISTANCE_M: f64 = 0.5;
/// Error of the yaw above which a frame is lost, radians.
pub const LOST_ANGLE_RAD: f64 = 0.5;

/// Error of one pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseError {
    /// Distance on the ground, metres.
    pub distance_m: f64,
    /// Absolute angle between the headings, radians.
    pub yaw_rad: f64,
}

impl PoseError {
    /// Computes the error of an estimated pose.
    pub fn new(estimate: CameraPose, truth: CameraPose) -> Self {
        Self {
            distance_m: (estimate.x_m - truth.x_m).hypot(estimate.y_m - truth.y_m),
            yaw_rad: wrap_angle(estimate.yaw_rad - truth.yaw_rad).abs(),
        }
    }

    /// Whether the frame is lost.
    pub fn is_lost(self) -> bool {
        self.distance_m > LOST_DISTANCE_M || self.yaw_rad > LOST_ANGLE_RAD
    }
}

/// Errors of many poses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorStatistics {
    /// Number of poses with a true pose to compare with.
    pub frames: usize,
    /// Mean distance, metres.
    pub mean_m: f64,
    /// Median distance, metres.
    pub median_m: f64,
    /// Root of the mean squared distance, metres.
    pub rmse_m: f64,
    /// 95th percentile of the distance, metres.
    pub p95_m: f64,
    /// Largest distance, metres.
    pub max_m: f64,
    /// Mean absolute error of the yaw, radians.
    pub mean_yaw_rad: f64,
    /// Number of frames that are off by more than [`LOST_DISTANCE_M`] or [`LOST_ANGLE_RAD`].
    pub lost_frames: usize,
}

impl ErrorStatistics {
    /// Computes the statistics of a recording's poses against its reference poses; `None` if it has none.
    pub fn of(sequence: &Sequence, poses: &[CameraPose]) -> Option<Self> {
        let both = sequence.reference_poses().zip(poses);
        let errors: Vec<PoseError> =
            both.filter_map(|(truth, pose)| Some(PoseError::new(*pose, truth?))).collect();
        Self::new(&errors)
    }

    /// Computes the statistics of some errors; `None` if there are none.
    pub fn new(errors: &[PoseError]) -> Option<Self> {
        let mut distances_m: Vec<f64> = errors.iter().map(|error| error.distance_m).collect();
        distances_m.sort_by(f64::total_cmp);
        let max_m = *distances_m.last()?;
        let count = errors.len() as f64;
        Some(Self {
            frames: errors.len(),
            mean_m: distances_m.iter().sum::<f64>() / count,
            median_m: percentile(&distances_m, 0.5)?,
            rmse_m: (distances_m.iter().map(|distance| distance * distance).sum::<f64>() / count).sqrt(),
            p95_m: percentile(&distances_m, 0.95)?,
            max_m,
            mean_yaw_rad: errors.iter().map(|error| error.yaw_rad).sum::<f64>() / count,
            lost_frames: errors.iter().filter(|error| error.is_lost()).count(),
        })
    }
}

/// Returns the value below which a fraction (0–1) of sorted values lies; `None` if there are none.
pub fn percentile(sorted: &[f64], fraction: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let place = fraction.clamp(0.0, 1.0) * last as f64;
    let below = place.floor() as usize;
    let (low, high) = (sorted[below], sorted[(below + 1).min(last)]);
    Some(low + place.fract() * (high - low))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn pose(x_m: f64, y_m: f64, yaw_rad: f64) -> CameraPose {
        CameraPose { x_m, y_m, yaw_rad, ..Default::default() }
    }

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-12, "{a} is not {b}");
    }

    #[test]
    fn the_error_is_the_distance_on_the_ground_and_the_angle_between_the_headings() {
        let truth = CameraPose { height_m: 0.5, ..pose(1.0, 2.0, PI - 0.1) };
        let error = PoseError::new(pose(1.3, 1.6, -PI + 0.1), truth);
        close(error.distance_m, 0.5);
        close(error.yaw_rad, 0.2);
    }

    #[test]
    fn statistics_match_those_computed_by_hand() {
        // Distances 0, 0.1, 0.2, 0.3, 1.4 m; yaws 0, 0.1, 0.2, 0.6, 0.1 rad.
        let errors = [(0.3, 0.6), (0.0, 0.0), (1.4, 0.1), (0.1, 0.1), (0.2, 0.2)]
            .map(|(distance_m, yaw_rad)| PoseError { distance_m, yaw_rad });
        let statistics = ErrorStatistics::new(&errors).unwrap();
        assert_eq!(statistics.frames, 5);
        close(statistics.mean_m, 0.4);
        close(statistics.median_m, 0.2);
        // Squares: 0 + 0.01 + 0.04 + 0.09 + 1.96 = 2.10; over 5: 0.42.
        close(statistics.rmse_m, 0.42_f64.sqrt());
        // Fractional index 0.95 · 4 = 3.8: 0.3 + 0.8 · 1.1.
        close(statistics.p95_m, 1.18);
        close(statistics.max_m, 1.4);
        close(statistics.mean_yaw_rad, 0.2);
        assert_eq!(statistics.lost_frames, 2, "one by its place, one by its yaw");
    }

    #[test]
    fn exactly_half_a_metre_and_half_a_radian_is_not_lost() {
        assert!(!PoseError { distance_m: 0.5, yaw_rad: 0.5 }.is_lost());
        assert!(PoseError { distance_m: 0.500_001, yaw_rad: 0.0 }.is_lost());
    }

    #[test]
    fn no_errors_have_no_statistics() {
        assert_eq!(ErrorStatistics::new(&[]), None);
        assert_eq!(percentile(&[], 0.5), None);
    }

    #[test]
    fn the_median_of_an_even_number_lies_between_the_two_in_the_middle() {
        close(percentile(&[1.0, 2.0, 4.0, 9.0], 0.5).unwrap(), 3.0);
        close(percentile(&[7.0], 0.95).unwrap(), 7.0);
    }
}
