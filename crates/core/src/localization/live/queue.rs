//! Pictures that wait to be localized: a few, of which the oldest makes room for the newest.

use std::{
    collections::VecDeque,
    mem,
    num::NonZeroUsize,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
    time::Instant,
};

use crate::{localization::Observation, pose::Pose2};

/// What became of a picture that was handed over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[must_use]
pub enum Pushed {
    /// It waits for its turn.
    Waits,
    /// It waits, and the oldest picture that waited was dropped.
    OldestDropped,
    /// It was refused: nothing is localized any more.
    Refused,
}

/// Picture that waits.
pub(super) struct Waiting {
    pub observation: Observation,
    pub since: Instant,
    /// Number of pictures that were dropped just before it.
    pub dropped_before: u64,
    /// Whether the odometry restarts at its origin here: whoever misses it takes the restart for a motion.
    is_restart: bool,
}

/// Queue between the camera's thread and the one that localizes.
pub(super) struct Queue {
    capacity: NonZeroUsize,
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    waiting: VecDeque<Waiting>,
    odometry: Option<Pose2>,
    dropped: u64,
    /// Number of pictures that were dropped after the last one that waits.
    dropped_before_next: u64,
    is_closed: bool,
}

impl Queue {
    /// Makes a queue for so many pictures.
    pub fn new(capacity: NonZeroUsize) -> Self {
        Self { capacity, state: Mutex::default(), changed: Condvar::new() }
    }

    /// Adds a picture without waiting; drops the oldest one if there is no room.
    pub fn push(&self, observation: Observation) -> Pushed {
        let mut state = self.state();
        if state.is_closed {
            return Pushed::Refused;
        }
        let origin = Some(Pose2::default());
        let is_restart =
            observation.odometry == origin && state.odometry.is_some_and(|before| Some(before) != origin);
        state.odometry = observation.odometry.or(state.odometry);
        let is_full = state.waiting.len() >= self.capacity.get();
        let dropped_before = mem::take(&mut state.dropped_before_next);
        let waiting = Waiting { observation, since: Instant::now(), dropped_before, is_restart };
        state.waiting.push_back(waiting);
        if is_full {
            state.drop_oldest();
        }
        drop(state);
        self.changed.notify_one();
        if is_full { Pushed::OldestDropped } else { Pushed::Waits }
    }

    /// Waits for a picture and takes it; `None` once the queue is closed and empty.
    pub fn pop(&self) -> Option<Waiting> {
        let mut state = self.state();
        loop {
            if let Some(next) = state.waiting.pop_front() {
                return Some(next);
            }
            if state.is_closed {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Refuses further pictures; those that wait stay.
    pub fn close(&self) {
        self.state().is_closed = true;
        self.changed.notify_all();
    }

    /// Refuses further pictures, and throws away those that wait.
    pub fn stop(&self) {
        let mut state = self.state();
        state.is_closed = true;
        state.waiting.clear();
        drop(state);
        self.changed.notify_all();
    }

    /// Returns the number of pictures that were dropped so far.
    pub fn dropped(&self) -> u64 {
        self.state().dropped
    }

    /// A thread that panicked here left nothing half done.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    /// Drops the oldest picture, or the oldest at which the odometry does not restart. The picture after it tells of it.
    fn drop_oldest(&mut self) {
        let oldest = self.waiting.iter().position(|waiting| !waiting.is_restart).unwrap_or(0);
        let Some(dropped) = self.waiting.remove(oldest) else { return };
        self.dropped += 1;
        match self.waiting.get_mut(oldest) {
            Some(next) => next.dropped_before += dropped.dropped_before + 1,
            None => self.dropped_before_next += dropped.dropped_before + 1,
        }
    }
}
