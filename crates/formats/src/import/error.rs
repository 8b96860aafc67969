//! Errors of imports: the message says in one line what is wrong and what to do.

use std::path::PathBuf;

use reality_sim_core::sequence::{Printable, SequenceError, on_one_line};

use crate::{
    log::LogError,
    message::{CalibrationFault, PixelFault},
};

/// Reason why an import fails.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The log cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The log lacks something that a sequence needs.
    #[error("{}: {lack}", Printable(.path))]
    Lack {
        /// Path of the log.
        path: PathBuf,
        /// What it lacks, and what to do.
        lack: Lack,
    },
    /// A file of the sequence cannot be written.
    #[error(transparent)]
    Sequence(Box<SequenceError>),
}

impl From<SequenceError> for ImportError {
    fn from(error: SequenceError) -> Self {
        Self::Sequence(Box::new(error))
    }
}

/// What a log lacks.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Lack {
    /// Several topics may be meant.
    #[error("{} topics may be the {what}: choose one by {flag}: {}", .candidates.len(), list(.candidates))]
    Ambiguous {
        /// What is wanted.
        what: &'static str,
        /// Option that chooses.
        flag: &'static str,
        /// Names of the topics.
        candidates: Vec<String>,
    },
    /// The topic that an option names is not there.
    #[error("{flag}: there is no topic {} of this kind, but {}", on_one_line(.topic), list(.candidates))]
    NoSuchTopic {
        /// Option that names it.
        flag: &'static str,
        /// Name that was given.
        topic: String,
        /// Topics that could be meant.
        candidates: Vec<String>,
    },
    /// There are no pictures.
    #[error("no topic holds pictures: `reality-sim info` lists what there is")]
    NoPictureTopic,
    /// No picture can be used.
    #[error("none of {count} messages on {} is a picture that can be used: {}", on_one_line(.topic), on_one_line(.reason))]
    NoPicture {
        /// Topic of the pictures.
        topic: String,
        /// Number of its messages.
        count: usize,
        /// What is wrong with the first.
        reason: String,
    },
    /// There is no calibration.
    #[error(
        "no topic holds the camera's calibration: give a camera.toml by --camera, or `reality-sim import` the log and find the camera with `reality-sim calibrate`"
    )]
    NoCalibration,
    /// The calibration cannot be used.
    #[error("the calibration on topic {} {fault}", on_one_line(.topic))]
    Calibration {
        /// Topic of the calibration.
        topic: String,
        /// What is wrong with it.
        fault: CalibrationFault,
    },
    /// The calibration is of pictures of another size.
    #[error("the calibration is of {} × {} pixels, the pictures on {} have {} × {}: choose another by --camera-info, or give a camera.toml by --camera", .calibration[0], .calibration[1], on_one_line(.topic), .pictures[0], .pictures[1])]
    OtherSize {
        /// Size by the calibration, pixels.
        calibration: [u32; 2],
        /// Size of the pictures, pixels.
        pictures: [u32; 2],
        /// Topic of the pictures.
        topic: String,
    },
    /// Nothing tells pitch and roll of the camera.
    #[error("nothing tells the camera's pitch and roll: it takes an IMU with orientation (--imu), tf up to the camera's frame {} (--camera-frame), or joints with a robot_description", frame_name(.frame))]
    NoAttitude {
        /// Frame of the camera; empty if the pictures do not say.
        frame: String,
    },
    /// Nothing tells the height of the camera.
    #[error(
        "nothing tells the camera's height above the carpet: give `import` the height by --height-m, or calibrate the sequence that it makes (`reality-sim calibrate`)"
    )]
    NoHeight,
    /// No frame has all that it needs.
    #[error(
        "none of {frames} frames has {what} within {tolerance_s} s: check the clocks, or widen --tolerance-s"
    )]
    NothingMatched {
        /// Number of pictures.
        frames: usize,
        /// What is missing.
        what: &'static str,
        /// Tolerance, seconds.
        tolerance_s: f64,
    },
}

fn list(names: &[String]) -> String {
    if names.is_empty() {
        return "none that is".to_owned();
    }
    names.iter().map(|name| on_one_line(name)).collect::<Vec<_>>().join(", ")
}

fn frame_name(frame: &str) -> String {
    if frame.is_empty() { "(the pictures name none)".to_owned() } else { on_one_line(frame) }
}

/// Reason why one picture cannot be used.
#[derive(Debug, Clone, thiserror::Error)]
pub enum PictureFault {
    /// The message is damaged.
    #[error("the message is damaged, or its definition is of another version")]
    Damaged,
    /// The file is in a format that is not read.
    #[error("the format `{}` is not read: record JPEG, PNG or raw pictures", on_one_line(.0))]
    Format(String),
    /// The pixels cannot be read.
    #[error("{0}")]
    Pixels(#[from] PixelFault),
    /// The picture has another size than those before it.
    #[error("has {} × {} pixels, those before it {} × {}", .found[0], .found[1], .usual[0], .usual[1])]
    Size {
        /// Size of the picture, pixels.
        found: [u32; 2],
        /// Size of the others, pixels.
        usual: [u32; 2],
    },
}
