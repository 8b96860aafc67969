//! Evidence for one half of the field against the other, by landmark and by view.
//!
//! Pictures of one landmark are not independent. What stands before it, or shines on it, deceives every picture from the same
//! place, and a landmark that is painted or lit like the other one deceives them all. Whether a view or a landmark deceives is
//! a hidden bit, so that log-odds pass from the pictures to the half through two binary symmetric channels; through a channel
//! with error probability q they become `2 artanh((1 − 2q) tanh(l / 2))` (Hagenauer, Offer and Papke, "Iterative decoding of
//! binary block and convolutional codes", 1996, eq. 12). However many pictures show it, a landmark tells at most
//! `ln((1 − q) / q)`; different landmarks add up.

use glam::DVec2;

use super::config::TrackConfig;
use crate::pose::Pose2;

/// Number of landmarks: the goal at −x, then the goal at +x.
const LANDMARKS: usize = 2;

/// What the pictures so far tell of the mirror pose, as log-odds against the pose itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct HalfEvidence {
    landmarks: [Vec<View>; LANDMARKS],
}

/// Pictures of one landmark from one place.
#[derive(Debug, Clone, Copy, PartialEq)]
struct View {
    place_in_world: DVec2,
    /// Sum over its pictures.
    log_odds: f64,
}

impl HalfEvidence {
    /// Adds a picture that was taken at a pose: the log-odds of the mirror pose by each goal, that at −x first; 0 where the
    /// picture does not tell.
    pub fn add(&mut self, pose: Pose2, log_odds: [f64; LANDMARKS], config: &TrackConfig) {
        let place_in_world = pose.position_in_world();
        for (views, log_odds) in self.landmarks.iter_mut().zip(log_odds) {
            if log_odds == 0.0 {
                continue;
            }
            let distance_m = |view: &View| view.place_in_world.distance(place_in_world);
            let nearest = views.iter_mut().min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)));
            match nearest {
                Some(view) if distance_m(view) < config.view_distance_m => view.log_odds += log_odds,
                _ => views.push(View { place_in_world, log_odds }),
            }
        }
    }

    /// Returns the log-odds of the mirror pose against the pose itself.
    pub fn log_odds(&self, config: &TrackConfig) -> f64 {
        let of_landmark = |views: &Vec<View>| {
            let views = views.iter().map(|view| through(config.deceiving_view_probability, view.log_odds));
            through(config.deceiving_landmark_probability, views.sum())
        };
        self.landmarks.iter().map(of_landmark).sum()
    }

    /// Returns the evidence for the mirror poses of all poses: each goal is then the other one.
    pub fn mirrored(&self) -> Self {
        let turned = |view: &View| View { place_in_world: -view.place_in_world, log_odds: -view.log_odds };
        let [negative_x, positive_x] =
            self.landmarks.each_ref().map(|views| views.iter().map(turned).collect());
        Self { landmarks: [positive_x, negative_x] }
    }
}

