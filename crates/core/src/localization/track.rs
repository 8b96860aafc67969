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

    /// Returns whether the place is beyond doubt.
    pub fn is_verified(&self) -> bool {
        self.is_verified
    }

    /// Returns whether a picture that agrees with a pose like this needs no search for other places.
    pub fn is_convincing(&self, agreement: Agreement) -> bool {
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
mod tests;
