//! Ingestion of recordings into the database.

use reality_sim_core::sequence::{Sequence, SequenceError};
use rusqlite::Transaction;

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
pub(crate) const BATCH_BYTES: usize = 16 << 20;

/// Numbers of a sequence's frames by what happened to them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct IngestReport {
    /// Number of frames that were added.
    pub added: usize,
    /// Number of frames whose pictures the database held, but could not be decoded: they are replaced.
    pub replaced: usize,
    /// Number of frames that the database already held.
    pub already_there: usize,
    /// Number of frames that were left out because they have no pose.
    pub without_pose: usize,
}

impl IngestReport {
    /// Returns the number of frames that the database now holds.
    pub fn stored(&self) -> usize {
        self.added + self.replaced + self.already_there
    }

    pub(crate) fn count(&mut self, insertion: Insertion) {
        match insertion {
            Insertion::Added => self.added += 1,
            Insertion::Replaced => self.replaced += 1,
            Insertion::AlreadyThere => self.already_there += 1,
        }
    }
}

impl Database {
    /// Adds a sequence's pictures, as their files are, with one pose per frame; frames without a pose are left out.
    ///
    /// Frames are committed in batches. After an error, or when the program is killed, all committed batches stay, and the
    /// next call continues where this one ended. Frames that are already in the database are compared: another picture,
    /// pose, camera or field is [`DbFault::Changed`]; a picture that cannot be decoded any more is replaced. A sequence is
    /// recognised, wherever it is, by its name and the record of its first frame.
    ///
    /// Pictures that are missing or damaged are left out. Once all others are stored, they are the error
    /// [`DbFault::LeftOut`].
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
        check_poses(sequence, poses).map_err(fail)?;
        let recording = Recording::of_sequence(sequence, source.clone())?;
        let mut frames = Frames { sequence, poses, recording, unusable: Vec::new() };
        let mut report = IngestReport::default();
        let (mut done, mut is_wanted) = (0, true);
        while done < poses.len() && is_wanted {
            let mut goes_on = |done| {
                is_wanted = goes_on(done);
                is_wanted
            };
            done =
                self.write(|transaction| frames.add_batch(transaction, done, &mut report, &mut goes_on))?;
        }
        match sequence.unusable_pictures(frames.unusable) {
            None => Ok(report),
            Some(source) if report.stored() == 0 => Err(source.into()),
            Some(source) => {
                let stored = report.stored();
                Err(fail(DbFault::LeftOut { stored, source: source.into() }))
            }
        }
    }

    /// Adds one image in its own transaction. An image that the database already holds, recognised by its frame number in
    /// the recording, is compared: another picture, pose, time, camera or field is [`DbFault::Changed`].
    pub fn insert(&mut self, recording: &Recording, image: &NewImage<'_>) -> Result<Insertion, DbError> {
        insert::check(self.path(), recording, image)?;
        self.write(|transaction| {
            let shared = Shared::find_or_add(transaction, recording)?;
            insert(transaction, recording, &shared, image)
        })
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
    sequence: &'a Sequence,
    poses: &'a [Option<PoseEstimate>],
    recording: Recording,
    /// What is wrong with the pictures that are left out.
    unusable: Vec<SequenceError>,
}

impl Frames<'_> {
    /// Adds frames from this one on while `goes_on` returns true after each, and returns the number of the next one.
    fn add_batch(
        &mut self,
        transaction: &Transaction<'_>,
        first: usize,
        report: &mut IngestReport,
        goes_on: &mut dyn FnMut(usize) -> bool,
    ) -> Result<usize, DbFault> {
        // Added with the first picture that can be used: of a recording without any, nothing is stored.
        let mut shared = None;
        let end = self.poses.len().min(first + BATCH_FRAMES);
        let mut held_bytes = 0;
        for index in first..end {
            if held_bytes >= BATCH_BYTES {
                return Ok(index);
            }
            match &self.poses[index] {
                None => report.without_pose += 1,
                Some(estimate) => match self.sequence.image_bytes(index) {
                    Ok(bytes) => {
                        held_bytes += bytes.len();
                        let image = self.image(index, estimate, &bytes)?;
                        let shared = match &mut shared {
                            Some(shared) => shared,
                            none => none.insert(Shared::find_or_add(transaction, &self.recording)?),
                        };
                        report.count(insert(transaction, &self.recording, shared, &image)?);
                    }
                    Err(error) => self.unusable.push(error),
                },
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
