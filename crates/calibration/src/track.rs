//! Poses of the whole recording with a lens that nearly fits.

use reality_sim_core::{
    field::FieldDimensions,
    localization::{LocalizedFrame, Localizer, Observation, mount_of_frame},
    pose::CameraPose,
    preprocess::Preprocessor,
    sequence::Sequence,
};

use crate::{error::CalibrationError, picture::Picture, state::State};

/// Least fraction of the lines in view, and of the white lines in the picture, that agree with a pose that is used.
const LEAST_AGREEMENT: f64 = 0.4;

/// A picture and its pose.
#[derive(Debug, Clone)]
pub(crate) struct Placed {
    pub picture: Picture,
    pub pose: CameraPose,
}

/// Localizes some frames of a recording, in their order, without a start pose; calls `done` after each. Returns those whose
/// pose explains the picture. Fails if a picture cannot be read.
pub(crate) fn track(
    sequence: &Sequence,
    state: &State,
    frames: &[usize],
    done: &mut dyn FnMut(),
) -> Result<Vec<Placed>, CalibrationError> {
    let field: &FieldDimensions = &sequence.field;
    let mut localizer = Localizer::builder(&state.camera, field).build()?;
    let preprocessor = Preprocessor::new(&state.camera, field.line_width_m);
    let mut placed = Vec::new();
    for &frame in frames {
        let pixels = std::sync::Arc::new(sequence.load_image(frame)?);
        let stated = mount_of_frame(sequence, frame);
        let mount = state.mount_pose(stated);
        let record = &sequence.frames[frame];
        let observation = Observation {
            odometry: record.odometry,
            ..Observation::new(record.timestamp_s, pixels.clone(), mount)
        };
        let localized = localizer.update(&observation)?;
        done();
        if is_right(&localized) {
            let prepared = preprocessor.prepare(pixels, mount);
            let picture = Picture::new(frame, &prepared, stated);
            placed.push(Placed { picture, pose: localized.pose });
        }
    }
    Ok(placed)
}

fn is_right(localized: &LocalizedFrame) -> bool {
    localized.fit.is_some()
        && localized.line_fraction >= LEAST_AGREEMENT
        && localized.explained_fraction >= LEAST_AGREEMENT
}
