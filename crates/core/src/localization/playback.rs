//! A recording as a stream of observations.

use std::{
    iter::Peekable,
    sync::{Arc, mpsc},
    thread,
};

use super::{observation::Observation, picture::Picture};
use crate::sequence::{Sequence, SequenceError};

/// Iterator over the frames of a recording with their pictures. A thread decodes one picture ahead; it ends when the iterator is
/// dropped. The iteration ends after an error.
#[derive(Debug)]
pub struct Playback {
    sequence: Arc<Sequence>,
    next: usize,
    /// `None` once the thread has ended.
    pictures: Option<Peekable<mpsc::IntoIter<Result<Picture, SequenceError>>>>,
    thread: Option<thread::JoinHandle<()>>,
}

impl Playback {
    /// Starts decoding the pictures of a recording.
    pub fn new(sequence: Arc<Sequence>) -> Self {
        let (sender, receiver) = mpsc::sync_channel(0);
        let decoded = sequence.clone();
        let thread = thread::spawn(move || {
            for index in 0..decoded.frames.len() {
                let picture = decoded.load_image(index).map(Picture::from);
                // The receiver is gone once nobody wants more pictures.
                if sender.send(picture).is_err() {
                    break;
                }
            }
        });
        Self { sequence, next: 0, pictures: Some(receiver.into_iter().peekable()), thread: Some(thread) }
    }

    /// Returns the recording.
    pub fn sequence(&self) -> &Arc<Sequence> {
        &self.sequence
    }

    /// Waits for the next picture and returns it without advancing; `None` at the end or if the picture cannot be read.
    pub fn peek(&mut self) -> Option<&Picture> {
        self.pictures.as_mut()?.peek()?.as_ref().ok()
    }

    /// Ends the thread; a panic in the thread is resumed here.
    fn end(&mut self) {
        self.pictures = None;
        if let Some(Err(panic)) = self.thread.take().map(thread::JoinHandle::join)
            && !thread::panicking()
        {
            std::panic::resume_unwind(panic);
        }
    }
}

impl Iterator for Playback {
    type Item = Result<Observation, SequenceError>;

    fn next(&mut self) -> Option<Self::Item> {
        let index = self.next;
        self.next += 1;
        match self.pictures.as_mut()?.next() {
            Some(Ok(picture)) => Some(Ok(Observation::of_frame(&self.sequence, index, picture))),
            Some(Err(error)) => {
                self.end();
                Some(Err(error))
            }
            None => {
                self.end();
                None
            }
        }
    }
}

impl Drop for Playback {
    fn drop(&mut self) {
        self.end();
    }
}
