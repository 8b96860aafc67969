//! Tests of the ball and the robots in the Drive panel, and of labels over its pictures, by clicks, drags and keys.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use std::path::{Path, PathBuf};

use eframe::egui::{
    Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, Pos2, Rect, TouchPhase, accesskit::Role, vec2,
};
use egui_kittest::kittest::{NodeT, Queryable};
use glam::DVec2;
use image::RgbaImage;
use reality_sim_core::{pose::CameraPose, sequence::Sequence};
use reality_sim_db::{Database, PoseEstimate, PoseSource};
use tempfile::TempDir;

use common::{
    choose, click, drag, shows, texts, until, until_label, until_part, viewer, viewer_with_demonstration,
    walk,
};

type Window = common::Viewer<'static>;

fn sequence() -> Sequence {
    Sequence::open(&walk()).unwrap()
}

/// Makes a database of the demonstration walk with all its pictures.
fn database(folder: &Path) -> PathBuf {
    let sequence = sequence();
    let path = folder.join("walk.db");
    let poses: Vec<_> = sequence.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
    let mut database = Database::create_or_open(&path).unwrap();
    database.ingest(&sequence, &poses, &PoseSource::GroundTruth).unwrap();
    path
}

/// Returns the window with a database and one picture, once it is there.
fn driving() -> (Window, TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let mut window = viewer(&database(folder.path()));
    until_part(&mut window, "auto at x -1.79 m");
    click(&mut window, "One");
    settled(&mut window);
    (window, folder)
}

/// Waits until the pictures are those of the present things.
fn settled(window: &mut Window) {
    window.run_steps(2);
    until(window, "the pictures", |window| !shows(window, "updating …"));
}

/// Returns the numbers in the one text that begins as given: of a thing, its place, metres, and the heading of a robot, degrees.
#[track_caller]
fn numbers(window: &Window, beginning: &str) -> Vec<f64> {
    let texts = texts(window, beginning);
    let text = texts.iter().find(|text| text.starts_with(beginning)).expect("the text is shown");
    let words = text[beginning.len()..].split([' ', '°', ',']);
    words.filter_map(|word| word.parse().ok()).collect()
}

#[track_caller]
fn place(window: &Window, name: &str) -> DVec2 {
    let numbers = numbers(window, &format!("{name} at x"));
    DVec2::new(numbers[0], numbers[1])
}

/// Returns the camera's pose as its fields show it.
fn pose(window: &Window) -> CameraPose {
    let number = |name: &str| {
        let node = window.get_by_role_and_label(Role::SpinButton, name);
        node.accesskit_node().numeric_value().unwrap()
    };
    CameraPose {
        x_m: number("x"),
        y_m: number("y"),
        yaw_rad: number("yaw").to_radians(),
        height_m: number("height"),
        pitch_rad: number("pitch").to_radians(),
        roll_rad: number("roll").to_radians(),
    }
}

/// Returns the rectangle of the field on the screen, and the points per metre: the view includes a metre around the carpet.
fn field(window: &Window) -> (Rect, f64) {
    let rect = window.get_by_label("the field from above").rect();
    let extent = 2.0 * (sequence().field.carpet_half_extent_m() + 1.0);
    let scale = (f64::from(rect.width()) / extent.x).min(f64::from(rect.height()) / extent.y);
    (rect, scale)
}

/// Returns the screen position of a place on the field.
fn on_field(window: &Window, place: DVec2) -> Pos2 {
    let (rect, scale) = field(window);
    rect.center() + vec2((scale * place.x) as f32, (-scale * place.y) as f32)
}

/// Returns the rectangle of the camera's picture on the screen, and the points per pixel.
fn picture(window: &Window) -> (Rect, f32) {
    let rect = window.get_by_label_contains("auto at x").rect();
    (rect, rect.width() / sequence().setup.camera.width as f32)
}

