//! Records of images, and their conversion from and to rows.

use nalgebra::Matrix6;
use reality_sim_core::{
    localization::{LocalizedFrame, LocalizerConfig},
    pose::CameraPose,
    refine::SmoothedPose,
};
use rusqlite::{Row, types::Type};
use serde_json::json;

/// Size of a stored covariance, bytes.
const COVARIANCE_BYTES: usize = 36 * 8;

/// Pose of the camera with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseEstimate {
    /// Pose of the camera.
    pub pose: CameraPose,
    /// Covariance of x, y, yaw, height, pitch and roll, in metres and radians, where it is known.
    pub covariance: Option<Matrix6<f64>>,
}

impl From<CameraPose> for PoseEstimate {
    /// Makes an estimate of a pose whose uncertainty is unknown.
    fn from(pose: CameraPose) -> Self {
        Self { pose, covariance: None }
    }
}

impl PoseEstimate {
    /// Returns the poses of a localized recording, one per frame: the smoothed ones if there are any, else the filter's.
    /// Frames that the filter is not sure of have none, unless `with_unsure` is set.
    ///
    /// # Panics
    ///
    /// Panics if there are fewer smoothed poses than frames: both must belong to the same frames.
    pub fn of_localized(
        frames: &[LocalizedFrame],
        smoothed: Option<&[SmoothedPose]>,
        with_unsure: bool,
    ) -> Vec<Option<Self>> {
        let estimate =
            |(index, frame): (usize, &LocalizedFrame)| match smoothed.map(|smoothed| smoothed[index]) {
                Some(smoothed) => Self { pose: smoothed.pose, covariance: Some(smoothed.covariance) },
                None => Self { pose: frame.pose, covariance: frame.fit.map(|fit| fit.covariance) },
            };
        let frames = frames.iter().enumerate();
        frames.map(|frame| (frame.1.sure || with_unsure).then(|| estimate(frame))).collect()
    }

    /// Whether a camera can have this pose, and the covariance contains neither NaN nor infinity.
    pub(crate) fn is_possible(&self) -> bool {
        self.pose.is_possible() && is_finite(self.covariance.as_ref())
    }
}

/// Source of poses.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PoseSource {
    /// Ground truth of the recording itself.
    GroundTruth,
    /// Particle filter.
    Filter {
        /// Settings and seed of the filter, as JSON.
        settings: String,
    },
    /// File of poses.
    File {
        /// Name of the file.
        name: String,
    },
}

impl PoseSource {
    /// Describes the particle filter with these settings, as run by a program on a device, with or without smoothing.
    pub fn of_filter(program: &str, config: &LocalizerConfig, device: &str, is_smoothed: bool) -> Self {
        let settings = json!({
            "program": program,
            "observation": config.observation.kind,
            "particles": config.filter.particles,
            "iterations": config.filter.iterations,
            "resampling": config.filter.resampling,
            "seed": config.filter.seed,
            "backend": device,
            "smoothed": is_smoothed,
        });
        Self::Filter { settings: settings.to_string() }
    }

    /// Returns `groundtruth`, `filter` or `file`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::GroundTruth => "groundtruth",
            Self::Filter { .. } => "filter",
            Self::File { .. } => "file",
        }
    }

    /// Returns the filter's settings, or the file's name; empty for ground truth.
    pub fn description(&self) -> &str {
        match self {
            Self::GroundTruth => "",
            Self::Filter { settings } => settings,
            Self::File { name } => name,
        }
    }

    /// Inverse of [`PoseSource::kind`] and [`PoseSource::description`].
    pub(crate) fn from_columns(kind: &str, description: String) -> Option<Self> {
        match kind {
            "groundtruth" => Some(Self::GroundTruth),
            "filter" => Some(Self::Filter { settings: description }),
            "file" => Some(Self::File { name: description }),
            _ => None,
        }
    }
}

/// What an image is found and drawn by. Of a million images these are a hundred megabytes in memory; [`ImageDetails`] are read when they are
/// asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageRecord {
    /// Id of the image in the database; later images have larger ids.
    pub id: i64,
    /// Id of its sequence in [`crate::Database::sequences`].
    pub sequence_id: i64,
    /// Number of the frame in its sequence, from 0.
    pub frame_index: usize,
    /// Id of its camera in [`crate::Database::cameras`].
    pub camera_id: i64,
    /// Id of its field in [`crate::Database::fields`].
    pub field_id: i64,
    /// Time at which it was taken, by its sequence's clock, seconds.
    pub timestamp_s: f64,
    /// Pose of the camera when it was taken.
    pub pose: CameraPose,
}

