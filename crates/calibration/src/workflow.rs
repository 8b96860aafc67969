//! From a recording to a calibration: first guess, poses, adjustment, choice of the lens's terms, covariances.

use std::{str::FromStr, sync::Arc};

use nalgebra::DMatrix;
use reality_sim_core::{
    camera::{Camera, Distortion, Opencv, OpencvFisheye},
    localization::mount_of_frame,
    mount::MountPose,
    names::{UnknownName, by_name},
    pose::{CameraPose, Pose2},
    preprocess::whiteness,
    refine::RefineConfig,
    sequence::Sequence,
    statistics::median,
};

use crate::{
    adjust::{Adjusted, View},
    advice::{self, Known},
    body_offset::{self, BodyOffset, Pair},
    calibration::Calibration,
    error::CalibrationError,
    noise::Noise,
    parameter::Parameter,
    picture::Lines,
    selection::{self, Recorded},
    start::{self, Guess, Taken},
    state::State,
    track::{Placed, track},
    uncertainty,
};

/// Largest number of pictures that are used, spread over the recording: twice as many take twice as long and make the errors smaller
/// by a third.
const MOST_PICTURES: usize = 150;

/// Smallest number of pictures with which a calibration is attempted: fewer lines than numbers to be found, if each shows a few.
const LEAST_PICTURES: usize = 6;

/// Number of pictures of the first guess.
const FIRST_PICTURES: usize = 16;

/// Part of the pictures that a given lens must place for it to be a start.
const LEAST_PLACED: f64 = 0.4;

/// Number of times that all pictures are placed anew with the lens found so far.
const ROUNDS: usize = 2;

/// Search ranges of the first fit to all pictures, pixels.
const FIRST_SEARCH_PX: [f64; 6] = [12.0, 8.0, 6.0, 5.0, 4.0, 4.0];

/// Search ranges of the last fit, pixels.
const LAST_SEARCH_PX: [f64; 6] = [5.0, 4.0, 4.0, 4.0, 4.0, 4.0];

/// Model of a lens, by COLMAP's names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LensModel {
    /// `OPENCV_FISHEYE`.
    OpencvFisheye,
    /// `OPENCV`.
    Opencv,
    /// `PINHOLE`.
    Pinhole,
}

impl LensModel {
    /// All models.
    pub const ALL: [Self; 3] = [Self::OpencvFisheye, Self::Opencv, Self::Pinhole];

    /// Returns the name that COLMAP gives it.
    pub fn name(self) -> &'static str {
        self.distortion().colmap_name()
    }

    /// Returns the model of a lens.
    pub fn of(distortion: &Distortion) -> Self {
        match distortion {
            Distortion::Pinhole => Self::Pinhole,
            Distortion::Opencv(_) => Self::Opencv,
            Distortion::OpencvFisheye(_) => Self::OpencvFisheye,
        }
    }

    /// Returns the lens without distortion, for a fisheye the equidistant one.
    fn distortion(self) -> Distortion {
        match self {
            Self::OpencvFisheye => Distortion::OpencvFisheye(OpencvFisheye::default()),
            Self::Opencv => Distortion::Opencv(Opencv { k1: 0.0, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0 }),
            Self::Pinhole => Distortion::Pinhole,
        }
    }

    /// Returns the camera with this field of view across the width of pictures of this size (pixels), with the axis in the
    /// middle and no distortion. Fails if there is none.
    pub fn camera(self, [width, height]: [u32; 2], fov_deg: f64) -> Result<Camera, CalibrationError> {
        let half_rad = 0.5 * fov_deg.to_radians();
        let half_width = 0.5 * f64::from(width);
        let focal_px = match self {
            Self::OpencvFisheye => half_width / half_rad,
            Self::Opencv | Self::Pinhole => half_width / half_rad.tan(),
        };
        let middle = [width, height].map(|side| 0.5 * (f64::from(side) - 1.0));
        Camera::new([width, height], [focal_px, focal_px, middle[0], middle[1]], self.distortion())
            .map_err(|reason| CalibrationError::FieldOfView { fov_deg, reason })
    }
}

impl FromStr for LensModel {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        by_name("lens model", &Self::ALL, Self::name, name)
    }
}

/// What of the sequence's camera is trusted as a start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trusted {
    /// The lens is a calibration, not only a guess of the field of view.
    pub lens: bool,
    /// The height was measured.
    pub height: bool,
}

/// Stage of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Focal lengths and heights are tried.
    Guessing,
    /// Pictures are placed: so many of so many.
    Placing(usize, usize),
    /// Lens, mount and poses are adjusted.
    Adjusting,
    /// Numbers of terms are compared.
    CrossValidating,
}

