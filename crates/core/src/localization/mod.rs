//! What a localizer carries from picture to picture, and its settings.

mod config;
mod track;

pub use self::config::TrackConfig;
pub(crate) use self::track::{Beginning, Prediction, Track};
