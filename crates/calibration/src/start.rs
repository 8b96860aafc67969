//! First guess: focal length, height and some poses, from next to nothing. A lens that is off by a few per cent still puts
//! most lines of a field near lines of the picture, at one pose; one that is off by more puts them nowhere. So a grid of focal
//! lengths and heights is tried, each by searching the whole field for the poses of a few pictures.

use std::sync::Arc;

use image::RgbImage;
use rayon::prelude::*;
use reality_sim_core::{
    backend::CpuBackend,
    field::FieldDimensions,
    mount::{MountPose, MountPoseSigma},
    pose::CameraPose,
    preprocess::Preprocessor,
    refine::{RefineConfig, Refiner},
    search::{GlobalSearch, SearchConfig},
    statistics::median,
};

use crate::{
    adjust::{Adjusted, Adjustment, Prior, View},
    error::CalibrationError,
    noise::Noise,
    parameter::Parameter,
    picture::{Lines, Picture},
    state::State,
};

/// Focal lengths that are tried, as factors of the guess: "about 150°" was said of a lens of 193°.
const FOCAL_FACTORS: [f64; 7] = [0.66, 0.75, 0.85, 0.95, 1.06, 1.2, 1.35];

/// Heights that are tried if none is known, metres: from the smallest robots to adult-sized ones, each a sixth above the last.
const HEIGHTS_M: [f64; 12] = [0.25, 0.3, 0.36, 0.43, 0.5, 0.58, 0.68, 0.8, 0.95, 1.1, 1.3, 1.55];

/// Heights that are tried around a stated one, as factors.
const HEIGHT_FACTORS: [f64; 3] = [0.87, 1.0, 1.15];

/// Numbers of candidates that go on to the next stage, and numbers of pictures that decide it.
const STAGES: [(usize, usize); 3] = [(10, 3), (4, 6), (2, 10)];

/// Uncertainty of the mount pose in searches with a lens and a mount that are guesses: 3 cm of 0.5 m, and 2°.
const ANGLE_SIGMA_RAD: f64 = 0.03;
const HEIGHT_SIGMA: f64 = 0.06;

/// Least fraction of the white lines that a pose must explain to be used for the next guess.
const LEAST_EXPLAINED: f64 = 0.55;

/// What is known before the pictures are looked at.
#[derive(Debug, Clone)]
pub(crate) struct Guess {
    /// Lens, with a height, and no turn of the mount.
    pub state: State,
    /// Whether the lens is a guess, or does not fit.
    pub lens_is_guessed: bool,
    /// Whether the height is unknown.
    pub height_is_guessed: bool,
}

impl Guess {
    fn candidates(&self) -> Vec<State> {
        let heights_m: Vec<f64> = match self.height_is_guessed {
            true => HEIGHTS_M.to_vec(),
            false => HEIGHT_FACTORS.iter().map(|factor| factor * self.state.height_m).collect(),
        };
        let scaled = |factor: f64| {
            let mut state = self.state.clone();
            state.camera.fx *= factor;
            state.camera.fy *= factor;
            state
        };
        let focal_factors: &[f64] = if self.lens_is_guessed { &FOCAL_FACTORS } else { &[1.0] };
        let states = focal_factors.iter().map(|factor| scaled(*factor));
        states
            .flat_map(|state| heights_m.iter().map(move |&height_m| State { height_m, ..state.clone() }))
            .collect()
    }
}

/// Picture of the recording with what the recording states of it.
#[derive(Debug, Clone)]
pub(crate) struct Taken {
    pub frame: usize,
    pub pixels: Arc<RgbImage>,
    pub stated: MountPose,
}

/// Pose found for a picture, and how well it fits.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    pub picture: Picture,
    pub pose: CameraPose,
    pub log_weight: f64,
    pub explained: f64,
}

/// State that is tried, with the poses found for some pictures.
#[derive(Debug, Clone)]
struct Candidate {
    state: State,
    found: Vec<Found>,
}

impl Candidate {
    fn score(&self) -> f64 {
        self.found.iter().map(|found| found.log_weight).sum()
    }
}