/// Calibrates the camera of a recording from the lines of its field. The sequence's camera and height are the start, as far as
/// they are trusted; its reference poses and its start are not used. `progress` is called with each stage.
///
/// Fails if a picture cannot be read, or if no lens explains the pictures.
pub fn calibrate(
    sequence: &Sequence,
    trusted: Trusted,
    progress: &mut dyn FnMut(Stage),
) -> Result<Calibration, CalibrationError> {
    let lines = Lines::new(&sequence.field, RefineConfig::default());
    let count = sequence.frames.len().min(MOST_PICTURES);
    let frames: Vec<usize> = (0..count).map(|index| index * sequence.frames.len() / count).collect();
    let work = Work { sequence, lines, frames };
    let (state, placed) = work.placed(trusted, progress)?;
    work.calibrated(&state, &placed, trusted, progress)
}

/// A recording that is being calibrated.
struct Work<'a> {
    sequence: &'a Sequence,
    lines: Lines,
    frames: Vec<usize>,
}

impl Work<'_> {
    fn stated(&self) -> State {
        let setup = &self.sequence.setup;
        State { camera: setup.camera.clone(), height_m: setup.mount_height_m, pitch_rad: 0.0, roll_rad: 0.0 }
    }

    /// Returns a state that nearly fits, and the poses of all pictures with it.
    fn placed(
        &self,
        trusted: Trusted,
        progress: &mut dyn FnMut(Stage),
    ) -> Result<(State, Vec<Placed>), CalibrationError> {
        let mut state = self.stated();
        let mut placed = Vec::new();
        if trusted.lens && trusted.height {
            placed = self.track(&state, progress)?;
        }
        if (placed.len() as f64) < LEAST_PLACED * self.frames.len() as f64 {
            state = self.guessed(trusted, progress)?;
            placed = self.track(&state, progress)?;
        }
        for _ in 1..ROUNDS {
            self.check_number(placed.len())?;
            progress(Stage::Adjusting);
            state = self.roughly_adjusted(&state, &placed, trusted)?;
            placed = self.track(&state, progress)?;
        }
        self.check_number(placed.len())?;
        Ok((state, placed))
    }

    fn check_number(&self, usable: usize) -> Result<(), CalibrationError> {
        let (tried, least) = (self.frames.len(), LEAST_PICTURES);
        if usable < least {
            return Err(CalibrationError::TooFewPictures { usable, tried, least });
        }
        Ok(())
    }

    fn track(&self, state: &State, progress: &mut dyn FnMut(Stage)) -> Result<Vec<Placed>, CalibrationError> {
        let mut done = 0;
        track(self.sequence, state, &self.frames, &mut || {
            done += 1;
            progress(Stage::Placing(done, self.frames.len()));
        })
    }

    /// Returns a state that explains some pictures, from little more than their size.
    fn guessed(&self, trusted: Trusted, progress: &mut dyn FnMut(Stage)) -> Result<State, CalibrationError> {
        progress(Stage::Guessing);
        let count = self.frames.len().min(FIRST_PICTURES);
        let taken = (0..count).map(|index| {
            let frame = self.frames[index * self.frames.len() / count];
            let pixels = Arc::new(self.sequence.load_image(frame)?);
            Ok(Taken { frame, pixels, stated: mount_of_frame(self.sequence, frame) })
        });
        let taken: Vec<Taken> = taken.collect::<Result<_, CalibrationError>>()?;
        // A search through black pictures, as behind a lens cap, takes a minute. Those with noise in the dark are searched.
        if taken.iter().all(|taken| whiteness(&taken.pixels).iter().all(|&white| white == 0)) {
            return Err(self.too_few(0));
        }
        let find = |height_is_guessed| {
            // A lens and a height that are both trusted were tried before: one of them is wrong.
            let lens_is_guessed = !trusted.lens || trusted.height;
            let guess = Guess { state: self.stated(), lens_is_guessed, height_is_guessed };
            start::find(&guess, &taken, &self.sequence.field, &self.lines)
        };
        // A stated height may be another robot's.
        match trusted.height {
            true => find(false).or_else(|_| find(true)),
            false => find(true),
        }
    }

    fn recorded<'a>(&'a self, placed: &'a [Placed], noise: Noise, trusted: Trusted) -> Recorded<'a> {
        let view = |placed: &'a Placed| View { picture: &placed.picture, pose: placed.pose };
        let lens_prior = if trusted.lens { selection::GIVEN_LENS } else { 1.0 };
        Recorded { lines: &self.lines, views: placed.iter().map(view).collect(), noise, lens_prior }
    }

    fn roughly_adjusted(
        &self,
        state: &State,
        placed: &[Placed],
        trusted: Trusted,
    ) -> Result<State, CalibrationError> {
        let recorded = self.recorded(placed, Noise::unknown(), trusted);
        let parameters = selection::usual(state);
        let adjusted = recorded.adjusted(state, &parameters, &recorded.views, &FIRST_SEARCH_PX);
        adjusted.map(|adjusted| adjusted.state).ok_or_else(|| self.too_few(0))
    }

    fn too_few(&self, usable: usize) -> CalibrationError {
        CalibrationError::TooFewPictures { usable, tried: self.frames.len(), least: LEAST_PICTURES }
    }

    fn calibrated(
        &self,
        state: &State,
        placed: &[Placed],
        trusted: Trusted,
        progress: &mut dyn FnMut(Stage),
    ) -> Result<Calibration, CalibrationError> {
        progress(Stage::Adjusting);
        let mut recorded = self.recorded(placed, Noise::unknown(), trusted);
        let most = selection::usual(state);
        let adjusted = recorded.adjusted(state, &most, &recorded.views, &FIRST_SEARCH_PX);
        let adjusted = adjusted.ok_or_else(|| self.too_few(0))?;
        recorded.take_over(&adjusted);
        progress(Stage::CrossValidating);
        let compared = selection::compare(&recorded, &adjusted.state);
        let (choices, chosen) = compared.ok_or_else(|| self.too_few(0))?;
        progress(Stage::Adjusting);
        let parameters = choices[chosen].parameters.clone();
        let start = selection::without_others(&adjusted.state, &parameters).unwrap_or(adjusted.state);
        let last = recorded.adjusted(&start, &parameters, &recorded.views, &LAST_SEARCH_PX);
        let last = last.ok_or_else(|| self.too_few(0))?;
        let usable = last.used.iter().filter(|used| **used).count();
        self.check_number(usable)?;
        let covariance = last.covariance().ok_or_else(|| self.too_few(usable))?;
        Ok(self.result(placed, &last, parameters, covariance, (choices, chosen)))
    }

    fn result(
        &self,
        placed: &[Placed],
        last: &Adjusted,
        parameters: Vec<Parameter>,
        covariance: DMatrix<f64>,
        (choices, chosen): (Vec<selection::Choice>, usize),
    ) -> Calibration {
        let stated = placed.iter().map(|placed| placed.picture.stated);
        let known = Known {
            state: &last.state,
            parameters: &parameters,
            covariance: &covariance,
            noise: last.noise,
            usual: usual(stated),
        };
        let poses = self.poses(placed, last);
        Calibration {
            camera: last.state.camera.clone(),
            height_m: last.state.height_m,
            mounting: last.state.mounting(),
            values: parameters.iter().map(|parameter| last.state.value(*parameter)).collect(),
            body_offset: self.body_offset(&poses),
            poses,
            pictures: self.frames.len(),
            noise: last.noise,
            reprojection_px: last.noise.offset_px,
            held_out_px: choices[chosen].held_out_px,
            uncertainty: uncertainty::map(&last.state, &parameters, &covariance, &last.measured),
            advice: advice::advise(&known, &self.lines, &self.sequence.field),
            choices,
            chosen,
            parameters,
            covariance,
        }
    }

    fn poses(&self, placed: &[Placed], adjusted: &Adjusted) -> Vec<(usize, CameraPose)> {
        let all = placed.iter().zip(&adjusted.poses).zip(&adjusted.used);
        all.filter(|(_, used)| **used).map(|((placed, pose), _)| (placed.picture.frame, *pose)).collect()
    }

    /// Estimates where the camera is on the body from neighbouring pictures.
    fn body_offset(&self, poses: &[(usize, CameraPose)]) -> Option<BodyOffset> {
        let odometry = |frame: usize| self.sequence.frames[frame].odometry;
        let step = self.frames.get(1).map_or(1, |second| second - self.frames[0]);
        let pair = |pair: &[(usize, CameraPose)]| {
            let [(first, from), (second, to)] = [pair[0], pair[1]];
            // Over a gap the odometry drifts.
            let is_next = second - first <= step + 1;
            let by_odometry: [Pose2; 2] = [odometry(first)?, odometry(second)?];
            is_next.then(|| Pair::new([from.planar(), to.planar()], by_odometry))
        };
        body_offset::estimate(&poses.windows(2).filter_map(pair).collect::<Vec<_>>())
    }
}

/// Returns the usual one of some mount poses.
fn usual(stated: impl Iterator<Item = MountPose> + Clone) -> MountPose {
    MountPose {
        height_m: median(stated.clone().map(|stated| stated.height_m)),
        pitch_rad: median(stated.clone().map(|stated| stated.pitch_rad)),
        roll_rad: median(stated.map(|stated| stated.roll_rad)),
    }
}
