//! Events that a pipeline reports while it works.

use reality_sim_core::{localization::LocalizedFrame, pose::CameraPose, warp::Hall};
use reality_sim_db::{IngestReport, PoseEstimate, PoseSource};

/// Step of a pipeline. Recordings are numbered from 0 in the order of the plan.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// The filter starts on a recording with this many frames.
    LocalizationStarted {
        /// Number of the recording.
        recording: usize,
        /// Number of its frames.
        frames: usize,
    },
    /// The filter has estimated a frame's pose.
    Localized {
        /// Number of the recording.
        recording: usize,
        /// Number of the frame, from 0.
        index: usize,
        /// Number of frames of the recording.
        of: usize,
        /// Result of the filter.
        frame: Box<LocalizedFrame>,
    },
    /// Smoothing has processed a picture a second time.
    Revisited {
        /// Number of the recording.
        recording: usize,
        /// Number of pictures processed again so far.
        done: usize,
        /// Number of pictures to process again.
        of: usize,
    },
    /// The poses of a recording are known.
    PosesFound {
        /// Number of the recording.
        recording: usize,
        /// Poses of the recording.
        poses: FoundPoses,
    },
    /// The images of a database start to be added.
    CopyingStarted {
        /// Number of the database in the plan, from 0.
        database: usize,
        /// Number of its images.
        images: usize,
    },
    /// Images of a database have been added, or were there.
    Copied {
        /// Number of the database.
        database: usize,
        /// Number of images so far.
        done: usize,
        /// Number of the database's images.
        of: usize,
    },
    /// All images of a database are there.
    DatabaseAdded {
        /// Number of the database.
        database: usize,
        /// Numbers of its images by what happened to them.
        report: IngestReport,
    },
    /// Storage of a recording with this many frames starts.
    StorageStarted {
        /// Number of the recording.
        recording: usize,
        /// Number of its frames.
        frames: usize,
    },
    /// Frames of a recording have been stored, or left out because they have no pose.
    Stored {
        /// Number of the recording.
        recording: usize,
        /// Number of frames so far.
        done: usize,
        /// Number of frames of the recording.
        of: usize,
    },
    /// A recording is in the database.
    Ingested {
        /// Number of the recording.
        recording: usize,
        /// Numbers of its frames by what happened to them.
        report: IngestReport,
        /// Time that storing took, seconds.
        seconds: f64,
    },
    /// The hall is being measured.
    HallStarted,
    /// The clean stage is being found in this many images.
    CleanStageStarted {
        /// Number of images.
        images: usize,
    },
    /// Images have been searched for things that stood on the carpet.
    Cleaned {
        /// Number of images so far.
        done: usize,
        /// Number of images.
        of: usize,
    },
    /// The clean stage is in the database.
    CleanStageFound(CleanStageSummary),
    /// Everything is in the database.
    Completed {
        /// Number of images that the database now holds.
        images: usize,
        /// The hall, if it was measured in this run.
        hall: Option<Hall>,
    },
}

/// Figures of a clean stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CleanStageSummary {
    /// Number of images that show something on the carpet.
    pub masked_images: usize,
    /// Share of the carpet that no image shows empty.
    pub unknown_share: f64,
}

/// Poses of a recording, and their source.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundPoses {
    /// Poses to be stored, one per frame.
    pub estimates: Vec<Option<PoseEstimate>>,
    /// Frames that are held back, with their poses.
    pub held_back: Vec<(usize, CameraPose)>,
    /// Source of the poses.
    pub source: PoseSource,
}
