//! What the window is opened with.

use std::path::PathBuf;

use crate::Device;

/// What the window shows first, and what it may use.
#[derive(Debug, Clone)]
pub struct ViewerOptions {
    /// A recording, a database, or a report of the gap.
    pub open: PathBuf,
    /// The recording that ships with the program, where it is found.
    pub demonstration: Option<PathBuf>,
    /// Where filter and pictures can be computed, the usual one first. At least one.
    pub devices: Vec<Device>,
}
