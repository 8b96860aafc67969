//! The path of the camera: a smooth one beside the poses at which a recording was made.

use std::f64::consts::PI;

use reality_sim::{
    Pose2,
    db::ImageRecord,
    pose::{Motion2, wrap_angle},
};

/// Distance of the path from the recorded poses, metres to the left: no picture was taken on it.
const BESIDE_M: f64 = 0.05;
/// Standard deviation of the smoothing along the path, pictures: it takes the sway of the gait away.
const SMOOTHING: f64 = 3.0;
/// Time from picture to picture, seconds.
const STEP_S: f64 = 0.25;

/// Path beside recorded poses. The camera goes to its end and back again, and is slow where it turns.
#[derive(Debug, Clone)]
pub struct Track {
    poses: Vec<Pose2>,
}

impl Track {
    /// Makes a path beside the first recording of a database; there is at least one picture.
    pub fn beside(images: &[ImageRecord]) -> Self {
        let first = images.first().map(|image| image.sequence_id);
        let images = images.iter().filter(|image| Some(image.sequence_id) == first);
        Self::along(&images.map(|image| image.pose.planar()).collect::<Vec<_>>())
    }

    /// Makes a path beside poses, in their order.
    pub fn along(recorded: &[Pose2]) -> Self {
        let mut yaw_rad = recorded.first().map_or(0.0, |pose| pose.yaw_rad);
        // Headings without jumps, so that their mean is one.
        let unwrapped: Vec<[f64; 3]> = recorded
            .iter()
            .map(|pose| {
                yaw_rad += wrap_angle(pose.yaw_rad - yaw_rad);
                [pose.x_m, pose.y_m, yaw_rad]
            })
            .collect();
        let beside = Motion2 { left_m: BESIDE_M, ..Motion2::default() };
        let smooth = |index| {
            let [x_m, y_m, yaw_rad] = smoothed(&unwrapped, index);
            Pose2::new(x_m, y_m, wrap_angle(yaw_rad)).moved(beside)
        };
        Self { poses: (0..recorded.len()).map(smooth).collect() }
    }

    /// Returns the pose at a time, seconds.
    pub fn pose(&self, time_s: f64) -> Pose2 {
        let place = 0.5 * (1.0 - (PI * time_s / self.duration_s()).cos()) * self.last() as f64;
        let before = (place as usize).min(self.last().saturating_sub(1));
        let [from, to] = [before, (before + 1).min(self.last())].map(|index| self.poses[index]);
        let share = place - before as f64;
        Pose2::new(
            from.x_m + share * (to.x_m - from.x_m),
            from.y_m + share * (to.y_m - from.y_m),
            wrap_angle(from.yaw_rad + share * wrap_angle(to.yaw_rad - from.yaw_rad)),
        )
    }

    /// Returns the first time at which the path is nearest to a pose, seconds. A turn by one radian counts as much as a metre.
    pub fn time_s_nearest(&self, pose: Pose2) -> f64 {
        let distance = |other: &Pose2| {
            let motion = other.motion_to(pose);
            motion.distance_m().hypot(motion.turn_rad)
        };
        let distances = self.poses.iter().map(distance).enumerate();
        let index = distances.min_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(index, _)| index);
        let share = index as f64 / self.last().max(1) as f64;
        (1.0 - 2.0 * share).acos() / PI * self.duration_s()
    }

    fn last(&self) -> usize {
        self.poses.len().saturating_sub(1)
    }

    fn duration_s(&self) -> f64 {
        STEP_S * self.last().max(1) as f64
    }
}

/// Returns the mean of the values around one, weighted by a Gaussian.
fn smoothed(values: &[[f64; 3]], index: usize) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let mut weights = 0.0;
    for (other, value) in values.iter().enumerate() {
        let away = (other as f64 - index as f64) / SMOOTHING;
        let weight = (-0.5 * away * away).exp();
        weights += weight;
        for (sum, value) in sum.iter_mut().zip(value) {
            *sum += weight * value;
        }
    }
    sum.map(|sum| sum / weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight() -> Track {
        let recorded: Vec<Pose2> =
            (0..41).map(|index| Pose2::new(0.05 * f64::from(index), 0.0, 0.0)).collect();
        Track::along(&recorded)
    }

    #[test]
    fn path_lies_to_the_left_of_what_was_recorded() {
        let middle = straight().pose(0.5 * straight().duration_s());
        assert!((middle.x_m - 1.0).abs() < 1e-3, "half of the way: {middle:?}");
        assert!((middle.y_m - BESIDE_M).abs() < 1e-9);
    }

    #[test]
    fn path_goes_there_and_back_without_jumps() {
        let track = straight();
        let times = (0..4000).map(|step| f64::from(step) * 0.01);
        let poses: Vec<Pose2> = times.map(|time_s| track.pose(time_s)).collect();
        let longest =
            poses.windows(2).map(|pair| pair[0].motion_to(pair[1]).distance_m()).fold(0.0, f64::max);
        assert!(longest < 0.005, "{longest} m in a hundredth of a second");
        let back = track.pose(2.0 * track.duration_s());
        assert!(back.motion_to(track.pose(0.0)).distance_m() < 1e-9);
    }

    #[test]
    fn headings_are_smoothed_across_the_jump_at_half_a_turn() {
        let recorded: Vec<Pose2> =
            [3.10, -3.12, 3.12, -3.10].map(|yaw_rad| Pose2::new(0.0, 0.0, yaw_rad)).into();
        let found = Track::along(&recorded).pose(0.0).yaw_rad;
        assert!(wrap_angle(found - PI).abs() < 0.05, "{found}");
    }

    #[test]
    fn nearest_time_leads_back_to_the_pose() {
        let track = straight();
        for index in [0, 7, 20, 40] {
            let pose = track.poses[index];
            let again = track.pose(track.time_s_nearest(pose));
            assert!(again.motion_to(pose).distance_m() < 1e-6, "{index}: {again:?}");
        }
    }

    #[test]
    fn path_of_one_picture_stands_still() {
        let track = Track::along(&[Pose2::new(1.0, 2.0, 0.0)]);
        assert_eq!(track.pose(0.0), track.pose(3.3));
        assert_eq!(track.time_s_nearest(Pose2::default()), 0.0);
    }
}
