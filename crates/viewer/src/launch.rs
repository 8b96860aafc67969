//! Opening the window, or reporting why it cannot be opened.

use std::{
    any::Any,
    panic::{self, AssertUnwindSafe},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use eframe::{egui, egui_wgpu::WgpuSetup};

use crate::{ViewerApp, ViewerOptions};

/// Error of opening the window.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewerError {
    /// There is no display.
    #[error(
        "viewer: there is no display to open a window on (neither DISPLAY nor WAYLAND_DISPLAY is set): start it from a desktop, or under xvfb-run"
    )]
    NoDisplay,
    /// No graphics driver can draw the window.
    #[error(
        "viewer: no graphics driver can draw the window ({0}): install a Vulkan driver (on Debian and Ubuntu: apt-get install mesa-vulkan-drivers)"
    )]
    NoGraphics(String),
    /// The display, or the connection to it, failed.
    #[error(
        "viewer: the window could not be opened ({0}): check that DISPLAY or WAYLAND_DISPLAY names a display that can be reached, and that the libraries that windows need are there (on Debian and Ubuntu: bash scripts/setup)"
    )]
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
    let mut native = eframe::NativeOptions { viewport, ..Default::default() };
    if let WgpuSetup::CreateNew(setup) = &mut native.wgpu_options.wgpu_setup {
        // OpenGL is only compiled in if another package of the same build asks for it; without it, the window is the same
        // everywhere.
        setup.instance_descriptor.backends.remove(wgpu::Backends::GL);
    }
    let opened = while_opening(|is_open| {
        let app = |cc: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, _> {
            is_open();
            Ok(Box::new(ViewerApp::new(cc, options)))
        };
        eframe::run_native("Reality Sim", native, Box::new(app))
    })?;
    opened.map_err(|error| match error {
        // The message lists the error of each kind of driver; the list is empty if there is none.
        eframe::Error::Wgpu(error) => ViewerError::NoGraphics(error.to_string().replace(": {}", "")),
        error => ViewerError::NoWindow(reason(&error.to_string())),
    })
}

fn has_display() -> bool {
    ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"]
        .iter()
        .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}

/// Runs the function that opens the window. Missing libraries make winit panic: until the window is open, a panic is
/// returned as an error, and nothing of it goes to standard error. A later panic stays a panic.
fn while_opening<T>(open: impl FnOnce(&dyn Fn()) -> T) -> Result<T, ViewerError> {
    let is_open = Arc::new(AtomicBool::new(false));
    let (loud, is_loud) = (Arc::new(panic::take_hook()), is_open.clone());
    let this_thread = std::thread::current().id();
    panic::set_hook(Box::new(move |info| {
        if is_loud.load(Ordering::Relaxed) || std::thread::current().id() != this_thread {
            loud(info);
        }
    }));
    let result = panic::catch_unwind(AssertUnwindSafe(|| open(&|| is_open.store(true, Ordering::Relaxed))));
    result.map_err(|panic| {
        if is_open.load(Ordering::Relaxed) {
            panic::resume_unwind(panic);
        }
        ViewerError::NoWindow(words(&*panic))
    })
}

/// Returns the message of a panic.
fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("for an unknown reason").trim_end_matches('.').to_owned()
}

/// Returns winit's message without the source location at its beginning.
fn reason(message: &str) -> String {
    let place = message.split_once("os error at ").and_then(|(_, rest)| rest.split_once(": "));
    place.map_or(message, |(_, reason)| reason).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_result_of_opening_the_window_is_returned() {
        assert_eq!(while_opening(|_| 5).unwrap(), 5);
    }

    #[test]
    fn a_library_that_is_missing_is_an_error_in_words() {
        let result: Result<(), _> = while_opening(|_| panic!("Library libnone.so could not be loaded."));
        let message = result.unwrap_err().to_string();
        assert!(message.contains("libnone.so") && message.contains("scripts/setup"), "{message}");
    }

    #[test]
    fn a_fault_in_the_open_window_stays_a_panic() {
        let run = || {
            while_opening(|is_open| {
                is_open();
                panic!("meant to: part of a test");
            })
        };
        let result: Result<Result<(), _>, _> = panic::catch_unwind(run);
        assert!(result.is_err());
    }

    #[test]
    fn source_locations_of_winit_are_not_shown() {
        let message = "winit EventLoopError: os error at /home/src/mod.rs:785: no X server";
        assert_eq!(reason(message), "no X server");
        assert_eq!(reason("winit error: something else"), "winit error: something else");
    }
}
