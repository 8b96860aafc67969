//! Recordings as the workflow uses them: frames with reference poses, in order of time.

use std::{collections::BTreeMap, ops::Range, path::PathBuf, sync::RwLock};

use image::RgbImage;
use rayon::prelude::*;
use reality_sim_core::{
    pose::{CameraPose, Motion2, Pose2, wrap_angle},
    sequence::{Sequence, SequenceError, StampedPose},
    statistics::median,
};
use reality_sim_sensor::{Trajectory, TrajectoryError};

use crate::{
    frame_index::{PerFrame, ViewIndex},
    simplification::Simplification,
    thresholds::{RecordingThresholds, Thresholds},
};

const THRESHOLDS: RecordingThresholds = Thresholds::DEFAULT.recording;

/// Least number of frames of a recording. A quarter of them is held out, and fewer frames would not suffice for the tests.
pub const LEAST_FRAMES: usize = THRESHOLDS.least_frames;
/// Least number of views. With fewer of them, no effect is tested.
pub(crate) const LEAST_VIEWS: usize = THRESHOLDS.least_views;

/// Reason why a recording cannot be compared with a model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// Too few frames with a reference pose.
    #[error(
        "{name}: only {found} of the {frames} frames chosen have a reference pose, the comparison needs at least {LEAST_FRAMES}: choose more frames, give more poses, or record more"
    )]
    TooFewFrames {
        /// Name of the recording.
        name: String,
        /// Number of frames with a pose.
        found: usize,
        /// Number of frames chosen.
        frames: usize,
    },
    /// There are too few frames whose picture can be read.
    #[error(
        "{name}: only {found} of the {frames} frames with a reference pose have a picture that can be read, the comparison needs at least {LEAST_FRAMES}: mend or put back {} and the others, or record again",
        first.display()
    )]
    TooFewPictures {
        /// Name of the recording.
        name: String,
        /// Number of frames with a pose and a picture.
        found: usize,
        /// Number of frames with a pose.
        frames: usize,
        /// First picture file that is missing or broken.
        first: PathBuf,
    },
    /// Most pictures are missing, whatever poses there are.
    #[error(
        "{name}: {missing} of its {frames} pictures are missing (no such file: {}): put them there, or give the folder that holds them",
        first.display()
    )]
    PicturesMissing {
        /// Name of the recording.
        name: String,
        /// Number of pictures that are missing.
        missing: usize,
        /// Number of frames chosen.
        frames: usize,
        /// First picture file that is missing.
        first: PathBuf,
    },
    /// The requested frames are not in the recording.
    #[error("{name} has the frames 0 to {last}: {from}..{to} is no range of them")]
    NoSuchFrames {
        /// Name of the recording.
        name: String,
        /// Index of its last frame.
        last: usize,
        /// Start of the requested range.
        from: usize,
        /// End of the requested range, exclusive.
        to: usize,
    },
    /// The reference poses do not form a trajectory.
    #[error("{name}: the reference poses do not form a camera's trajectory: check their times and places")]
    Trajectory {
        /// Name of the recording.
        name: String,
        /// Fault of the trajectory.
        source: TrajectoryError,
    },
}

/// Source of the reference poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ReferenceSource {
    /// The poses were measured independently of the pictures, for example by motion capture.
    Measured,
    /// Position and heading were estimated from the pictures themselves; height, pitch and roll are the robot's own.
    Tagged,
}

/// Components of the reference poses that were measured independently of the pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ReferenceKind {
    /// All six components.
    Whole,
    /// Only height, pitch and roll; position and heading were estimated from the pictures.
    Attitude,
}

/// Odometry between a frame and the next one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OdometryStep {
    /// Time of the next frame, seconds.
    pub(crate) until_s: f64,
    pub(crate) odometry: Motion2,
}

