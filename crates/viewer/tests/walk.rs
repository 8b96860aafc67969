//! Tests of the Walk panel without a screen, driven by clicks and keys.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use std::{
    path::Path,
    thread,
    time::{Duration, Instant},
};

use eframe::egui::{
    Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, Rect, TouchPhase, Vec2,
    vec2,
};
use egui_kittest::{SnapshotOptions, image_snapshot_options, kittest::Queryable};
use image::RgbaImage;

use common::{
    PATIENCE, SIZE, choose, click, drag, rect_of, shows, until, until_label, until_part, until_still,
    viewer_with, viewer_with_demonstration, walk,
};

type Window = common::Viewer<'static>;

const POSE: [u8; 3] = [255, 45, 160];
const TRUTH: [u8; 3] = [20, 130, 255];
const BORDER: [u8; 3] = [255, 205, 0];
const PARTICLE: [u8; 3] = [255, 150, 30];

/// Returns a window on the walk, with its first picture.
fn window() -> Window {
    window_on(&walk(), SIZE)
}

/// Returns a window on a recording, with its first picture.
fn window_on(recording: &Path, size: Vec2) -> Window {
    let mut window = viewer_with(recording, size, None);
    until_part(&mut window, "weighed");
    window
}

/// Counts pixels close to a colour in a part of the window.
fn count(picture: &RgbaImage, rect: Rect, color: [u8; 3]) -> usize {
    let is_near = |pixel: &image::Rgba<u8>| pixel.0.iter().zip(color).all(|(a, b)| a.abs_diff(b) < 24);
    let (min, size) = (rect.min.round(), rect.size().floor());
    let part = image::imageops::crop_imm(picture, min.x as u32, min.y as u32, size.x as u32, size.y as u32);
    part.to_image().pixels().filter(|pixel| is_near(pixel)).count()
}

/// Counts the pixels of the camera's picture that have a colour.
fn in_picture(window: &mut Window, color: [u8; 3]) -> usize {
    let rect = rect_of(window, "Camera picture");
    count(&window.render().unwrap(), rect, color)
}

/// Returns the mean grey value of the camera's picture.
fn brightness(window: &mut Window) -> f64 {
    let rect = rect_of(window, "Camera picture");
    let picture = window.render().unwrap();
    let part = image::imageops::crop_imm(
        &picture,
        rect.min.x as u32,
        rect.min.y as u32,
        rect.width() as u32,
        rect.height() as u32,
    );
    let grey = image::imageops::grayscale(&part.to_image());
    grey.pixels().map(|pixel| f64::from(pixel.0[0])).sum::<f64>() / f64::from(grey.width() * grey.height())
}

#[test]
fn the_first_picture_is_there_with_its_lines_and_nothing_moves() {
    let mut window = window();
    until_part(&mut window, "picture 1 of 60");
    assert!(in_picture(&mut window, POSE) > 500);
    // Nothing changes any more: no frame is requested until something happens.
    until_still(&mut window);
}

#[test]
fn the_demonstration_plays_at_once_after_its_particles_have_gathered() {
    let mut window = viewer_with_demonstration(&walk());
    until_part(&mut window, "gathering, ");
    assert!(shows(&window, "Pause"));
    // Without a value: the curves are of the walk.
    assert!(shows(&window, "spread, cm") && shows(&window, "error, cm"));
    until_part(&mut window, "picture 3 of 60");
    assert!(shows(&window, "Pause"));
    window.key_press(Key::Home);
    until_part(&mut window, "gathering, ");
}

#[test]
fn particles_too_close_together_to_be_told_apart_are_shown_enlarged() {
    let mut window = window();
    let field = rect_of(&window, "Field from above");
    let mut particles = || {
        window.run_steps(2);
        let count = count(&window.render().unwrap(), field, PARTICLE);
        click(&mut window, "Enlarged particles");
        count
    };
    let (on, off, again) = (particles(), particles(), particles());
    assert!(on > off + 50 && again == on, "{on} {off} {again}");
}

