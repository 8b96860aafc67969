//! Storage of recordings with their poses, of the hall around them and of the clean stage.

use std::{
    path::Path,
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

use reality_sim_core::{sequence::Sequence, warp::Hall};
use reality_sim_db::{Database, IngestReport};
use reality_sim_synthesis::{Archive, find_clean_stage, measure_hall};

use crate::{
    error::PipelineError,
    event::{CleanStageSummary, Event, FoundPoses},
    outbox::{Outbox, Stop},
};

/// Adds the images of another database.
pub(crate) fn store_images_of(
    database: &mut Database,
    number: usize,
    other: &Database,
    outbox: &Outbox,
) -> Result<(), Stop> {
    let of = other.images_by_field()?.into_values().sum();
    outbox.send(Event::CopyingStarted { database: number, images: of })?;
    let mut is_wanted = true;
    let report = database.copy_from(other, None, |done| {
        is_wanted = outbox.send(Event::Copied { database: number, done, of }).is_ok();
        is_wanted
    })?;
    if !is_wanted {
        return Err(Stop::Cancelled);
    }
    outbox.send(Event::DatabaseAdded { database: number, report })
}

/// Stores a recording with its poses.
pub(crate) fn store(
    database: &mut Database,
    recording: usize,
    sequence: &Sequence,
    poses: &FoundPoses,
    outbox: &Outbox,
) -> Result<IngestReport, Stop> {
    let of = sequence.frames.len();
    outbox.send(Event::StorageStarted { recording, frames: of })?;
    let start = Instant::now();
    let mut is_wanted = true;
    let report = database.ingest_while(sequence, &poses.estimates, &poses.source, |done| {
        is_wanted = outbox.send(Event::Stored { recording, done, of }).is_ok();
        is_wanted
    })?;
    if !is_wanted {
        return Err(Stop::Cancelled);
    }
    outbox.send(Event::Ingested { recording, report, seconds: start.elapsed().as_secs_f64() })?;
    Ok(report)
}

/// Measures and stores the hall around a field. `None` if the images do not show it.
pub(crate) fn store_hall(
    path: &Path,
    database: &mut Database,
    field_id: i64,
) -> Result<Option<Hall>, PipelineError> {
    let archive = Archive::open_field(path, field_id, 0)?;
    let Some(hall) = measure_hall(&archive)? else { return Ok(None) };
    database.set_hall(field_id, &hall)?;
    Ok(Some(hall))
}

/// Finds and stores the clean stage of a field, if the images show it.
pub(crate) fn store_clean_stage(
    path: &Path,
    database: &mut Database,
    field_id: i64,
    outbox: &Outbox,
) -> Result<(), Stop> {
    let archive = Archive::open_field(path, field_id, 0)?;
    outbox.send(Event::CleanStageStarted { images: archive.images().len() })?;
    let is_cancelled = AtomicBool::new(false);
    let goes_on = |done: usize, of: usize| {
        let is_wanted = outbox.send(Event::Cleaned { done, of }).is_ok();
        is_cancelled.fetch_or(!is_wanted, Ordering::Relaxed);
        is_wanted
    };
    let found = find_clean_stage(&archive, &goes_on)?;
    if is_cancelled.into_inner() {
        return Err(Stop::Cancelled);
    }
    let Some(found) = found else { return Ok(()) };
    database.set_clean_stage(field_id, &found.ground, &found.masks)?;
    outbox.send(Event::CleanStageFound(CleanStageSummary {
        masked_images: found.masks.len(),
        unknown_share: found.ground.unknown_share(),
    }))
}
