//! Where on the field a picture can have been taken: exhaustive search over all places and headings, then the best
//! places refined. Used for a start nobody knows, and when the filter has lost its way.

use std::f64::consts::TAU;

use glam::DVec2;
use rayon::prelude::*;

use crate::{
    backend::{Backend, BackendError, CpuBackend},
    camera::Camera,
    field::FieldDimensions,
    filter::{FilterConfig, ParticleFilter, PlanarSigma},
    observation::{CpuScorer, ObservationConfig, Scorer},
    pose::{CameraPose, Pose2, wrap_angle},
    preprocess::{Attitude, Prepared},
    refine::{AttitudeTolerance, PoseFit, Reach, RefineConfig, Refiner},
};

/// Grid poses kept for refinement.
const KEPT: usize = 60;
/// Headings of one place that can be among them.
const KEPT_HEADINGS: usize = 4;
/// Places of the grid scored in one go.
const PLACES_AT_ONCE: usize = 1024;
/// Modes that are fitted to a fraction of a pixel before they are ranked.
const FITTED: usize = 24;
/// Least log-probability of a prior.
const PRIOR_FLOOR: f64 = -20.0;
/// A fit may lose this much log-weight, which the particle it starts from was chosen to maximise.
const FIT_MARGIN: f64 = 4.0;
/// Poses nearer than this to a better one belong to it, metres and radians.
const SAME_PLACE: PlanarSigma = PlanarSigma { position_m: 0.35, yaw_rad: 0.25 };
/// A small particle filter, standing still.
#[derive(Debug, Clone, Copy)]
struct Look {
    particles: usize,
    sigma: PlanarSigma,
}

/// Refines each grid pose.
const FIRST_LOOK: Look = Look { particles: 60, sigma: PlanarSigma { position_m: 0.08, yaw_rad: 0.04 } };
/// Looks farther around the best of them: a place where some of the lines fit may be next to the one where all do.
const SECOND_LOOK: Look = Look { particles: 400, sigma: PlanarSigma { position_m: 0.3, yaw_rad: 0.06 } };
/// Modes that get the second look.
const LOOKED_AT_TWICE: usize = 8;
/// Iterations of both.
const LOOK_ITERATIONS: u32 = 6;

/// A place the picture fits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// The pose.
    pub pose: CameraPose,
    /// Log-weight by the contrast model, prior included.
    pub log_weight: f64,
    /// Probability among all modes found.
    pub probability: f64,
    /// The sub-pixel fit that `pose` comes from, where there is one.
    pub fit: Option<PoseFit>,
}

/// What is known before the picture is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Where the camera probably is.
    pub pose: Pose2,
    /// How far from there it may be.
    pub sigma: PlanarSigma,
}

impl Prior {
    /// Log-probability up to a constant; normal, but never below [`PRIOR_FLOOR`]: a clear picture outweighs a wrong
    /// prior.
    pub(crate) fn log_probability(&self, pose: Pose2) -> f64 {
        let place =
            (pose.position_in_world() - self.pose.position_in_world()).length() / self.sigma.position_m;
        let turn = wrap_angle(pose.yaw_rad - self.pose.yaw_rad) / self.sigma.yaw_rad;
        (-0.5 * (place * place + turn * turn)).max(PRIOR_FLOOR)
    }
}

/// Places and headings over the whole carpet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchGrid {
    /// Between neighbouring places along x and y, metres; a little less where the carpet's size is no multiple of it.
    pub step_m: f64,
    /// Headings at every place.
    pub headings: u32,
}

impl SearchGrid {
    /// As fine as the grid's score asks for on this field.
    pub fn new(field: &FieldDimensions) -> Self {
        Self { step_m: (2.0 * field.line_width_m).max(0.1), headings: 120 }
    }

    /// All places, column after column.
    pub fn places(&self, field: &FieldDimensions) -> Vec<DVec2> {
        let half_extent = field.carpet_half_extent_m();
        let along = |half: f64| {
            let steps = (2.0 * half / self.step_m).ceil().max(1.0);
            (0..=steps as u32).map(move |index| -half + 2.0 * half * f64::from(index) / steps)
        };
        along(half_extent.x).flat_map(|x| along(half_extent.y).map(move |y| DVec2::new(x, y))).collect()
    }