/// Returns the state that explains the pictures best. Fails if none explains them.
pub(crate) fn find(
    guess: &Guess,
    pictures: &[Taken],
    field: &FieldDimensions,
    lines: &Lines,
) -> Result<State, CalibrationError> {
    let tried = |state: State, count: usize, config: SearchConfig| {
        let count = count.min(pictures.len());
        let spread = (0..count).map(|index| &pictures[index * pictures.len() / count]);
        let found = search(&state, field, config, spread);
        Candidate { state, found }
    };
    let mut config = quick();
    let mut states = guess.candidates();
    for (kept, count) in STAGES {
        let mut candidates: Vec<Candidate> =
            states.into_par_iter().map(|state| tried(state, count, config)).collect();
        config = SearchConfig::default();
        candidates.sort_by(|a, b| b.score().total_cmp(&a.score()));
        candidates.truncate(kept);
        states = candidates.iter().map(|candidate| improved(candidate, lines)).collect();
    }
    let mut candidates: Vec<Candidate> =
        states.into_par_iter().map(|state| tried(state, pictures.len(), config)).collect();
    candidates.sort_by(|a, b| b.score().total_cmp(&a.score()));
    let nothing = CalibrationError::NothingFits { explained: 0.0 };
    let best = candidates.into_iter().next().ok_or(nothing)?;
    let explained = median(best.found.iter().map(|found| found.explained));
    if explained < LEAST_EXPLAINED {
        return Err(CalibrationError::NothingFits { explained });
    }
    Ok(improved(&best, lines))
}

/// Returns the settings of a search that only has to tell lenses which are far off from one that is not.
fn quick() -> SearchConfig {
    SearchConfig::default().with_kept_poses(20).with_far_places(2).with_fitted_places(6)
}

/// Searches the field for the poses of pictures.
fn search<'a>(
    state: &State,
    field: &FieldDimensions,
    config: SearchConfig,
    pictures: impl Iterator<Item = &'a Taken>,
) -> Vec<Found> {
    let sigma = MountPoseSigma { height_m: HEIGHT_SIGMA * state.height_m, angle_rad: ANGLE_SIGMA_RAD };
    let refiner = Refiner::new(&state.camera, field, RefineConfig::default(), sigma);
    // This processor does not fail.
    let search = GlobalSearch::with_backend(&state.camera, field, config, refiner, &CpuBackend);
    let Ok(mut search) = search else { return Vec::new() };
    let preprocessor = Preprocessor::new(&state.camera, field.line_width_m);
    let mut found = Vec::new();
    for taken in pictures {
        let mount = state.mount_pose(taken.stated);
        let prepared = preprocessor.prepare(taken.pixels.clone(), mount);
        let Ok(modes) = search.search(&prepared, mount, None, 0) else { continue };
        let Some(best) = modes.first() else { continue };
        let picture = Picture::new(taken.frame, &prepared, taken.stated);
        let explained = search.explained_fraction(best.pose);
        found.push(Found { picture, pose: best.pose, log_weight: best.log_weight, explained });
    }
    found
}

/// Returns a candidate's state adjusted to the poses that explain their pictures; as it is if there are none.
fn improved(candidate: &Candidate, lines: &Lines) -> State {
    let explains = |found: &&Found| found.explained > LEAST_EXPLAINED;
    let views: Vec<View<'_>> = candidate
        .found
        .iter()
        .filter(explains)
        .map(|found| View { picture: &found.picture, pose: found.pose })
        .collect();
    let parameters = first_parameters(&candidate.state);
    let prior = Prior::around(&candidate.state, &parameters);
    let adjustment = Adjustment { lines, parameters: &parameters, prior, noise: Noise::unknown() };
    let adjusted = adjustment.run(&candidate.state, &views, &[16.0, 12.0, 10.0, 8.0, 8.0]);
    adjusted.map_or_else(|| candidate.state.clone(), |Adjusted { state, .. }| state)
}

/// Returns the parameters without which nothing fits.
fn first_parameters(state: &State) -> Vec<Parameter> {
    let mut parameters =
        vec![Parameter::FocalLength, Parameter::Height, Parameter::MountPitch, Parameter::MountRoll];
    if !state.camera.distortion.parameters().is_empty() {
        parameters.push(Parameter::Distortion(0));
    }
    parameters
}
