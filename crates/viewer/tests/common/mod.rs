//! Window content for tests, driven by clicks and keys, without a window.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]
#![allow(dead_code, reason = "each test program uses some of them")]

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use eframe::{
    Storage,
    egui::{Event, Key, Modifiers, Pos2, Rect, Vec2, accesskit::Role, vec2},
};
use egui_kittest::{
    Harness,
    kittest::{NodeT, Queryable},
};
use reality_sim_viewer::{Device, ViewerApp, ViewerOptions};

/// Time limit, longer than anything takes on a busy machine.
pub const PATIENCE: Duration = Duration::from_secs(120);
/// Size of a window, points.
pub const SIZE: Vec2 = vec2(1280.0, 820.0);

/// Storage that lasts as long as the test.
#[derive(Default)]
pub struct Memory(pub HashMap<String, String>);

impl Storage for Memory {
    fn get_string(&self, key: &str) -> Option<String> {
        self.0.get(key).cloned()
    }

    fn set_string(&mut self, key: &str, value: String) {
        self.0.insert(key.to_owned(), value);
    }

    fn remove_string(&mut self, key: &str) {
        self.0.remove(key);
    }

    fn flush(&mut self) {}
}

/// The window's content.
pub type Viewer<'a> = Harness<'a, ViewerApp>;

/// Returns the path of the demonstration walk.
pub fn walk() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/walk").canonicalize().unwrap()
}

/// Returns a window that opens a path, on the processor.
pub fn viewer<'a>(open: &Path) -> Viewer<'a> {
    viewer_with(open, SIZE, None)
}

/// Returns a window of a size, in points, that opens a path and remembers what is stored. It has no demonstration, so that
/// the walk waits as a user's recording does.
pub fn viewer_with<'a>(open: &Path, size: Vec2, storage: Option<&'a dyn Storage>) -> Viewer<'a> {
    window(open, None, size, storage)
}

/// Returns a window that opens a path and knows the demonstration.
pub fn viewer_with_demonstration<'a>(open: &Path) -> Viewer<'a> {
    window(open, Some(walk()), SIZE, None)
}

fn window<'a>(
    open: &Path,
    demonstration: Option<PathBuf>,
    size: Vec2,
    storage: Option<&'a dyn Storage>,
) -> Viewer<'a> {
    let devices = vec![Device::processor()];
    let options = ViewerOptions { open: open.to_path_buf(), demonstration, model: None, devices };
    Harness::builder().with_size(size).build_eframe(|cc| {
        cc.storage = storage;
        ViewerApp::new(cc, options)
    })
}

/// Returns a window in which the walk is open.
pub fn viewer_of_walk<'a>() -> Viewer<'a> {
    let mut viewer = viewer(&walk());
    until_label(&mut viewer, "Drive");
    viewer
}

/// Draws frames until a condition holds: threads answer when they are done.
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

/// Draws frames until several in a row ask for no other. A thread that has just answered asks for one at any moment, so a
/// single late request is no fault; a window that never comes to rest is.
#[track_caller]
pub fn until_still(viewer: &mut Viewer<'_>) {
    const FRAMES_AT_REST: usize = 5;
    const FRAMES: usize = 1000;
    let mut at_rest = 0;
    for _ in 0..FRAMES {
        viewer.step();
        at_rest = if viewer.ctx.has_requested_repaint() { 0 } else { at_rest + 1 };
        if at_rest == FRAMES_AT_REST {
            return;
        }
        thread::sleep(Duration::from_millis(5));
    }
    panic!("frames are drawn while nothing happens: {:?}", viewer.ctx.repaint_causes());
}

/// Draws frames until a text is shown.
#[track_caller]
pub fn until_label(viewer: &mut Viewer<'_>, label: &str) {
    until(viewer, label, |viewer| shows(viewer, label));
}

/// Draws frames until a widget is shown whose name contains a text.
#[track_caller]
pub fn until_part(viewer: &mut Viewer<'_>, part: &str) {
    until(viewer, part, |viewer| viewer.query_all_by_label_contains(part).next().is_some());
}

/// Whether exactly this text is shown.
pub fn shows(viewer: &Viewer<'_>, label: &str) -> bool {
    viewer.query_all_by_label(label).next().is_some()
}

/// Returns the texts shown that contain a part.
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

/// Clicks the widget with this text.
#[track_caller]
pub fn click(viewer: &mut Viewer<'_>, label: &str) {
    viewer.get_by_label(label).click();
    viewer.step();
    viewer.step();
}

/// Chooses an entry from a list.
#[track_caller]
pub fn choose(viewer: &mut Viewer<'_>, list: &str, entry: &str) {
    viewer.get_by_role_and_label(Role::ComboBox, list).click();
    viewer.run_steps(4);
    viewer.get_by_role_and_label(Role::Button, entry).click();
    viewer.run_steps(4);
}

/// Returns the rectangle of a widget, points.
#[track_caller]
pub fn rect_of(viewer: &Viewer<'_>, label: &str) -> Rect {
    viewer.get_by_label(label).rect()
}

/// Drags the mouse along positions.
pub fn drag(viewer: &mut Viewer<'_>, places: &[Pos2]) {
    viewer.hover_at(places[0]);
    viewer.step();
    viewer.drag_at(places[0]);
    viewer.step();
    for &place in &places[1..] {
        viewer.hover_at(place);
        viewer.step();
    }
    viewer.drop_at(places[places.len() - 1]);
    viewer.run_steps(2);
}

/// Presses a key.
pub fn press(viewer: &mut Viewer<'_>, modifiers: Modifiers, key: Key) {
    viewer.key_press_modifiers(modifiers, key);
    viewer.step();
    viewer.step();
}

/// Types a text into the widget with the focus, with the key events that a keyboard sends along.
pub fn type_text(viewer: &mut Viewer<'_>, text: &str) {
    for letter in text.chars() {
        if let Some(key) = Key::from_name(&letter.to_uppercase().to_string()) {
            viewer.key_press(key);
        }
        viewer.event(Event::Text(letter.to_string()));
    }
    viewer.step();
}
