//! Monte Carlo localization, one picture at a time.

use std::{fmt, sync::Arc, time::Instant};

use image::RgbImage;

use super::{
    agreement::Agreement,
    config::LocalizerConfig,
    error::LocalizationError,
    frame::LocalizedFrame,
    observation::Observation,
    rivals::Rival,
    track::{Beginning, Track},
};
use crate::{
    filter::{Filter, FilterEstimate},
    goal_colors::GoalColors,
    mount::MountPose,
    pose::{CameraPose, Motion2, Pose2, wrap_angle},
    preprocess::{FieldBorder, LinePoints, Prepared, Preprocessor},
    refine::PoseFit,
    search::{GlobalSearch, Mode, Prior},
};

/// Localizes a camera picture by picture, with a particle filter over white lines. [`Localizer::builder`] makes one.
pub struct Localizer {
    pub(super) config: LocalizerConfig,
    /// Width and height, pixels.
    pub(super) size: [u32; 2],
    pub(super) preprocessor: Preprocessor,
    pub(super) filter: Box<dyn Filter>,
    pub(super) search: GlobalSearch,
    pub(super) goal_colors: Option<GoalColors>,
    pub(super) start: Option<Pose2>,
    /// `None` before the first picture.
    pub(super) track: Option<Track>,
    /// Number of pictures so far.
    pub(super) frame: u32,
    /// Last picture.
    pub(super) picture: Option<Prepared>,
}

/// Result of prediction, search and filter for one picture.
struct Posterior {
    track: Track,
    estimate: FilterEstimate,
    motion: Option<Motion2>,
    searched: bool,
}

impl Localizer {
    /// Finds the pose of the next picture.
    ///
    /// Fails if the picture does not have the camera's size or if the device fails. After an error the track is as it was
    /// before the picture. If a device has failed, its particles may be lost: [`Localizer::reset`] starts again.
    pub fn update(&mut self, observation: &Observation) -> Result<LocalizedFrame, LocalizationError> {
        let begin = Instant::now();
        let picture = self.load(observation)?;
        let mount = observation.mount;
        let posterior = match self.track.clone() {
            Some(track) => self.follow(track, &picture, observation)?,
            None => self.begin(&picture, observation)?,
        };
        let Posterior { mut track, estimate, motion, searched } = posterior;
        let refined = self.refine(&track, mount, estimate.pose)?;
        let (pose, fit) = self.weigh_rivals(&mut track, mount, refined)?;
        let agreement = self.agreement(pose, mount, track.fits_from());
        let Agreement { line_fraction, explained_fraction, .. } = agreement;
        let settled = track.settle(pose.planar(), agreement);
        let mut frame = LocalizedFrame {
            timestamp_s: observation.timestamp_s,
            pose,
            fit,
            filter: estimate,
            mount,
            motion,
            line_fraction,
            explained_fraction,
            settled,
            sure: settled && track.is_half_sure(),
            mirrored_probability: track.mirrored_probability(),
            searched,
            seconds: 0.0,
        };
        self.resolve_symmetry(&mut track, &mut frame, observation)?;
        self.track = Some(track);
        self.picture = Some(picture);
        self.frame += 1;
        frame.seconds = begin.elapsed().as_secs_f64();
        Ok(frame)
    }

    /// Starts again at a pose, or anywhere on the field, as if no picture had been seen. Keeps everything that was built.
    pub fn reset(&mut self, start: Option<Pose2>) {
        self.reset_with_seed(start, self.config.filter.seed);
    }

    /// Works as [`Localizer::reset`], with another random seed.
    pub fn reset_with_seed(&mut self, start: Option<Pose2>, seed: u64) {
        self.config.filter.seed = seed;
        self.filter.reset(seed);
        (self.start, self.track, self.picture, self.frame) = (start, None, None, 0);
    }

    /// Hands over early the picture that will be localized after the next one, so that a device can upload it while it
    /// computes.
    pub fn prefetch(&mut self, next: &Arc<RgbImage>) {
        self.filter.prefetch(next);
    }

    /// Returns the settings in use.
    pub fn config(&self) -> &LocalizerConfig {
        &self.config
    }

    /// Returns the particles after the last picture. Fails if they cannot be read from the device.
    pub fn particles(&self) -> Result<Vec<CameraPose>, LocalizationError> {
        Ok(self.filter.particles()?)
    }

    /// Returns the field's border in a picture, for drawing.
    pub fn border(&self, observation: &Observation) -> FieldBorder {
        self.preprocessor.prepare(observation.picture.pixels().clone(), observation.mount).border
    }