    fn poses_at(&self, place: DVec2) -> impl Iterator<Item = Pose2> {
        (0..self.headings).map(move |heading| {
            let yaw_rad = wrap_angle(TAU * f64::from(heading) / f64::from(self.headings));
            Pose2::new(place.x, place.y, yaw_rad)
        })
    }
}

/// Searches the whole field in pictures of one camera.
pub struct GlobalSearch {
    grid: SearchGrid,
    grid_scorer: Box<dyn Scorer>,
    scorer: CpuScorer,
    white_contrast: f64,
    field: FieldDimensions,
    refiner: Refiner,
    tolerance: AttitudeTolerance,
}

impl std::fmt::Debug for GlobalSearch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("GlobalSearch").field("tolerance", &self.tolerance).finish_non_exhaustive()
    }
}

impl GlobalSearch {
    /// Prepares the search on this processor.
    pub fn new(camera: &Camera, field: &FieldDimensions, tolerance: AttitudeTolerance) -> Self {
        Self::with_backend(camera, field, tolerance, &CpuBackend)
            .unwrap_or_else(|error| unreachable!("this processor never fails: {error}"))
    }

    /// As [`GlobalSearch::new`], with the grid scored on the device of a backend.
    pub fn with_backend(
        camera: &Camera,
        field: &FieldDimensions,
        tolerance: AttitudeTolerance,
        backend: &dyn Backend,
    ) -> Result<Self, BackendError> {
        Ok(Self {
            grid: SearchGrid::new(field),
            grid_scorer: backend.scorer(camera, field, ObservationConfig::grid(field))?,
            scorer: CpuScorer::new(camera, field, ObservationConfig::coarse_contrast()),
            white_contrast: 1.0,
            field: field.clone(),
            refiner: Refiner::new(camera, field, RefineConfig { tolerance, ..RefineConfig::default() }),
            tolerance,
        })
    }

    /// Another grid.
    pub fn set_grid(&mut self, grid: SearchGrid) {
        self.grid = grid;
    }

    /// Takes over a new picture for what needs no search.
    pub fn load(&mut self, picture: &Prepared) {
        self.scorer.load(picture);
        self.white_contrast = f64::from(picture.levels.contrast());
    }

    /// Fraction of the line in view that the picture shows where the pose puts it, see [`CpuScorer::line_fraction`]; 0
    /// where no line is in view.
    pub fn line_fraction(&self, pose: CameraPose) -> f64 {
        self.scorer.line_fraction(pose).unwrap_or(0.0)
    }

    /// The poses the picture fits, best first. A field with equal halves fits every pose and its mirror image alike:
    /// without a prior only one of the two is searched, with one the prior decides.
    pub fn search(
        &mut self,
        picture: &Prepared,
        attitude: Attitude,
        prior: Option<Prior>,
        seed: u64,
    ) -> Vec<Mode> {
        self.load(picture);
        let mut places = self.best_on_grid(picture, attitude, prior);
        if let Some(prior) = prior {
            places.push(prior.pose);
        }
        let look_around = |places: &[Pose2], look: Look, seed: u64| -> Vec<Mode> {
            let seed_of = |index: usize| seed ^ (index as u64) << 32;
            let found = places.par_iter().enumerate();
            found.map(|(i, place)| self.look(look, *place, attitude, prior, seed_of(i))).collect()
        };
        let mut modes = ranked(look_around(&places, FIRST_LOOK, seed));
        let best: Vec<Pose2> = modes.iter().take(LOOKED_AT_TWICE).map(|mode| mode.pose.planar()).collect();
        modes.extend(look_around(&best, SECOND_LOOK, !seed));
        let mut modes = ranked(modes);
        modes.truncate(FITTED);
        // The place expected gets a fit of its own: the particles around it may have found a worse one.
        modes.extend(prior.map(|known| self.mode(attitude.at(known.pose), attitude, prior)));
        modes.par_iter_mut().for_each(|mode| *mode = self.fitted(*mode, attitude, prior));
        with_probabilities(ranked(modes))
    }

