//! Recordings on their way into the database.

use std::{path::Path, sync::PoisonError};

use reality_sim_core::{
    pose::{CameraPose, wrap_angle},
    sequence::Sequence,
};
use rusqlite::{OptionalExtension, Row, Transaction, TransactionBehavior, params};

use crate::{
    Database,
    error::{DbError, DbFault},
    record::{PoseEstimate, PoseSource, covariance_bytes, pose_from_row},
};

/// Frames that are committed together, at most.
const BATCH_FRAMES: usize = 64;

/// A transaction is committed once it holds so much: all of it stays in the writer's memory until then.
const BATCH_BYTES: usize = 16 << 20;

/// Poses nearer than this, metres and radians, are one: a filter computes them anew when work goes on.
const SAME_POSE: f64 = 1e-6;

/// What became of a sequence's frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct IngestReport {
    /// Frames that were added.
    pub added: usize,
    /// Frames that the database already held.
    pub already_there: usize,
    /// Frames that were left out because they have no pose.
    pub without_pose: usize,
}

impl Database {
    /// Adds a sequence's pictures, as their files are, with one pose a frame; frames without a pose are left out.
    ///
    /// Frames are committed in batches: `progress` then gets the number of frames done. After an error, or when the
    /// program is killed, all batches before stay, and the next call goes on where this one ended. Frames that are in
    /// the database already are compared: another picture, pose, camera or field is [`DbFault::Changed`]. A sequence is
    /// recognised, wherever it lies, by its name and the line of its first frame.
    pub fn ingest(
        &mut self,
        sequence: &Sequence,
        poses: &[Option<PoseEstimate>],
        source: &PoseSource,
        progress: impl FnMut(usize),
    ) -> Result<IngestReport, DbError> {
        self.ingest_batches(sequence, poses, source, |_| true, progress)
    }

    /// As [`Database::ingest`], but `progress` gets the number of frames done after every frame, before it is committed, and
    /// only as long as it says true: where it does not, the frames done are committed, and the rest is left for another call.
    pub fn ingest_while(
        &mut self,
        sequence: &Sequence,
        poses: &[Option<PoseEstimate>],
        source: &PoseSource,
        progress: impl FnMut(usize) -> bool,
    ) -> Result<IngestReport, DbError> {
        self.ingest_batches(sequence, poses, source, progress, |_| {})
    }

    /// `goes_on` gets the number of frames done after every frame, `committed` after every batch.
    fn ingest_batches(
        &mut self,
        sequence: &Sequence,
        poses: &[Option<PoseEstimate>],
        source: &PoseSource,
        mut goes_on: impl FnMut(usize) -> bool,
        mut committed: impl FnMut(usize),
    ) -> Result<IngestReport, DbError> {
        let path = self.path().to_path_buf();
        let fail = |fault| DbError::new(&path, fault);
        if !self.is_writer {
            return Err(fail(DbFault::OpenedForReading));
        }
        check_poses(sequence, poses).map_err(fail)?;
        let recording = Recording::new(&path, sequence, poses, source)?;
        let connection = self.connection.get_mut().unwrap_or_else(PoisonError::into_inner);
        let mut report = IngestReport::default();
        let (mut done, mut is_wanted) = (0, true);
        while done < poses.len() && is_wanted {
            let transaction = connection
                .transaction_with_behavior(TransactionBehavior::Immediate)
                .map_err(|error| fail(error.into()))?;
            let mut goes_on = |done| {
                is_wanted = goes_on(done);
                is_wanted
            };
            done = recording.add_batch(&transaction, done, &mut report, &mut goes_on)?;
            transaction.commit().map_err(|error| fail(error.into()))?;
            committed(done);
        }
        Ok(report)
    }
}

fn check_poses(sequence: &Sequence, poses: &[Option<PoseEstimate>]) -> Result<(), DbFault> {
    let (found, expected) = (poses.len(), sequence.frames.len());
    if found != expected {
        return Err(DbFault::PoseCount { found, expected });
    }
    let is_bad = |estimate: &Option<PoseEstimate>| estimate.is_some_and(|estimate| !estimate.is_possible());
    poses.iter().position(is_bad).map_or(Ok(()), |frame_index| Err(DbFault::PoseImpossible { frame_index }))
}

