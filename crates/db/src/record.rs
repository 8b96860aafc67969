//! What is known of an image, and its way in and out of a row.

use nalgebra::Matrix6;
use reality_sim_core::{
    localization::{LocalizedFrame, LocalizerConfig},
    pose::CameraPose,
    refine::SmoothedPose,
};
use rusqlite::{Row, types::Type};
use serde_json::json;

/// Bytes of a stored covariance.
const COVARIANCE_BYTES: usize = 36 * 8;

/// Where a camera was, and how well that is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseEstimate {
    /// The pose.
    pub pose: CameraPose,
    /// Covariance of x, y, yaw, height, pitch and roll, in metres and radians, where it is known.
    pub covariance: Option<Matrix6<f64>>,
}

impl From<CameraPose> for PoseEstimate {
    /// A pose of which it is not known how well it is known.
    fn from(pose: CameraPose) -> Self {
        Self { pose, covariance: None }
    }
}

impl PoseEstimate {
    /// The poses of a localized recording, one a frame: as smoothed, or where they were not, as localized. Frames that the filter
    /// is not sure of have none, unless `with_unsure`.
    ///
    /// # Panics
    ///
    /// Where there are fewer smoothed poses than frames: both are of the same frames.
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

    /// Whether a camera can be there, and no number of the covariance is NaN or infinite.
    pub(crate) fn is_possible(&self) -> bool {
        let covariance = self.covariance.iter().flat_map(Matrix6::iter);
        self.pose.is_possible() && covariance.copied().all(f64::is_finite)
    }
}

/// Where poses come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PoseSource {
    /// The recording's own ground truth.
    GroundTruth,
    /// The particle filter.
    Filter {
        /// Its settings and seed, as JSON.
        settings: String,
    },
    /// A file of poses.
    File {
        /// Its name.
        name: String,
    },
}

impl PoseSource {
    /// The particle filter with these settings, as a program ran it on a device, with or without smoothing.
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

    /// `groundtruth`, `filter` or `file`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::GroundTruth => "groundtruth",
            Self::Filter { .. } => "filter",
            Self::File { .. } => "file",
        }
    }

    /// The filter's settings, or the file's name; empty for ground truth.
    pub fn description(&self) -> &str {
        match self {
            Self::GroundTruth => "",
            Self::Filter { settings } => settings,
            Self::File { name } => name,
        }
    }

    /// The reverse of [`PoseSource::kind`] and [`PoseSource::description`].
    pub(crate) fn from_columns(kind: &str, description: String) -> Option<Self> {
        match kind {
            "groundtruth" => Some(Self::GroundTruth),
            "filter" => Some(Self::Filter { settings: description }),
            "file" => Some(Self::File { name: description }),
            _ => None,
        }
    }
}

/// All of an image but its bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageRecord {
    /// Number of the image in the database; later ones are larger.
    pub id: i64,
    /// Which of [`crate::Database::sequences`] it belongs to.
    pub sequence_id: i64,
    /// Number of the frame in its sequence, from 0.
    pub frame_index: usize,
    /// Which of [`crate::Database::cameras`] took it.
    pub camera_id: i64,
    /// Which of [`crate::Database::fields`] it shows.
    pub field_id: i64,
    /// Which of [`crate::Database::pose_sources`] the pose is from.
    pub pose_source_id: i64,
    /// When it was taken, by its sequence's clock, seconds.
    pub timestamp_s: f64,
    /// The file it was, relative to its sequence's folder.
    pub file_name: String,
    /// Length of its JPEG or PNG file, bytes.
    pub byte_length: u64,
    /// Where it was taken.
    pub pose: CameraPose,
    /// Covariance of x, y, yaw, height, pitch and roll, in metres and radians, where it is known.
    pub covariance: Option<Matrix6<f64>>,
}

/// The columns of a record, in the order in which [`ImageRecord::from_row`] takes them.
pub(crate) const IMAGE_COLUMNS: &str = "id, sequence_id, frame_index, camera_id, field_id, pose_source_id, \
     timestamp_s, file_name, byte_length, x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad, covariance";

impl ImageRecord {
    /// A record from [`IMAGE_COLUMNS`]. Its numbers may be infinite.
    pub(crate) fn from_row(row: &Row<'_>) -> rusqlite::Result<Self> {
        Ok(Self {
            id: row.get(0)?,
            sequence_id: row.get(1)?,
            frame_index: unsigned(row, 2)?,
            camera_id: row.get(3)?,
            field_id: row.get(4)?,
            pose_source_id: row.get(5)?,
            timestamp_s: row.get(6)?,
            file_name: row.get(7)?,
            byte_length: unsigned(row, 8)?,
            pose: pose_from_row(row, 9)?,
            covariance: covariance(row, 15)?,
        })
    }

    /// What is wrong with its numbers, if anything.
    pub(crate) fn problem(&self) -> Option<&'static str> {
        let estimate = PoseEstimate { pose: self.pose, covariance: self.covariance };
        if !estimate.is_possible() {
            Some("no camera can have its pose")
        } else if !self.timestamp_s.is_finite() {
            Some("its time is not a finite number")
        } else {
            None
        }
    }
}

/// A pose from six columns, in the order of [`IMAGE_COLUMNS`], of which this is the first.
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

/// A covariance as it is stored: row by row, little-endian.
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

fn unsigned<T: TryFrom<i64>>(row: &Row<'_>, column: usize) -> rusqlite::Result<T> {
    let value: i64 = row.get(column)?;
    T::try_from(value).map_err(|_| rusqlite::Error::IntegralValueOutOfRange(column, value))
}