    /// The most probable of some poses, each fitted to the picture loaded or searched last.
    pub fn best_of(&self, poses: &[CameraPose], attitude: Attitude, prior: Option<Prior>) -> Option<Mode> {
        let fitted: Vec<Mode> = poses
            .par_iter()
            .map(|&pose| self.fitted(self.mode(pose, attitude, prior), attitude, prior))
            .collect();
        fitted.into_iter().max_by(|a, b| a.log_weight.total_cmp(&b.log_weight))
    }

    fn fitted(&self, mode: Mode, attitude: Attitude, prior: Option<Prior>) -> Mode {
        // Where lines lie close together, a wide search for them can slip from one to the next; a narrow one stays.
        [Reach::Wide, Reach::Narrow]
            .into_iter()
            .filter_map(|reach| {
                let fit = self.refiner.fit(
                    self.scorer.texture(),
                    mode.pose,
                    attitude,
                    self.white_contrast,
                    reach,
                )?;
                Some(Mode { fit: Some(fit), ..self.mode(fit.pose, attitude, prior) })
            })
            .find(|fitted| fitted.log_weight >= mode.log_weight - FIT_MARGIN)
            .unwrap_or(mode)
    }

    fn mode(&self, pose: CameraPose, attitude: Attitude, prior: Option<Prior>) -> Mode {
        let prior = prior.map_or(0.0, |prior| prior.log_probability(pose.planar()));
        let log_weight = self.scorer.log_weight(&pose) + self.tolerance.log_prior(pose, attitude) + prior;
        Mode { pose, log_weight, probability: 0.0, fit: None }
    }

    /// Scores every pose of the grid, and gives the best that lie apart from each other.
    pub fn best_on_grid(
        &mut self,
        picture: &Prepared,
        attitude: Attitude,
        prior: Option<Prior>,
    ) -> Vec<Pose2> {
        self.grid_scorer.load(picture);
        let mut places = self.grid.places(&self.field);
        if prior.is_none() {
            // The other half of the field looks the same turned by 180°.
            places.retain(|place| place.x <= self.grid.step_m);
        }
        let mut scored: Vec<(Pose2, f64)> = Vec::new();
        // In parts: a fine grid has millions of poses.
        for places in places.chunks(PLACES_AT_ONCE) {
            let poses: Vec<Pose2> = places.iter().flat_map(|&place| self.grid.poses_at(place)).collect();
            let cameras: Vec<CameraPose> = poses.iter().map(|&pose| attitude.at(pose)).collect();
            let log_weights = self.grid_scorer.log_weights(&cameras);
            let headings = self.grid.headings as usize;
            scored.extend(poses.chunks(headings).zip(log_weights.chunks(headings)).flat_map(
                |(poses, scores)| {
                    let prior = |pose: &Pose2| prior.map_or(0.0, |prior| prior.log_probability(*pose));
                    let mut here: Vec<(Pose2, f64)> =
                        poses.iter().zip(scores).map(|(pose, score)| (*pose, score + prior(pose))).collect();
                    here.sort_by(|a, b| b.1.total_cmp(&a.1));
                    here.truncate(KEPT_HEADINGS);
                    here
                },
            ));
        }
        scored.sort_by(|a, b| b.1.total_cmp(&a.1));
        scored.truncate(KEPT * 40);
        let mut places = distinct(scored, |(pose, _)| *pose);
        places.truncate(KEPT);
        places.into_iter().map(|(pose, _)| pose).collect()
    }

    /// The best pose that a small particle filter finds around a place.
    fn look(&self, look: Look, place: Pose2, attitude: Attitude, prior: Option<Prior>, seed: u64) -> Mode {
        let config = FilterConfig {
            particles: look.particles,
            iterations: LOOK_ITERATIONS,
            seed,
            attitude_tolerance: Some(self.tolerance),
            ..FilterConfig::default()
        };
        let mut filter = ParticleFilter::new(config, place, look.sigma);
        let estimate = filter.update(&self.scorer, attitude, look.sigma);
        self.mode(estimate.pose, attitude, prior)
    }
}

/// Best first, one of each place.
fn ranked(mut modes: Vec<Mode>) -> Vec<Mode> {
    modes.sort_by(|a, b| b.log_weight.total_cmp(&a.log_weight));
    distinct(modes, |mode| mode.pose.planar())
}

