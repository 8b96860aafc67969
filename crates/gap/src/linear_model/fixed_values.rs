//! Fixed parameters of effects that no fit changes step by step, because what they do is no smooth function of them: the time of
//! a jump, the frequency of a gait. A search tries a few values of them.

use std::{collections::BTreeMap, f64::consts::TAU, sync::PoisonError};

use reality_sim_core::{pose::CameraPose, statistics::median};
use reality_sim_sensor::{Effect, Role};

use crate::{
    recording::{Frame, Recording},
    thresholds::Thresholds,
};

/// Times of a jump that are tried.
const TIMES: usize = Thresholds::DEFAULT.workflow.jump_times;

/// Returns the value of a fixed parameter: the one that a search found, or the first that it would try.
pub(super) fn fixed_value(recording: &Recording<'_>, name: &str) -> f64 {
    let searched = recording.searched.read().unwrap_or_else(PoisonError::into_inner);
    searched.get(name).copied().unwrap_or_else(|| candidates(recording, name).first().copied().unwrap_or(0.0))
}

/// Sets the values that a search found, by the parameters' names.
pub(crate) fn set_fixed_values(recording: &Recording<'_>, values: BTreeMap<&'static str, f64>) {
    *recording.searched.write().unwrap_or_else(PoisonError::into_inner) = values;
}

/// Returns the number of values among which a search chooses for an effect: as many tests are made.
pub(crate) fn tries(effect: &dyn Effect) -> usize {
    let fixed = effect.parameters().iter().filter(|parameter| parameter.role == Role::Fixed);
    let of = |name: &str| match name {
        "at_s" => TIMES,
        "gait_hz" => SIGNALS.len(),
        _ => 1,
    };
    fixed.map(|parameter| of(parameter.name)).product()
}

/// Returns the values of a fixed parameter that a search tries; none for a parameter that the recording gives.
pub(crate) fn candidates(recording: &Recording<'_>, name: &str) -> Vec<f64> {
    match name {
        "at_s" => between_frames(recording),
        "gait_hz" => SIGNALS.iter().filter_map(|signal| peak_hz(recording, *signal)).collect(),
        _ => Vec::new(),
    }
}

/// Returns times between frames, evenly spread over the recording.
fn between_frames(recording: &Recording<'_>) -> Vec<f64> {
    let frames = recording.frames.as_slice();
    let between = |part: usize| {
        let after = part * frames.len() / (TIMES + 1);
        let before = after.checked_sub(1)?;
        Some(0.5 * (frames.get(before)?.time_s + frames.get(after)?.time_s))
    };
    (1..=TIMES).filter_map(between).collect()
}

/// Number that changes with a robot's steps: of a pose, and of pitch and roll as the robot states them.
type Signal = fn(CameraPose, [f64; 2]) -> f64;

const SIGNALS: [Signal; 5] = [
    |_, [pitch_rad, _]| pitch_rad,
    |pose, _| pose.pitch_rad,
    |pose, _| pose.height_m,
    |_, [_, roll_rad]| roll_rad,
    |pose, _| pose.roll_rad,
];

/// Lowest frequency of steps, hertz: slower changes are no gait.
const LOWEST_HZ: f64 = 0.3;

/// Returns the frequency at which a signal changes most, up to half of the frames' rate: what is faster looks as slow as that.
fn peak_hz(recording: &Recording<'_>, signal: Signal) -> Option<f64> {
    let value = |frame: &Frame| {
        let stated = &recording.sequence.frames[frame.index_in_sequence];
        signal(recording.trajectory.at(frame.time_s), [stated.pitch_rad, stated.roll_rad])
    };
    let frames = recording.frames.as_slice();
    let mean = frames.iter().map(value).sum::<f64>() / frames.len() as f64;
    let samples: Vec<(f64, f64)> = frames.iter().map(|frame| (frame.time_s, value(frame) - mean)).collect();
    let duration_s = samples.last()?.0 - samples.first()?.0;
    let highest_hz = 0.5 / median(samples.windows(2).map(|pair| pair[1].0 - pair[0].0));
    let power = |hz: f64| {
        let sum = |wave: fn(f64) -> f64| -> f64 {
            samples.iter().map(|(time_s, value)| value * wave(TAU * hz * time_s)).sum()
        };
        sum(f64::cos).hypot(sum(f64::sin))
    };
    // A quarter of a turn of phase over the recording.
    let step_hz = 0.25 / duration_s;
    let tried = (0..).map(|step| LOWEST_HZ + f64::from(step) * step_hz).take_while(|hz| *hz < highest_hz);
    tried.max_by(|a, b| power(*a).total_cmp(&power(*b)))
}