/// Returns what log-odds of a bit tell of another one that differs from it with this probability.
fn through(error_probability: f64, log_odds: f64) -> f64 {
    2.0 * ((1.0 - 2.0 * error_probability) * (0.5 * log_odds).tanh()).atanh()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::{Purpose, Stream};

    const SAMPLE_LOG_ODDS: f64 = 0.15;

    fn at(x_m: f64) -> Pose2 {
        Pose2::new(x_m, 0.0, 0.0)
    }

    #[test]
    fn many_pictures_of_one_landmark_tell_no_more_than_the_landmark_can() {
        let config = TrackConfig::default();
        let limit = |probability: f64| ((1.0 - probability) / probability).ln();
        let mut evidence = HalfEvidence::default();
        for _ in 0..200 {
            evidence.add(at(0.1), [0.0, -2.0], &config);
        }
        let view = limit(config.deceiving_view_probability);
        assert!(evidence.log_odds(&config) > -view && evidence.log_odds(&config) < -0.8 * view);
        for place in 0..200 {
            evidence.add(at(f64::from(place)), [0.0, -2.0], &config);
        }
        let landmark = limit(config.deceiving_landmark_probability);
        assert!((evidence.log_odds(&config) + landmark).abs() < 1e-6);
        // The other goal adds its own evidence.
        let alone = evidence.log_odds(&config);
        let mut other = HalfEvidence::default();
        other.add(at(0.0), [-2.0, 0.0], &config);
        evidence.add(at(0.0), [-2.0, 0.0], &config);
        assert!((evidence.log_odds(&config) - alone - other.log_odds(&config)).abs() < 1e-12);
    }

    #[test]
    fn weak_evidence_passes_nearly_unchanged_and_contradicting_views_cancel() {
        let config = TrackConfig::default();
        let mut evidence = HalfEvidence::default();
        evidence.add(at(0.0), [0.0, 0.2], &config);
        let share = (1.0 - 2.0 * config.deceiving_view_probability)
            * (1.0 - 2.0 * config.deceiving_landmark_probability);
        assert!((evidence.log_odds(&config) - share * 0.2).abs() < 0.002);
        evidence.add(at(3.0), [0.0, -0.2], &config);
        assert!(evidence.log_odds(&config).abs() < 1e-12);
    }

    #[test]
    fn the_mirrored_evidence_speaks_for_the_other_half() {
        let config = TrackConfig::default();
        let mut evidence = HalfEvidence::default();
        evidence.add(at(1.0), [0.5, -2.0], &config);
        let mirrored = evidence.mirrored();
        assert!((mirrored.log_odds(&config) + evidence.log_odds(&config)).abs() < 1e-12);
        assert_eq!(mirrored.mirrored(), evidence);
        // The same view of the same goal, told of the mirror pose, is no second one.
        let (mut again, mut other) = (mirrored.clone(), mirrored);
        again.add(at(-1.0), [2.0, 0.0], &config);
        assert_eq!(again.landmarks.each_ref().map(Vec::len), [1, 1]);
        other.add(at(1.0), [2.0, 0.0], &config);
        assert_eq!(other.landmarks.each_ref().map(Vec::len), [2, 1]);
    }

    /// Random bits, each true with its own probability.
    struct Bits {
        stream: Stream,
        next: u32,
    }

    impl Bits {
        fn is(&mut self, probability: f64) -> bool {
            self.next += 1;
            self.stream.uniform(self.next) < probability
        }
    }

    /// Simulates a robot that turns before goals: of each goal and each view whether it deceives, of each picture how many
    /// of 20 samples have the wrong colour. Returns the probability of the mirror pose that the evidence states, and whether
    /// the robot is there.
    fn trial(seed: u64, goals: usize, views: u32, pictures: u32) -> (f64, bool) {
        let config = TrackConfig::default();
        let mut bits = Bits { stream: Stream::new(seed, Purpose::Initialise, 0, 0), next: 0 };
        let is_mirrored = bits.is(0.5);
        let sample_is_right = 1.0 / (1.0 + (-SAMPLE_LOG_ODDS).exp());
        let mut evidence = HalfEvidence::default();
        for goal in 0..goals {
            let goal_deceives = bits.is(config.deceiving_landmark_probability);
            for view in 0..views {
                let deceives = bits.is(config.deceiving_view_probability) != goal_deceives;
                for _ in 0..pictures / views {
                    let right = (0..20).filter(|_| bits.is(sample_is_right)).count() as f64;
                    let for_what_is_seen = SAMPLE_LOG_ODDS * (2.0 * right - 20.0);
                    let mut log_odds = [0.0; LANDMARKS];
                    log_odds[goal] =
                        if is_mirrored != deceives { for_what_is_seen } else { -for_what_is_seen };
                    evidence.add(at(f64::from(view)), log_odds, &config);
                }
            }
        }
        (1.0 / (1.0 + (-evidence.log_odds(&config)).exp()), is_mirrored)
    }

    /// Of the cases whose half is stated with some probability, as many are right as it says, whether a picture or two
    /// hundred of them were seen.
    #[test]
    fn stated_probabilities_are_the_shares_of_right_answers() {
        for (goals, views, pictures) in [(1, 1, 1), (1, 1, 200), (1, 4, 200), (2, 3, 60)] {
            let trials: Vec<(f64, bool)> =
                (0..2000).map(|seed| trial(seed, goals, views, pictures)).collect();
            for (from, to) in [(0.5, 0.8), (0.8, 0.95), (0.95, 1.0)] {
                let stated = trials.iter().filter_map(|&(mirrored, is_mirrored)| {
                    let said = mirrored.max(1.0 - mirrored);
                    (said >= from && said < to).then_some((said, (mirrored > 0.5) == is_mirrored))
                });
                let stated: Vec<(f64, bool)> = stated.collect();
                let count = stated.len() as f64;
                if count < 50.0 {
                    continue;
                }
                let said = stated.iter().map(|(said, _)| said).sum::<f64>() / count;
                let right = stated.iter().filter(|(_, right)| *right).count() as f64 / count;
                // Four standard deviations of a share.
                let tolerance = 4.0 * (said * (1.0 - said) / count).sqrt() + 1e-3;
                assert!(
                    (said - right).abs() < tolerance,
                    "{goals} goals, {views} views, {pictures} pictures: said {said}, right {right} of {count}"
                );
            }
        }
    }
}