/// What is added, and the texts it shares.
struct Recording<'a> {
    path: &'a Path,
    sequence: &'a Sequence,
    poses: &'a [Option<PoseEstimate>],
    source: &'a PoseSource,
    first_frame: String,
    camera: String,
    field: String,
}

/// Rows that all images of a recording refer to.
struct Shared {
    sequence_id: i64,
    camera_id: i64,
    field_id: i64,
    pose_source_id: i64,
}

impl<'a> Recording<'a> {
    fn new(
        path: &'a Path,
        sequence: &'a Sequence,
        poses: &'a [Option<PoseEstimate>],
        source: &'a PoseSource,
    ) -> Result<Self, DbError> {
        let camera = sequence.setup.to_toml(&sequence.folder)?;
        let field = sequence.field.to_toml(&sequence.folder)?;
        Ok(Self { path, sequence, poses, source, first_frame: first_frame(sequence), camera, field })
    }

    /// Adds frames from this one on, as long as `goes_on` says true after each, and says which is next.
    fn add_batch(
        &self,
        transaction: &Transaction<'_>,
        first: usize,
        report: &mut IngestReport,
        goes_on: &mut dyn FnMut(usize) -> bool,
    ) -> Result<usize, DbError> {
        let shared = self.shared(transaction).map_err(|error| DbError::new(self.path, error))?;
        let end = self.poses.len().min(first + BATCH_FRAMES);
        let mut held_bytes = 0;
        for index in first..end {
            if held_bytes >= BATCH_BYTES {
                return Ok(index);
            }
            match &self.poses[index] {
                None => report.without_pose += 1,
                Some(estimate) => {
                    let bytes = self.sequence.image_bytes(index)?;
                    held_bytes += bytes.len();
                    let is_new = self
                        .add_frame(transaction, &shared, index, estimate, &bytes)
                        .map_err(|fault| DbError::new(self.path, fault))?;
                    *(if is_new { &mut report.added } else { &mut report.already_there }) += 1;
                }
            }
            if !goes_on(index + 1) {
                return Ok(index + 1);
            }
        }
        Ok(end)
    }

    /// Adds a frame that is not there yet; returns whether it was not.
    fn add_frame(
        &self,
        transaction: &Transaction<'_>,
        shared: &Shared,
        index: usize,
        estimate: &PoseEstimate,
        bytes: &[u8],
    ) -> Result<bool, DbFault> {
        let frame = &self.sequence.frames[index];
        let file_name = frame.image.to_str().ok_or(DbFault::NameNotUtf8 { frame_index: index })?;
        let Some(stored) = StoredFrame::find(transaction, shared.sequence_id, index, bytes)? else {
            let image = NewImage { index, timestamp_s: frame.timestamp_s, file_name, estimate, bytes };
            image.insert(transaction, shared)?;
            return Ok(true);
        };
        let differences = [
            (stored.camera_id != shared.camera_id, "camera"),
            (stored.field_id != shared.field_id, "field"),
            (stored.timestamp_s != frame.timestamp_s, "time"),
            (stored.file_name != file_name, "file name"),
            (!stored.has_these_bytes, "picture"),
            (!is_same_pose(stored.pose, estimate.pose), "pose"),
        ];
        match differences.iter().find(|(differs, _)| *differs) {
            None => Ok(false),
            Some((_, what)) => {
                Err(DbFault::Changed { sequence: self.sequence.name.clone(), frame_index: index, what })
            }
        }
    }

    /// Finds the rows that the images refer to, or adds them.
    fn shared(&self, transaction: &Transaction<'_>) -> rusqlite::Result<Shared> {
        let row = |table: &str, columns: [&str; 2], values: [&str; 2]| {
            let [first, second] = columns;
            let insert = format!("INSERT OR IGNORE INTO {table} ({first}, {second}) VALUES (?1, ?2)");
            transaction.execute(&insert, values)?;
            let find = format!("SELECT id FROM {table} WHERE {first} = ?1 AND {second} = ?2");
            transaction.query_row(&find, values, |row| row.get(0))
        };
        let text = |table: &str, toml: &str| {
            transaction.execute(&format!("INSERT OR IGNORE INTO {table} (toml) VALUES (?1)"), [toml])?;
            transaction
                .query_row(&format!("SELECT id FROM {table} WHERE toml = ?1"), [toml], |row| row.get(0))
        };
        Ok(Shared {
            sequence_id: row("sequences", ["name", "first_frame"], [&self.sequence.name, &self.first_frame])?,
            camera_id: text("cameras", &self.camera)?,
            field_id: text("fields", &self.field)?,
            pose_source_id: row(
                "pose_sources",
                ["kind", "description"],
                [self.source.kind(), self.source.description()],
            )?,
        })
    }
}

