//! A camera pose for every picture of a recording: preprocessing, particle filter, recovery and refinement together.

use std::{
    sync::{Arc, mpsc},
    time::Instant,
};

use image::RgbImage;

use crate::{
    backend::{Backend, BackendError, CpuBackend},
    camera::Camera,
    field::FieldDimensions,
    filter::{Filter, FilterConfig, FilterEstimate, PlanarSigma},
    goal_colors::GoalColors,
    localization::{Beginning, Prediction, Track, TrackConfig},
    observation::{ObservationConfig, ObservationKind},
    pose::{CameraPose, Motion2, Pose2},
    preprocess::{Attitude, FieldBorder, Prepared, Preprocessor, Texture},
    refine::{
        AttitudeTolerance, PoseFit, Reach, RefineConfig, Refiner, SmoothedPose, TrajectoryFrame,
        smooth_trajectory,
    },
    search::{GlobalSearch, Mode, Prior},
    sequence::{Sequence, SequenceError},
};

/// Uncertainty of a start pose that the recording gives.
const START_SIGMA: PlanarSigma = PlanarSigma { position_m: 0.05, yaw_rad: 0.05 };
/// Poses nearer than this are of one place.
const SAME_PLACE: PlanarSigma = PlanarSigma { position_m: 0.3, yaw_rad: 0.2 };
/// Particles spread around a place that a search found.
const FOUND_SIGMA: PlanarSigma = PlanarSigma { position_m: 0.06, yaw_rad: 0.04 };
/// A place found by search is sure when the next best one is at least this much worse (log-weight).
const SURE_MARGIN: f64 = 6.0;
/// A search must beat the filter's own place by this much (log-weight) to move the particles.
const MOVE_MARGIN: f64 = 4.0;
/// Places that a search finds worse than the best one by more than this (log-weight) get no particles.
const RIVAL_MARGIN: f64 = 4.0;

/// How a recording is tagged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TagConfig {
    /// The observation model that weighs the particles.
    pub observation: ObservationConfig,
    /// The particle filter.
    pub filter: FilterConfig,
    /// Use the recording's odometry; without it the previous picture alone predicts the next, as in the paper.
    pub odometry: bool,
    /// Search the field when the filter is lost.
    pub recovery: bool,
    /// Fit each pose to a fraction of a pixel, height, pitch and roll included.
    pub refine: bool,
    /// What joints and IMU are worth.
    pub tolerance: AttitudeTolerance,
}

impl TagConfig {
    /// The defaults for an observation model: the paper's two as in the paper, `contrast` with all six degrees of
    /// freedom and refinement.
    pub fn new(kind: ObservationKind) -> Self {
        let six = kind == ObservationKind::Contrast;
        let tolerance = AttitudeTolerance::default();
        Self {
            observation: ObservationConfig::new(kind),
            filter: FilterConfig { attitude_tolerance: six.then_some(tolerance), ..FilterConfig::default() },
            odometry: true,
            recovery: true,
            refine: six,
            tolerance,
        }
    }
}

/// A picture with what the robot knew when it was taken.
#[derive(Debug, Clone)]
pub struct Recorded {
    /// The picture; it has the camera's size.
    pub picture: Arc<RgbImage>,
    /// Dead-reckoned pose, where the recording has one.
    pub odometry: Option<Pose2>,
    /// Height, pitch and roll by joints and IMU.
    pub attitude: Attitude,
}

/// A picture's pose, and how far to trust it.
#[derive(Debug, Clone, PartialEq)]
pub struct TaggedFrame {
    /// The pose.
    pub pose: CameraPose,
    /// The sub-pixel fit, where one was asked for and found.
    pub fit: Option<PoseFit>,
    /// The filter's own estimate.
    pub filter: FilterEstimate,
    /// Fraction of the line in view that the picture shows where the pose puts it, or where that is little, where the pose
    /// next to it that fits best puts it.
    pub line_fraction: f64,
    /// False while the lines do not fit, or may fit elsewhere as well; a settled pose may still be the mirror image of
    /// the right one.
    pub settled: bool,
    /// Settled, and not the mirror image of the right pose: false while the pose may be wrong.
    pub sure: bool,
    /// Probability that the pose turned by 180° about the field's centre is the right one.
    pub mirror_probability: f64,
    /// Motion since the previous picture, by odometry.
    pub motion: Option<Motion2>,
    /// Whether the whole field was searched for this picture.
    pub searched: bool,
    /// Time taken, decoding excluded, seconds.
    pub seconds: f64,
}