/// Returns the pixel at which the camera sees a place on the ground.
fn pixel_of(window: &Window, place: DVec2) -> DVec2 {
    let point_in_camera = pose(window).camera_from_world(place.extend(0.0));
    sequence().setup.camera.project(point_in_camera).unwrap()
}

/// Returns the screen position at which the picture shows a place on the ground.
fn in_picture(window: &Window, place: DVec2) -> Pos2 {
    let ((rect, scale), pixel) = (picture(window), pixel_of(window, place));
    rect.min + scale * vec2(pixel.x as f32 + 0.5, pixel.y as f32 + 0.5)
}

/// Returns what the window shows of the camera's picture.
fn pixels(window: &mut Window) -> RgbaImage {
    settled(window);
    window.remove_cursor();
    window.run_steps(2);
    let rect = picture(window).0.shrink(1.0);
    let whole = window.render().unwrap();
    let [x, y, width, height] =
        [rect.left(), rect.top(), rect.width(), rect.height()].map(|edge| edge as u32);
    image::imageops::crop_imm(&whole, x, y, width, height).to_image()
}

/// Puts the ball before the camera, by its button, so that its place is shown.
fn with_ball() -> (Window, TempDir) {
    let (mut window, folder) = driving();
    click(&mut window, "Ball here");
    settled(&mut window);
    (window, folder)
}

#[test]
fn the_ball_dragged_on_the_field_goes_with_the_mouse_and_the_picture_follows() {
    let (mut window, _folder) = with_ball();
    let (before, seen) = (place(&window, "ball"), pixels(&mut window));
    let from = on_field(&window, before);
    drag(&mut window, &[from, from + vec2(10.0, -5.0), from + vec2(24.0, -12.0)]);
    let moved = place(&window, "ball") - before;
    let (_, scale) = field(&window);
    let expected = DVec2::new(24.0, 12.0) / scale;
    assert!((moved - expected).abs().max_element() < 0.011, "{moved} {expected}");
    assert!(pixels(&mut window) != seen, "the picture shows it elsewhere");
    let untouched = pose(&window);
    assert!((untouched.x_m + 1.79).abs() < 0.01, "the camera stays");
}

#[test]
fn the_ball_dragged_in_the_picture_stays_under_the_mouse() {
    let (mut window, _folder) = with_ball();
    let before = pixel_of(&window, place(&window, "ball"));
    // The ball is grabbed above the point on which it lies.
    let from = in_picture(&window, place(&window, "ball")) - vec2(0.0, 6.0);
    let (_, scale) = picture(&window);
    drag(&mut window, &[from, from + vec2(30.0, 8.0), from + vec2(70.0, 20.0)]);
    let moved = pixel_of(&window, place(&window, "ball")) - before;
    let expected = DVec2::new(70.0, 20.0) / f64::from(scale);
    // Places are shown in whole centimetres, which is up to two pixels at less than a metre.
    assert!((moved - expected).abs().max_element() < 3.0, "{moved} {expected}");
    settled(&mut window);
}

#[test]
fn a_ball_dragged_to_the_horizon_stops_at_the_edge_of_where_things_may_be() {
    let (mut window, _folder) = with_ball();
    let reach_m = sequence().field.carpet_half_extent_m() + 1.0;
    let from = in_picture(&window, place(&window, "ball")) - vec2(0.0, 6.0);
    let steps: Vec<Pos2> = (0..=30).map(|step| from - vec2(0.0, 10.0 * step as f32)).collect();
    drag(&mut window, &steps);
    let share = (place(&window, "ball").abs() / reach_m).max_element();
    assert!(share > 0.8 && share <= 1.003, "{share}");
    let from = on_field(&window, place(&window, "ball"));
    drag(&mut window, &[from, from + vec2(50.0, 50.0), from + vec2(900.0, 900.0)]);
    let place = place(&window, "ball");
    assert!((place - DVec2::new(reach_m.x, -reach_m.y)).abs().max_element() < 0.006, "{place}");
}