/// What tells a sequence from others of its name: all that is known of its first frame but the picture.
fn first_frame(sequence: &Sequence) -> String {
    let Some(frame) = sequence.frames.first() else { return String::new() };
    let odometry =
        frame.odometry.map_or(String::new(), |pose| format!("{},{},{}", pose.x_m, pose.y_m, pose.yaw_rad));
    let image = frame.image.display();
    format!("{},{image},{odometry},{},{}", frame.timestamp_s, frame.pitch_rad, frame.roll_rad)
}

fn is_same_pose(a: CameraPose, b: CameraPose) -> bool {
    let lengths_m = [a.x_m - b.x_m, a.y_m - b.y_m, a.height_m - b.height_m];
    let angles_rad =
        [a.yaw_rad - b.yaw_rad, a.pitch_rad - b.pitch_rad, a.roll_rad - b.roll_rad].map(wrap_angle);
    lengths_m.iter().chain(&angles_rad).all(|difference| difference.abs() < SAME_POSE)
}

/// A frame's own part of its row, and its picture.
struct NewImage<'a> {
    index: usize,
    timestamp_s: f64,
    file_name: &'a str,
    estimate: &'a PoseEstimate,
    bytes: &'a [u8],
}

impl NewImage<'_> {
    fn insert(&self, transaction: &Transaction<'_>, shared: &Shared) -> rusqlite::Result<()> {
        let pose = self.estimate.pose;
        transaction.execute(
            "INSERT INTO images (sequence_id, frame_index, camera_id, field_id, pose_source_id, timestamp_s,
                file_name, byte_length, x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad, covariance)
                VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15)",
            params![
                shared.sequence_id,
                self.index as i64,
                shared.camera_id,
                shared.field_id,
                shared.pose_source_id,
                self.timestamp_s,
                self.file_name,
                self.bytes.len() as i64,
                pose.x_m,
                pose.y_m,
                pose.yaw_rad,
                pose.height_m,
                pose.pitch_rad,
                pose.roll_rad,
                self.estimate.covariance.as_ref().map(covariance_bytes),
            ],
        )?;
        let id = transaction.last_insert_rowid();
        transaction
            .execute("INSERT INTO image_bytes (image_id, bytes) VALUES (?1, ?2)", params![id, self.bytes])?;
        Ok(())
    }
}

/// What the database holds of a frame.
struct StoredFrame {
    camera_id: i64,
    field_id: i64,
    timestamp_s: f64,
    file_name: String,
    pose: CameraPose,
    has_these_bytes: bool,
}

impl StoredFrame {
    /// The frame of a sequence, if it is there, compared with the bytes of a picture.
    fn find(
        transaction: &Transaction<'_>,
        sequence_id: i64,
        index: usize,
        bytes: &[u8],
    ) -> rusqlite::Result<Option<Self>> {
        let query = "SELECT camera_id, field_id, timestamp_s, file_name,
                x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad, bytes IS ?3
                FROM images LEFT JOIN image_bytes ON image_bytes.image_id = images.id
                WHERE sequence_id = ?1 AND frame_index = ?2";
        transaction.query_row(query, params![sequence_id, index as i64, bytes], Self::from_row).optional()
    }

    fn from_row(row: &Row<'_>) -> rusqlite::Result<Self> {
        Ok(Self {
            camera_id: row.get(0)?,
            field_id: row.get(1)?,
            timestamp_s: row.get(2)?,
            file_name: row.get(3)?,
            pose: pose_from_row(row, 4)?,
            has_these_bytes: row.get(10)?,
        })
    }
}
