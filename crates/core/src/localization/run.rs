//! A recording localized, frame after frame.

use std::{borrow::BorrowMut, sync::Arc};

use super::{
    error::LocalizationError, frame::LocalizedFrame, localizer::Localizer, observation::Observation,
    playback::Playback,
};
use crate::sequence::Sequence;

/// The frames of a recording, localized in order. Pictures are decoded ahead on a thread of their own; dropping this
/// cancels it. After an error there are no more frames.
#[derive(Debug)]
pub struct Run<L> {
    localizer: L,
    playback: Playback,
    observation: Option<Observation>,
    has_failed: bool,
}

impl Localizer {
    /// Localizes the frames of a recording in order, one with every step of the iterator.
    pub fn run(&mut self, sequence: &Sequence) -> Run<&mut Self> {
        Run::new(self, Arc::new(sequence.clone()))
    }
}

impl<L: BorrowMut<Localizer>> Run<L> {
    /// As [`Localizer::run`], with a localizer that is owned.
    pub fn new(localizer: L, sequence: Arc<Sequence>) -> Self {
        Self { localizer, playback: Playback::new(sequence), observation: None, has_failed: false }
    }

    /// Ends here, and gives the localizer back.
    pub fn into_localizer(self) -> L {
        self.localizer
    }

    /// The localizer as the last frame left it.
    pub fn localizer(&self) -> &Localizer {
        self.localizer.borrow()
    }

    /// What was observed at the last frame.
    pub fn observation(&self) -> Option<&Observation> {
        self.observation.as_ref()
    }

    fn step(&mut self) -> Option<Result<LocalizedFrame, LocalizationError>> {
        let observation = match self.playback.next()? {
            Ok(observation) => observation,
            Err(error) => return Some(Err(error.into())),
        };
        let localizer = self.localizer.borrow_mut();
        if let Some(next) = self.playback.peek() {
            localizer.prefetch(next.pixels());
        }
        let frame = localizer.update(&observation);
        self.observation = Some(observation);
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
