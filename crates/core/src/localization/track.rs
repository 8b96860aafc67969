//! State that passes from picture to picture: a state machine of plain numbers, without pictures, particles or devices.
//!
//! A track is *settled* while the lines fit and no other place is in question. After a search with several answers it is
//! *unconfirmed* until some consecutive pictures have fitted. It is *doubtful* while they fit badly. Whether the field's
//! point symmetry has been resolved is tracked separately: a settled pose may still be the mirror image of the right one.

use super::{agreement::Agreement, config::TrackConfig, half_evidence::HalfEvidence, rivals::Rival};
use crate::{
    filter::{MotionNoise, PlanarSigma},
    pose::{Motion2, Pose2},
    search::Prior,
};

/// How a track begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Beginning {
    /// At a given pose, so that the half of the field is known.
    Given,
    /// At the best place of a search; `is_clear` if the search had a single answer.
    Searched { is_clear: bool },
}

/// What the motion model predicts before the picture is used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Prediction {
    /// Standard deviations of the motion.
    pub sigma: PlanarSigma,
    /// Motion since the previous picture, if odometry measured it.
    pub motion: Option<Motion2>,
    /// Whether the odometry was reset, so that nothing is known of the motion.
    pub is_kidnapped: bool,
}

/// State of a track.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Track {
    config: TrackConfig,
    /// Last pose that fitted, moved by the odometry since.
    anchor: Pose2,
    /// Present uncertainty of the anchor.
    anchor_sigma: PlanarSigma,
    odometry: Option<Pose2>,
    /// Slow average of the line fraction of settled poses.
    usual_line_fraction: f64,
    /// The same of the explained fraction.
    usual_explained_fraction: f64,
    /// Other places that may be the right one.
    rivals: Vec<Rival>,
    /// Whether the place is beyond doubt: a picture showed it clearly, or the field was searched for others.
    is_verified: bool,
    /// Number of consecutive pictures that fitted since the place became uncertain; `None` once it is confirmed.
    unconfirmed: Option<u32>,
    /// Number of doubtful pictures since the last one that fitted: in these the filter may have been lost.
    doubtful_frames: u32,
    /// Log-odds of the mirror pose against the pose itself, apart from what pictures of the goals have told since.
    prior_mirrored_log_odds: f64,
    /// What pictures of the goals have told since.
    half_evidence: HalfEvidence,
}

impl Track {
    /// Starts a track at a pose.
    pub fn new(config: TrackConfig, pose: Pose2, odometry: Option<Pose2>, beginning: Beginning) -> Self {
        let (unconfirmed, prior_mirrored_log_odds) = match beginning {
            Beginning::Given => (None, f64::NEG_INFINITY),
            Beginning::Searched { is_clear } => ((!is_clear).then_some(0), 0.0),
        };
        Self {
            config,
            anchor: pose,
            anchor_sigma: config.kidnapped_sigma,
            odometry,
            usual_line_fraction: 0.0,
            usual_explained_fraction: 0.0,
            rivals: Vec::new(),
            is_verified: false,
            unconfirmed,
            doubtful_frames: 0,
            prior_mirrored_log_odds,
            half_evidence: HalfEvidence::default(),
        }
    }

    /// Predicts the pose at the next picture from the odometry at that time.
    pub fn predict(&mut self, odometry: Option<Pose2>, noise: &MotionNoise) -> Prediction {
        let prediction = self.prediction(odometry, noise);
        self.odometry = odometry;
        self.anchor = self.anchor.moved(prediction.motion.unwrap_or_default());
        self.anchor_sigma = self.anchor_sigma.plus(prediction.sigma);
        self.rivals.iter_mut().for_each(|rival| rival.follow(prediction.motion));
        if prediction.is_kidnapped || self.is_long_way(&prediction) {
            self.is_verified = false;
        }
        if prediction.is_kidnapped {
            // Whoever carried the robot may have turned it round.
            self.forget_half(0.0);
        }
        prediction
    }

