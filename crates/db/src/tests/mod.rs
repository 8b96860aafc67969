//! Round trips of the demonstration walk through the database, and the faults that can occur.

mod cleaning;
mod copying;
mod hostile;
mod ingesting;
mod inserting;
mod interrupted;
mod opening;
mod reading;
mod removing;
mod sharing;

use std::{collections::BTreeMap, fs, path::Path, path::PathBuf};

use nalgebra::Matrix6;
use reality_sim_core::{pose::CameraPose, sequence::Sequence};
use tempfile::TempDir;

use crate::*;

fn walk() -> Sequence {
    Sequence::open(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/walk")).unwrap()
}

/// Returns the walk's first frames.
fn short_walk(frames: usize) -> Sequence {
    let mut sequence = walk();
    sequence.frames.truncate(frames);
    sequence
}

/// Returns the walk repeated, as one recording.
fn long_walk(frames: usize) -> Sequence {
    let once = walk();
    let count = once.frames.len();
    let mut sequence = once.clone();
    sequence.frames = (0..frames).map(|index| once.frames[index % count].clone()).collect();
    for (index, frame) in sequence.frames.iter_mut().enumerate() {
        frame.timestamp_s = 0.2 * index as f64;
    }
    sequence
}

/// Returns the ground truth with a covariance whose entries all differ.
fn estimates(sequence: &Sequence) -> Vec<Option<PoseEstimate>> {
    let covariance = Matrix6::from_fn(|i, j| if i == j { 0.1 } else { 1e-3 / (1 + i + j) as f64 });
    let estimate =
        |pose: Option<CameraPose>| pose.map(|pose| PoseEstimate { pose, covariance: Some(covariance) });
    sequence.reference_poses().map(estimate).collect()
}

fn add(database: &mut Database, sequence: &Sequence) -> Result<IngestReport, DbError> {
    database.ingest(sequence, &estimates(sequence), &PoseSource::GroundTruth)
}

/// Makes a database of a sequence; its folder is otherwise empty.
fn database_of(sequence: &Sequence) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.db");
    add(&mut Database::create_or_open(&path).unwrap(), sequence).unwrap();
    (folder, path)
}

fn names_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

/// Runs a statement as another program might.
fn tamper(path: &Path, sql: &str) {
    let connection = rusqlite::Connection::open(path).unwrap();
    connection.execute_batch(&format!("PRAGMA foreign_keys = OFF; {sql}")).unwrap();
}

/// Checks that a message is one line that names the file and contains these parts.
fn assert_message(error: &DbError, path: &Path, parts: &[&str]) {
    let message = error.to_string();
    assert!(message.starts_with(path.to_str().unwrap()), "{message}");
    assert!(!message.contains('\n'), "{message}");
    for part in parts {
        assert!(message.contains(part), "{part:?} is not in: {message}");
    }
}

/// Reads everything; damage must be an error whose message is a single line.
fn read_all(path: &Path) -> Result<usize, DbError> {
    let database = Database::open(path)?;
    database.sequences()?;
    database.cameras()?;
    database.fields()?;
    database.pose_sources()?;
    for field_id in database.fields()?.into_keys() {
        database.ground(field_id)?;
        database.image_masks(field_id)?;
    }
    let (images, details) = (database.images()?, details_of(&database)?);
    for image in &images {
        assert_eq!(database.image_bytes(image.id)?.len() as u64, details[&image.id].byte_length);
    }
    Ok(images.len())
}

/// Reads the details of all images, by their ids.
fn details_of(database: &Database) -> Result<BTreeMap<i64, ImageDetails>, DbError> {
    let mut details = BTreeMap::new();
    database.each_image(|image, of_image| drop(details.insert(image.id, of_image)))?;
    Ok(details)
}
