//! Storage of recordings with their poses, and of the hall around them.

use std::{path::Path, time::Instant};

use reality_sim_core::{sequence::Sequence, warp::Hall};
use reality_sim_db::{Database, IngestReport};
use reality_sim_synthesis::{Archive, measure_hall};

use crate::{
    error::PipelineError,
    event::{Event, FoundPoses},
    outbox::{Outbox, Stop},
};

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