/// Tags one picture after the other.
pub struct Tagger {
    config: TagConfig,
    preprocessor: Preprocessor,
    backend: Arc<dyn Backend>,
    filter: Box<dyn Filter>,
    refiner: Refiner,
    search: GlobalSearch,
    goal_colors: Option<GoalColors>,
    state: Option<Track>,
    start: Option<Pose2>,
    frame: u32,
}

impl std::fmt::Debug for Tagger {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Tagger")
            .field("config", &self.config)
            .field("frame", &self.frame)
            .finish_non_exhaustive()
    }
}

impl Tagger {
    /// Tags pictures of a camera on a field from a start pose, or from anywhere, on this processor.
    pub fn new(camera: &Camera, field: &FieldDimensions, start: Option<Pose2>, config: TagConfig) -> Self {
        Self::with_backend(camera, field, start, config, Arc::new(CpuBackend))
            .unwrap_or_else(|error| unreachable!("this processor never fails: {error}"))
    }

    /// As [`Tagger::new`], on the device of a backend.
    pub fn with_backend(
        camera: &Camera,
        field: &FieldDimensions,
        start: Option<Pose2>,
        config: TagConfig,
        backend: Arc<dyn Backend>,
    ) -> Result<Self, BackendError> {
        let refine = RefineConfig { tolerance: config.tolerance, ..RefineConfig::default() };
        Ok(Self {
            config,
            preprocessor: Preprocessor::new(camera, field.line_width_m),
            filter: backend.filter(camera, field, config.observation, config.filter)?,
            refiner: Refiner::new(camera, field, refine),
            search: GlobalSearch::with_backend(camera, field, config.tolerance, &*backend)?,
            goal_colors: GoalColors::new(camera, field),
            backend,
            state: None,
            start,
            frame: 0,
        })
    }

    /// The particles after the last picture.
    pub fn particles(&self) -> Vec<CameraPose> {
        self.filter.particles()
    }

    /// The field's border in a picture, for drawing.
    pub fn border(&self, picture: &Arc<RgbImage>, attitude: Attitude) -> FieldBorder {
        self.preprocessor.prepare(picture.clone(), attitude).border
    }

    /// Fits a picture from a pose that is known from elsewhere.
    fn refit(&self, picture: &Prepared, guess: CameraPose, attitude: Attitude) -> Option<PoseFit> {
        let texture = Texture::pack(&picture.whiteness);
        self.refiner.fit(&texture, guess, attitude, f64::from(picture.levels.contrast()), Reach::Wide)
    }

    /// The picture that follows the one tagged next, where it is known already: a device takes it over while it computes.
    pub fn announce(&mut self, next: &Arc<RgbImage>) {
        self.filter.announce(next);
    }

    /// Tags the next picture.
    pub fn tag(&mut self, recorded: &Recorded) -> Result<TaggedFrame, BackendError> {
        let begin = Instant::now();
        let picture = self.preprocessor.prepare(recorded.picture.clone(), recorded.attitude);
        rayon::join(|| self.filter.load(&picture), || self.search.load(&picture));
        let mut tagged = match self.state.take() {
            Some(track) => self.follow(track, &picture, recorded),
            None => self.begin(&picture, recorded),
        };
        self.backend.status()?;
        self.update_mirror(&mut tagged, recorded);
        self.frame += 1;
        tagged.seconds = begin.elapsed().as_secs_f64();
        Ok(tagged)
    }