    /// Finds points on the white lines of the last picture, independently of its pose, for [`crate::quality::LineMeter`];
    /// `None` before the first picture. Takes half a millisecond for 640 × 480 pixels.
    pub fn line_points(&self) -> Option<LinePoints> {
        self.picture.as_ref().map(Prepared::line_points)
    }

    fn load(&mut self, observation: &Observation) -> Result<Prepared, LocalizationError> {
        let (found, expected) = (observation.picture.size(), self.size);
        if found != expected {
            return Err(LocalizationError::PictureSize { found, expected });
        }
        let pixels = observation.picture.pixels().clone();
        let picture = self.preprocessor.prepare(pixels, observation.mount);
        rayon::join(|| self.filter.load(&picture), || self.search.load(&picture)).0?;
        Ok(picture)
    }

    /// Handles the first picture: places particles around the start, or around the places that a search finds.
    fn begin(
        &mut self,
        picture: &Prepared,
        observation: &Observation,
    ) -> Result<Posterior, LocalizationError> {
        self.filter.initialize(&[(self.start.unwrap_or_default(), 1.0)], self.config.start_sigma)?;
        let mut beginning = Beginning::Given;
        let mut found = Vec::new();
        if self.start.is_none() {
            let modes = self.search(picture, observation.mount, None)?;
            beginning = Beginning::Searched { is_clear: self.config.relocalization.is_clear(&modes) };
            found = modes;
        }
        let estimate = self.filter.update(observation.mount, self.config.filter.noise.sigma(None))?;
        let pose = estimate.pose.planar();
        let mut track = Track::new(self.config.track, pose, self.odometry(observation), beginning);
        if let Some(best) = found.first() {
            self.add_rivals(&mut track, &found, best);
            track.verify();
        }
        Ok(Posterior { track, estimate, motion: None, searched: self.start.is_none() })
    }

    /// Handles any later picture: predicts and updates; relocalizes if the prediction is too uncertain or the picture
    /// contradicts it.
    fn follow(
        &mut self,
        mut track: Track,
        picture: &Prepared,
        observation: &Observation,
    ) -> Result<Posterior, LocalizationError> {
        let mount = observation.mount;
        let prediction = track.predict(self.odometry(observation), &self.config.filter.noise);
        self.filter.predict(prediction.motion)?;

        let mut diffusion = prediction.sigma;
        let mut searched = self.config.relocalizes && track.needs_search(&prediction);
        if searched {
            let prior = track.prior();
            let modes = self.search(picture, mount, Some(prior))?;
            self.relocalize(&mut track, &modes, prior);
            diffusion = self.config.relocalization.found_sigma;
        }
        // After a long way, more than one place may fit.
        let is_long_way = track.is_long_way(&prediction);
        if is_long_way {
            track.confirm_after_long_way();
        }

        let mut estimate = self.filter.update(mount, diffusion)?;

        let asks_for_search = || {
            is_long_way
                || self.may_be_lost(&track, estimate.pose, mount)
                || self.may_be_elsewhere(&track, estimate.pose, mount)
        };
        if self.config.relocalizes && !searched && asks_for_search() {
            searched = true;
            estimate = self.recover(&mut track, picture, mount, estimate)?;
        }
        Ok(Posterior { track, estimate, motion: prediction.motion, searched })
    }

    fn odometry(&self, observation: &Observation) -> Option<Pose2> {
        observation.odometry.filter(|_| self.config.uses_odometry)
    }

    fn may_be_lost(&self, track: &Track, pose: CameraPose, mount: MountPose) -> bool {
        let least = track.lost_below();
        track.is_unconfirmed()
            || self.search.explained_fraction(pose) < track.lost_unless_explained()
            || self.line_fraction_near(pose, mount, least) < least
    }

    /// Returns whether the place was never verified, and the picture leaves so much open that the field has to be searched for
    /// others.
    fn may_be_elsewhere(&self, track: &Track, pose: CameraPose, mount: MountPose) -> bool {
        !track.is_verified() && !track.is_convincing(self.agreement(pose, mount, track.fits_from()))
    }

    /// Returns the line fraction of a pose. If it is less than `enough`, returns that of the pose next to it that fits the
    /// picture best: with a mount pose that is wrong by a degree, narrow lines are missed even from the right place.
    fn line_fraction_near(&self, pose: CameraPose, mount: MountPose, enough: f64) -> f64 {
        let own = self.search.line_fraction(pose);
        if own >= enough {
            return own;
        }
        match self.search.best_of(&[pose], mount, None) {
            Some(near) if self.config.relocalization.is_same_place(near.pose, pose) => {
                own.max(self.search.line_fraction(near.pose))
            }
            _ => own,
        }
    }

