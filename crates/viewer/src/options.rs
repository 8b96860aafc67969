//! Options of the window.

use std::path::PathBuf;

use crate::Device;

/// Options of the window: what it first shows, and the devices that it offers.
#[derive(Debug, Clone)]
pub struct ViewerOptions {
    /// Path of a recording, a database, or a report of the gap.
    pub open: PathBuf,
    /// Recording that ships with the program, if it is found.
    pub demonstration: Option<PathBuf>,
    /// Devices for the filter and the pictures, the default one first. At least one.
    pub devices: Vec<Device>,
}
