//! Window of Reality Sim: the particle filter running on a recording, a robot driven through recorded pictures, and the
//! differences between a camera's simulation and its pictures.
//!
//! | type | role |
//! |---|---|
//! | [`run`] | opens the window, and returns when it is closed |
//! | [`ViewerOptions`] | what the window first shows: a recording, a database, or a report of the gap |
//! | [`Device`] | a device that runs the filter and draws pictures, opened when it is chosen |
//! | [`ViewerApp`] | the window's content, for tests and pictures without a window |
//! | [`ViewerError`] | error of opening the window |
//!
//! Nothing that takes longer than a frame runs in the window's thread: separate threads open recordings, find poses and draw
//! pictures. They send messages and request a repaint. While nothing happens, nothing is drawn. Units and frames are those
//! of [`reality_sim_core::pose`].
//!
//! ```no_run
//! use reality_sim_viewer::{Device, ViewerOptions, run};
//!
//! let devices = vec![Device::processor()];
//! run(ViewerOptions { open: "assets/walk".into(), demonstration: None, devices })?;
//! # Ok::<(), reality_sim_viewer::ViewerError>(())
//! ```

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
