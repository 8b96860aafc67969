//! The way of events from the thread that works to whoever listens.

use std::sync::mpsc;

use crate::{error::PipelineError, event::Event};

/// Sends events for as long as anybody listens.
pub(crate) struct Outbox(mpsc::SyncSender<Result<Event, PipelineError>>);

/// Why the work ends before it is done.
pub(crate) enum Stop {
    /// Nobody listens any more.
    Cancelled,
    /// An error, which the listener is told.
    Failed(PipelineError),
}

impl<E: Into<PipelineError>> From<E> for Stop {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

impl Outbox {
    /// The sending end of a channel.
    pub fn new(sender: mpsc::SyncSender<Result<Event, PipelineError>>) -> Self {
        Self(sender)
    }

    /// Tells what has been done.
    pub fn send(&self, event: Event) -> Result<(), Stop> {
        self.0.send(Ok(event)).map_err(|_| Stop::Cancelled)
    }

    /// Tells why there are no more events.
    pub fn fail(&self, error: PipelineError) {
        // Who does not listen any more need not know.
        let _ = self.0.send(Err(error));
    }
}