#[test]
fn robots_are_added_turned_and_removed_by_buttons_and_keys() {
    let (mut window, _folder) = driving();
    assert!(window.get_by_label("Remove").accesskit_node().is_disabled(), "nothing was touched");
    click(&mut window, "Add robot");
    let [x, y, heading] = numbers(&window, "robot_2 at x")[..] else { panic!("place and heading") };
    // The end of its line is 24 points from its middle.
    let middle = on_field(&window, DVec2::new(x, y));
    let aside = 24.0 * vec2(heading.to_radians().cos() as f32, -heading.to_radians().sin() as f32);
    drag(&mut window, &[middle + aside, middle + vec2(0.0, -30.0), middle + vec2(0.0, -60.0)]);
    let [turned_x, turned_y, turned] = numbers(&window, "robot_2 at x")[..] else { panic!("the same") };
    assert!((turned - 90.0).abs() <= 1.0 && (turned_x, turned_y) == (x, y), "{turned}");

    window.key_press(Key::R);
    window.run_steps(2);
    numbers(&window, "robot_3 at x");
    window.key_press(Key::Delete);
    window.run_steps(2);
    assert!(texts(&window, "robot_3 at x").is_empty());
    window.key_press(Key::R);
    window.run_steps(2);
    numbers(&window, "robot_4 at x");
    click(&mut window, "Remove");
    assert!(window.get_by_label("Remove").accesskit_node().is_disabled());
    window.key_press(Key::B);
    window.run_steps(2);
    numbers(&window, "ball at x");
}

#[test]
fn the_wheel_over_a_robot_in_the_picture_turns_it() {
    let (mut window, _folder) = driving();
    click(&mut window, "Add robot");
    settled(&mut window);
    let before = numbers(&window, "robot_2 at x");
    let at = in_picture(&window, DVec2::new(before[0], before[1])) - vec2(0.0, 20.0);
    window.hover_at(at);
    window.step();
    window.event(Event::MouseWheel {
        unit: MouseWheelUnit::Point,
        delta: vec2(0.0, 60.0),
        phase: TouchPhase::Move,
        source: MouseWheelSource::Unknown,
        modifiers: Modifiers::NONE,
    });
    window.run_steps(30);
    let after = numbers(&window, "robot_2 at x");
    let turned = (after[2] - before[2]).rem_euclid(360.0);
    // 60 points at 0.005 rad each.
    assert!((turned - 17.2).abs() < 2.0, "{turned}");
    assert_eq!(after[..2], before[..2]);
}

#[test]
fn what_is_clicked_in_the_picture_is_what_is_removed() {
    let (mut window, _folder) = with_ball();
    click(&mut window, "Add robot");
    settled(&mut window);
    let ball = {
        window.key_press(Key::B);
        window.run_steps(2);
        place(&window, "ball")
    };
    click(&mut window, "Add robot");
    settled(&mut window);
    let at = in_picture(&window, ball) - vec2(0.0, 6.0);
    window.hover_at(at);
    window.step();
    window.drag_at(at);
    window.step();
    window.drop_at(at);
    window.run_steps(2);
    place(&window, "ball");
    click(&mut window, "Remove");
    click(&mut window, "Labels");
    until_part(&mut window, "robot_3 ");
    settled(&mut window);
    assert!(texts(&window, "auto at x").iter().all(|text| !text.contains("ball")), "it is gone");
}

