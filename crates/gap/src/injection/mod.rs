//! Controls on a recording of one's own: the recording as it would be if an effect of a given size were hidden in it.
//!
//! Effects of the light, the sensor and the encoding are hidden in the pictures, by the forward model; those of the lens, the
//! mount, the field, the clock and the odometry in the files, which then lack what the pictures show. Which of the two it is
//! follows from the effect's own hooks.

mod files;
mod pictures;

use reality_sim_core::{pose::CameraPose, sequence::Sequence, sequence::SequenceError};
use reality_sim_sensor::{Chain, Effect, Model, ModelError, Parameter, Redevelopment, Role};
use tempfile::TempDir;

use crate::linear_model::initial_values::values_between;

/// Reason why an effect cannot be hidden in a recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InjectionError {
    /// The effect shows while a row is exposed: neither files nor finished pictures can be given it.
    #[error("{id}: cannot be hidden in finished pictures: it acts while they are exposed")]
    WhileExposed {
        /// Id of the effect.
        id: &'static str,
    },
    /// The size is outside the range of the effect's parameter, or neutral.
    #[error("{id}: {parameter} has to be from {} to {} and other than {neutral}", .range[0], .range[1])]
    Size {
        /// Id of the effect.
        id: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// Smallest and largest value.
        range: [f64; 2],
        /// Value at which the effect vanishes.
        neutral: f64,
    },
    /// The recording does not have what the effect changes.
    #[error("{id}: the recording has nothing that it would change")]
    NothingToChange {
        /// Id of the effect.
        id: &'static str,
    },
    /// The size leaves no valid camera.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A picture cannot be read or written.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// There is no room for pictures.
    #[error("no folder for pictures can be made ({0}): check the temporary folder")]
    Folder(#[source] std::io::Error),
}

/// Recording in which an effect is hidden. Its pictures, where they are changed, lie in a temporary folder, which is removed
/// with it.
#[derive(Debug)]
pub struct InjectedRecording {
    /// The recording.
    pub sequence: Sequence,
    /// Reference poses of its frames.
    pub poses: Vec<Option<CameraPose>>,
    _folder: Option<TempDir>,
}

/// Returns the parameter that the size of an effect refers to: the most important one.
pub fn injected_parameter(effect: &dyn Effect) -> Option<&'static Parameter> {
    effect.parameters().iter().find(|parameter| parameter.role == Role::Size)
}

/// Hides an effect in a recording: its first size has this value, the others are neutral. `poses` has one entry for each frame
/// of the sequence.
///
/// # Errors
///
/// Returns an error if the effect cannot be hidden in files or finished pictures, or if the size is impossible.
pub fn inject(
    sequence: &Sequence,
    poses: &[Option<CameraPose>],
    effect: &'static dyn Effect,
    size: f64,
) -> Result<InjectedRecording, InjectionError> {
    let id = effect.id();
    let parameter = injected_parameter(effect).ok_or(InjectionError::NothingToChange { id })?;
    let Parameter { name, neutral, range, .. } = *parameter;
    if !(range[0]..=range[1]).contains(&size) || size == neutral {
        return Err(InjectionError::Size { id, parameter: name, range, neutral });
    }
    let chain = |size: f64| chain_with(sequence, effect, parameter, size);
    let hidden = chain(size)?;
    if hidden.has_row_times() || hidden.exposure_s() > 0.0 {
        return Err(InjectionError::WhileExposed { id });
    }
    // What the files lack is the opposite: the effect brings it back.
    let mut changed = files::without(sequence, poses, &chain(2.0 * neutral - size)?, &hidden);
    let nominal = Chain::nominal(&sequence.setup, &sequence.field);
    let redevelopment = Redevelopment { recorded: &nominal, other: &hidden };
    let times_s: Vec<f64> = sequence.frames.iter().map(|frame| frame.timestamp_s).collect();
    let mut folder = None;
    if redevelopment.changes(&times_s) {
        folder = Some(pictures::with(sequence, poses, &redevelopment, &mut changed.sequence)?);
    } else if changed.sequence == *sequence && changed.poses == poses {
        return Err(InjectionError::NothingToChange { id });
    }
    Ok(InjectedRecording { sequence: changed.sequence, poses: changed.poses, _folder: folder })
}

/// Returns the camera of a recording with one effect, whose first size has this value.
fn chain_with(
    sequence: &Sequence,
    effect: &'static dyn Effect,
    parameter: &Parameter,
    size: f64,
) -> Result<Chain, ModelError> {
    let time_s =
        |frame: Option<&reality_sim_core::sequence::FrameRecord>| frame.map(|frame| frame.timestamp_s);
    let mut values =
        values_between(effect, [time_s(sequence.frames.first()), time_s(sequence.frames.last())]);
    let changed = effect.parameters().iter().zip(&mut values).filter(|(one, _)| one.name == parameter.name);
    changed.for_each(|(_, value)| *value = size);
    Chain::new(&sequence.setup, &sequence.field, &Model::default().with(effect, values))
}

#[cfg(test)]
mod tests;
