//! What a pipeline tells while it works.

use reality_sim_core::{localization::LocalizedFrame, pose::CameraPose, warp::Hall};
use reality_sim_db::{IngestReport, PoseEstimate, PoseSource};

/// A step of a pipeline. Recordings count from 0 in the order of the plan.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// The filter begins with a recording of so many frames.
    LocalizationStarted {
        /// Which recording.
        recording: usize,
        /// Its frames.
        frames: usize,
    },
    /// The filter has found a frame's pose.
    Localized {
        /// Which recording.
        recording: usize,
        /// Number of the frame, from 0.
        index: usize,
        /// Frames of the recording.
        of: usize,
        /// What was found.
        frame: Box<LocalizedFrame>,
    },
    /// Smoothing has looked at a picture once more.
    Revisited {
        /// Which recording.
        recording: usize,
        /// Pictures looked at again so far.
        done: usize,
        /// Pictures to look at again.
        of: usize,
    },
    /// The poses of a recording are known.
    PosesFound {
        /// Which recording.
        recording: usize,
        /// The poses.
        poses: FoundPoses,
    },
    /// Storing of a recording of so many frames begins.
    StorageStarted {
        /// Which recording.
        recording: usize,
        /// Its frames.
        frames: usize,
    },
    /// Frames of a recording have been stored, or left out for want of a pose.
    Stored {
        /// Which recording.
        recording: usize,
        /// Frames so far.
        done: usize,
        /// Frames of the recording.
        of: usize,
    },
    /// A recording is in the database.
    Ingested {
        /// Which recording.
        recording: usize,
        /// What became of its frames.
        report: IngestReport,
        /// Time that storing took, seconds.
        seconds: f64,
    },
    /// The hall is being measured.
    HallStarted,
    /// Everything is in the database.
    Completed {
        /// Images in the database now.
        images: usize,
        /// The hall, where it was measured now.
        hall: Option<Hall>,
    },
}

/// The poses of a recording, and where they come from.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundPoses {
    /// What goes into the database, one a frame.
    pub estimates: Vec<Option<PoseEstimate>>,
    /// Frames held back, with their poses.
    pub held_back: Vec<(usize, CameraPose)>,
    /// Where they come from.
    pub source: PoseSource,
}
