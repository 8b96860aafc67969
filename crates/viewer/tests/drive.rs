//! Tests of the Drive panel in the whole window, by clicks, drags and keys.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use eframe::egui::{Key, Pos2, Rect, ViewportId, accesskit::Role, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use reality_sim_core::sequence::Sequence;
use reality_sim_db::{Database, PoseEstimate, PoseSource};
use tempfile::TempDir;

use common::{PATIENCE, SIZE, choose, click, drag, shows, until, until_label, until_part, viewer, walk};

type Window = common::Viewer<'static>;

/// Makes a database of the demonstration walk with all its pictures.
fn database(folder: &Path) -> PathBuf {
    let sequence = Sequence::open(&walk()).unwrap();
    let path = folder.join("walk.db");
    let poses: Vec<_> = sequence.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
    let mut database = Database::create_or_open(&path).unwrap();
    database.ingest(&sequence, &poses, &PoseSource::GroundTruth).unwrap();
    path
}

/// Returns the window with a database, once the first picture is there.
fn driving() -> (Window, TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let mut window = viewer(&database(folder.path()));
    until_part(&mut window, "auto at x -1.79 m");
    (window, folder)
}

/// Returns a number of the robot's pose as shown.
fn number(window: &Window, name: &str) -> f64 {
    let node = window.get_by_role_and_label(Role::SpinButton, name);
    node.accesskit_node().numeric_value().unwrap()
}

/// Returns the rectangle of the field on the screen, and the points per metre: the view includes a metre around the carpet.
fn field(window: &Window) -> (Rect, f64) {
    let rect = window.get_by_label("the field from above").rect();
    let extent = 2.0 * (Sequence::open(&walk()).unwrap().field.carpet_half_extent_m() + 1.0);
    let scale = (f64::from(rect.width()) / extent.x).min(f64::from(rect.height()) / extent.y);
    (rect, scale)
}

/// Returns the screen position of a position on the field.
fn on_screen(window: &Window, x_m: f64, y_m: f64) -> Pos2 {
    let (rect, scale) = field(window);
    rect.center() + vec2((scale * x_m) as f32, (-scale * y_m) as f32)
}

#[test]
fn the_robot_dragged_goes_with_the_mouse_and_another_picture_comes() {
    let (mut window, _folder) = driving();
    let (x, y) = (number(&window, "x"), number(&window, "y"));
    let from = on_screen(&window, x, y);
    drag(&mut window, &[from, from + vec2(20.0, -10.0), from + vec2(40.0, -30.0)]);
    let (_, scale) = field(&window);
    assert!((number(&window, "x") - x - 40.0 / scale).abs() < 0.02, "{}", number(&window, "x"));
    assert!((number(&window, "y") - y - 30.0 / scale).abs() < 0.02, "{}", number(&window, "y"));
    let words = format!("auto at x {:.2} m, y {:.2} m", number(&window, "x"), number(&window, "y"));
    until_part(&mut window, &words);
}

#[test]
fn the_arrows_tip_turns_the_robot_and_leaves_it_where_it_is() {
    let (mut window, _folder) = driving();
    let (x, y, yaw) = (number(&window, "x"), number(&window, "y"), number(&window, "yaw").to_radians());
    let tail = on_screen(&window, x, y);
    let rect = field(&window).0;
    let length = (0.1 * rect.width().min(rect.height())).clamp(18.0, 60.0);
    let tip = tail + length * vec2(yaw.cos() as f32, -yaw.sin() as f32);
    drag(&mut window, &[tip, tail + vec2(0.0, -40.0), tail + vec2(0.0, -80.0)]);
    assert!((number(&window, "yaw") - 90.0).abs() < 1.0, "{}", number(&window, "yaw"));
    assert!((number(&window, "x") - x).abs() < 1e-6 && (number(&window, "y") - y).abs() < 1e-6);
    until_part(&mut window, "yaw 90");
}

