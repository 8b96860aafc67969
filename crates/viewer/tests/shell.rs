//! Tests of the window around the panels: opening, problems, settings, keys.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use std::{
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use eframe::{
    App,
    egui::{DroppedFile, Event, HoveredFile, Key, Modifiers, ViewportCommand, accesskit::Role},
};
use egui_kittest::kittest::Queryable;
use reality_sim_core::sequence::Sequence;
use reality_sim_db::{Database, PoseEstimate, PoseSource};
use tempfile::{TempDir, tempdir};

use common::{
    Memory, SIZE, Viewer, click, press, shows, texts, type_text, until, until_label, until_still, viewer,
    viewer_of_walk, viewer_with, viewer_with_demonstration, walk,
};

/// Returns a database of the walk's first pictures, in a folder of its own.
fn database() -> (TempDir, PathBuf) {
    let mut sequence = Sequence::open(&walk()).unwrap();
    sequence.frames.truncate(3);
    let poses: Vec<_> = sequence.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
    let folder = tempdir().unwrap();
    let path = folder.path().join("walk.db");
    let mut database = Database::create_or_open(&path).unwrap();
    database.ingest(&sequence, &poses, &PoseSource::GroundTruth).unwrap();
    (folder, path)
}

/// Copies the walk under another name.
fn copy_of_walk() -> (TempDir, PathBuf) {
    let folder = tempdir().unwrap();
    let copy = folder.path().join("another-walk");
    fs::create_dir_all(copy.join("images")).unwrap();
    for part in ["", "images"] {
        for entry in fs::read_dir(walk().join(part)).unwrap().map(Result::unwrap) {
            if entry.path().is_file() {
                fs::copy(entry.path(), copy.join(part).join(entry.file_name())).unwrap();
            }
        }
    }
    (folder, copy)
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("a folder".to_owned())
    }
}

fn drop_on(viewer: &mut Viewer<'_>, paths: &[&Path]) {
    let files = paths.iter().map(|path| Arc::new(Dropped(path.to_path_buf())) as _);
    viewer.input_mut().dropped_files = files.collect();
    viewer.step();
}

/// Waits for a problem about a path, and returns it.
#[track_caller]
fn problem(viewer: &mut Viewer<'_>, path: &Path) -> String {
    let name = path.file_name().unwrap().to_str().unwrap();
    until_label(viewer, "Dismiss");
    let texts = texts(viewer, name);
    texts.into_iter().find(|text| text.contains(": ")).unwrap_or_else(|| panic!("no word about {name}"))
}

fn has_tabs(viewer: &Viewer<'_>) -> [bool; 2] {
    ["Walk", "Drive"].map(|tab| shows(viewer, tab))
}

#[test]
fn a_recording_opens_with_walk_and_drive() {
    let viewer = viewer_of_walk();
    assert_eq!(has_tabs(&viewer), [true, true]);
    assert!(!shows(&viewer, "Dismiss"));
}

#[test]
fn a_database_opens_with_drive_alone() {
    let (_folder, path) = database();
    let mut viewer = viewer(&path);
    until_label(&mut viewer, "Drive");
    assert_eq!(has_tabs(&viewer), [false, true]);
}

#[test]
fn a_database_takes_the_place_of_a_recording() {
    let (_folder, path) = database();
    let mut viewer = viewer_of_walk();
    drop_on(&mut viewer, &[&path]);
    until(&mut viewer, "Walk goes", |viewer| has_tabs(viewer) == [false, true]);
}

#[test]
fn what_cannot_be_opened_is_named_and_what_was_open_stays() {
    let (folder, database) = database();
    let (_copy, cut_off) = copy_of_walk();
    let text = fs::read_to_string(cut_off.join("sequence.toml")).unwrap();
    fs::write(cut_off.join("sequence.toml"), &text[..text.len() / 3]).unwrap();
    let bytes = fs::read(&database).unwrap();
    let truncated = folder.path().join("truncated.db");
    fs::write(&truncated, &bytes[..bytes.len() / 2]).unwrap();
    let no_database = folder.path().join("letter.txt");
    fs::write(&no_database, "Dear robot,").unwrap();
    let empty = folder.path().join("empty");
    fs::create_dir(&empty).unwrap();

    let mut viewer = viewer_of_walk();
    for path in [&cut_off, &folder.path().join("missing"), &no_database, &truncated, &empty] {
        drop_on(&mut viewer, &[path]);
        let message = problem(&mut viewer, path);
        let remedies = ["check", "give", "build", "correct", "copy"];
        assert!(remedies.into_iter().any(|remedy| message.contains(remedy)), "{message}");
        assert_eq!(has_tabs(&viewer), [true, true], "{message}");
        click(&mut viewer, "Dismiss");
        assert!(!shows(&viewer, "Dismiss"), "{message}");
    }
}

