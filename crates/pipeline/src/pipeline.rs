//! A running plan.

use std::{path::Path, sync::mpsc, thread};

use reality_sim_db::Database;

use crate::{
    error::PipelineError,
    event::{Event, FoundPoses},
    outbox::{Outbox, Stop},
    plan::Plan,
    poses::PoseFinder,
    storage::{store, store_clean_stage, store_hall, store_images_of},
};

/// Largest number of events that wait for the listener.
const QUEUE: usize = 1;

/// Plan that runs on a thread of its own, as a stream of events. There are no more events after an error. Dropping the
/// pipeline cancels the work and waits until the thread has ended; what was stored before stays, and another pipeline
/// continues from there.
#[derive(Debug)]
pub struct Pipeline {
    /// `None` once the events have ended.
    events: Option<mpsc::Receiver<Result<Event, PipelineError>>>,
    thread: Option<thread::JoinHandle<()>>,
}

impl Plan {
    /// Starts the pipeline.
    pub fn start(self) -> Pipeline {
        let (sender, events) = mpsc::sync_channel(QUEUE);
        let thread = thread::spawn(move || {
            let outbox = Outbox::new(sender);
            if let Err(Stop::Failed(error)) = work(&self, &outbox) {
                outbox.fail(error);
            }
        });
        Pipeline { events: Some(events), thread: Some(thread) }
    }
}

/// Finds all poses before anything is stored, so that an error of the filter does not leave half a database behind.
fn work(plan: &Plan, outbox: &Outbox) -> Result<(), Stop> {
    if let Some(path) = plan.database.as_deref().filter(|path| path.exists()) {
        // Whether the file can be a database is checked before the filter works for an hour.
        drop(Database::create_or_open(path)?);
    }
    for path in &plan.databases {
        drop(Database::open(path)?);
    }
    if plan.database.is_some() {
        plan.recordings.iter().try_for_each(|sequence| sequence.check_pictures())?;
    }
    let mut finder = PoseFinder::new(plan, outbox);
    let mut poses = Vec::with_capacity(plan.recordings.len());
    for recording in 0..plan.recordings.len() {
        let found = finder.find(recording)?;
        outbox.send(Event::PosesFound { recording, poses: found.clone() })?;
        poses.push(found);
    }
    match &plan.database {
        Some(path) => store_all(plan, path, &poses, outbox),
        None => Ok(()),
    }
}

fn store_all(plan: &Plan, path: &Path, poses: &[FoundPoses], outbox: &Outbox) -> Result<(), Stop> {
    let mut database = Database::create_or_open(path)?;
    for (number, path) in plan.databases.iter().enumerate() {
        store_images_of(&mut database, number, &Database::open(path)?, outbox)?;
    }
    for (recording, (sequence, poses)) in plan.recordings.iter().zip(poses).enumerate() {
        store(&mut database, recording, sequence, poses, outbox)?;
    }
    let images = database.images()?.len();
    let mut hall = None;
    let fields = if plan.measures_hall { database.fields_without_hall()? } else { Vec::new() };
    for field_id in fields {
        outbox.send(Event::HallStarted)?;
        hall = store_hall(path, &mut database, field_id)?.or(hall);
    }
    let fields = if plan.finds_clean_stage { database.fields_without_ground()? } else { Vec::new() };
    for field_id in fields {
        store_clean_stage(path, &mut database, field_id, outbox)?;
    }
    drop(database);
    outbox.send(Event::Completed { images, hall })
}

impl Pipeline {
    /// Waits for the end of the thread and resumes its panic, if any.
    fn end(&mut self) {
        self.events = None;
        if let Some(Err(panic)) = self.thread.take().map(thread::JoinHandle::join)
            && !thread::panicking()
        {
            std::panic::resume_unwind(panic);
        }
    }
}

impl Iterator for Pipeline {
    type Item = Result<Event, PipelineError>;

    fn next(&mut self) -> Option<Self::Item> {
        let event = self.events.as_ref()?.recv().ok();
        if !matches!(event, Some(Ok(_))) {
            self.end();
        }
        event
    }
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        self.end();
    }
}