#[test]
fn keys_walk_and_turn_and_the_picture_follows() {
    let (mut window, _folder) = driving();
    let (x, y, yaw) = (number(&window, "x"), number(&window, "y"), number(&window, "yaw"));
    window.key_down(Key::W);
    window.run_steps(6);
    window.key_up(Key::W);
    window.step();
    let (dx, dy) = (number(&window, "x") - x, number(&window, "y") - y);
    assert!(dx.hypot(dy) > 0.05, "{dx} {dy}");
    assert!((dy.atan2(dx).to_degrees() - yaw).abs() < 1.0, "forwards is along the heading");
    window.key_down(Key::Q);
    window.run_steps(4);
    window.key_up(Key::Q);
    window.run_steps(2);
    assert!(number(&window, "yaw") > yaw + 3.0, "to the left is counter-clockwise");
    let still = number(&window, "yaw");
    window.run_steps(3);
    assert_eq!(number(&window, "yaw"), still);
    let words = format!("auto at x {:.2} m", number(&window, "x"));
    until_part(&mut window, &words);
}

#[test]
fn every_method_gives_its_picture_and_tells_where_each_pixel_came_from() {
    let (mut window, _folder) = driving();
    click(&mut window, "One");
    for method in ["nearest", "quadratic", "plane", "blend", "simulated"] {
        choose(&mut window, "Picture", method);
        until_part(&mut window, &format!("{method} at x"));
    }
    choose(&mut window, "Picture", "blend");
    choose(&mut window, "Show", "where each pixel came from");
    until_part(&mut window, "blend, where each pixel came from, at x");
    until_part(&mut window, "no recorded picture shows it");
    until_part(&mut window, "frame 0, ");
    choose(&mut window, "Show", "how far to trust each pixel");
    until_part(&mut window, "white: fully");
}

#[test]
fn all_methods_are_seen_at_once_and_a_database_alone_has_no_true_picture() {
    let (mut window, _folder) = driving();
    click(&mut window, "All methods");
    for method in ["nearest", "quadratic", "plane", "blend", "simulated"] {
        until_part(&mut window, &format!("{method} at x"));
    }
    until_part(&mut window, "No true picture is known");
    click(&mut window, "Compare with a recording…");
    until_part(&mut window, "Compare with the pictures of a recording");
}

#[test]
fn where_nothing_was_recorded_the_pane_says_so_until_best_effort_is_asked_for() {
    let (mut window, _folder) = driving();
    // The robot goes to the corner and faces outwards: no picture was recorded in that direction.
    let (from, to) =
        (on_screen(&window, number(&window, "x"), number(&window, "y")), on_screen(&window, 3.4, -2.4));
    drag(&mut window, &[from, from + vec2(20.0, 0.0), to]);
    until_part(&mut window, "or ask for the best effort");
    click(&mut window, "Best effort");
    until_part(&mut window, "auto at x 3.");
}

#[test]
fn the_line_of_a_wipe_is_dragged() {
    let (mut window, _folder) = driving();
    click(&mut window, "Wipe");
    until_part(&mut window, "50 % of the width; then simulated at x");
    let rect = window.get_by_label_contains("% of the width").rect();
    let to = rect.left_center() + vec2(0.25 * rect.width(), 0.0);
    drag(&mut window, &[rect.center(), rect.center() - vec2(20.0, 0.0), to]);
    until_part(&mut window, "25 % of the width");
}

#[test]
fn a_path_is_drawn_followed_stopped_and_cleared() {
    let (mut window, _folder) = driving();
    let at = |window: &Window, x, y| on_screen(window, x, y);
    click(&mut window, "Draw a path");
    let path: Vec<Pos2> = (0..=10).map(|step| at(&window, -1.0 + 0.1 * f64::from(step), 1.0)).collect();
    drag(&mut window, &path);
    window.key_press(Key::Space);
    window.run_steps(4);
    assert!(window.query_by_label("Stop").is_some(), "it follows");
    assert!((number(&window, "y") - 1.0).abs() < 0.05 && number(&window, "yaw").abs() < 5.0);
    let x = number(&window, "x");
    assert!(x > -1.05 && x < 0.0, "{x}");
    click(&mut window, "Stop");
    let x = number(&window, "x");
    window.run_steps(4);
    assert_eq!(number(&window, "x"), x);
    click(&mut window, "Follow the path");
    until_label(&mut window, "Follow the path");
    assert!(number(&window, "x").abs() < 0.05, "to its end: {}", number(&window, "x"));
    click(&mut window, "Clear the path");
    assert!(window.get_by_label("Follow the path").accesskit_node().is_disabled());
}