/// Frame that is compared with the model.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    /// Index in the sequence.
    pub(crate) index_in_sequence: usize,
    pub(crate) time_s: f64,
    /// Odometry step to the next frame. None for the last frame, without odometry, or if the next frame comes too late.
    pub(crate) step: Option<OdometryStep>,
    /// Pitch and roll by joints and IMU, radians, less their median difference from the reference poses: the mount of the IMU
    /// and of the markers is not compared. None if the reference poses have them from there.
    pub(crate) stated_attitude_rad: Option<[f64; 2]>,
}

/// Frames of a sequence that are compared with a model.
#[derive(Debug)]
pub struct Recording<'a> {
    pub(crate) sequence: &'a Sequence,
    pub(crate) trajectory: Trajectory,
    pub(crate) frames: PerFrame<Frame>,
    pub(crate) source: ReferenceSource,
    /// Values of effects' fixed parameters that a search found, see [`crate::linear_model::fixed_values`].
    pub(crate) searched: RwLock<BTreeMap<&'static str, f64>>,
    /// Picture files that are broken or missing; their frames are left out.
    pub(crate) left_out: Vec<PathBuf>,
    pub(crate) simplification: Option<Simplification>,
}

impl<'a> Recording<'a> {
    /// Selects the frames of a sequence, or a range of them, that have a reference pose. `poses` has one entry for each
    /// frame of the sequence. If these are the sequence's own, its poses between the frames are used, too.
    pub fn new(
        sequence: &'a Sequence,
        poses: &[Option<CameraPose>],
        source: ReferenceSource,
        range: Option<Range<usize>>,
    ) -> Result<Self, RecordingError> {
        let name = || sequence.name.clone();
        let range = Self::check_pictures(sequence, range)?;
        let frames = range.len();
        let posed = |index: usize| {
            let (time_s, pose) = (sequence.frames[index].timestamp_s, poses.get(index).copied()??);
            Some(PosedFrame { index_in_sequence: index, time_s, pose })
        };
        let posed: Vec<PosedFrame> = range.filter_map(posed).collect();
        if posed.len() < LEAST_FRAMES {
            return Err(RecordingError::TooFewFrames { name: name(), found: posed.len(), frames });
        }
        let frames = posed.len();
        let (posed, left_out) = readable(sequence, posed);
        if let Some(first) = left_out.first().filter(|_| posed.len() < LEAST_FRAMES) {
            let first = sequence.folder.join(first);
            return Err(RecordingError::TooFewPictures { name: name(), found: posed.len(), frames, first });
        }
        // Other poses than the sequence's own say nothing of the times between frames.
        let is_own =
            source == ReferenceSource::Measured && sequence.reference_poses().eq(poses.iter().copied());
        let between = if is_own { sequence.poses_between_frames.as_slice() } else { &[] };
        let trajectory = Trajectory::near(&stamped_poses(&posed, between))
            .map_err(|source| RecordingError::Trajectory { name: name(), source })?;
        let attitude_bias_rad =
            (source == ReferenceSource::Measured).then(|| attitude_bias_rad(sequence, &posed));
        let every = posed.len().div_ceil(THRESHOLDS.most_frames);
        let frame = |&PosedFrame { index_in_sequence, time_s, .. }: &PosedFrame| Frame {
            index_in_sequence,
            time_s,
            step: step(sequence, index_in_sequence),
            stated_attitude_rad: attitude_bias_rad
                .map(|bias| stated_attitude_rad(sequence, index_in_sequence, bias)),
        };
        let frames = posed.iter().step_by(every).map(frame).collect();
        let (searched, simplification) = Default::default();
        Ok(Self { sequence, trajectory, frames, source, left_out, searched, simplification })
    }