    fn prediction(&self, odometry: Option<Pose2>, noise: &MotionNoise) -> Prediction {
        let Some((before, now)) = self.odometry.zip(odometry) else {
            return Prediction { sigma: noise.sigma(None), motion: None, is_kidnapped: false };
        };
        let motion = before.motion_to(now);
        // Odometry that restarts at its origin says nothing about the motion in between.
        if now == Pose2::default() && motion.distance_m() > self.config.reset_jump_m {
            return Prediction { sigma: self.config.kidnapped_sigma, motion: None, is_kidnapped: true };
        }
        Prediction { sigma: noise.sigma(Some(motion)), motion: Some(motion), is_kidnapped: false }
    }

    /// Returns whether the field must be searched before the particles can be used again.
    pub fn needs_search(&self, prediction: &Prediction) -> bool {
        prediction.is_kidnapped || prediction.sigma.position_m > self.config.search_sigma_m
    }

    /// Returns whether the prediction may have led to the wrong one of two places that fit.
    pub fn is_long_way(&self, prediction: &Prediction) -> bool {
        prediction.sigma.position_m > self.config.long_way_sigma_m
    }

    /// Requires the place to be confirmed again after a long way.
    pub fn confirm_after_long_way(&mut self) {
        let head_start = self.config.confirming_frames.saturating_sub(self.config.confirmed_on_a_long_way);
        self.unconfirmed.get_or_insert(head_start);
    }

    /// Continues from the result of a search around a prior.
    pub fn relocalize(&mut self, best: Option<Pose2>, is_clear: bool, prior: Prior) {
        self.unconfirmed = (!is_clear).then_some(0);
        if let Some(best) = best {
            // A picture of the lines cannot tell the two halves apart: only prior knowledge can.
            let odds = prior.log_probability(best.mirrored()) - prior.log_probability(best);
            if odds > self.mirrored_log_odds() {
                self.forget_half(odds);
            }
        }
    }

    /// Returns where the camera probably is; while in doubt, the prior widens with every picture that does not fit.
    pub fn prior(&self) -> Prior {
        self.prior_with_doubt(self.doubtful_frames > 0)
    }

    /// Works as [`Track::prior`], for a filter that may be lost.
    pub fn prior_of_lost(&self) -> Prior {
        self.prior_with_doubt(true)
    }

    fn prior_with_doubt(&self, is_doubtful: bool) -> Prior {
        let times = if is_doubtful { 1.0 + f64::from(self.doubtful_frames) } else { 0.0 };
        let lost = self.config.lost_sigma;
        let sigma = PlanarSigma {
            position_m: self.anchor_sigma.position_m.max(times * lost.position_m),
            yaw_rad: self.anchor_sigma.yaw_rad.max(times * lost.yaw_rad),
        };
        Prior { pose: self.anchor, sigma }
    }

    /// Returns whether the last search left several places, and no picture has fitted since.
    pub fn is_unconfirmed(&self) -> bool {
        self.unconfirmed == Some(0)
    }

    /// Returns the other places that may be the right one.
    pub fn rivals(&self) -> &[Rival] {
        &self.rivals
    }

    /// Notes that the field was searched for other places, which are now among the rivals.
    pub fn verify(&mut self) {
        self.is_verified = true;
    }

    /// Returns whether a picture that agrees with the pose like this leaves so much open that the field has to be searched for
    /// other places.
    pub fn needs_verification(&self, agreement: Agreement) -> bool {
        !self.is_verified && !self.is_convincing(agreement)
    }

    fn is_convincing(&self, agreement: Agreement) -> bool {
        agreement.line_fraction >= self.config.convincing_line_fraction
            && agreement.explained_fraction >= self.config.convincing_explained_fraction
    }

    /// Replaces the other places that may be the right one. Of many, the most probable are kept; those that have lost are not.
    pub fn set_rivals(&mut self, mut rivals: Vec<Rival>) {
        rivals.retain(|rival| rival.log_odds > -self.config.rival_loses_at);
        rivals.sort_by(|a, b| b.log_odds.total_cmp(&a.log_odds));
        rivals.truncate(self.config.most_rivals);
        self.rivals = rivals;
    }

