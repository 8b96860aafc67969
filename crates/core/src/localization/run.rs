//! Localization of a whole recording, frame by frame.

use std::{borrow::BorrowMut, sync::Arc};

use super::{
    error::LocalizationError, frame::LocalizedFrame, localizer::Localizer, observation::Observation,
    playback::Playback,
};
use crate::sequence::{Sequence, SequenceError};

/// Iterator that localizes the frames of a recording in order. A thread decodes the pictures ahead; dropping the iterator
/// stops it. The iteration ends after an error; that of a picture tells of all pictures that cannot be used.
#[derive(Debug)]
pub struct Run<L> {
    localizer: L,
    playback: Playback,
    observation: Option<Observation>,
    /// What the next step takes; `None` before the first.
    upcoming: Option<Result<Observation, SequenceError>>,
    has_failed: bool,
}

impl Localizer {
    /// Localizes the frames of a recording in order, one with every step of the iterator.
    pub fn run(&mut self, sequence: &Sequence) -> Run<&mut Self> {
        Run::new(self, Arc::new(sequence.clone()))
    }
}

impl<L: BorrowMut<Localizer>> Run<L> {
    /// Works as [`Localizer::run`], with a localizer that is owned.
    pub fn new(localizer: L, sequence: Arc<Sequence>) -> Self {
        let playback = Playback::new(sequence);
        Self { localizer, playback, observation: None, upcoming: None, has_failed: false }
    }

    /// Ends the run, and returns the localizer.
    pub fn into_localizer(self) -> L {
        self.localizer
    }

    /// Returns the localizer as the last frame left it.
    pub fn localizer(&self) -> &Localizer {
        self.localizer.borrow()
    }

    /// Returns what was observed at the last frame.
    pub fn observation(&self) -> Option<&Observation> {
        self.observation.as_ref()
    }

    fn step(&mut self) -> Option<Result<LocalizedFrame, LocalizationError>> {
        let observation = match self.upcoming.take().or_else(|| self.playback.next())? {
            Ok(observation) => observation,
            // Whoever mends the recording wants to know of all its broken pictures.
            Err(error) => {
                let all = self.playback.sequence().check_every_picture();
                return Some(Err(all.err().unwrap_or(error).into()));
            }
        };
        let localizer = self.localizer.borrow_mut();
        if let Some(next) = self.playback.peek() {
            localizer.prefetch(next.pixels());
        }
        let frame = localizer.update(&observation);
        self.observation = Some(observation);
        // Taken now: the next picture but one is decoded while the caller looks at the result, and less while a picture is localized, which
        // uses all cores.
        self.upcoming = self.playback.next();
        self.playback.peek();
        Some(frame)
    }
}

impl<L: BorrowMut<Localizer>> Iterator for Run<L> {
    type Item = Result<LocalizedFrame, LocalizationError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.has_failed {
            return None;
        }
        let frame = self.step();
        self.has_failed = matches!(frame, Some(Err(_)));
        frame
    }
}
