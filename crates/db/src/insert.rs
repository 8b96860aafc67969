//! Insertion of one image into the database.

use std::path::Path;

use reality_sim_core::{
    pose::{CameraPose, wrap_angle},
    sequence::check_image,
};
use rusqlite::{OptionalExtension, Row, Transaction, params};

use crate::{
    clean_stage::forget_clean_stage,
    error::{DbError, DbFault},
    record::{covariance_bytes, pose_from_row},
    recording::{Insertion, NewImage, Recording},
};

/// Tolerance within which poses are equal, metres and radians: a filter computes them anew when an ingest is resumed.
const SAME_POSE: f64 = 1e-6;

/// Rows that all images of a recording refer to.
pub(crate) struct Shared {
    sequence_id: i64,
    camera_id: i64,
    field_id: i64,
    pose_source_id: i64,
}

impl Shared {
    /// Finds the rows, or adds them.
    pub fn find_or_add(transaction: &Transaction<'_>, recording: &Recording) -> rusqlite::Result<Self> {
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
        let Recording { name, first_frame, camera, field, source, .. } = recording;
        Ok(Self {
            sequence_id: row("sequences", ["name", "first_frame"], [name, first_frame])?,
            camera_id: text("cameras", camera)?,
            field_id: text("fields", field)?,
            pose_source_id: row(
                "pose_sources",
                ["kind", "description"],
                [source.kind(), source.description()],
            )?,
        })
    }
}

/// Checks an image whose bytes do not come from a recording's folder; `path` is the database's.
pub(crate) fn check(path: &Path, recording: &Recording, image: &NewImage<'_>) -> Result<(), DbError> {
    image.check().map_err(|fault| DbError::new(path, fault))?;
    Ok(check_image(Path::new(image.file_name), image.bytes, recording.size)?)
}

/// Adds an image if it is not there yet, and compares it if it is. A stored picture that cannot be decoded is replaced.
pub(crate) fn insert(
    transaction: &Transaction<'_>,
    recording: &Recording,
    shared: &Shared,
    image: &NewImage<'_>,
) -> Result<Insertion, DbFault> {
    let Some(stored) = StoredImage::find(transaction, shared.sequence_id, image)? else {
        add(transaction, shared, image)?;
        return Ok(Insertion::Added);
    };
    let differences = [
        (stored.camera_id != shared.camera_id, "camera"),
        (stored.field_id != shared.field_id, "field"),
        (stored.timestamp_s != image.timestamp_s, "time"),
        (stored.file_name != image.file_name, "file name"),
        (!stored.has_these_bytes && stored.is_readable(transaction, recording.size)?, "picture"),
        (!is_same_pose(stored.pose, image.estimate.pose), "pose"),
    ];
    match differences.iter().find(|(differs, _)| *differs) {
        None if stored.has_these_bytes => Ok(Insertion::AlreadyThere),
        None => {
            replace(transaction, shared, stored.id, image.bytes)?;
            Ok(Insertion::Replaced)
        }
        Some((_, what)) => {
            Err(DbFault::Changed { sequence: recording.name.clone(), frame_index: image.frame_index, what })
        }
    }
}

fn is_same_pose(a: CameraPose, b: CameraPose) -> bool {
    let lengths_m = [a.x_m - b.x_m, a.y_m - b.y_m, a.height_m - b.height_m];
    let angles_rad =
        [a.yaw_rad - b.yaw_rad, a.pitch_rad - b.pitch_rad, a.roll_rad - b.roll_rad].map(wrap_angle);
    lengths_m.iter().chain(&angles_rad).all(|difference| difference.abs() < SAME_POSE)
}

fn add(transaction: &Transaction<'_>, shared: &Shared, image: &NewImage<'_>) -> rusqlite::Result<()> {
    let pose = image.estimate.pose;
    transaction.execute(
        "INSERT INTO images (sequence_id, frame_index, camera_id, field_id, pose_source_id, timestamp_s,
            file_name, byte_length, x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad, covariance)
            VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15)",
        params![
            shared.sequence_id,
            image.frame_index as i64,
            shared.camera_id,
            shared.field_id,
            shared.pose_source_id,
            image.timestamp_s,
            image.file_name,
            image.bytes.len() as i64,
            pose.x_m,
            pose.y_m,
            pose.yaw_rad,
            pose.height_m,
            pose.pitch_rad,
            pose.roll_rad,
            image.estimate.covariance.as_ref().map(covariance_bytes),
        ],
    )?;
    let id = transaction.last_insert_rowid();
    store_bytes(transaction, shared, id, image.bytes)
}

/// Puts other bytes in the place of a stored picture's.
fn replace(transaction: &Transaction<'_>, shared: &Shared, id: i64, bytes: &[u8]) -> rusqlite::Result<()> {
    transaction
        .execute("UPDATE images SET byte_length = ?2 WHERE id = ?1", params![id, bytes.len() as i64])?;
    store_bytes(transaction, shared, id, bytes)
}

/// Stores the bytes of a picture. Hall and clean stage of its field were found without it, and are forgotten.
fn store_bytes(
    transaction: &Transaction<'_>,
    shared: &Shared,
    id: i64,
    bytes: &[u8],
) -> rusqlite::Result<()> {
    transaction.execute(
        "INSERT OR REPLACE INTO image_bytes (image_id, bytes) VALUES (?1, ?2)",
        params![id, bytes],
    )?;
    forget_clean_stage(transaction, shared.field_id)?;
    transaction.execute("DELETE FROM halls WHERE field_id = ?1", [shared.field_id]).map(drop)
}

/// Stored contents of an image.
struct StoredImage {
    id: i64,
    camera_id: i64,
    field_id: i64,
    timestamp_s: f64,
    file_name: String,
    pose: CameraPose,
    has_these_bytes: bool,
}

impl StoredImage {
    /// Finds the frame of a sequence, if it is there, and compares its bytes with those of an image.
    fn find(
        transaction: &Transaction<'_>,
        sequence_id: i64,
        image: &NewImage<'_>,
    ) -> rusqlite::Result<Option<Self>> {
        let query = "SELECT images.id, camera_id, field_id, timestamp_s, file_name,
                x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad, bytes IS ?3
                FROM images LEFT JOIN image_bytes ON image_bytes.image_id = images.id
                WHERE sequence_id = ?1 AND frame_index = ?2";
        let key = params![sequence_id, image.frame_index as i64, image.bytes];
        transaction.query_row(query, key, Self::from_row).optional()
    }

    fn from_row(row: &Row<'_>) -> rusqlite::Result<Self> {
        Ok(Self {
            id: row.get(0)?,
            camera_id: row.get(1)?,
            field_id: row.get(2)?,
            timestamp_s: row.get(3)?,
            file_name: row.get(4)?,
            pose: pose_from_row(row, 5)?,
            has_these_bytes: row.get(11)?,
        })
    }

    /// Returns whether the stored bytes are a picture of this size, pixels.
    fn is_readable(&self, transaction: &Transaction<'_>, size: [u32; 2]) -> rusqlite::Result<bool> {
        let query = "SELECT bytes FROM image_bytes WHERE image_id = ?1";
        let bytes: Option<Vec<u8>> = transaction.query_row(query, [self.id], |row| row.get(0)).optional()?;
        Ok(bytes.is_some_and(|bytes| check_image(Path::new(&self.file_name), &bytes, size).is_ok()))
    }
}