#[test]
fn space_plays_and_pauses_and_the_arrows_step() {
    let mut window = window();
    window.key_press(Key::Space);
    until_part(&mut window, "picture 4 of 60");
    window.key_press(Key::Space);
    until_label(&mut window, "Play");
    let at =
        (4..60).find(|at| window.query_by_label_contains(&format!("picture {at} of")).is_some()).unwrap();
    window.key_press(Key::ArrowRight);
    until_part(&mut window, &format!("picture {} of 60", at + 1));
    window.key_press(Key::ArrowLeft);
    until_part(&mut window, &format!("picture {at} of 60"));
    window.key_press(Key::End);
    until_part(&mut window, "picture 60 of 60");
    window.key_press(Key::Home);
    until_part(&mut window, "picture 1 of 60");
}

#[test]
fn buttons_do_what_the_keys_do() {
    let mut window = window();
    click(&mut window, "Next");
    until_part(&mut window, "picture 2 of 60");
    click(&mut window, "Next");
    until_part(&mut window, "picture 3 of 60");
    click(&mut window, "Back");
    until_part(&mut window, "picture 2 of 60");
    click(&mut window, "Start");
    until_part(&mut window, "picture 1 of 60");
    click(&mut window, "Play");
    until_label(&mut window, "Pause");
    until_part(&mut window, "picture 3 of 60");
    click(&mut window, "Pause");
    until_label(&mut window, "Play");
}

#[test]
fn scrubbing_leads_to_the_picture_under_the_pointer() {
    let mut window = window();
    let slider = rect_of(&window, "Picture");
    let at = |share: f32| Pos2::new(slider.left() + share * slider.width(), slider.center().y);
    drag(&mut window, &[0.0, 0.2, 0.4, 0.5].map(at));
    until(&mut window, "another picture", |window| {
        (28..=33).any(|at| window.query_by_label_contains(&format!("picture {at} of")).is_some())
    });
}

#[test]
fn a_click_on_a_curve_leads_to_its_time() {
    let mut window = window();
    let label = window.get_by_label_contains("spread, cm").rect();
    let place = label.left_bottom() + Vec2::new(160.0, 80.0);
    window.hover_at(place);
    window.step();
    window.drag_at(place);
    window.step();
    window.drop_at(place);
    until(&mut window, "another picture", |window| window.query_by_label_contains("picture 1 of").is_none());
}

#[test]
fn overlays_are_switched_on_and_off() {
    let mut window = window();
    for (label, color, is_on) in
        [("Pose found", POSE, true), ("Truth", TRUTH, true), ("Field's border", BORDER, false)]
    {
        // The true lines lie under those of the estimated pose, and become visible once these are off.
        let before = in_picture(&mut window, color);
        click(&mut window, label);
        window.step();
        let after = in_picture(&mut window, color);
        let (on, off) = if is_on { (before, after) } else { (after, before) };
        assert!(on > off + 200, "{label}: {on} pixels on, {off} off");
        if label == "Truth" {
            click(&mut window, label);
        }
    }
}

#[test]
fn what_the_models_read_is_laid_over_the_picture() {
    let mut window = window();
    let bare = brightness(&mut window);
    let mut seen = vec![bare];
    for veil in ["blurred picture", "white-line evidence", "distances"] {
        choose(&mut window, "Over the picture", veil);
        // The filter's thread makes the veil.
        let before = *seen.last().unwrap();
        let begin = Instant::now();
        let mut now = before;
        while (now - before).abs() < 1.0 {
            assert!(begin.elapsed() < PATIENCE, "{veil} changes nothing");
            thread::sleep(Duration::from_millis(20));
            window.step();
            now = brightness(&mut window);
        }
        seen.push(now);
    }
    // The evidence is nearly black, the distances are nearly white.
    assert!(seen[2] < 0.5 * bare && seen[3] > 1.3 * bare, "{seen:?}");
    choose(&mut window, "Over the picture", "nothing");
    let begin = Instant::now();
    while (brightness(&mut window) - bare).abs() > 1.0 {
        assert!(begin.elapsed() < PATIENCE, "the veil stays");
        thread::sleep(Duration::from_millis(20));
        window.step();
    }
}

