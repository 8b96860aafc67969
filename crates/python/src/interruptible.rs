//! Work that Ctrl-C ends.

use std::{
    sync::mpsc::{self, RecvTimeoutError},
    thread,
    time::Duration,
};

use pyo3::{exceptions::PyRuntimeError, prelude::*};

/// How often it is asked whether somebody has pressed Ctrl-C.
const POLL: Duration = Duration::from_millis(50);

/// Does some work without Python's lock, on a thread of its own. Where a handler of a signal raises meanwhile, as that of Ctrl-C does, the
/// exception is returned at once, and the work goes on unheard until it is done or the process ends.
pub fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, receiver) = mpsc::sync_channel(1);
    // Whoever was interrupted does not listen any more.
    thread::spawn(move || sender.send(work()).ok());
    py.detach(move || {
        loop {
            match receiver.recv_timeout(POLL) {
                Ok(done) => return Ok(done),
                Err(RecvTimeoutError::Timeout) => check_signals()?,
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(PyRuntimeError::new_err("a defect of the library: its thread has panicked"));
                }
            }
        }
    })
}

/// Calls the handlers of signals that have come, and returns what they raise. The caller does not hold Python's lock.
pub fn check_signals() -> PyResult<()> {
    #[expect(clippy::redundant_closure_for_method_calls, reason = "the method is of one lifetime only")]
    Python::attach(|py| py.check_signals())
}
