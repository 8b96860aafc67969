//! What topics have in common, whichever messages they have.

use std::{fmt::Debug, sync::Arc};

use foxglove::{Context, FoxgloveError};

/// Topics of one file or one server.
pub trait Topics: Debug + Sized {
    /// Picture with everything that the topics tell of it.
    type Shot<'a>;

    /// Profile of an MCAP file with these topics, by which players know how to read it.
    const PROFILE: &'static str;

    /// Announces the topics. Fails if their definitions contradict each other.
    fn open(context: &Arc<Context>) -> Result<Self, FoxgloveError>;

    /// Returns the time of a picture, seconds.
    fn timestamp_s(shot: &Self::Shot<'_>) -> f64;

    /// Sends everything of a picture at its time.
    fn log(&self, shot: &Self::Shot<'_>);
}