#[test]
fn another_model_and_fewer_particles_act_at_once() {
    let mut window = window();
    assert!(window.query_by_label("Gain").is_some() && window.query_by_label("α").is_none());
    choose(&mut window, "Model", "gauss");
    until_label(&mut window, "α");
    // Clicking the number allows typing another one.
    click(&mut window, "Particle count");
    window.step();
    window.get_by_label("Particle count").type_text("300");
    window.key_press(Key::Enter);
    until_label(&mut window, "300 weighed");
}

#[test]
fn particles_dragged_away_find_back() {
    let mut window = window();
    click(&mut window, "Next");
    until_part(&mut window, "picture 2 of 60");
    let field = rect_of(&window, "Field from above");
    let away = Vec2::new(0.25 * field.width(), 0.1 * field.height());
    drag(&mut window, &[field.center(), field.center() + 0.5 * away, field.center() + away]);
    until_part(&mut window, "not sure");
    choose(&mut window, "Speed", "as fast as the filter");
    click(&mut window, "Play");
    let sure = ["sure", "sure, after a search"];
    until(&mut window, "sure of the pose", |window| sure.iter().any(|label| shows(window, label)));
}

#[test]
fn a_narrow_window_shows_picture_and_field_one_above_the_other() {
    let window = window_on(&walk(), vec2(640.0, 900.0));
    let (picture, field) = (rect_of(&window, "Camera picture"), rect_of(&window, "Field from above"));
    assert!(picture.bottom() <= field.top());
    assert!(picture.width() > 150.0 && field.width() > 150.0);
}

/// Writes the first frames of the demonstration, without ground truth, start and odometry.
fn bare_recording(folder: &Path, frames: usize) {
    for name in ["camera.toml", "field.toml"] {
        std::fs::copy(walk().join(name), folder.join(name)).unwrap();
    }
    let text = "name = \"bare\"\ncamera = \"camera.toml\"\nfield = \"field.toml\"\nframes = \"frames.csv\"\n";
    std::fs::write(folder.join("sequence.toml"), text).unwrap();
    std::fs::create_dir(folder.join("images")).unwrap();
    let table = std::fs::read_to_string(walk().join("frames.csv")).unwrap();
    let mut bare = "timestamp_s,image,pitch_rad,roll_rad\n".to_owned();
    for line in table.lines().skip(1).take(frames) {
        let cells: Vec<&str> = line.split(',').collect();
        std::fs::copy(walk().join(cells[1]), folder.join(cells[1])).unwrap();
        bare += &format!("{},{},{},{}\n", cells[0], cells[1], cells[5], cells[6]);
    }
    std::fs::write(folder.join("frames.csv"), bare).unwrap();
}

#[test]
fn a_recording_without_truth_start_and_odometry_is_searched_and_shown_without_them() {
    let folder = tempfile::tempdir().unwrap();
    bare_recording(folder.path(), 4);
    let mut window = window_on(folder.path(), SIZE);
    until_part(&mut window, "after a search");
    assert!(window.query_by_label("Truth").is_none());
    assert!(window.query_by_label_contains("error, cm").is_none());
    window.key_press(Key::End);
    until_part(&mut window, "picture 4 of 4");
}

#[test]
fn a_recording_of_one_picture_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    bare_recording(folder.path(), 1);
    let mut window = window_on(folder.path(), SIZE);
    until_part(&mut window, "picture 1 of 1");
    for key in [Key::ArrowRight, Key::ArrowLeft, Key::End, Key::Home, Key::Space] {
        window.key_press(key);
        window.step();
    }
    until_label(&mut window, "Play");
    let slider = rect_of(&window, "Picture");
    drag(&mut window, &[slider.left_center(), slider.right_center()]);
    until_part(&mut window, "picture 1 of 1");
}

