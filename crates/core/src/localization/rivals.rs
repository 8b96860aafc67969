//! Other places from which the pictures may have been taken, followed from picture to picture until one place wins.

use super::config::TrackConfig;
use crate::pose::{Motion2, Pose2};

/// Place that may be the right one instead of the track's own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rival {
    pub pose: Pose2,
    /// Log-odds against the track's own place.
    pub log_odds: f64,
    /// Whether the log-odds contain the present picture.
    pub knows_picture: bool,
}

impl Rival {
    /// Makes a rival out of a place that fits the present picture.
    pub fn new(pose: Pose2, log_odds: f64) -> Self {
        Self { pose, log_odds, knows_picture: true }
    }

    /// Moves the rival by the odometry, to the next picture.
    pub fn follow(&mut self, motion: Option<Motion2>) {
        self.pose = self.pose.moved(motion.unwrap_or_default());
        self.knows_picture = false;
    }

    /// Takes in a picture in which this place has a log-weight that is larger by `gain` than that of the track's own.
    pub fn weigh(&mut self, pose: Pose2, gain: f64, config: &TrackConfig) {
        let most = config.most_per_picture;
        self.log_odds += gain.clamp(-most, most);
        self.pose = pose;
        self.knows_picture = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rival_moves_with_the_robot() {
        let mut rival = Rival::new(Pose2::new(1.0, 2.0, 0.5), -2.0);
        let step = Motion2 { forward_m: 0.3, left_m: 0.1, turn_rad: 0.2 };
        rival.follow(Some(step));
        assert_eq!(rival.pose, Pose2::new(1.0, 2.0, 0.5).moved(step));
        assert!(!rival.knows_picture && rival.log_odds == -2.0);
    }

    #[test]
    fn a_single_picture_does_not_decide() {
        let config = TrackConfig::default();
        let mut rival = Rival::new(Pose2::default(), -1.0);
        rival.weigh(Pose2::default(), 100.0, &config);
        assert!(rival.log_odds < config.rival_wins_at);
        rival.weigh(Pose2::default(), 100.0, &config);
        assert!(rival.log_odds >= config.rival_wins_at);
    }
}