    /// Returns the explained fraction below which the filter may be lost.
    pub fn lost_unless_explained(&self) -> f64 {
        self.config.lost_explained_ratio * self.usual_explained_fraction
    }

    /// Returns the line fraction below which the filter may be lost.
    pub fn lost_below(&self) -> f64 {
        self.config.lost_line_fraction.max(self.config.lost_ratio * self.usual_line_fraction)
    }

    /// Returns the line fraction from which a pose fits.
    pub fn fits_from(&self) -> f64 {
        self.config.fitting_line_fraction.max(self.config.fitting_ratio * self.usual_line_fraction)
    }

    /// Returns the explained fraction from which a pose fits.
    fn fits_where_explained(&self) -> f64 {
        let ratio = self.config.fitting_explained_ratio;
        self.config.fitting_explained_fraction.max(ratio * self.usual_explained_fraction)
    }

    /// Updates the track with the pose of a picture and its agreement with it; returns whether the pose is settled.
    pub fn settle(&mut self, pose: Pose2, agreement: Agreement) -> bool {
        let Agreement { line_fraction, explained_fraction, is_at_fit } = agreement;
        let fits = line_fraction >= self.fits_from() && explained_fraction >= self.fits_where_explained();
        self.unconfirmed = match self.unconfirmed {
            Some(streak) if fits && streak + 1 < self.config.confirming_frames => Some(streak + 1),
            Some(_) if fits => None,
            Some(_) => Some(0),
            None => None,
        };
        if fits {
            self.doubtful_frames = 0;
        } else if line_fraction < self.lost_below() {
            self.doubtful_frames = (self.doubtful_frames + 1).min(self.config.max_doubtful_frames);
        }
        self.is_verified |= self.is_convincing(agreement);
        let is_alone = self.is_verified && self.unconfirmed.is_none() && self.rivals.is_empty();
        let is_settled = fits && is_at_fit && is_alone;
        if fits {
            let sigma = if is_settled { self.config.settled_sigma } else { self.config.likely_sigma };
            (self.anchor, self.anchor_sigma) = (pose, sigma);
        }
        self.average(is_settled.then_some([line_fraction, explained_fraction]));
        is_settled
    }

    /// Updates the slow average. Without a settled picture it fades: what was usual before a search need not be usual
    /// after it.
    fn average(&mut self, settled: Option<[f64; 2]>) {
        let weight = self.config.line_fraction_weight;
        let averages = [&mut self.usual_line_fraction, &mut self.usual_explained_fraction];
        for (index, usual) in averages.into_iter().enumerate() {
            match settled {
                Some(fractions) => {
                    let weight = if *usual == 0.0 { 1.0 } else { weight };
                    *usual += weight * (fractions[index] - *usual);
                }
                None => *usual *= 1.0 - weight,
            }
        }
    }

    /// Returns whether the half of the field is still uncertain and the picture shows enough to decide it.
    pub fn asks_for_half(&self, line_fraction: f64) -> bool {
        self.prior_mirrored_log_odds != f64::NEG_INFINITY
            && line_fraction >= self.config.fitting_line_fraction
    }

    /// Adds what a picture taken at a pose tells of the mirror pose: its log-odds by each goal, that at −x first. If the
    /// mirror pose becomes the more probable one, the track turns round and this returns true.
    pub fn weigh_halves(&mut self, pose: Pose2, log_odds: [f64; 2]) -> bool {
        self.half_evidence.add(pose, log_odds, &self.config);
        let is_mirrored = self.mirrored_log_odds() > 0.0;
        if is_mirrored {
            self.prior_mirrored_log_odds = -self.prior_mirrored_log_odds;
            self.half_evidence = self.half_evidence.mirrored();
            self.anchor = self.anchor.mirrored();
        }
        is_mirrored
    }

    /// Starts anew with the halves: whatever the goals have told belongs to a place that may have been left.
    fn forget_half(&mut self, prior_mirrored_log_odds: f64) {
        self.prior_mirrored_log_odds = prior_mirrored_log_odds;
        self.half_evidence = HalfEvidence::default();
    }