    /// Checks that enough pictures of the frames chosen are there, before any pose is known; returns the range of these frames.
    /// A few that are missing are left out later.
    ///
    /// # Errors
    ///
    /// Returns an error if the range is none of frames, or if too many pictures are missing.
    pub fn check_pictures(
        sequence: &Sequence,
        range: Option<Range<usize>>,
    ) -> Result<Range<usize>, RecordingError> {
        let (name, count) = (|| sequence.name.clone(), sequence.frames.len());
        let range = range.unwrap_or(0..count);
        if range.start >= range.end || range.end > count {
            let (from, to) = (range.start, range.end);
            return Err(RecordingError::NoSuchFrames { name: name(), last: count - 1, from, to });
        }
        let files = sequence.frames[range.clone()].iter().map(|frame| sequence.folder.join(&frame.image));
        let missing: Vec<PathBuf> = files.filter(|file| !file.is_file()).collect();
        match missing.first() {
            // Fewer frames than needed are too few even with all of their pictures.
            Some(first) if range.len() >= LEAST_FRAMES && range.len() - missing.len() < LEAST_FRAMES => {
                let (missing, frames, first) = (missing.len(), range.len(), first.clone());
                Err(RecordingError::PicturesMissing { name: name(), missing, frames, first })
            }
            _ => Ok(range),
        }
    }

    /// Returns the recording for an analysis in a simpler way.
    pub fn simplified(self, simplification: Simplification) -> Self {
        Self { simplification: Some(simplification), ..self }
    }

    /// Returns the view of each frame. Successive frames belong to one view while their poses differ so little that they may
    /// share one pose error.
    pub(crate) fn views(&self) -> PerFrame<ViewIndex> {
        let mut first: Option<CameraPose> = None;
        let mut view = ViewIndex(0);
        let of_frame = |frame: &Frame| {
            let pose = self.trajectory.at(frame.time_s);
            if let Some(first) = first.as_mut().filter(|first| !is_same_view(first, pose)) {
                *first = pose;
                view = ViewIndex(view.0 + 1);
            }
            first.get_or_insert(pose);
            view
        };
        self.frames.iter().map(of_frame).collect()
    }

    /// Returns the number of views.
    pub(crate) fn view_count(&self) -> usize {
        self.views().iter().max().map_or(0, |last| last.0 + 1)
    }

    /// Returns the time of the first frame, seconds.
    pub(crate) fn start_s(&self) -> f64 {
        self.frames.as_slice().first().map_or(0.0, |frame| frame.time_s)
    }

    /// Returns the time between the first frame and the last, seconds.
    pub(crate) fn duration_s(&self) -> f64 {
        self.frames.as_slice().last().map_or(0.0, |frame| frame.time_s) - self.start_s()
    }

    /// Returns the sequence.
    pub fn sequence(&self) -> &Sequence {
        self.sequence
    }

    /// Whether the camera moves by more than the errors of its poses, on average from the first frame.
    pub(crate) fn moves(&self) -> bool {
        let poses: Vec<CameraPose> =
            self.frames.iter().map(|frame| self.trajectory.at(frame.time_s)).collect();
        let (Some(first), count) = (poses.first(), poses.len() as f64) else { return false };
        let distance_m = poses
            .iter()
            .map(|pose| (pose.position_in_world() - first.position_in_world()).length())
            .sum::<f64>();
        let turned_rad =
            poses.iter().map(|pose| first.planar().motion_to(pose.planar()).turn_rad.abs()).sum::<f64>();
        distance_m / count > THRESHOLDS.moves_m || turned_rad / count > THRESHOLDS.moves_rad
    }

    /// Returns the exponent of the camera's nominal encoding.
    pub(crate) fn gamma(&self) -> f64 {
        self.sequence.setup.photometry.map_or(2.2, |photometry| photometry.gamma)
    }

    pub(crate) fn reference(&self) -> ReferenceKind {
        match self.source {
            ReferenceSource::Measured => ReferenceKind::Whole,
            ReferenceSource::Tagged => ReferenceKind::Attitude,
        }
    }

    /// Reads a frame's picture; returns it with the bytes of its file.
    pub(crate) fn picture(&self, frame: &Frame) -> Result<(RgbImage, Vec<u8>), SequenceError> {
        self.sequence.load_image_and_file(frame.index_in_sequence)
    }
}

/// Frame of a sequence that has a reference pose.
struct PosedFrame {
    index_in_sequence: usize,
    time_s: f64,
    pose: CameraPose,
}