#[test]
fn labels_tint_the_picture_and_name_what_is_in_view_until_they_are_switched_off() {
    let (mut window, _folder) = driving();
    let plain = pixels(&mut window);
    click(&mut window, "Labels");
    until_part(&mut window, "ball 100 %");
    assert!(texts(&window, "robot_1 ").iter().any(|text| text.contains("auto at x")));
    for class in ["carpet", "line", "goal", "robot", "outside"] {
        assert!(shows(&window, class), "{class} is not in the legend");
    }
    let labelled = pixels(&mut window);
    let greenness = |picture: &RgbaImage| {
        let sum: i64 = picture.pixels().map(|pixel| i64::from(pixel[1]) - i64::from(pixel[0])).sum();
        sum as f64 / f64::from(picture.width() * picture.height())
    };
    assert!(greenness(&labelled) > greenness(&plain) + 10.0, "most of the picture is carpet");
    window.key_press(Key::L);
    window.run_steps(2);
    until(&mut window, "no labels", |window| texts(window, "ball 100 %").is_empty());
    assert!(pixels(&mut window) == plain);
}

#[test]
fn things_are_hidden_and_shown_again_where_they_were() {
    let (mut window, _folder) = driving();
    let with = pixels(&mut window);
    click(&mut window, "Ball and robots");
    let without = pixels(&mut window);
    assert!(without != with);
    click(&mut window, "Ball and robots");
    assert!(pixels(&mut window) == with);
}

#[test]
fn in_a_wipe_things_are_dragged_and_so_is_the_line() {
    let (mut window, _folder) = with_ball();
    click(&mut window, "Wipe");
    until_part(&mut window, "50 % of the width; then simulated at x");
    settled(&mut window);
    let before = place(&window, "ball");
    let from = in_picture(&window, before) - vec2(0.0, 4.0);
    drag(&mut window, &[from, from + vec2(10.0, 5.0), from + vec2(20.0, 10.0)]);
    assert!(place(&window, "ball").distance(before) > 0.01);
    until_part(&mut window, "50 % of the width");
    let (rect, _) = picture(&window);
    let line = rect.center() - vec2(0.0, 0.4 * rect.height());
    drag(&mut window, &[line, line - vec2(20.0, 0.0), line - vec2(0.25 * rect.width(), 0.0)]);
    until_part(&mut window, "25 % of the width");
}

#[test]
fn the_true_picture_shows_what_was_there_with_its_labels_but_without_things() {
    let mut window = viewer(&walk());
    until_label(&mut window, "Drive");
    window.get_by_label("Drive").click();
    until_part(&mut window, "auto at x");
    choose(&mut window, "Right", "true picture");
    until_part(&mut window, "No true picture was taken within 20 px");
    click(&mut window, "Go there");
    click(&mut window, "Ball here");
    click(&mut window, "Labels");
    until(&mut window, "labels of both", |window| {
        let of = |name: &str| texts(window, name).into_iter().find(|text| text.contains("labels: "));
        of("auto at x").is_some_and(|text| text.contains("ball"))
            && of("true picture at x").is_some_and(|text| !text.contains("ball"))
    });
    until_part(&mut window, "PSNR");
}

#[test]
fn a_database_without_a_clean_stage_does_not_offer_it() {
    let (window, _folder) = driving();
    assert!(window.get_by_label("Clean stage").accesskit_node().is_disabled());
}

#[test]
fn the_demonstration_shows_a_ball_and_a_robot_at_once() {
    let mut window = viewer_with_demonstration(&walk());
    until_label(&mut window, "Drive");
    window.get_by_label("Drive").click();
    until_part(&mut window, "auto at x");
    click(&mut window, "Labels");
    until_part(&mut window, "ball 100 %");
    until_part(&mut window, "robot_1 100 %");
}

#[test]
fn frames_a_second_and_the_parts_of_their_time_are_told() {
    let (mut window, _folder) = with_ball();
    until_part(&mut window, "drawing ");
    until_part(&mut window, "things ");
    let at = on_field(&window, place(&window, "ball"));
    window.hover_at(at);
    window.step();
    window.drag_at(at);
    for step in 1..60 {
        window.hover_at(at + vec2(step as f32, 0.0));
        window.step();
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    window.drop_at(at + vec2(59.0, 0.0));
    until_part(&mut window, "frames/s · things ");
}