#[test]
fn a_recording_whose_first_picture_is_broken_is_walked_through_all_the_same() {
    let folder = tempfile::tempdir().unwrap();
    bare_recording(folder.path(), 3);
    let first = folder.path().join("images/000000.jpg");
    let bytes = std::fs::read(&first).unwrap();
    std::fs::write(&first, &bytes[..bytes.len() / 2]).unwrap();
    let mut window = viewer_with(folder.path(), SIZE, None);
    until_part(&mut window, "000000.jpg");
    // The message makes room for itself.
    window.run_steps(3);
    click(&mut window, "Next");
    until_part(&mut window, "picture 2 of 3");
    until_part(&mut window, "weighed");
}

#[test]
fn the_view_is_moved_by_the_secondary_button_though_it_followed() {
    let mut window = window();
    let field = rect_of(&window, "Field from above");
    window.hover_at(field.center());
    window.event(Event::MouseWheel {
        unit: MouseWheelUnit::Point,
        delta: vec2(0.0, 400.0),
        phase: TouchPhase::Move,
        source: MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    window.run_steps(60);
    let before = window.render().unwrap();
    let button = PointerButton::Secondary;
    for (pos, pressed) in [(field.center(), true), (field.center() + vec2(80.0, 40.0), false)] {
        window.hover_at(pos);
        window.step();
        window.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
        window.step();
    }
    window.run_steps(3);
    let moved = window.render().unwrap();
    let part = |picture: &RgbaImage| {
        let (min, size) = (field.min.round(), field.size().floor());
        image::imageops::crop_imm(picture, min.x as u32, min.y as u32, size.x as u32, size.y as u32)
            .to_image()
    };
    let changed = part(&before).pixels().zip(part(&moved).pixels()).filter(|(a, b)| a != b).count();
    assert!(changed > 1000, "{changed} pixels");
    // The particles stay where they were moved to.
    window.run_steps(3);
    assert_eq!(part(&moved), part(&window.render().unwrap()));
}

#[test]
fn a_drag_that_ends_in_another_panel_leaves_nothing_behind() {
    let mut window = window();
    let before = window.render().unwrap();
    let field = rect_of(&window, "Field from above");
    window.hover_at(field.center());
    window.step();
    window.drag_at(field.center());
    window.step();
    window.hover_at(field.center() + vec2(90.0, 40.0));
    window.step();
    window.key_press_modifiers(Modifiers::COMMAND, Key::Num2);
    window.step();
    window.drop_at(field.center() + vec2(90.0, 40.0));
    window.step();
    window.key_press_modifiers(Modifiers::COMMAND, Key::Num1);
    window.run_steps(4);
    window.remove_cursor();
    window.run_steps(20);
    let white = |picture: &RgbaImage| count(picture, field, [255, 255, 255]);
    let after = window.render().unwrap();
    assert!(white(&after) <= white(&before) + 20, "{} {}", white(&before), white(&after));
}

#[test]
fn the_panel_looks_like_its_snapshot() {
    let mut window = window_on(&walk(), vec2(760.0, 520.0));
    until_label(&mut window, "sure");
    // Times differ from run to run, so only picture and field are compared.
    let views = rect_of(&window, "Camera picture").union(rect_of(&window, "Field from above"));
    let picture = window.render().unwrap();
    let (min, size) = (views.min.round(), views.size().floor());
    let part = image::imageops::crop_imm(&picture, min.x as u32, min.y as u32, size.x as u32, size.y as u32)
        .to_image();
    // Graphics drivers that run on the processor compile for it: line edges differ by a few levels between processors, and
    // poses in their last digits.
    let options = SnapshotOptions::new().threshold(1.0).max_failed_pixels(600);
    image_snapshot_options(&part, "walk", &options);
}