/// Returns the poses of frames and those between them, in order of time. At the ends, one exposure or clock that is off does
/// not reach farther than the trajectory's margin.
fn stamped_poses(posed: &[PosedFrame], between: &[StampedPose]) -> Vec<(f64, CameraPose)> {
    let of_frames = posed.iter().map(|frame| (frame.time_s, frame.pose));
    let mut stamped: Vec<(f64, CameraPose)> = of_frames.collect();
    let (Some(&(first_s, _)), Some(&(last_s, _))) = (stamped.first(), stamped.last()) else { return stamped };
    let span = first_s - THRESHOLDS.trajectory_margin_s..=last_s + THRESHOLDS.trajectory_margin_s;
    let others = between.iter().filter(|stamped| span.contains(&stamped.timestamp_s));
    stamped.extend(others.map(|stamped| (stamped.timestamp_s, stamped.pose)));
    // The sort is stable: of two poses at one time, the frame's comes first and stays.
    stamped.sort_by(|a, b| a.0.total_cmp(&b.0));
    stamped.dedup_by(|later, earlier| later.0 <= earlier.0);
    stamped
}

/// Splits frames into those whose pictures can be read and the picture files of the others.
fn readable(sequence: &Sequence, posed: Vec<PosedFrame>) -> (Vec<PosedFrame>, Vec<PathBuf>) {
    let is_readable: Vec<bool> =
        posed.par_iter().map(|frame| sequence.load_image(frame.index_in_sequence).is_ok()).collect();
    let mut left_out = Vec::new();
    let kept = posed.into_iter().zip(is_readable).filter_map(|(frame, is_readable)| {
        if !is_readable {
            left_out.push(sequence.frames[frame.index_in_sequence].image.clone());
        }
        is_readable.then_some(frame)
    });
    (kept.collect(), left_out)
}

/// Whether two poses are so close that their pictures belong to one view.
fn is_same_view(a: &CameraPose, b: CameraPose) -> bool {
    let moved_m = (a.position_in_world() - b.position_in_world()).length();
    let turned = a.rotation_world_from_camera().transpose() * b.rotation_world_from_camera();
    let turned_rad =
        (0.5 * (turned.x_axis.x + turned.y_axis.y + turned.z_axis.z - 1.0)).clamp(-1.0, 1.0).acos();
    moved_m < THRESHOLDS.same_view_m && turned_rad < THRESHOLDS.same_view_rad
}

/// Returns pitch and roll of a frame by joints and IMU, less their bias.
fn stated_attitude_rad(sequence: &Sequence, index: usize, [pitch_rad, roll_rad]: [f64; 2]) -> [f64; 2] {
    let frame = &sequence.frames[index];
    [frame.pitch_rad - pitch_rad, frame.roll_rad - roll_rad]
}

/// Returns the median differences of pitch and roll by joints and IMU from those of the reference poses.
fn attitude_bias_rad(sequence: &Sequence, posed: &[PosedFrame]) -> [f64; 2] {
    let stated = |frame: &PosedFrame| stated_attitude_rad(sequence, frame.index_in_sequence, [0.0; 2]);
    let pitch = posed.iter().map(|frame| stated(frame)[0] - frame.pose.pitch_rad);
    let roll = posed.iter().map(|frame| wrap_angle(stated(frame)[1] - frame.pose.roll_rad));
    [median(pitch), median(roll)]
}

/// Returns the odometry between a frame and the next one. None for the last frame, without odometry, or if the next frame
/// comes too late.
fn step(sequence: &Sequence, index: usize) -> Option<OdometryStep> {
    let (from, to) = (&sequence.frames[index], sequence.frames.get(index + 1)?);
    let (before, after): (Pose2, Pose2) = (from.odometry?, to.odometry?);
    (to.timestamp_s - from.timestamp_s <= THRESHOLDS.longest_step_s)
        .then_some(OdometryStep { until_s: to.timestamp_s, odometry: before.motion_to(after) })
}
