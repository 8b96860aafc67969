//! Reality Sim in a window: the particle filter at work on a recording, a robot driven through recorded pictures, and where a
//! camera's simulation and its pictures disagree.
//!
//! [`run`] opens the window; [`ViewerApp`] is what is in it, for tests and pictures without one. Nothing that takes longer than a
//! frame runs in the window's thread: recordings are opened, poses found and pictures drawn by threads of their own, which send
//! messages and ask for a repaint. While nothing happens nothing is drawn.

mod app;
mod background;
mod colors;
mod device;
mod drive;
mod field_view;
mod footprint;
mod frame_times;
mod gap;
mod launch;
mod open_window;
mod opening;
mod options;
mod picture_view;
mod problems;
mod screenshot;
mod settings;
mod shortcuts;
mod toolbar;
mod walk;

pub use self::{
    app::ViewerApp,
    device::Device,
    launch::{ViewerError, run},
    options::ViewerOptions,
};