#[test]
fn a_broken_first_recording_leaves_a_window_that_opens_others() {
    let mut viewer = viewer(Path::new("/no/such/walk"));
    let message = problem(&mut viewer, Path::new("/no/such/walk"));
    assert!(message.contains("/no/such/walk"), "{message}");
    assert!(!texts(&viewer, "Nothing is open").is_empty());
    drop_on(&mut viewer, &[&walk()]);
    until_label(&mut viewer, "Walk");
    assert!(shows(&viewer, "Dismiss"), "it goes when it has been read");
}

#[test]
fn two_problems_are_shown_at_once_and_dismissed_one_by_one() {
    let mut viewer = viewer_of_walk();
    for name in ["/first-missing", "/second-missing"] {
        drop_on(&mut viewer, &[Path::new(name)]);
        until(&mut viewer, name, |viewer| texts(viewer, name).iter().any(|text| text.contains(": ")));
    }
    assert_eq!(viewer.query_all_by_label("Dismiss").count(), 2);
    viewer.get_all_by_label("Dismiss").next().unwrap().click();
    viewer.run_steps(2);
    assert_eq!(viewer.query_all_by_label("Dismiss").count(), 1);
    assert!(texts(&viewer, "/first-missing").is_empty());
    assert!(!texts(&viewer, "/second-missing").is_empty());
}

#[test]
fn more_problems_than_fit_are_counted_and_come_up_later() {
    let mut viewer = viewer_of_walk();
    for number in 0..6 {
        let name = format!("/missing-{number}");
        drop_on(&mut viewer, &[Path::new(&name)]);
        until(&mut viewer, &name, |viewer| !viewer_is_opening(viewer));
    }
    assert_eq!(viewer.query_all_by_label("Dismiss").count(), 4);
    assert!(shows(&viewer, "and 2 more"));
    for _ in 0..6 {
        viewer.get_all_by_label("Dismiss").next().unwrap().click();
        viewer.run_steps(2);
    }
    assert!(!shows(&viewer, "Dismiss"));
}

fn viewer_is_opening(viewer: &Viewer<'_>) -> bool {
    !texts(viewer, "Opening ").is_empty()
}

#[test]
fn a_typed_path_is_opened_by_enter() {
    let (_folder, copy) = copy_of_walk();
    let mut viewer = viewer_of_walk();
    press(&mut viewer, Modifiers::COMMAND, Key::O);
    viewer.run_steps(2);
    viewer.event(Event::Text("/no/such/recording".to_owned()));
    press(&mut viewer, Modifiers::NONE, Key::Enter);
    let message = problem(&mut viewer, Path::new("recording"));
    assert!(message.contains("/no/such/recording"), "{message}");
    assert!(!shows(&viewer, "Choose a folder…"), "the window stays open");

    // The typed path is there again, to be corrected.
    press(&mut viewer, Modifiers::COMMAND, Key::O);
    assert_eq!(viewer.get_by_role(Role::TextInput).value().as_deref(), Some("/no/such/recording"));
    press(&mut viewer, Modifiers::COMMAND, Key::A);
    viewer.event(Event::Text(copy.join("sequence.toml").display().to_string()));
    viewer.step();
    click(&mut viewer, "Open");
    press_open_until_recent(&mut viewer, &copy);
}

/// Reopens the window until a path is in its list.
#[track_caller]
fn press_open_until_recent(viewer: &mut Viewer<'_>, path: &Path) {
    until(viewer, "opened", |viewer| !viewer_is_opening(viewer));
    press(viewer, Modifiers::COMMAND, Key::O);
    until_label(viewer, path.to_str().unwrap());
}

#[test]
fn recent_recordings_are_listed_and_open_by_a_click() {
    let (_folder, copy) = copy_of_walk();
    let mut viewer = viewer_with_demonstration(&copy);
    until_label(&mut viewer, "Walk");
    drop_on(&mut viewer, &[&walk().join("sequence.toml")]);
    until(&mut viewer, "opened", |viewer| !viewer_is_opening(viewer));
    click(&mut viewer, "Open…");
    // The demonstration has its own entry.
    assert!(shows(&viewer, "The demonstration walk"));
    assert!(!shows(&viewer, walk().to_str().unwrap()));
    fs::remove_file(copy.join("sequence.toml")).unwrap();
    click(&mut viewer, copy.to_str().unwrap());
    let message = problem(&mut viewer, &copy);
    assert!(message.contains("sequence.toml"), "{message}");
}

