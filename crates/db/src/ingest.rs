//! Ingestion of recordings into the database.

use std::{path::Path, sync::PoisonError};

use reality_sim_core::sequence::Sequence;
use rusqlite::{Connection, Transaction, TransactionBehavior};

use crate::{
    database::Database,
    error::{DbError, DbFault},
    insert::{self, Shared, insert},
    record::{PoseEstimate, PoseSource},
    recording::{Insertion, NewImage, Recording},
};

/// Largest number of frames that are committed together.
pub(crate) const BATCH_FRAMES: usize = 64;

/// Size at which a transaction is committed, bytes: until then all of it stays in the writer's memory.
const BATCH_BYTES: usize = 16 << 20;

/// Numbers of a sequence's frames by what happened to them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct IngestReport {
    /// Number of frames that were added.
    pub added: usize,
    /// Number of frames that the database already held.
    pub already_there: usize,
    /// Number of frames that were left out because they have no pose.
    pub without_pose: usize,
}

impl Database {
    /// Adds a sequence's pictures, as their files are, with one pose per frame; frames without a pose are left out.
    ///
    /// Frames are committed in batches. After an error, or when the program is killed, all committed batches stay, and the
    /// next call continues where this one ended. Frames that are already in the database are compared: another picture,
    /// pose, camera or field is [`DbFault::Changed`]. A sequence is recognised, wherever it is, by its name and the record
    /// of its first frame.
    pub fn ingest(
        &mut self,
        sequence: &Sequence,
        poses: &[Option<PoseEstimate>],
        source: &PoseSource,
    ) -> Result<IngestReport, DbError> {
        self.ingest_while(sequence, poses, source, |_| true)
    }

    /// Works like [`Database::ingest`] while `goes_on` returns true. It gets the number of frames done after every frame,
    /// before that frame is committed; once it returns false, the frames done are committed, and the rest is left for
    /// another call.
    pub fn ingest_while(
        &mut self,
        sequence: &Sequence,
        poses: &[Option<PoseEstimate>],
        source: &PoseSource,
        mut goes_on: impl FnMut(usize) -> bool,
    ) -> Result<IngestReport, DbError> {
        let path = self.path().to_path_buf();
        let fail = |fault| DbError::new(&path, fault);
        if !self.is_writer {
            return Err(fail(DbFault::OpenedForReading));
        }
        check_poses(sequence, poses).map_err(fail)?;
        let recording = Recording::of_sequence(sequence, source.clone())?;
        let frames = Frames { path: &path, sequence, poses, recording };
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
            done = frames.add_batch(&transaction, done, &mut report, &mut goes_on)?;
            transaction.commit().map_err(|error| fail(error.into()))?;
        }
        Ok(report)
    }

    /// Adds one image in its own transaction. An image that the database already holds, recognised by its frame number in
    /// the recording, is compared: another picture, pose, time, camera or field is [`DbFault::Changed`].
    pub fn insert(&mut self, recording: &Recording, image: &NewImage<'_>) -> Result<Insertion, DbError> {
        let path = self.path().to_path_buf();
        let fail = |fault| DbError::new(&path, fault);
        if !self.is_writer {
            return Err(fail(DbFault::OpenedForReading));
        }
        insert::check(&path, recording, image)?;
        let insert_now = |connection: &mut Connection| -> Result<Insertion, DbFault> {
            let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
            let shared = Shared::find_or_add(&transaction, recording)?;
            let insertion = insert(&transaction, recording, &shared, image)?;
            transaction.commit()?;
            Ok(insertion)
        };
        let connection = self.connection.get_mut().unwrap_or_else(PoisonError::into_inner);
        insert_now(connection).map_err(fail)
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

/// Frames of a sequence with everything that they share.
struct Frames<'a> {
    path: &'a Path,
    sequence: &'a Sequence,
    poses: &'a [Option<PoseEstimate>],
    recording: Recording,
}

impl Frames<'_> {
    /// Adds frames from this one on while `goes_on` returns true after each, and returns the number of the next one.
    fn add_batch(
        &self,
        transaction: &Transaction<'_>,
        first: usize,
        report: &mut IngestReport,
        goes_on: &mut dyn FnMut(usize) -> bool,
    ) -> Result<usize, DbError> {
        let fail = |fault| DbError::new(self.path, fault);
        let shared =
            Shared::find_or_add(transaction, &self.recording).map_err(|error| fail(DbFault::from(error)))?;
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
                    let image = self.image(index, estimate, &bytes).map_err(fail)?;
                    match insert(transaction, &self.recording, &shared, &image).map_err(fail)? {
                        Insertion::Added => report.added += 1,
                        Insertion::AlreadyThere => report.already_there += 1,
                    }
                }
            }
            if !goes_on(index + 1) {
                return Ok(index + 1);
            }
        }
        Ok(end)
    }

    fn image<'b>(
        &'b self,
        index: usize,
        estimate: &'b PoseEstimate,
        bytes: &'b [u8],
    ) -> Result<NewImage<'b>, DbFault> {
        let frame = &self.sequence.frames[index];
        let file_name = frame.image.to_str().ok_or(DbFault::NameNotUtf8 { frame_index: index })?;
        Ok(NewImage { frame_index: index, timestamp_s: frame.timestamp_s, file_name, estimate, bytes })
    }
}