    fn begin(&mut self, picture: &Prepared, recorded: &Recorded) -> TaggedFrame {
        self.filter.place(&[(self.start.unwrap_or_default(), 1.0)], START_SIGMA);
        let mut beginning = Beginning::Given;
        if self.start.is_none() {
            let modes = self.search_modes(picture, recorded.attitude, None);
            place(&mut *self.filter, &modes);
            beginning = Beginning::Searched { is_clear: is_clear(&modes) };
        }
        let estimate = self.filter.update(recorded.attitude, self.config.filter.noise.sigma(None));
        let track =
            Track::new(TrackConfig::default(), estimate.pose.planar(), self.odometry(recorded), beginning);
        self.finish(track, recorded, Found { estimate, motion: None, searched: self.start.is_none() })
    }

    fn follow(&mut self, mut track: Track, picture: &Prepared, recorded: &Recorded) -> TaggedFrame {
        let prediction: Prediction = track.predict(self.odometry(recorded), &self.config.filter.noise);
        self.filter.predict(prediction.motion);
        let mut searched = false;
        if self.config.recovery && track.needs_search(&prediction) {
            let prior = track.prior();
            let modes = self.search_modes(picture, recorded.attitude, Some(prior));
            place(&mut *self.filter, &modes);
            relocalize(&mut track, &modes, prior);
            searched = true;
        }
        // After a long way there may be more than one place that fits.
        let long_way = track.is_long_way(&prediction);
        if long_way {
            track.confirm_after_long_way();
        }
        let diffusion = if searched { FOUND_SIGMA } else { prediction.sigma };
        let mut estimate = self.filter.update(recorded.attitude, diffusion);
        let doubt = || long_way || self.may_be_lost(&track, estimate.pose, recorded.attitude);
        if self.config.recovery && !searched && doubt() {
            searched = true;
            estimate = self.recover(&mut track, picture, recorded.attitude, estimate);
        }
        self.finish(track, recorded, Found { estimate, motion: prediction.motion, searched })
    }

    fn odometry(&self, recorded: &Recorded) -> Option<Pose2> {
        recorded.odometry.filter(|_| self.config.odometry)
    }

    fn may_be_lost(&self, track: &Track, pose: CameraPose, attitude: Attitude) -> bool {
        let least = track.lost_below();
        track.is_unconfirmed() || self.line_fraction_near(pose, attitude, least) < least
    }

    /// The line fraction of a pose, or where that is less than `enough`, of the pose next to it that fits the picture
    /// best: joints and IMU that are wrong by a degree hide narrow lines from a pose in the right place.
    fn line_fraction_near(&self, pose: CameraPose, attitude: Attitude, enough: f64) -> f64 {
        let own = self.search.line_fraction(pose);
        if own >= enough {
            return own;
        }
        match self.search.best_of(&[pose], attitude, None) {
            Some(near) if is_near(near.pose, pose) => own.max(self.search.line_fraction(near.pose)),
            _ => own,
        }
    }

    /// Searches the field; moves the particles only where another place fits clearly better than the filter's.
    fn recover(
        &mut self,
        track: &mut Track,
        picture: &Prepared,
        attitude: Attitude,
        estimate: FilterEstimate,
    ) -> FilterEstimate {
        let prior = track.prior_of_lost();
        let mut modes = self.search_modes(picture, attitude, Some(prior));
        // From many places no line is in view, which fits every picture a little and none well.
        modes
            .retain(|mode| self.search.line_fraction(mode.pose) >= TrackConfig::default().lost_line_fraction);
        let Some(best) = modes.first() else { return estimate };
        let Some(own) = self.search.best_of(&[estimate.pose], attitude, Some(prior)) else {
            return estimate;
        };
        if is_near(best.pose, own.pose) || best.log_weight - own.log_weight < MOVE_MARGIN {
            return estimate;
        }
        place(&mut *self.filter, &modes);
        relocalize(track, &modes, prior);
        self.filter.update(attitude, FOUND_SIGMA)
    }