/// Drops everything near something better; the input is sorted, best first.
fn distinct<T>(sorted: Vec<T>, pose: impl Fn(&T) -> Pose2) -> Vec<T> {
    let mut kept: Vec<T> = Vec::new();
    for item in sorted {
        let here = pose(&item);
        let known = kept.iter().map(&pose).any(|other| {
            (here.position_in_world() - other.position_in_world()).length() < SAME_PLACE.position_m
                && wrap_angle(here.yaw_rad - other.yaw_rad).abs() < SAME_PLACE.yaw_rad
        });
        if !known {
            kept.push(item);
        }
    }
    kept
}

fn with_probabilities(modes: Vec<Mode>) -> Vec<Mode> {
    let log_weights: Vec<f64> = modes.iter().map(|mode| mode.log_weight).collect();
    let weights = crate::filter::normalise(&log_weights);
    modes.into_iter().zip(weights).map(|(mode, probability)| Mode { probability, ..mode }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        filter::{Purpose, Stream},
        preprocess::Preprocessor,
        test_scene,
    };

    /// Guesses far enough away that a fit finds other lines than the right ones.
    #[test]
    fn a_fit_never_explains_the_picture_worse_than_the_pose_it_starts_from() {
        let (camera, field) = (test_scene::fisheye(), test_scene::field());
        let mut search = GlobalSearch::new(&camera, &field, AttitudeTolerance::default());
        let (mut fitted, mut slipped) = (0, 0);
        for (scene, pose) in test_scene::poses().into_iter().enumerate() {
            let attitude = Attitude::of(pose);
            let picture = Preprocessor::new(&camera, field.line_width_m)
                .prepare(test_scene::render(&camera, pose, &field), attitude);
            search.load(&picture);
            let stream = Stream::new(7, Purpose::Initialise, scene as u32, 0);
            for index in 0..40 {
                let normals = stream.normals(index);
                let place = Pose2::new(
                    pose.x_m + 0.2 * normals[0],
                    pose.y_m + 0.2 * normals[1],
                    pose.yaw_rad + 0.1 * normals[2],
                );
                let prior = Prior { pose: place, sigma: PlanarSigma { position_m: 0.05, yaw_rad: 0.03 } };
                let before = search.mode(attitude.at(place), attitude, Some(prior));
                let after = search.best_of(&[before.pose], attitude, Some(prior)).unwrap();
                assert!(after.log_weight >= before.log_weight - FIT_MARGIN, "{before:?} {after:?}");
                fitted += u32::from(after.fit.is_some());
                slipped += u32::from(after.fit.is_none());
            }
        }
        assert!(fitted > 20 && slipped > 5, "both happen: {fitted} fitted, {slipped} slipped");
    }

    #[test]
    fn a_picture_alone_tells_the_place_up_to_the_mirror() {
        let (camera, field) = (test_scene::fisheye(), test_scene::field());
        let mut search = GlobalSearch::new(&camera, &field, AttitudeTolerance::default());
        for pose in test_scene::poses() {
            let attitude = Attitude::of(pose);
            let picture = Preprocessor::new(&camera, field.line_width_m)
                .prepare(test_scene::render(&camera, pose, &field), attitude);
            search.load(&picture);
            let error = |found: CameraPose| {
                (found.x_m - pose.x_m).hypot(found.y_m - pose.y_m)
                    + wrap_angle(found.yaw_rad - pose.yaw_rad).abs()
            };
            let modes = search.search(&picture, attitude, None, 1);
            let best = modes[0].pose;
            assert!(error(best).min(error(best.mirrored())) < 0.05, "{best:?} instead of {pose:?}");
            assert!((modes.iter().map(|mode| mode.probability).sum::<f64>() - 1.0).abs() < 1e-9);

            let prior = Prior {
                pose: pose.planar().mirrored(),
                sigma: PlanarSigma { position_m: 0.5, yaw_rad: 0.5 },
            };
            let modes = search.search(&picture, attitude, Some(prior), 1);
            assert!(error(modes[0].pose.mirrored()) < 0.05, "a prior tells which of the two");
        }
    }
}
