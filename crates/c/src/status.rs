//! Outcome of functions.

use std::panic::{AssertUnwindSafe, catch_unwind};

use reality_sim::{SynthesisError, simulator::LookError};

use crate::message::remember;

/// Outcome of a function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub enum Status {
    /// It did what was asked.
    Ok = 0,
    /// An argument was missing or impossible.
    Argument = 1,
    /// The database could not be read.
    Database = 2,
    /// Too little was recorded near the pose for a picture.
    NoPicture = 3,
    /// The library failed where it must not. Its authors would like to hear of it.
    Defect = 4,
}

/// Reason why a function fails.
#[derive(Debug)]
pub struct Failure {
    pub status: Status,
    pub message: String,
}

impl Failure {
    /// Makes a failure of an argument.
    pub fn argument(message: impl Into<String>) -> Self {
        Self { status: Status::Argument, message: message.into() }
    }
}

impl From<SynthesisError> for Failure {
    fn from(error: SynthesisError) -> Self {
        let status = if error.is_refusal() { Status::NoPicture } else { Status::Database };
        Self { status, message: error.to_string() }
    }
}

impl From<LookError> for Failure {
    fn from(error: LookError) -> Self {
        let status = if error.is_refusal() { Status::NoPicture } else { Status::Database };
        Self { status, message: error.to_string() }
    }
}

/// Does the work of a function, and remembers why it failed. A panic must not reach C.
pub fn outcome(work: impl FnOnce() -> Result<(), Failure>) -> Status {
    let done = catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let words = panic.downcast_ref::<&str>().map(|words| (*words).to_owned());
        let words = words.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
        Err(Failure { status: Status::Defect, message: format!("a defect of the library: {words}") })
    });
    match done {
        Ok(()) => Status::Ok,
        Err(Failure { status, message }) => {
            remember(message);
            status
        }
    }
}