    fn search_modes(&mut self, picture: &Prepared, attitude: Attitude, prior: Option<Prior>) -> Vec<Mode> {
        let seed = self.config.filter.seed ^ u64::from(self.frame).rotate_left(48);
        self.search.search(picture, attitude, prior, seed)
    }

    fn finish(&mut self, mut track: Track, recorded: &Recorded, found: Found) -> TaggedFrame {
        let Found { estimate, motion, searched } = found;
        let mut pose = estimate.pose;
        let mut fit = None;
        if self.config.refine
            && let Some(mode) = self.most_probable(&track, recorded.attitude, pose)
        {
            (pose, fit) = (mode.pose, mode.fit);
            if !is_near(pose, estimate.pose) {
                // The particles follow, or they would go on from a place that was given up.
                self.filter.place(&[(pose.planar(), 1.0)], FOUND_SIGMA);
            }
        }
        let line_fraction = self.line_fraction_near(pose, recorded.attitude, track.fits_from());
        let settled = track.settle(pose.planar(), line_fraction);
        let mirror_probability = track.mirrored_probability();
        self.state = Some(track);
        TaggedFrame {
            pose,
            fit,
            filter: estimate,
            line_fraction,
            settled,
            sure: settled && track.is_half_sure(),
            mirror_probability,
            motion,
            searched,
            seconds: 0.0,
        }
    }

    /// The best particle, its rivals and the prediction, each fitted to the picture: the most probable of them, by picture
    /// and prediction together.
    fn most_probable(&self, track: &Track, attitude: Attitude, best: CameraPose) -> Option<Mode> {
        let prior = track.prior();
        let mut candidates = vec![best, attitude.at(prior.pose)];
        candidates.extend(self.filter.rivals());
        self.search.best_of(&candidates, attitude, Some(prior))
    }

    /// Lets the colours of the goals decide between a pose and its mirror image, and turns everything round when they
    /// speak for the other.
    fn update_mirror(&mut self, tagged: &mut TaggedFrame, recorded: &Recorded) {
        let (Some(goal_colors), Some(track)) = (&self.goal_colors, &mut self.state) else { return };
        if !track.asks_for_half(tagged.line_fraction) {
            return;
        }
        if track.weigh_halves(goal_colors.mirror_log_odds(&recorded.picture, tagged.pose)) {
            self.filter.mirror();
            tagged.pose = tagged.pose.mirrored();
            tagged.filter.pose = tagged.filter.pose.mirrored();
            tagged.fit = tagged.fit.map(PoseFit::mirrored);
        }
        tagged.mirror_probability = track.mirrored_probability();
        tagged.sure = tagged.settled && track.is_half_sure();
    }
}

/// What prediction, filter and search came to.
#[derive(Clone, Copy)]
struct Found {
    estimate: FilterEstimate,
    motion: Option<Motion2>,
    searched: bool,
}

/// Goes on from what a search found.
fn relocalize(track: &mut Track, modes: &[Mode], prior: Prior) {
    track.relocalize(modes.first().map(|mode| mode.pose.planar()), is_clear(modes), prior);
}

fn place(filter: &mut dyn Filter, modes: &[Mode]) {
    let best = modes.first().map_or(0.0, |mode| mode.log_weight);
    let weighted: Vec<(Pose2, f64)> = modes
        .iter()
        .filter(|mode| best - mode.log_weight < RIVAL_MARGIN)
        .map(|mode| (mode.pose.planar(), mode.probability))
        .collect();
    if !weighted.is_empty() {
        filter.place(&weighted, FOUND_SIGMA);
    }
}

/// Whether a search had one answer only.
fn is_clear(modes: &[Mode]) -> bool {
    match modes {
        [] => false,
        [_] => true,
        [best, second, ..] => best.log_weight - second.log_weight >= SURE_MARGIN,
    }
}

