//! Opening the window, or saying what is missing.

use std::path::PathBuf;

use eframe::egui;

use crate::{Device, ViewerApp};

/// What the window shows first, and what it may use.
#[derive(Debug, Clone)]
pub struct ViewerOptions {
    /// A recording or a database.
    pub open: PathBuf,
    /// The recording that ships with the program, where it is found.
    pub demonstration: Option<PathBuf>,
    /// Where filter and pictures can be computed, the usual one first. At least one.
    pub devices: Vec<Device>,
}

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
pub enum ViewerError {
    /// No screen.
    #[error(
        "viewer: there is no display to open a window on (neither DISPLAY nor WAYLAND_DISPLAY is set): start it from a desktop, or under xvfb-run"
    )]
    NoDisplay,
    /// Nothing that draws.
    #[error(
        "viewer: no graphics driver can draw the window: install a Vulkan driver (on Debian and Ubuntu: apt-get install mesa-vulkan-drivers): {0}"
    )]
    NoGraphics(String),
    /// The display, or what is between it and us.
    #[error("viewer: the window could not be opened: check that the display can be reached: {0}")]
    NoWindow(String),
}

/// Opens the window, and returns when it is closed.
pub fn run(options: ViewerOptions) -> Result<(), ViewerError> {
    if cfg!(target_os = "linux") && !has_display() {
        return Err(ViewerError::NoDisplay);
    }
    let viewport = egui::ViewportBuilder::default()
        .with_title("Reality Sim")
        .with_app_id("reality-sim")
        .with_inner_size([1280.0, 820.0])
        .with_min_inner_size([640.0, 420.0]);
    let native = eframe::NativeOptions { viewport, ..Default::default() };
    let app = |cc: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, _> {
        Ok(Box::new(ViewerApp::new(cc, options)))
    };
    eframe::run_native("Reality Sim", native, Box::new(app)).map_err(|error| match error {
        eframe::Error::Wgpu(error) => ViewerError::NoGraphics(error.to_string()),
        error => ViewerError::NoWindow(error.to_string()),
    })
}

fn has_display() -> bool {
    ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"]
        .iter()
        .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}
