//! Channel for events from the worker thread to the listener.

use std::sync::mpsc;

use crate::{error::PipelineError, event::Event};

/// Sender of events, as long as somebody listens.
pub(crate) struct Outbox(mpsc::SyncSender<Result<Event, PipelineError>>);

/// Reason why the work stops before it is done.
pub(crate) enum Stop {
    /// Nobody listens any more.
    Cancelled,
    /// An error, which the listener receives.
    Failed(PipelineError),
}

impl<E: Into<PipelineError>> From<E> for Stop {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

impl Outbox {
    /// Wraps the sending end of a channel.
    pub fn new(sender: mpsc::SyncSender<Result<Event, PipelineError>>) -> Self {
        Self(sender)
    }

    /// Sends an event.
    pub fn send(&self, event: Event) -> Result<(), Stop> {
        self.0.send(Ok(event)).map_err(|_| Stop::Cancelled)
    }

    /// Sends the error after which there are no more events.
    pub fn fail(&self, error: PipelineError) {
        // It does not matter whether anybody still listens.
        let _ = self.0.send(Err(error));
    }
}