    /// Returns the log-odds of the mirror pose against the pose itself.
    fn mirrored_log_odds(&self) -> f64 {
        self.prior_mirrored_log_odds + self.half_evidence.log_odds(&self.config)
    }

    /// Returns the probability that the mirror pose is the right one.
    pub fn mirrored_probability(&self) -> f64 {
        1.0 / (1.0 + (-self.mirrored_log_odds()).exp())
    }

    /// Returns whether the half of the field is beyond doubt.
    pub fn is_half_sure(&self) -> bool {
        self.mirrored_probability() < self.config.max_mirrored_probability
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: Motion2 = Motion2 { forward_m: 0.05, left_m: 0.0, turn_rad: 0.02 };
    /// Line fractions of a pose that fits, of one that neither fits nor is lost, and of one that is lost.
    const GOOD: f64 = 0.8;
    const POOR: f64 = 0.42;
    const BAD: f64 = 0.1;

    /// Returns the agreement of a pose with this line fraction that explains all lines of its picture.
    fn agreeing(line_fraction: f64) -> Agreement {
        Agreement { line_fraction, explained_fraction: 1.0, is_at_fit: true }
    }

    fn track(beginning: Beginning) -> Track {
        let start = Pose2::new(-1.0, 0.5, 0.3);
        Track::new(TrackConfig::default(), start, Some(Pose2::default()), beginning)
    }

    /// Returns a track with a given start whose first picture fitted.
    fn settled() -> Track {
        let mut track = track(Beginning::Given);
        assert!(track.settle(Pose2::new(-1.0, 0.5, 0.3), agreeing(GOOD)));
        track
    }

    /// Predicts the next picture, with odometry that advances by one step.
    fn step(track: &mut Track) -> Prediction {
        let odometry = track.odometry.unwrap().moved(STEP);
        track.predict(Some(odometry), &MotionNoise::default())
    }

    #[test]
    fn a_given_start_is_settled_at_the_first_picture_that_fits_and_its_half_is_known() {
        let mut track = track(Beginning::Given);
        assert!(!track.is_unconfirmed() && track.is_half_sure() && track.mirrored_probability() == 0.0);
        assert!(!track.asks_for_half(GOOD), "whoever gave the start knew the half");
        assert!(track.settle(Pose2::new(0.0, 0.0, 0.0), agreeing(GOOD)));
        assert_eq!(track.prior().sigma, TrackConfig::default().settled_sigma);
    }

    #[test]
    fn a_search_with_one_answer_settles_at_once_and_one_with_several_after_four_pictures_that_fit() {
        let mut clear = track(Beginning::Searched { is_clear: true });
        assert!(clear.settle(Pose2::default(), agreeing(GOOD)));

        let mut unclear = track(Beginning::Searched { is_clear: false });
        assert!(unclear.is_unconfirmed());
        let fits: Vec<bool> = (0..5).map(|_| unclear.settle(Pose2::default(), agreeing(GOOD))).collect();
        assert_eq!(fits, [false, false, false, true, true]);
    }

    #[test]
    fn a_pose_that_fits_but_is_not_confirmed_moves_the_anchor_with_the_likely_uncertainty() {
        let mut track = track(Beginning::Searched { is_clear: false });
        let pose = Pose2::new(2.0, 1.0, -0.4);
        assert!(!track.settle(pose, agreeing(GOOD)));
        assert_eq!(track.prior(), Prior { pose, sigma: TrackConfig::default().likely_sigma });
    }

    #[test]
    fn one_picture_that_does_not_fit_begins_the_confirmation_anew() {
        let mut track = track(Beginning::Searched { is_clear: false });
        for _ in 0..3 {
            track.settle(Pose2::default(), agreeing(GOOD));
        }
        assert!(!track.is_unconfirmed());
        track.settle(Pose2::default(), agreeing(POOR / 2.0));
        assert!(track.is_unconfirmed());
    }

    #[test]
    fn both_halves_are_alike_after_a_search_until_goals_have_told() {
        let mut track = track(Beginning::Searched { is_clear: true });
        assert_eq!(track.mirrored_probability(), 0.5);
        assert!(!track.is_half_sure() && track.asks_for_half(GOOD) && !track.asks_for_half(POOR / 2.0));
        let goal = [0.0, -4.0];
        for _ in 0..100 {
            assert!(!track.weigh_halves(Pose2::new(1.0, 0.0, 0.0), goal));
            assert!(!track.is_half_sure(), "a hundred pictures of one view are one");
        }
        assert!(!track.weigh_halves(Pose2::new(0.0, 0.0, 0.0), goal) && track.is_half_sure());
    }

    #[test]
    fn evidence_for_the_mirrored_pose_turns_the_track_round() {
        let mut track = track(Beginning::Searched { is_clear: true });
        let pose = Pose2::new(1.0, 0.5, 0.2);
        track.settle(pose, agreeing(GOOD));
        assert!(!track.weigh_halves(pose, [0.0, -1.0]));
        let before = track.mirrored_probability();
        assert!(track.weigh_halves(pose, [0.0, 2.0]));
        assert_eq!(track.prior().pose, pose.mirrored());
        // The evidence counts for the pose that the track has turned to: 2 − 1 for it is as much as 1 against it was.
        assert!((track.mirrored_probability() - before).abs() < 1e-12);
    }

    #[test]
    fn odometry_moves_the_anchor_and_its_uncertainty_grows() {
        let mut track = settled();
        let before = track.prior();
        let prediction = step(&mut track);
        assert!(!prediction.is_kidnapped && !track.needs_search(&prediction));
        let motion = prediction.motion.unwrap();
        assert!((motion.forward_m - STEP.forward_m).abs() < 1e-12 && motion.left_m.abs() < 1e-12);
        let expected = before.pose.moved(STEP);
        assert!((track.prior().pose.position_in_world() - expected.position_in_world()).length() < 1e-12);
        let noise = MotionNoise::default().sigma(Some(STEP));
        assert!(
            (track.prior().sigma.position_m - before.sigma.plus(noise).position_m).abs() < 1e-12,
            "variances add"
        );
    }

    #[test]
    fn without_odometry_the_prediction_stands_still_with_the_noise_of_an_unknown_motion() {
        let noise = MotionNoise::default();
        let mut track = settled();
        let before = track.prior().pose;
        let prediction = track.predict(None, &noise);
        assert_eq!((prediction.motion, prediction.sigma), (None, noise.sigma(None)));
        assert_eq!(track.prior().pose, before.moved(Motion2::default()));
        let prediction = track.predict(Some(Pose2::new(9.0, 0.0, 0.0)), &noise);
        assert_eq!(prediction.motion, None, "a motion takes the odometry of two pictures");
    }

    #[test]
    fn odometry_that_jumps_to_its_origin_is_a_kidnapping_and_the_half_is_unknown() {
        let mut track = settled();
        for _ in 0..3 {
            step(&mut track);
        }
        let prediction = track.predict(Some(Pose2::default()), &MotionNoise::default());
        assert!(prediction.is_kidnapped && prediction.motion.is_none() && track.needs_search(&prediction));
        assert_eq!(prediction.sigma, TrackConfig::default().kidnapped_sigma);
        assert!(!track.is_half_sure());
    }

    #[test]
    fn odometry_near_its_origin_is_no_kidnapping() {
        let mut track = settled();
        step(&mut track);
        let prediction = track.predict(Some(Pose2::default()), &MotionNoise::default());
        assert!(!prediction.is_kidnapped && track.is_half_sure());
    }

    #[test]
    fn a_way_that_is_too_long_for_the_particles_asks_for_a_search() {
        let prediction_of = |forward_m| {
            let mut track = settled();
            let odometry = Pose2::new(forward_m, 0.0, 0.0);
            let prediction = track.predict(Some(odometry), &MotionNoise::default());
            (track, prediction)
        };
        // 0.02 m standing still plus 0.15 m per metre: 0.15 m after 0.87 m, 0.3 m after 1.87 m.
        for (forward_m, is_long, needs_search) in
            [(0.8, false, false), (0.9, true, false), (1.8, true, false), (1.9, true, true)]
        {
            let (track, prediction) = prediction_of(forward_m);
            assert_eq!(track.is_long_way(&prediction), is_long, "{forward_m} m");
            assert_eq!(track.needs_search(&prediction), needs_search, "{forward_m} m");
        }
    }

    #[test]
    fn a_long_way_takes_two_pictures_that_fit_to_be_confirmed() {
        let mut track = settled();
        track.confirm_after_long_way();
        assert!(!track.is_unconfirmed(), "it was right before");
        assert!(!track.settle(Pose2::default(), agreeing(GOOD)));
        assert!(track.settle(Pose2::default(), agreeing(GOOD)));
    }

    #[test]
    fn a_long_way_does_not_shorten_a_confirmation_under_way() {
        let mut track = track(Beginning::Searched { is_clear: false });
        track.confirm_after_long_way();
        assert!(track.is_unconfirmed());
    }

    #[test]
    fn what_fits_is_measured_against_what_is_usual_here() {
        let mut track = settled();
        assert!((track.fits_from() - 0.55 * GOOD).abs() < 1e-12);
        assert!((track.lost_below() - 0.5 * GOOD).abs() < 1e-12);
        assert!(!track.settle(Pose2::default(), agreeing(POOR)));
        assert_eq!(track.doubtful_frames, 0, "neither fits nor lost");
    }

    #[test]
    fn the_usual_line_fraction_follows_slowly_and_fades_while_nothing_is_settled() {
        let mut track = settled();
        assert_eq!(track.usual_line_fraction, GOOD, "the first picture is all that is known");
        track.settle(Pose2::default(), agreeing(0.6));
        assert!((track.usual_line_fraction - (GOOD + 0.05 * (0.6 - GOOD))).abs() < 1e-12);
        let before = track.usual_line_fraction;
        track.settle(Pose2::default(), agreeing(BAD));
        assert!((track.usual_line_fraction - 0.95 * before).abs() < 1e-12);
    }

    #[test]
    fn doubt_widens_the_prior_with_every_bad_picture_up_to_a_limit_and_ends_with_a_good_one() {
        let mut track = settled();
        let lost = TrackConfig::default().lost_sigma.position_m;
        assert_eq!(track.prior_of_lost().sigma.position_m, lost, "the first doubt");
        for times in [2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 9.0, 9.0] {
            assert!(!track.settle(Pose2::new(7.0, 7.0, 0.0), agreeing(BAD)));
            assert!((track.prior().sigma.position_m - times * lost).abs() < 1e-12, "{times}");
        }
        assert_eq!(track.prior().pose, Pose2::new(-1.0, 0.5, 0.3), "the anchor stays where it last fitted");
        track.settle(Pose2::default(), agreeing(GOOD));
        assert_eq!(track.prior().sigma, TrackConfig::default().settled_sigma);
    }

    #[test]
    fn a_relocalization_with_several_answers_is_unconfirmed_and_one_with_a_single_answer_is_not() {
        let mut track = settled();
        let prior = track.prior_of_lost();
        track.relocalize(Some(prior.pose), false, prior);
        assert!(track.is_unconfirmed());
        track.relocalize(Some(prior.pose), true, prior);
        assert!(!track.is_unconfirmed() && track.settle(prior.pose, agreeing(GOOD)));
        track.relocalize(None, false, prior);
        assert!(track.is_unconfirmed(), "nothing was found");
    }

    #[test]
    fn a_relocalization_doubts_the_half_as_much_as_the_prior_does() {
        let pose = Pose2::new(2.0, 0.0, 0.0);
        let prior_of = |position_m, yaw_rad| Prior { pose, sigma: PlanarSigma { position_m, yaw_rad } };
        let mut near = settled();
        near.relocalize(Some(pose), true, prior_of(0.5, 0.4));
        assert!(near.is_half_sure());
        let mut far = settled();
        far.relocalize(Some(pose), true, prior_of(40.0, 40.0));
        assert!(!far.is_half_sure() && far.asks_for_half(GOOD));
        // The wrong half is never more probable than the prior says, and searching does not restore certainty.
        far.relocalize(Some(pose), true, prior_of(0.5, 0.4));
        assert!(!far.is_half_sure());
    }
}
