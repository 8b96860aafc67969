//! Controls on a recording of one's own: the recording as it would be if an effect of a given size were hidden in it.
//!
//! Effects of the light, the sensor and the encoding are hidden in the pictures, by the forward model; those of the lens, the
//! mount, the field and the clock in the files, which then lack what the pictures show; those of the odometry in its steps. Which of
//! these it is follows from the effect's own hooks.

mod error;
mod pictures;

use reality_sim_core::{
    pose::Pose2,
    sequence::{FrameRecord, Sequence},
};
use reality_sim_sensor::{Chain, Effect, Model, Parameter, Redevelopment, Role};
use tempfile::TempDir;

pub use self::error::InjectionError;
use crate::{linear_model::initial_values::starting_values, recording::Recording};

/// Recording in which an effect is hidden. Its pictures, where they are changed, lie in a temporary folder, which is removed
/// with it.
#[derive(Debug)]
pub struct InjectedRecording {
    /// The recording, with its reference poses.
    pub sequence: Sequence,
    _folder: Option<TempDir>,
}

/// Returns the parameter that the size of an effect refers to: the most important one.
pub fn injected_parameter(effect: &dyn Effect) -> Option<&'static Parameter> {
    effect.parameters().iter().find(|parameter| parameter.role == Role::Size)
}

/// Hides an effect in a recording: its first size has this value, the others are neutral; of an effect that changes over time, the
/// sizes grow to this value from the first to the last.
///
/// # Errors
///
/// Returns an error if the effect cannot be hidden in files or finished pictures, or if the size is impossible.
pub fn inject(
    recording: &Recording<'_>,
    effect: &'static dyn Effect,
    size: f64,
) -> Result<InjectedRecording, InjectionError> {
    let (id, sequence) = (effect.id(), with_own_poses(recording));
    let parameter = injected_parameter(effect).ok_or(InjectionError::NothingToChange { id })?;
    let Parameter { name, neutral, range, .. } = *parameter;
    if !(range[0]..=range[1]).contains(&size) || size == neutral {
        return Err(InjectionError::Size { id, parameter: name, range, neutral });
    }
    let model = |size: f64| Model::default().with(effect, values(recording, effect, size));
    let hidden = Chain::new(&sequence.setup, &sequence.field, &model(size))?;
    if hidden.has_row_times() || hidden.exposure_s() > 0.0 {
        return Err(InjectionError::WhileExposed { id });
    }
    // What the files lack is the opposite: the effect brings it back.
    let opposite = model(2.0 * neutral - size).correct(&sequence)?;
    let mut changed = Sequence { corrected_by: sequence.corrected_by.clone(), ..opposite };
    changed.frames = with_odometry(changed.frames, &sequence, &hidden);
    let nominal = Chain::nominal(&sequence.setup, &sequence.field);
    let redevelopment = Redevelopment { recorded: &nominal, other: &hidden };
    let times_s: Vec<f64> = sequence.frames.iter().map(|frame| frame.timestamp_s).collect();
    let mut folder = None;
    if redevelopment.changes(&times_s) {
        folder = Some(pictures::with(&sequence, &redevelopment, &mut changed)?);
    } else if changed == sequence {
        return Err(InjectionError::NothingToChange { id });
    }
    Ok(InjectedRecording { sequence: changed, _folder: folder })
}

/// Returns the recording's sequence, with the poses that the recording was made with as its own.
fn with_own_poses(recording: &Recording<'_>) -> Sequence {
    let mut sequence = recording.sequence.clone();
    for frame in &mut sequence.frames {
        frame.reference_pose = None;
    }
    for frame in &recording.frames {
        let pose = recording.trajectory.at(frame.time_s);
        sequence.frames[frame.index_in_sequence].reference_pose = Some(pose);
    }
    sequence
}

/// Returns the values of an effect's parameters.
fn values(recording: &Recording<'_>, effect: &'static dyn Effect, size: f64) -> Vec<f64> {
    let mut values = starting_values(effect, recording);
    let parameters = effect.parameters().iter().enumerate();
    let sizes: Vec<(usize, &Parameter)> =
        parameters.filter(|(_, parameter)| parameter.role == Role::Size).collect();
    if effect.about().varies_over_time && sizes.len() > 2 {
        for (step, (index, parameter)) in sizes.iter().enumerate() {
            let part = (step + 1) as f64 / sizes.len() as f64;
            values[*index] = parameter.neutral + part * (size - parameter.neutral);
        }
    } else if let Some((index, _)) = sizes.first() {
        values[*index] = size;
    }
    values
}

/// Returns frames with every step of a sequence's odometry as the effect makes it.
fn with_odometry(mut frames: Vec<FrameRecord>, sequence: &Sequence, hidden: &Chain) -> Vec<FrameRecord> {
    let mut last: Option<(f64, Pose2, Pose2)> = None;
    for (frame, recorded) in frames.iter_mut().zip(&sequence.frames) {
        let Some(stated) = recorded.odometry else { continue };
        let reported = last.map_or(stated, |(time_s, from, to)| {
            let motion = from.motion_to(stated);
            let reported = hidden.odometry(motion, recorded.timestamp_s - time_s);
            // Where nothing changes, no rounding changes the numbers of the file.
            if reported == motion && from == to { stated } else { to.moved(reported) }
        });
        frame.odometry = Some(reported);
        last = Some((recorded.timestamp_s, stated, reported));
    }
    frames
}

#[cfg(test)]
mod tests;