    /// Searches the field; moves the particles only if another place fits clearly better than the filter's own.
    fn recover(
        &mut self,
        track: &mut Track,
        picture: &Prepared,
        mount: MountPose,
        estimate: FilterEstimate,
    ) -> Result<FilterEstimate, LocalizationError> {
        let prior = track.prior_of_lost();
        let mut modes = self.modes(picture, mount, Some(prior))?;
        track.verify();
        // From many places no line is in view: such a place fits every picture a little, and none well.
        modes.retain(|mode| self.search.line_fraction(mode.pose) >= self.config.track.lost_line_fraction);
        let Some(best) = modes.first() else { return Ok(estimate) };
        let Some(own) = self.search.best_of(&[estimate.pose], mount, Some(prior)) else {
            return Ok(estimate);
        };
        if !self.config.relocalization.is_better_elsewhere(best, &own) {
            self.add_rivals(track, &modes, &own);
            return Ok(estimate);
        }
        self.place(&modes)?;
        self.relocalize(track, &modes, prior);
        Ok(self.filter.update(mount, self.config.relocalization.found_sigma)?)
    }

    /// Searches the field, and places the particles at the poses that fit the picture.
    fn search(
        &mut self,
        picture: &Prepared,
        mount: MountPose,
        prior: Option<Prior>,
    ) -> Result<Vec<Mode>, LocalizationError> {
        let modes = self.modes(picture, mount, prior)?;
        self.place(&modes)?;
        Ok(modes)
    }

    fn modes(
        &mut self,
        picture: &Prepared,
        mount: MountPose,
        prior: Option<Prior>,
    ) -> Result<Vec<Mode>, LocalizationError> {
        let seed = self.config.filter.seed ^ u64::from(self.frame).rotate_left(48);
        Ok(self.search.search(picture, mount, prior, seed)?)
    }

    fn place(&mut self, modes: &[Mode]) -> Result<(), LocalizationError> {
        let seeds = self.config.relocalization.seeds(modes);
        if !seeds.is_empty() {
            self.filter.initialize(&seeds, self.config.relocalization.found_sigma)?;
        }
        Ok(())
    }

    fn relocalize(&self, track: &mut Track, modes: &[Mode], prior: Prior) {
        let best = modes.first().map(|mode| mode.pose.planar());
        track.relocalize(best, self.config.relocalization.is_clear(modes), prior);
        track.verify();
        if let Some(best) = modes.first() {
            self.add_rivals(track, modes, best);
        }
    }

    /// Adds the places of a search that fit nearly as well as the track's own to its rivals.
    fn add_rivals(&self, track: &mut Track, modes: &[Mode], own: &Mode) {
        let config = &self.config.relocalization;
        let is_own = |pose: CameraPose| {
            config.is_same_place(pose, own.pose) || config.is_same_place(pose, own.pose.mirrored())
        };
        let mut rivals = track.rivals().to_vec();
        for mode in modes.iter().filter(|mode| !is_own(mode.pose)) {
            // Goals tell the halves apart: of a place and its mirror place, the one nearer to the track's own is its rival.
            let pose = nearer(own.pose, mode.pose);
            let is_known = |rival: &Rival| config.is_same_place(pose.with_planar(rival.pose), pose);
            if !rivals.iter().any(is_known) {
                let log_odds = (mode.log_weight - own.log_weight).min(0.0);
                rivals.push(Rival::new(pose.planar(), log_odds));
            }
        }
        track.set_rivals(rivals);
    }

    /// Weighs the track's rivals against its own pose by the present picture. If one wins, the track goes on at its place; the
    /// pose of the picture and its fit are returned.
    fn weigh_rivals(
        &mut self,
        track: &mut Track,
        mount: MountPose,
        own: (CameraPose, Option<PoseFit>),
    ) -> Result<(CameraPose, Option<PoseFit>), LocalizationError> {
        let mut rivals = track.rivals().to_vec();
        if rivals.is_empty() {
            return Ok(own);
        }
        // The prediction counts for none of them: how sure it is depends on how each place was found.
        let here = self.search.best_near(own.0, mount);
        let least = track.fits_from();
        let fits = |pose| self.search.line_fraction(pose) >= least;
        let mut modes = Vec::with_capacity(rivals.len());
        for rival in &mut rivals {
            let there = self.search.best_near(mount.at(rival.pose), mount);
            if !rival.knows_picture {
                // A picture that fits at neither place tells nothing of them.
                let tells = [here, there].iter().any(|mode| fits(mode.pose));
                let gain = if tells { there.log_weight - here.log_weight } else { 0.0 };
                rival.weigh(there.pose.planar(), gain, &self.config.track);
            }
            modes.push(there);
        }
        let best = (0..rivals.len()).max_by(|&a, &b| rivals[a].log_odds.total_cmp(&rivals[b].log_odds));
        let wins_at = self.config.track.rival_wins_at;
        let winner = best.filter(|&index| rivals[index].log_odds >= wins_at && fits(modes[index].pose));
        let mut found = own;
        if let Some(index) = winner {
            let (mode, lead) = (modes[index], rivals[index].log_odds);
            rivals[index] = Rival::new(own.0.planar(), 0.0);
            rivals.iter_mut().for_each(|rival| rival.log_odds -= lead);
            self.filter.initialize(&[(mode.pose.planar(), 1.0)], self.config.relocalization.found_sigma)?;
            found = (mode.pose, mode.fit.filter(|_| self.config.refines));
        }
        let place = found.0;
        let config = &self.config.relocalization;
        rivals.retain(|rival| !config.is_same_place(place.with_planar(rival.pose), place));
        track.set_rivals(rivals);
        Ok(found)
    }

