//! What a recording says of the calibration that it was localized with: how far lens and mount seem to be off, and what that does to
//! the poses. A calibration that is stated without its uncertainty is then not taken as exact.

use std::sync::Arc;

use nalgebra::DVector;
use rayon::prelude::*;
use reality_sim_core::{
    camera::Camera,
    localization::{LocalizedFrame, mount_of_frame},
    pose::CameraPose,
    preprocess::Preprocessor,
    refine::{CalibrationUncertainty, RefineConfig},
    sequence::{Sequence, SequenceError},
};

use crate::{
    adjust::{Adjusted, View},
    calibration::{noise_of_mount, of_all_parameters},
    noise::Noise,
    parameter::Parameter,
    picture::{Lines, Picture},
    selection::{self, Recorded},
    state::State,
};

/// Largest number of pictures that are looked at: they are spread over the recording, and an assessment need not be exact.
const MOST_PICTURES: usize = 60;

/// Smallest number of pictures that say anything of the calibration.
const LEAST_PICTURES: usize = 8;

/// Search ranges, pixels: the poses are fits already.
const SEARCH_PX: [f64; 4] = [6.0, 5.0, 4.0, 4.0];

/// What a recording says of its calibration.
#[derive(Debug, Clone)]
pub struct Assessment {
    /// Uncertainty of lens and mount as stated: how far the recording contradicts them, and how well it can tell.
    pub uncertainty: CalibrationUncertainty,
    /// Parameters that the recording contradicts, with what it finds minus what is stated, and the standard deviation of that.
    pub shifts: Vec<Shift>,
}

/// Difference between what a recording finds of a parameter and what is stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shift {
    /// Parameter of lens or mount.
    pub parameter: Parameter,
    /// What the recording finds minus what is stated, in the parameter's unit.
    pub by: f64,
    /// Standard deviation of that.
    pub sigma: f64,
}

/// Assesses the calibration of a recording by the poses that were found for some of its frames (from 0) with it. Returns `None` if
/// too few pictures show enough lines. Fails if a picture cannot be read.
pub fn assess(
    sequence: &Sequence,
    poses: &[(usize, CameraPose)],
) -> Result<Option<Assessment>, Box<SequenceError>> {
    let count = poses.len().min(MOST_PICTURES);
    if count < LEAST_PICTURES {
        return Ok(None);
    }
    let state = State {
        camera: sequence.setup.camera.clone(),
        height_m: sequence.setup.mount_height_m,
        pitch_rad: 0.0,
        roll_rad: 0.0,
    };
    let preprocessor = Preprocessor::new(&state.camera, sequence.field.line_width_m);
    let chosen = (0..count).into_par_iter().map(|index| poses[index * poses.len() / count]);
    let pictures: Vec<(Picture, CameraPose)> = chosen
        .map(|(frame, pose)| Ok((picture(sequence, &preprocessor, frame)?, pose)))
        .collect::<Result<_, SequenceError>>()?;
    let lines = Lines::new(&sequence.field, RefineConfig::default());
    let views = pictures.iter().map(|(picture, pose)| View { picture, pose: *pose }).collect();
    let recorded =
        Recorded { lines: &lines, views, noise: Noise::unknown(), lens_prior: selection::GIVEN_LENS };
    let parameters = selection::usual(&state);
    let adjusted = recorded.adjusted(&state, &parameters, &recorded.views, &SEARCH_PX);
    Ok(adjusted.and_then(|adjusted| assessment(&state, &parameters, &adjusted)))
}

fn picture(sequence: &Sequence, preprocessor: &Preprocessor, frame: usize) -> Result<Picture, SequenceError> {
    let stated = mount_of_frame(sequence, frame);
    let prepared = preprocessor.prepare(Arc::new(sequence.load_image(frame)?), stated);
    Ok(Picture::new(frame, &prepared, stated))
}

fn assessment(stated: &State, parameters: &[Parameter], adjusted: &Adjusted) -> Option<Assessment> {
    if adjusted.used.iter().filter(|used| **used).count() < LEAST_PICTURES {
        return None;
    }
    let covariance = adjusted.covariance()?;
    let by = |parameter: &Parameter| adjusted.state.value(*parameter) - stated.value(*parameter);
    let shift = DVector::from_iterator(parameters.len(), parameters.iter().map(by));
    // The stated values are off by the shift, which is itself uncertain.
    let about_stated = &covariance + &shift * shift.transpose();
    let shifts = parameters.iter().enumerate().map(|(index, &parameter)| Shift {
        parameter,
        by: shift[index],
        sigma: covariance[(index, index)].sqrt(),
    });
    let camera: &Camera = &stated.camera;
    let uncertainty =
        CalibrationUncertainty::new(camera, of_all_parameters(camera, parameters, &about_stated));
    Some(Assessment {
        uncertainty: uncertainty.ok()?.with_mount_sigma(noise_of_mount(&adjusted.noise)),
        shifts: shifts.collect(),
    })
}

/// Makes what the calibration is worth a part of the covariances of localized frames, one for each frame of the sequence from the first
/// on, where the sequence does not state it itself. Returns the assessment, if one could be made. Fails if a picture cannot be read.
pub fn assess_frames(
    sequence: &Sequence,
    frames: &mut [LocalizedFrame],
) -> Result<Option<Assessment>, Box<SequenceError>> {
    if sequence.calibration.is_some() {
        return Ok(None);
    }
    let fitted = frames.iter().enumerate().filter(|(_, frame)| frame.settled);
    let poses: Vec<(usize, CameraPose)> =
        fitted.filter_map(|(index, frame)| Some((index, frame.fit?.pose))).collect();
    let assessment = assess(sequence, &poses)?;
    if let Some(Assessment { uncertainty, .. }) = &assessment {
        for frame in frames {
            frame.fit = frame.fit.map(|fit| fit.with_calibration(Some(uncertainty)));
        }
    }
    Ok(assessment)
}