/// Returns the drawing of the field without texts, to compare layers on it.
fn picture_of_field(window: &mut Window) -> Vec<u8> {
    window.remove_cursor();
    window.run_steps(3);
    let rect = window.get_by_label("the field from above").rect();
    let [x, y, width, height] =
        [rect.left(), rect.top(), rect.width(), rect.height()].map(|points| points as u32);
    let picture = window.render().unwrap();
    image::imageops::crop_imm(&picture, x, y, width, height).to_image().into_raw()
}

#[test]
fn every_layer_changes_what_is_drawn_of_the_field_and_back() {
    let (mut window, _folder) = driving();
    until_part(&mut window, "% recorded");
    for layer in ["neighbours", "triangulation", "recorded", "in use", "ground seen"] {
        let before = picture_of_field(&mut window);
        click(&mut window, layer);
        // The edges come from the drawing thread.
        let started = Instant::now();
        while picture_of_field(&mut window) == before {
            assert!(started.elapsed() < PATIENCE, "{layer} changes nothing");
        }
        click(&mut window, layer);
        while picture_of_field(&mut window) != before {
            assert!(started.elapsed() < PATIENCE, "{layer} leaves something");
        }
    }
    for (coverage, legend) in
        [("pictures taken there", "in 25 cm × 25 cm"), ("pixels to the nearest picture", "300 px or more")]
    {
        let before = picture_of_field(&mut window);
        choose(&mut window, "Coverage", coverage);
        until_part(&mut window, legend);
        assert!(picture_of_field(&mut window) != before, "{coverage}");
    }
}

#[test]
fn a_picture_of_a_pose_before_is_marked_until_the_new_one_comes() {
    let (mut window, _folder) = driving();
    let is_marked = |window: &common::Viewer<'_>| shows(window, "updating …");
    until(&mut window, "both pictures", |window| !is_marked(window));
    window.key_down(Key::Q);
    window.run_steps(2);
    assert!(is_marked(&window), "it has turned, and no picture can have come");
    window.key_up(Key::Q);
    until(&mut window, "both pictures again", |window| !is_marked(window));
}

#[test]
fn the_fields_panel_is_as_wide_as_it_was_dragged_to_be_in_proportion_to_the_window() {
    let (mut window, _folder) = driving();
    let rect = field(&window).0;
    let edge = rect.left_center() - vec2(8.0, 0.0);
    let width = |window: &Window| f64::from(field(window).0.width());
    let before = width(&window);
    let edges: Vec<Pos2> = (-8..=8).map(|offset| edge + vec2(offset as f32, 0.0)).collect();
    // The line between the panels follows the mouse.
    for at in edges {
        drag(&mut window, &[at, at + vec2(50.0, 0.0), at + vec2(100.0, 0.0)]);
        if width(&window) < before - 50.0 {
            break;
        }
    }
    let dragged = width(&window);
    assert!(dragged < before - 50.0, "{before} {dragged}");
    window.set_size(vec2(1000.0, 820.0));
    window.run_steps(3);
    assert!(width(&window) < dragged - 20.0, "{dragged} {}", width(&window));
    window.set_size(SIZE);
    window.run_steps(3);
    assert!((width(&window) - dragged).abs() < 2.0, "{dragged} {}", width(&window));
}

/// Writes the demonstration walk repeated many times: storing it takes far longer than a few frames of the window, so that
/// it is still under way when it is cancelled, even on a slow machine.
fn long_walk(folder: &Path, times: usize) {
    for name in ["sequence.toml", "camera.toml", "field.toml"] {
        fs::copy(walk().join(name), folder.join(name)).unwrap();
    }
    let repeated = |name: &str, separator: char, header: usize| {
        let text = fs::read_to_string(walk().join(name)).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let mut repeated: Vec<String> = lines[..header].iter().map(|&line| line.to_owned()).collect();
        for round in 0..times {
            for line in &lines[header..] {
                let (time, rest) = line.split_once(separator).unwrap();
                let time_s: f64 = time.parse::<f64>().unwrap() + 100.0 * round as f64;
                repeated.push(format!("{time_s:.3}{separator}{rest}"));
            }
        }
        fs::write(folder.join(name), repeated.join("\n") + "\n").unwrap();
    };
    repeated("frames.csv", ',', 1);
    repeated("groundtruth.tum", ' ', 0);
    fs::create_dir(folder.join("images")).unwrap();
    for entry in fs::read_dir(walk().join("images")).unwrap() {
        let entry = entry.unwrap();
        fs::copy(entry.path(), folder.join("images").join(entry.file_name())).unwrap();
    }
}

