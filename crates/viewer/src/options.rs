//! Options of the window.

use std::path::PathBuf;

use crate::Device;

/// What the window first shows, and what it may use.
#[derive(Debug, Clone)]
pub struct ViewerOptions {
    /// Path of a recording, a database, or a report of the gap.
    pub open: PathBuf,
    /// Recording that ships with the program, if it is found.
    pub demonstration: Option<PathBuf>,
    /// Devices for the filter and the pictures, the default one first. At least one.
    pub devices: Vec<Device>,
}
