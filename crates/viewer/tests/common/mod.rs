//! The window's content, driven by clicks and keys, without a window.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::{
    path::{Path, PathBuf},
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

use eframe::{
    Storage,
    egui::{Event, Key, Modifiers},
};
use egui_kittest::{
    Harness,
    kittest::{NodeT, Queryable},
};
use reality_sim_core::backend::CpuBackend;
use reality_sim_viewer::{Device, ViewerApp, ViewerOptions};

/// Longer than anything takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// The window's content.
pub type Viewer<'a> = Harness<'a, ViewerApp>;

/// The demonstration walk.
pub fn walk() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/walk").canonicalize().unwrap()
}

/// A window that opens a path, on the processor.
pub fn viewer<'a>(open: &Path) -> Viewer<'a> {
    viewer_with(open, None)
}

/// A window that opens a path and remembers what is stored.
pub fn viewer_with<'a>(open: &Path, storage: Option<&'a dyn Storage>) -> Viewer<'a> {
    let device = Device { name: "processor".to_owned(), open: Arc::new(|| Ok(Arc::new(CpuBackend))) };
    let options =
        ViewerOptions { open: open.to_path_buf(), demonstration: Some(walk()), devices: vec![device] };
    Harness::builder().with_size([1280.0, 820.0]).build_eframe(|cc| {
        cc.storage = storage;
        ViewerApp::new(cc, options)
    })
}

/// A window in which the demonstration is open.
pub fn demonstration<'a>() -> Viewer<'a> {
    let mut viewer = viewer(&walk());
    until_label(&mut viewer, "Drive");
    viewer
}

/// Draws frames until something holds: threads answer when they are done.
#[track_caller]
pub fn until(viewer: &mut Viewer<'_>, what: &str, holds: impl Fn(&Viewer<'_>) -> bool) {
    let started = Instant::now();
    loop {
        viewer.step();
        if holds(viewer) {
            return;
        }
        assert!(started.elapsed() < PATIENCE, "{what}: does not happen: {:#?}", viewer.root());
        thread::sleep(Duration::from_millis(5));
    }
}

/// Draws frames until a text is shown.
#[track_caller]
pub fn until_label(viewer: &mut Viewer<'_>, label: &str) {
    until(viewer, label, |viewer| shows(viewer, label));
}

/// Whether this very text is shown.
pub fn shows(viewer: &Viewer<'_>, label: &str) -> bool {
    viewer.query_all_by_label(label).next().is_some()
}

/// The texts shown that contain a part.
pub fn texts(viewer: &Viewer<'_>, part: &str) -> Vec<String> {
    let text = |node: egui_kittest::Node<'_>| {
        let node = node.accesskit_node();
        node.label().or_else(|| node.value()).unwrap_or_default()
    };
    let contains = |node: &egui_kittest::kittest::AccessKitNode<'_>| {
        [node.label(), node.value()].into_iter().flatten().any(|text| text.contains(part))
    };
    viewer.query_all_by(contains).map(text).collect()
}

/// Clicks what has this text.
#[track_caller]
pub fn click(viewer: &mut Viewer<'_>, label: &str) {
    viewer.get_by_label(label).click();
    viewer.step();
    viewer.step();
}

/// Presses a key.
pub fn press(viewer: &mut Viewer<'_>, modifiers: Modifiers, key: Key) {
    viewer.key_press_modifiers(modifiers, key);
    viewer.step();
    viewer.step();
}

/// Types a text into what has the focus: with the keys that a keyboard sends along.
pub fn type_text(viewer: &mut Viewer<'_>, text: &str) {
    for letter in text.chars() {
        if let Some(key) = Key::from_name(&letter.to_uppercase().to_string()) {
            viewer.key_press(key);
        }
        viewer.event(Event::Text(letter.to_string()));
    }
    viewer.step();
}