    /// Returns how well a pose and the picture agree; `enough` is the line fraction from which the pose fits.
    fn agreement(&self, pose: CameraPose, mount: MountPose, enough: f64) -> Agreement {
        // Where enough lines coincide, the pose is right to a line's width. With a mount pose that is wrong by a degree, narrow
        // lines are missed even from the right place.
        let coincides = self.search.line_fraction(pose) >= enough;
        let near = if coincides { pose } else { self.search.best_near(pose, mount).pose };
        let most = self.config.track.fit_distance;
        let is_at_fit = (pose.x_m - near.x_m).hypot(pose.y_m - near.y_m) <= most.position_m
            && wrap_angle(pose.yaw_rad - near.yaw_rad).abs() <= most.yaw_rad;
        let best = |of: &dyn Fn(CameraPose) -> f64| of(pose).max(of(near));
        Agreement {
            line_fraction: best(&|pose| self.search.line_fraction(pose)),
            explained_fraction: best(&|pose| self.search.explained_fraction(pose)),
            is_at_fit,
        }
    }

    /// Fits the best particle, its alternatives and the prediction to the picture. Returns the most probable of these poses,
    /// given both picture and prediction.
    fn refine(
        &mut self,
        track: &Track,
        mount: MountPose,
        best: CameraPose,
    ) -> Result<(CameraPose, Option<PoseFit>), LocalizationError> {
        if !self.config.refines {
            return Ok((best, None));
        }
        let prior = track.prior();
        let mut candidates = vec![best, mount.at(prior.pose)];
        candidates.extend(self.filter.alternatives());
        let Some(Mode { pose, fit, .. }) = self.search.best_of(&candidates, mount, Some(prior)) else {
            return Ok((best, None));
        };
        if !self.config.relocalization.is_same_place(pose, best) {
            // Move the particles, too, or they would go on from a place that was given up.
            self.filter.initialize(&[(pose.planar(), 1.0)], self.config.relocalization.found_sigma)?;
        }
        Ok((pose, fit))
    }

    /// Decides by the colours of the goals between a pose and its mirror pose, and turns everything round if they favour the
    /// mirror pose.
    fn resolve_symmetry(
        &mut self,
        track: &mut Track,
        frame: &mut LocalizedFrame,
        observation: &Observation,
    ) -> Result<(), LocalizationError> {
        let Some(goal_colors) = &self.goal_colors else { return Ok(()) };
        if observation.picture.is_grey() || !track.asks_for_half(frame.line_fraction) {
            return Ok(());
        }
        let log_odds = goal_colors.mirrored_log_odds(observation.picture.pixels(), frame.pose);
        if track.weigh_halves(frame.pose.planar(), log_odds) {
            self.filter.mirror()?;
            frame.pose = frame.pose.mirrored();
            frame.filter.pose = frame.filter.pose.mirrored();
            frame.fit = frame.fit.map(PoseFit::mirrored);
        }
        frame.mirrored_probability = track.mirrored_probability();
        frame.sure = frame.settled && track.is_half_sure();
        Ok(())
    }
}

/// Returns a pose or its mirror pose, whichever is nearer to another one.
fn nearer(to: CameraPose, pose: CameraPose) -> CameraPose {
    let distance_m = |pose: CameraPose| (pose.x_m - to.x_m).hypot(pose.y_m - to.y_m);
    let mirrored = pose.mirrored();
    if distance_m(mirrored) < distance_m(pose) { mirrored } else { pose }
}

impl fmt::Debug for Localizer {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = formatter.debug_struct("Localizer");
        debug.field("config", &self.config).field("track", &self.track).field("frame", &self.frame);
        debug.finish_non_exhaustive()
    }
}
