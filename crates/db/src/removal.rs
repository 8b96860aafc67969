//! Removal of images from the database.

use std::ops::Range;

use rusqlite::{Transaction, params};

use crate::{
    clean_stage::forget_clean_stage,
    database::Database,
    error::{DbError, DbFault},
};

/// Tables whose rows images refer to, and the columns by which they do.
const SHARED: [(&str, &str); 4] = [
    ("sequences", "sequence_id"),
    ("cameras", "camera_id"),
    ("fields", "field_id"),
    ("pose_sources", "pose_source_id"),
];

impl Database {
    /// Removes the images of the recordings of this name whose frames, counted from 0, are in the range, and returns their
    /// number. All are removed, or, after an error, none. Fails if no recording has this name.
    ///
    /// Halls and clean stages of their fields were found with them, and are forgotten. The file keeps its length; what is added
    /// next uses the space.
    pub fn remove(&mut self, sequence: &str, frames: Range<usize>) -> Result<usize, DbError> {
        self.write(|transaction| remove(transaction, sequence, &frames))
    }
}

fn remove(transaction: &Transaction<'_>, sequence: &str, frames: &Range<usize>) -> Result<usize, DbFault> {
    let recordings: i64 =
        transaction
            .query_row("SELECT count(*) FROM sequences WHERE name = ?1", [sequence], |row| row.get(0))?;
    if recordings == 0 {
        return Err(DbFault::NoSuchSequence { name: sequence.to_owned() });
    }
    let chosen = "SELECT images.id FROM images JOIN sequences ON sequences.id = sequence_id
        WHERE sequences.name = ?1 AND frame_index >= ?2 AND frame_index < ?3";
    let bound = |frame: usize| i64::try_from(frame).unwrap_or(i64::MAX);
    let values = params![sequence, bound(frames.start), bound(frames.end)];
    let fields = format!("SELECT DISTINCT field_id FROM images WHERE id IN ({chosen})");
    let fields: Vec<i64> = transaction
        .prepare(&fields)?
        .query_map(values, |row| row.get(0))?
        .collect::<rusqlite::Result<_>>()?;
    fields.iter().try_for_each(|field_id| forget_clean_stage(transaction, *field_id))?;
    transaction.execute(
        &format!("DELETE FROM halls WHERE field_id IN (SELECT field_id FROM images WHERE id IN ({chosen}))"),
        values,
    )?;
    transaction.execute(&format!("DELETE FROM image_bytes WHERE image_id IN ({chosen})"), values)?;
    let removed = transaction.execute(&format!("DELETE FROM images WHERE id IN ({chosen})"), values)?;
    for (table, column) in SHARED {
        let unused = format!("DELETE FROM {table} WHERE id NOT IN (SELECT {column} FROM images)");
        transaction.execute(&unused, [])?;
    }
    Ok(removed)
}