#[test]
fn escape_closes_the_open_window_and_the_list_of_keys() {
    let mut viewer = viewer_of_walk();
    press(&mut viewer, Modifiers::COMMAND, Key::O);
    assert!(shows(&viewer, "Choose a folder…"));
    press(&mut viewer, Modifiers::NONE, Key::Escape);
    assert!(!shows(&viewer, "Choose a folder…"));
    press(&mut viewer, Modifiers::NONE, Key::F1);
    assert!(shows(&viewer, "Keys and mouse"));
    press(&mut viewer, Modifiers::NONE, Key::Escape);
    assert!(!shows(&viewer, "Keys and mouse"));
}

#[test]
fn a_dropped_folder_is_opened_and_a_hint_says_so_before() {
    let mut viewer = viewer(Path::new("/no/such/walk"));
    until_label(&mut viewer, "Dismiss");
    let shapes_before = viewer.output().shapes.len();
    viewer.input_mut().hovered_files = vec![HoveredFile { path: Some(walk()), mime: String::new() }];
    viewer.step();
    assert!(painted_text(&viewer).contains("Drop a recording"), "{shapes_before} shapes before");
    viewer.input_mut().hovered_files.clear();
    drop_on(&mut viewer, &[&walk()]);
    until_label(&mut viewer, "Walk");
    assert!(!painted_text(&viewer).contains("Drop a recording"));
}

/// Returns all text in the window, including text painted without widgets.
fn painted_text(viewer: &Viewer<'_>) -> String {
    fn text(shape: &eframe::egui::Shape) -> String {
        match shape {
            eframe::egui::Shape::Text(text) => text.galley.text().to_owned(),
            eframe::egui::Shape::Vec(shapes) => shapes.iter().map(text).collect(),
            _ => String::new(),
        }
    }
    viewer.output().shapes.iter().map(|clipped| text(&clipped.shape)).collect()
}

#[test]
fn the_first_of_several_dropped_things_is_opened_and_the_others_are_mentioned() {
    let mut viewer = viewer(Path::new("/no/such/walk"));
    until_label(&mut viewer, "Dismiss");
    drop_on(&mut viewer, &[&walk(), Path::new("/another")]);
    until_label(&mut viewer, "Walk");
    assert!(!texts(&viewer, "only the first").is_empty());
}

#[test]
fn f1_and_the_question_mark_list_every_key() {
    let mut viewer = viewer_of_walk();
    let question_mark_with_shift = (Modifiers::SHIFT, Key::Questionmark);
    let question_mark = (Modifiers::NONE, Key::Questionmark);
    for (modifiers, key) in [(Modifiers::NONE, Key::F1), question_mark_with_shift, question_mark] {
        assert!(!shows(&viewer, "save a screenshot"));
        press(&mut viewer, modifiers, key);
        for line in ["save a screenshot", "Ctrl+P", "one picture back", "walk forwards", "quit"] {
            assert!(shows(&viewer, line), "{line}");
        }
        press(&mut viewer, modifiers, key);
    }
    click(&mut viewer, "?");
    assert!(shows(&viewer, "save a screenshot"));
}

#[test]
fn a_key_that_is_held_down_acts_once() {
    let mut viewer = viewer_of_walk();
    for repeat in [false, true, true] {
        let (key, modifiers, physical_key) = (Key::F1, Modifiers::NONE, None);
        viewer.event(Event::Key { key, pressed: true, modifiers, repeat, physical_key });
        viewer.run_steps(2);
    }
    assert!(shows(&viewer, "save a screenshot"));
}

/// Returns which of the three themes the button shows.
fn theme(viewer: &Viewer<'_>) -> &'static str {
    ["System", "Light", "Dark"].into_iter().find(|theme| shows(viewer, theme)).unwrap()
}

#[test]
fn light_dark_and_the_systems_follow_each_other_by_button_and_by_key() {
    let mut viewer = viewer_of_walk();
    assert_eq!(theme(&viewer), "System");
    click(&mut viewer, "System");
    assert_eq!((theme(&viewer), viewer.ctx.global_style().visuals.dark_mode), ("Light", false));
    press(&mut viewer, Modifiers::COMMAND, Key::T);
    assert_eq!((theme(&viewer), viewer.ctx.global_style().visuals.dark_mode), ("Dark", true));
    press(&mut viewer, Modifiers::COMMAND, Key::T);
    assert_eq!(theme(&viewer), "System");
}

#[test]
fn typing_a_path_triggers_no_keys() {
    let mut viewer = viewer_of_walk();
    press(&mut viewer, Modifiers::COMMAND, Key::O);
    viewer.run_steps(2);
    type_text(&mut viewer, "what? wasdqe");
    press(&mut viewer, Modifiers::SHIFT, Key::Questionmark);
    viewer.run_steps(2);
    assert!(!shows(&viewer, "save a screenshot"), "the list of keys is open");
    assert_eq!(viewer.get_by_role(Role::TextInput).value().as_deref(), Some("what? wasdqe"));
}

#[test]
fn keys_with_ctrl_work_while_a_text_field_has_the_focus() {
    let mut viewer = viewer_of_walk();
    press(&mut viewer, Modifiers::COMMAND, Key::O);
    viewer.run_steps(2);
    assert!(viewer.get_by_role(Role::TextInput).is_focused());
    press(&mut viewer, Modifiers::COMMAND, Key::T);
    assert_eq!(theme(&viewer), "Light");
}

#[test]
fn ctrl_q_closes_the_window() {
    let mut viewer = viewer_of_walk();
    let closes = |viewer: &Viewer<'_>| {
        let viewports = &viewer.output().viewport_output;
        viewports.values().any(|viewport| viewport.commands.contains(&ViewportCommand::Close))
    };
    // Every event takes a frame of its own, and only the last frame is checked.
    viewer.event(Event::ModifiersChanged(Modifiers::COMMAND));
    viewer.step();
    assert!(!closes(&viewer), "closes without the key");
    let (key, modifiers) = (Key::Q, Modifiers::COMMAND);
    viewer.event(Event::Key { key, pressed: true, modifiers, repeat: false, physical_key: None });
    viewer.step();
    assert!(closes(&viewer));
}