#[test]
fn making_a_database_of_a_recording_is_cancelled_and_begun_again() {
    let folder = tempfile::tempdir().unwrap();
    long_walk(folder.path(), 400);
    let mut window = viewer(folder.path());
    until_label(&mut window, "Drive");
    window.get_by_label("Drive").click();
    until_label(&mut window, "Build the database");
    click(&mut window, "Build the database");
    until_label(&mut window, "Storing the pictures …");
    click(&mut window, "Cancel");
    until_label(&mut window, "Build the database");
    click(&mut window, "Build the database");
    until_label(&mut window, "Cancel");
}

#[test]
fn a_recording_becomes_a_database_and_its_true_pictures_are_reached() {
    let mut window = viewer(&walk());
    until_label(&mut window, "Drive");
    window.get_by_label("Drive").click();
    until_part(&mut window, "auto at x");
    choose(&mut window, "Right", "true picture");
    until_part(&mut window, "No true picture was taken within 20 px");
    click(&mut window, "Go there");
    until_part(&mut window, "true picture at x");
    until_part(&mut window, "PSNR");
}

#[test]
fn in_the_smallest_window_the_way_to_a_true_picture_is_reached_and_the_field_grows_with_the_window() {
    let mut window = viewer(&walk());
    until_label(&mut window, "Drive");
    window.get_by_label("Drive").click();
    until_part(&mut window, "auto at x");
    let wide = window.get_by_label("the field from above").rect().width();
    window.set_size(vec2(640.0, 420.0));
    window.run_steps(3);
    let narrow = window.get_by_label("the field from above").rect().width();
    click(&mut window, "All methods");
    until_label(&mut window, "Go there");
    click(&mut window, "Go there");
    until_part(&mut window, "true picture at x");
    window.set_size(SIZE);
    window.run_steps(3);
    let again = window.get_by_label("the field from above").rect().width();
    assert!(narrow < 0.8 * wide && (again - wide).abs() < 2.0, "{wide} {narrow} {again}");
}

#[test]
fn nothing_is_drawn_again_at_rest() {
    let (mut window, _folder) = driving();
    click(&mut window, "triangulation");
    window.remove_cursor();
    let delay =
        |window: &common::Viewer<'_>| window.output().viewport_output[&ViewportId::ROOT].repaint_delay;
    // Pictures arrive and animations end; after that, no repaint is requested.
    until(&mut window, "rest", |window| delay(window) == Duration::MAX);
    std::thread::sleep(Duration::from_millis(300));
    window.run_steps(3);
    for _ in 0..3 {
        window.step();
        assert_eq!(delay(&window), Duration::MAX);
    }
}

#[test]
fn a_file_that_is_no_database_is_named_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.db");
    fs::write(&path, "not a database at all, but long enough to be looked at").unwrap();
    let mut window = viewer(&path);
    until_part(&mut window, "broken.db: ");
    assert!(window.query_by_label("Drive").is_none());
}

#[test]
fn a_recording_without_ground_truth_says_what_can_be_done() {
    let folder = tempfile::tempdir().unwrap();
    let copy = |name: &str, change: fn(String) -> String| {
        let text = fs::read_to_string(walk().join(name)).unwrap();
        fs::write(folder.path().join(name), change(text)).unwrap();
    };
    copy("sequence.toml", |text| text.replace("groundtruth = \"groundtruth.tum\"\n", ""));
    copy("camera.toml", |text| text);
    copy("field.toml", |text| text);
    copy("frames.csv", |text| text.lines().take(5).map(|line| format!("{line}\n")).collect());
    fs::create_dir(folder.path().join("images")).unwrap();
    for frame in 0..4 {
        let name = format!("images/{frame:06}.jpg");
        fs::copy(walk().join(&name), folder.path().join(&name)).unwrap();
    }
    let mut window = viewer(folder.path());
    until_label(&mut window, "Drive");
    click(&mut window, "Drive");
    until_part(&mut window, "It has no ground truth");
    click(&mut window, "Find the poses and build");
    until_part(&mut window, "auto at x");
}