/// What else is known of an image except its bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageDetails {
    /// Id of the source of its pose in [`crate::Database::pose_sources`].
    pub pose_source_id: i64,
    /// Path of its original file, relative to its sequence's folder.
    pub file_name: String,
    /// Length of its JPEG or PNG file, bytes.
    pub byte_length: u64,
    /// Covariance of x, y, yaw, height, pitch and roll, in metres and radians, where it is known.
    pub covariance: Option<Matrix6<f64>>,
}

/// Columns of a record, in the order in which [`ImageRecord::from_row`] takes them.
pub(crate) const IMAGE_COLUMNS: &str = "id, sequence_id, frame_index, camera_id, field_id, timestamp_s, x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad";

/// Number of [`IMAGE_COLUMNS`].
pub(crate) const IMAGE_WIDTH: usize = 12;

/// Column that is checked with every record: the id of the pose's source.
pub(crate) const POSE_SOURCE_COLUMN: &str = "pose_source_id";

/// Columns of details, in the order in which [`ImageDetails::from_row`] takes them; the first is [`POSE_SOURCE_COLUMN`].
pub(crate) const DETAIL_COLUMNS: &str = "pose_source_id, file_name, byte_length, covariance";

impl ImageRecord {
    /// Reads a record from [`IMAGE_COLUMNS`]. Its numbers may be infinite.
    pub(crate) fn from_row(row: &Row<'_>) -> rusqlite::Result<Self> {
        Ok(Self {
            id: row.get(0)?,
            sequence_id: row.get(1)?,
            frame_index: unsigned(row, 2)?,
            camera_id: row.get(3)?,
            field_id: row.get(4)?,
            timestamp_s: row.get(5)?,
            pose: pose_from_row(row, 6)?,
        })
    }

    /// Returns what is wrong with its numbers, if anything.
    pub(crate) fn problem(&self) -> Option<&'static str> {
        if !self.pose.is_possible() {
            Some("no camera can have its pose")
        } else if !self.timestamp_s.is_finite() {
            Some("its time is not a finite number")
        } else {
            None
        }
    }
}

impl ImageDetails {
    /// Reads details from [`DETAIL_COLUMNS`], which begin at `first`. Numbers of the covariance may be infinite.
    pub(crate) fn from_row(row: &Row<'_>, first: usize) -> rusqlite::Result<Self> {
        Ok(Self {
            pose_source_id: row.get(first)?,
            file_name: row.get(first + 1)?,
            byte_length: unsigned(row, first + 2)?,
            covariance: covariance(row, first + 3)?,
        })
    }

    /// Returns what is wrong with its numbers, if anything.
    pub(crate) fn problem(&self) -> Option<&'static str> {
        (!is_finite(self.covariance.as_ref())).then_some("its covariance is not of finite numbers")
    }
}

fn is_finite(covariance: Option<&Matrix6<f64>>) -> bool {
    covariance.into_iter().flat_map(Matrix6::iter).copied().all(f64::is_finite)
}

/// Reads a pose from six columns in the order of [`IMAGE_COLUMNS`], starting at `first`.
pub(crate) fn pose_from_row(row: &Row<'_>, first: usize) -> rusqlite::Result<CameraPose> {
    Ok(CameraPose {
        x_m: row.get(first)?,
        y_m: row.get(first + 1)?,
        yaw_rad: row.get(first + 2)?,
        height_m: row.get(first + 3)?,
        pitch_rad: row.get(first + 4)?,
        roll_rad: row.get(first + 5)?,
    })
}

/// Encodes a covariance as it is stored: row by row, little-endian.
pub(crate) fn covariance_bytes(covariance: &Matrix6<f64>) -> Vec<u8> {
    covariance.transpose().iter().flat_map(|value| value.to_le_bytes()).collect()
}

fn covariance(row: &Row<'_>, column: usize) -> rusqlite::Result<Option<Matrix6<f64>>> {
    let Some(bytes) = row.get_ref(column)?.as_blob_or_null()? else { return Ok(None) };
    if bytes.len() != COVARIANCE_BYTES {
        return Err(rusqlite::Error::InvalidColumnType(column, "covariance".to_owned(), Type::Blob));
    }
    let (numbers, _) = bytes.as_chunks::<8>();
    Ok(Some(Matrix6::from_row_iterator(numbers.iter().map(|number| f64::from_le_bytes(*number)))))
}

/// Reads a number that is not negative.
pub(crate) fn unsigned<T: TryFrom<i64>>(row: &Row<'_>, column: usize) -> rusqlite::Result<T> {
    let value: i64 = row.get(column)?;
    T::try_from(value).map_err(|_| rusqlite::Error::IntegralValueOutOfRange(column, value))
}