#[test]
fn settings_survive_a_restart() {
    let (_folder, copy) = copy_of_walk();
    let mut memory = Memory::default();
    let mut first = viewer(&copy);
    until_label(&mut first, "Walk");
    press(&mut first, Modifiers::COMMAND, Key::T);
    press(&mut first, Modifiers::COMMAND, Key::T);
    first.state_mut().save(&mut memory);

    let mut second = viewer_with(&walk(), SIZE, Some(&memory));
    until_label(&mut second, "Walk");
    assert_eq!(theme(&second), "Dark");
    click(&mut second, "Open…");
    assert!(shows(&second, copy.to_str().unwrap()));
}

#[test]
fn settings_that_cannot_be_read_are_the_defaults() {
    let mut written = Memory::default();
    viewer_of_walk().state_mut().save(&mut written);
    let keys: Vec<String> = written.0.keys().cloned().collect();
    assert!(!keys.is_empty());
    for garbage in
        ["", "garbage", "(theme:Purple)", "(recent:5,theme:", "()", "(theme:Dark,an_old_name:(1,2))", "\0"]
    {
        let memory = Memory(keys.iter().map(|key| (key.clone(), garbage.to_owned())).collect());
        let mut viewer = viewer_with(&walk(), SIZE, Some(&memory));
        until_label(&mut viewer, "Walk");
        assert_eq!(theme(&viewer), "System", "{garbage:?}");
    }
}

#[test]
fn a_part_of_the_settings_that_cannot_be_read_leaves_the_others() {
    let mut memory = Memory::default();
    let mut first = viewer_of_walk();
    press(&mut first, Modifiers::COMMAND, Key::T);
    first.state_mut().save(&mut memory);
    assert!(memory.0.contains_key("walk") && memory.0.contains_key("drive"));
    memory.0.insert("walk".to_owned(), "(speed:Warp)".to_owned());
    let mut second = viewer_with(&walk(), SIZE, Some(&memory));
    until_label(&mut second, "Walk");
    assert_eq!(theme(&second), "Light");
}

#[test]
fn a_screenshot_goes_to_the_current_folder_and_the_window_says_where() {
    let folder = tempdir().unwrap();
    // No other test depends on the current folder: their paths are absolute.
    std::env::set_current_dir(folder.path()).unwrap();
    let mut viewer = viewer_of_walk();
    click(&mut viewer, "Screenshot");
    until(&mut viewer, "saved", |viewer| !texts(viewer, "saved ").is_empty());
    let picture = image::open(folder.path().join("reality-sim-1.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (1280, 820));
    press(&mut viewer, Modifiers::COMMAND, Key::P);
    until(&mut viewer, "saved again", |viewer| !texts(viewer, "reality-sim-2.png").is_empty());
    until_still(&mut viewer);
}

#[test]
fn nothing_is_drawn_while_nothing_happens() {
    let mut viewer = viewer_of_walk();
    until_still(&mut viewer);
    press(&mut viewer, Modifiers::COMMAND, Key::O);
    press(&mut viewer, Modifiers::NONE, Key::F1);
    until_still(&mut viewer);
}

#[test]
fn every_button_has_a_name_and_every_letter_a_glyph() {
    // The harness panics if a button has no name or a letter no glyph.
    let mut viewer = viewer_of_walk();
    drop_on(&mut viewer, &[Path::new("/missing")]);
    until_label(&mut viewer, "Dismiss");
    press(&mut viewer, Modifiers::COMMAND, Key::O);
    press(&mut viewer, Modifiers::NONE, Key::F1);
    until_still(&mut viewer);
}