/// Whether two poses are of one place, so that particles around the one find the other.
fn is_near(a: CameraPose, b: CameraPose) -> bool {
    (a.x_m - b.x_m).hypot(a.y_m - b.y_m) < SAME_PLACE.position_m
        && crate::pose::wrap_angle(a.yaw_rad - b.yaw_rad).abs() < SAME_PLACE.yaw_rad
}

/// Why a sequence could not be tagged.
#[derive(Debug, thiserror::Error)]
pub enum TagError {
    /// A picture cannot be read, or a result not be written.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// The device that weighs the particles failed.
    #[error(transparent)]
    Backend(#[from] BackendError),
}

/// Tags all pictures of a sequence in order. Pictures are decoded ahead on a thread of their own; memory does not grow
/// with the recording but for the results. `observe` sees every result as it comes, with the picture.
pub fn tag_sequence(
    sequence: &Sequence,
    tagger: &mut Tagger,
    mut observe: impl FnMut(usize, &TaggedFrame, &Arc<RgbImage>, &Tagger) -> Result<(), SequenceError>,
) -> Result<Vec<TaggedFrame>, TagError> {
    std::thread::scope(|scope| {
        let (sender, receiver) = mpsc::sync_channel(1);
        scope.spawn(move || {
            for index in 0..sequence.frames.len() {
                // The receiver is gone once tagging has failed.
                if sender.send(sequence.load_image(index).map(Arc::new)).is_err() {
                    break;
                }
            }
        });
        let mut tagged = Vec::with_capacity(sequence.frames.len());
        let mut pictures = receiver.into_iter().peekable();
        while let Some(picture) = pictures.next() {
            let picture = picture?;
            if let Some(Ok(next)) = pictures.peek() {
                tagger.announce(next);
            }
            let index = tagged.len();
            let frame = tagger.tag(&recorded(sequence, index, &picture))?;
            observe(index, &frame, &picture, tagger)?;
            tagged.push(frame);
        }
        Ok(tagged)
    })
}

/// The most probable poses of a tagged sequence as a whole, see [`smooth_trajectory`]. Pictures whose own fit was
/// missing, or contradicts the others, are looked at once more from where the others say they were taken.
///
/// `None` where no picture could be fitted at all.
pub fn smooth_sequence(
    sequence: &Sequence,
    tagger: &Tagger,
    tagged: &[TaggedFrame],
) -> Result<Option<Vec<SmoothedPose>>, SequenceError> {
    let attitude = |index: usize| sequence_attitude(sequence, index);
    let mut frames: Vec<TrajectoryFrame> = tagged
        .iter()
        .enumerate()
        .map(|(index, frame)| TrajectoryFrame {
            guess: frame.pose,
            fit: frame.fit.filter(|_| frame.line_fraction >= TrackConfig::default().fitting_line_fraction),
            attitude: attitude(index),
            motion: frame.motion,
        })
        .collect();
    let Some(first) = smooth_trajectory(&frames, tagger.config.tolerance, tagger.config.filter.noise) else {
        return Ok(None);
    };
    for (index, smoothed) in first.iter().enumerate() {
        frames[index].guess = smoothed.pose;
        if !smoothed.picture_used {
            let picture = tagger.preprocessor.prepare(sequence.load_image(index)?, attitude(index));
            frames[index].fit = tagger.refit(&picture, smoothed.pose, attitude(index));
        }
    }
    Ok(smooth_trajectory(&frames, tagger.config.tolerance, tagger.config.filter.noise))
}

fn sequence_attitude(sequence: &Sequence, index: usize) -> Attitude {
    let record = &sequence.frames[index];
    Attitude {
        height_m: sequence.setup.mount_height_m,
        pitch_rad: record.pitch_rad,
        roll_rad: record.roll_rad,
    }
}

/// What the robot knew when it took a picture of a sequence.
pub fn recorded(sequence: &Sequence, index: usize, picture: &Arc<RgbImage>) -> Recorded {
    Recorded {
        picture: picture.clone(),
        odometry: sequence.frames[index].odometry,
        attitude: sequence_attitude(sequence, index),
    }
}

#[cfg(test)]
mod tests;
