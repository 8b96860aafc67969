//! Decoding ahead: a thread decodes the pictures that a moving camera needs next.

use std::{
    collections::VecDeque,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread::{self, JoinHandle},
};

use reality_sim_core::pose::CameraPose;

use crate::Synthesizer;

/// Largest number of poses that wait; the oldest one is dropped for a newer one.
const WAITING: usize = 4;

/// Thread that decodes what pictures at expected poses need. Cameras share one; the pictures are kept in the archive, within
/// its bound.
#[derive(Debug)]
pub struct Ahead {
    queue: Arc<Queue>,
    /// `None` where the system gave no thread: then nothing is decoded ahead.
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug, Default)]
struct Queue {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    poses: VecDeque<CameraPose>,
    is_over: bool,
}

impl Ahead {
    /// Starts the thread.
    pub fn new(synthesizer: Arc<Synthesizer>) -> Self {
        let queue = Arc::new(Queue::default());
        let work = {
            let queue = queue.clone();
            move || {
                while let Some(pose) = queue.next() {
                    // A picture that cannot be made is an error of the call that asks for it.
                    synthesizer.prepare(pose).ok();
                }
            }
        };
        let thread = thread::Builder::new().name("decoding ahead".to_owned()).spawn(work).ok();
        Self { queue, thread }
    }

    /// Decodes in the background what a picture at a pose needs.
    pub fn expect(&self, pose: CameraPose) {
        let mut state = self.queue.lock();
        if state.poses.len() == WAITING {
            state.poses.pop_front();
        }
        state.poses.push_back(pose);
        self.queue.changed.notify_one();
    }
}

impl Drop for Ahead {
    fn drop(&mut self) {
        self.queue.lock().is_over = true;
        self.queue.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

impl Queue {
    /// Waits for a pose; `None` at the end.
    fn next(&self) -> Option<CameraPose> {
        let mut state = self.lock();
        loop {
            if state.is_over {
                return None;
            }
            if let Some(pose) = state.poses.pop_front() {
                return Some(pose);
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing panics while the lock is held.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
