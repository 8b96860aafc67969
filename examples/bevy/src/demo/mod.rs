//! The demonstration.
//!
//! | file | what it is |
//! |---|---|
//! | `track.rs`, `driver.rs` | the path beside the recorded poses; the camera on it, or in the user's hand |
//! | `play.rs`, `walker.rs`, `things.rs` | two robots and their ball; their entities |
//! | `layout.rs`, `top_view.rs`, `caption.rs` | the window |
//! | `screenshot.rs` | a picture of the window in a file |

mod caption;
mod driver;
mod layout;
mod play;
mod screenshot;
mod things;
mod top_view;
mod track;
mod walker;

use std::{path::Path, sync::Arc};

use bevy::prelude::*;
use reality_sim::{Archive, SynthesisError, Synthesizer, simulator, synthesis::MethodKind};
use reality_sim_bevy::RealityCameraPlugin;

pub use self::screenshot::Wanted;
use self::{driver::Driver, play::Play, things::LibraryCamera, track::Track};

/// Memory for decoded pictures, bytes.
const CACHE_BYTES: usize = 512 << 20;

/// Opens a database for a camera, with what stood there while it was recorded or without.
pub fn open(database: &Path, is_clean: bool) -> Result<simulator::Camera, SynthesisError> {
    let synthesizer = Synthesizer::new(Arc::new(Archive::open(database, CACHE_BYTES)?)).with_clean(is_clean);
    Ok(simulator::Camera::with(Arc::new(synthesizer), MethodKind::default()))
}

/// Runs the demonstration until its window is closed, or until its picture is saved.
pub fn run(camera: simulator::Camera, screenshot: Option<Wanted>) -> AppExit {
    let mut app = App::new();
    app.add_plugins((DefaultPlugins.set(layout::window_plugin()), RealityCameraPlugin))
        .insert_resource(ClearColor(layout::BACKGROUND))
        .add_systems(Startup, (layout::spawn, things::spawn, top_view::spawn, caption::spawn).chain())
        .add_systems(Update, (driver::drive, things::play, top_view::follow, caption::write).chain());
    let archive = camera.synthesizer().archive().clone();
    let driver = Driver::new(Track::beside(archive.images()), archive.usual_pose());
    app.insert_resource(Play::before(driver.pose().planar(), archive.field()))
        .insert_resource(driver)
        .insert_resource(LibraryCamera(camera));
    if let Some(wanted) = screenshot {
        screenshot::add(&mut app, wanted);
    }
    app.run()
}
