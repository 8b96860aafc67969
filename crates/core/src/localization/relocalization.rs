//! Decisions about the places that a search finds, by numbers alone.

use super::config::RelocalizationConfig;
use crate::{
    pose::{CameraPose, Pose2, wrap_angle},
    search::Mode,
};

impl RelocalizationConfig {
    /// Returns whether a search had a single answer; `modes` are sorted, best first.
    pub(crate) fn is_clear(&self, modes: &[Mode]) -> bool {
        match modes {
            [] => false,
            [_] => true,
            [best, second, ..] => best.log_weight - second.log_weight >= self.clear_margin,
        }
    }

    /// Returns the poses to place particles around, with their weights: the best one and all that are nearly as good.
    pub(crate) fn seeds(&self, modes: &[Mode]) -> Vec<(Pose2, f64)> {
        let best = modes.first().map_or(0.0, |mode| mode.log_weight);
        let good = modes.iter().filter(|mode| best - mode.log_weight < self.alternative_margin);
        good.map(|mode| (mode.pose.planar(), mode.probability)).collect()
    }

    /// Returns whether the best place of a search differs from the filter's own, and fits clearly better.
    pub(crate) fn is_better_elsewhere(&self, best: &Mode, own: &Mode) -> bool {
        !self.is_same_place(best.pose, own.pose) && best.log_weight - own.log_weight >= self.move_margin
    }

    /// Returns whether two poses are the same place, so that particles around one find the other.
    pub(crate) fn is_same_place(&self, a: CameraPose, b: CameraPose) -> bool {
        (a.x_m - b.x_m).hypot(a.y_m - b.y_m) < self.same_place.position_m
            && wrap_angle(a.yaw_rad - b.yaw_rad).abs() < self.same_place.yaw_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mode(x_m: f64, log_weight: f64) -> Mode {
        let pose = CameraPose { x_m, ..CameraPose::default() };
        Mode { pose, log_weight, probability: 0.25, fit: None }
    }

    #[test]
    fn a_search_is_clear_where_nothing_else_comes_near() {
        let config = RelocalizationConfig::default();
        assert!(!config.is_clear(&[]), "nothing was found");
        assert!(config.is_clear(&[mode(0.0, 3.0)]));
        assert!(config.is_clear(&[mode(0.0, 9.0), mode(2.0, 3.0)]));
        assert!(!config.is_clear(&[mode(0.0, 9.0), mode(2.0, 3.1)]));
    }

    #[test]
    fn particles_go_to_every_place_that_is_nearly_as_good_as_the_best() {
        let modes = [mode(0.0, 9.0), mode(1.0, 5.1), mode(2.0, 5.0)];
        let seeds = RelocalizationConfig::default().seeds(&modes);
        assert_eq!(seeds, [(Pose2::new(0.0, 0.0, 0.0), 0.25), (Pose2::new(1.0, 0.0, 0.0), 0.25)]);
        assert!(RelocalizationConfig::default().seeds(&[]).is_empty());
    }

    #[test]
    fn particles_move_only_to_another_place_that_fits_clearly_better() {
        let config = RelocalizationConfig::default();
        let own = mode(0.0, 3.0);
        for (x_m, log_weight, moves) in [(2.0, 7.0, true), (2.0, 6.9, false), (0.2, 70.0, false)] {
            assert_eq!(config.is_better_elsewhere(&mode(x_m, log_weight), &own), moves, "{x_m} {log_weight}");
        }
    }

    #[test]
    fn headings_on_both_sides_of_the_cut_are_of_one_place() {
        let facing = |yaw_rad| CameraPose { yaw_rad, ..CameraPose::default() };
        assert!(RelocalizationConfig::default().is_same_place(facing(3.1), facing(-3.1)));
        assert!(!RelocalizationConfig::default().is_same_place(facing(0.0), facing(0.3)));
    }
}
