//! Tests of the Gap panel in the whole window: a report is opened, explored by clicks, drags and keys, and damaged.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[path = "../common/mod.rs"]
mod common;
mod fixture;

use std::{collections::BTreeMap, fs, time::Duration};

use eframe::{
    App,
    egui::{Color32, Key, Modifiers, Shape, ViewportId, accesskit::Role, vec2},
};
use egui_kittest::kittest::Queryable;
use image::RgbImage;
use reality_sim_gap::{
    Channel,
    report::{EffectReport, Report, Verdict, text},
};
use tempfile::TempDir;

use common::{
    Memory, SIZE, click, drag, press, rect_of, shows, texts, until, until_label, until_part, until_still,
    viewer, viewer_of_walk, viewer_with, walk,
};

use fixture::{report, write, written};

type Window = common::Viewer<'static>;

const WITHOUT: &str = "measured, 50 % of the width; then simulated without the effect";
const WITH: &str = "measured, 50 % of the width; then simulated with the effect";

/// Returns the window with a report.
fn opened() -> (Window, TempDir) {
    let (folder, path) = written(&report());
    let mut window = viewer(&path);
    until_label(&mut window, "Gap");
    until_still(&mut window);
    (window, folder)
}

/// Returns the only problem shown.
#[track_caller]
fn problem(window: &mut Window) -> String {
    until_label(window, "Dismiss");
    let texts = texts(window, ": ");
    texts.into_iter().find(|text| text.contains("reality-sim gap")).unwrap()
}

/// Counts the rectangles painted within a widget by their fill colour.
fn painted(window: &Window, label: &str) -> BTreeMap<[u8; 4], usize> {
    fn count(shape: &Shape, inside: eframe::egui::Rect, counts: &mut BTreeMap<[u8; 4], usize>) {
        match shape {
            Shape::Rect(rect) if inside.contains(rect.rect.center()) => {
                *counts.entry(rect.fill.to_array()).or_default() += 1;
            }
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| count(shape, inside, counts)),
            _ => {}
        }
    }
    let (inside, mut counts) = (rect_of(window, label), BTreeMap::new());
    window.output().shapes.iter().for_each(|clipped| count(&clipped.shape, inside, &mut counts));
    counts.remove(&Color32::BLACK.to_array());
    counts
}

#[test]
fn a_report_opens_alone_with_its_verdict_and_its_sentence() {
    let (window, _folder) = opened();
    assert!(shows(&window, "confusable"));
    assert!(shows(&window, &text::summary(&report())));
    assert!(!texts(&window, "12 frames, 3 of them held out").is_empty());
    assert!(!shows(&window, "Walk") && !shows(&window, "Drive") && !shows(&window, "Dismiss"));
}

#[test]
fn every_verdict_is_shown_in_words() {
    for verdict in [Verdict::None, Verdict::Named, Verdict::Unknown, Verdict::Inconclusive] {
        let (_folder, path) = written(&Report { verdict, ..report() });
        until_label(&mut viewer(&path), text::verdict_word(verdict));
    }
}

#[test]
fn a_report_stands_beside_walk_and_drive_and_keys_lead_to_each() {
    let (_folder, path) = written(&report());
    let mut window = viewer_of_walk();
    press(&mut window, Modifiers::COMMAND, Key::Num3);
    assert!(!shows(&window, "Gap"), "there is none yet");
    press(&mut window, Modifiers::COMMAND, Key::O);
    window.run_steps(2);
    window.event(eframe::egui::Event::Text(path.join("report.json").display().to_string()));
    press(&mut window, Modifiers::NONE, Key::Enter);
    until_label(&mut window, "Gap");
    for tab in ["Walk", "Drive"] {
        assert!(shows(&window, tab), "{tab}");
    }
    until_part(&mut window, WITHOUT);
    press(&mut window, Modifiers::COMMAND, Key::Num1);
    until_label(&mut window, "Next");
    assert!(!shows(&window, WITHOUT));
    press(&mut window, Modifiers::COMMAND, Key::Num3);
    until_label(&mut window, WITHOUT);
    click(&mut window, "Open…");
    assert!(shows(&window, path.to_str().unwrap()), "it is remembered by its folder");
}

#[test]
fn a_report_is_no_recording_to_compare_with() {
    let (_folder, path) = written(&report());
    let mut window = viewer_of_walk();
    click(&mut window, "Drive");
    until_part(&mut window, "auto at x");
    click(&mut window, "Compare with a recording…");
    window.run_steps(2);
    window.event(eframe::egui::Event::Text(path.display().to_string()));
    press(&mut window, Modifiers::NONE, Key::Enter);
    until_part(&mut window, "is a report: to compare with");
}

#[test]
fn the_wipe_is_dragged_and_the_simulated_side_is_changed_by_click_and_key() {
    let (mut window, _folder) = opened();
    let rect = rect_of(&window, WITHOUT);
    assert!((rect.width() / rect.height() - 64.0 / 48.0).abs() < 0.02, "{rect}");
    drag(&mut window, &[rect.center(), rect.center() + vec2(0.25 * rect.width(), 0.0)]);
    until_label(&mut window, &WITHOUT.replace("50", "75"));
    click(&mut window, "with the effect");
    until_label(&mut window, &WITH.replace("50", "75"));
    press(&mut window, Modifiers::NONE, Key::Space);
    until_label(&mut window, &WITHOUT.replace("50", "75"));
}

#[test]
fn the_difference_takes_the_place_of_the_wipe() {
    let (mut window, _folder) = opened();
    click(&mut window, "Difference");
    until_label(&mut window, "difference without the effect");
    press(&mut window, Modifiers::NONE, Key::Space);
    until_label(&mut window, "difference with the effect");
    press(&mut window, Modifiers::NONE, Key::D);
    until_label(&mut window, WITH);
}

#[test]
fn the_maps_have_a_colour_for_every_value_and_pale_with_the_effect() {
    let (mut window, _folder) = opened();
    for place in ["in the picture", "on the field"] {
        let [without, with] = ["without", "with"].map(|side| format!("residuals {place} {side} the effect"));
        click(&mut window, "without the effect");
        let before = painted(&window, &without);
        assert!(before.len() >= 15, "a column's values are all different: {before:?}");
        click(&mut window, "with the effect");
        let after = painted(&window, &with);
        assert!(!shows(&window, &without) && before != after);
        let strongest = |colors: &BTreeMap<[u8; 4], usize>| {
            colors.keys().map(|[r, _, b, _]| r.abs_diff(*b)).max().unwrap()
        };
        assert!(strongest(&after) < strongest(&before), "{before:?} {after:?}");
    }
}

#[test]
fn another_channel_has_other_maps_and_another_unit() {
    let mut changed = report();
    let geometry = changed.maps.get_mut(&Channel::Geometry).unwrap();
    geometry.picture.before.iter_mut().chain(&mut geometry.field.before).for_each(|value| {
        *value = value.map(|value| -20.0 * value);
    });
    changed.gap.channels.get_mut(&Channel::Geometry).unwrap().before = 9.0;
    let (_folder, path) = written(&changed);
    let mut window = viewer(&path);
    until_label(&mut window, WITHOUT);
    let name = "residuals in the picture without the effect";
    let legend = |window: &Window| texts(window, " to ").into_iter().find(|text| text.starts_with('−'));
    let (geometry, pixels) = (painted(&window, name), legend(&window).unwrap());
    assert!(pixels.ends_with(" px"), "{pixels}");
    // The channel is chosen by its row in the table, by the keys, and by the list, whose entries come after that row.
    window.get_by_role_and_label(Role::Button, "Photometry").click();
    until_still(&mut window);
    assert!(legend(&window).is_some_and(|legend| !legend.ends_with(" px")), "{:?}", legend(&window));
    assert_ne!(painted(&window, name), geometry);
    press(&mut window, Modifiers::NONE, Key::ArrowLeft);
    until_still(&mut window);
    assert_eq!((painted(&window, name), legend(&window).unwrap()), (geometry, pixels));
    window.get_by_role_and_label(Role::ComboBox, "Residuals of").click();
    window.run_steps(4);
    let entries = window.query_all_by_role_and_label(Role::Button, "Photometry");
    entries.last().unwrap().click();
    window.run_steps(4);
    assert!(legend(&window).is_some_and(|legend| !legend.ends_with(" px")), "{:?}", legend(&window));
}

#[test]
fn a_channel_without_a_map_says_so() {
    let mut empty = report();
    for maps in empty.maps.values_mut() {
        for map in [&mut maps.picture, &mut maps.field] {
            map.before.fill(None);
            map.after.fill(None);
        }
        maps.time.before.fill(None);
    }
    let (_folder, path) = written(&empty);
    let mut window = viewer(&path);
    until_label(&mut window, "too few measurements in any place for a map");
    until_still(&mut window);
}

#[test]
fn the_chosen_effect_shows_all_that_is_known_of_it() {
    let (mut window, _folder) = opened();
    let all = report();
    let because = |effect: &EffectReport| format!("Because {}.", text::effect_because(effect));
    let [vignetting, tone_curve] = &all.effects[..] else { panic!() };
    assert!(shows(&window, &because(vignetting)), "the surest comes first");
    let estimate = text::estimate(&vignetting.parameters["strength"]);
    assert!(shows(&window, &format!("strength = {estimate}")));
    let numbers = [text::plain_probability(vignetting.p_value), text::estimate(&vignetting.held_out_gain)];
    assert!(numbers.iter().all(|number| shows(&window, number)));
    assert!(shows(&window, "Nothing else explains these frames as well."));
    click(&mut window, text::effect_name(tone_curve));
    assert!(shows(&window, &because(tone_curve)) && !shows(&window, &because(vignetting)));
    assert!(shows(&window, "These frames cannot tell it from: black_level"));
    let deciding = text::deciding_recordings(tone_curve)[0];
    assert!(shows(&window, &format!("To decide, record: {deciding}")));
    press(&mut window, Modifiers::NONE, Key::ArrowDown);
    until_still(&mut window);
    assert!(shows(&window, &because(&all.in_model[0])), "those of the model follow");
    for _ in 0..5 {
        press(&mut window, Modifiers::NONE, Key::ArrowUp);
    }
    assert!(shows(&window, &because(vignetting)));
}

#[test]
fn what_is_left_what_was_not_found_and_what_cannot_be_seen_are_listed() {
    let (window, _folder) = opened();
    let Report { unexplained, objects, not_found, unobservable, gap, .. } = report();
    let remedy = text::unobservable_remedy(&unobservable[0]);
    let texts = [
        text::finding_place(&unexplained[0]),
        text::finding_size(&unexplained[0]),
        text::object_place(&objects[0]),
        text::limit(&not_found[0]),
        text::library_name(&not_found[0].id).to_owned(),
        text::unobservable_reason(&unobservable[0].cause).to_owned(),
        format!("What would decide: {remedy}"),
        text::amount(Channel::Geometry, gap.channels[&Channel::Geometry].floor, "px", 3),
    ];
    for text in texts {
        assert!(shows(&window, &text), "{text}");
    }
}

#[test]
fn a_report_in_which_nothing_was_found_has_no_effects_and_still_the_limits() {
    let nothing = Report {
        verdict: Verdict::None,
        effects: Vec::new(),
        in_model: Vec::new(),
        unexplained: Vec::new(),
        unobservable: Vec::new(),
        ..report()
    };
    let (_folder, path) = written(&nothing);
    let mut window = viewer(&path);
    until_label(&mut window, "nothing missing");
    assert!(shows(&window, "none") && shows(&window, "nothing significant"));
    assert!(!texts(&window, "(none was found)").is_empty());
    press(&mut window, Modifiers::NONE, Key::ArrowDown);
    assert!(shows(&window, &text::limit(&report().not_found[0])));
}

#[test]
fn a_report_that_is_broken_is_a_problem_in_words_and_no_panel() {
    let text = serde_json::to_string_pretty(&report()).unwrap();
    let too_few = {
        let mut report = report();
        report.maps.get_mut(&Channel::Geometry).unwrap().field.after.pop();
        serde_json::to_string(&report).unwrap()
    };
    let broken = [
        (text[..text.len() / 2].to_owned(), "is not a report"),
        (text.replace("\"verdict\": \"confusable\"", "\"verdict\": \"perhaps\""), "perhaps"),
        ("{}".to_owned(), "missing field"),
        (String::new(), "is not a report"),
        (too_few, "the maps of geometry: not as many values as cells"),
        (text.replace("-3.725", "3.725"), "an extent without an area"),
    ];
    for (text, fault) in broken {
        let (_folder, path) = written(&report());
        fs::write(path.join("report.json"), text).unwrap();
        let mut window = viewer(&path);
        let message = problem(&mut window);
        assert!(message.contains("report.json") && message.contains(fault), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(!shows(&window, "Gap"));
    }
}

#[test]
fn a_report_folder_without_its_report_is_named() {
    let (_folder, path) = written(&report());
    fs::remove_file(path.join("report.json")).unwrap();
    let message = problem(&mut viewer(&path));
    assert!(message.contains("report.json: there is no such file"), "{message}");
    fs::create_dir(path.join("report.json")).unwrap();
    let message = problem(&mut viewer(&path));
    assert!(message.contains("is not a regular file"), "{message}");
}

#[test]
fn a_report_without_pictures_says_so_and_shows_the_rest() {
    let (_folder, path) = written(&report());
    fs::remove_dir_all(path.join("pictures")).unwrap();
    let mut window = viewer(&path);
    until_label(&mut window, "confusable");
    let problems = texts(&window, "there is no such picture");
    for name in ["measured.png", "before.png", "after.png"] {
        assert!(problems.iter().any(|problem| problem.contains(name)), "{name}: {problems:?}");
    }
    assert!(shows(&window, "the report has no pictures of this"));
    assert!(shows(&window, "residuals in the picture without the effect"));
    click(&mut window, "Difference");
    until_still(&mut window);
}

#[test]
fn of_pictures_that_do_not_fit_those_that_do_are_shown() {
    let (_folder, path) = written(&report());
    fs::write(path.join("pictures/after.png"), "no picture").unwrap();
    RgbImage::new(10, 10).save(path.join("pictures/before.png")).unwrap();
    let mut window = viewer(&path);
    until_part(&mut window, "after.png: is no whole picture");
    assert!(!texts(&window, "differ in size").is_empty());
    assert!(shows(&window, "measured, 50 % of the width; then simulated without the effect is missing"));
    click(&mut window, "Difference");
    assert!(shows(&window, "the report has no pictures of this"));
}

#[test]
fn in_the_smallest_window_every_view_is_on_the_screen() {
    let (_folder, path) = written(&report());
    let mut window = viewer_with(&path, vec2(640.0, 420.0), None);
    until_label(&mut window, WITHOUT);
    until_still(&mut window);
    for view in
        [WITHOUT, "residuals in the picture without the effect", "residuals on the field without the effect"]
    {
        let rect = rect_of(&window, view);
        assert!(rect.width() > 30.0 && rect.right() <= 640.0 && rect.bottom() <= 420.0, "{view}: {rect}");
    }
}

#[test]
fn what_is_looked_at_survives_a_restart_under_a_key_of_its_own() {
    let (_folder, path) = written(&report());
    let mut memory = Memory::default();
    let mut first = viewer(&path);
    until_label(&mut first, "Gap");
    click(&mut first, "with the effect");
    press(&mut first, Modifiers::NONE, Key::ArrowLeft);
    first.state_mut().save(&mut memory);
    assert!(memory.0["gap"].to_lowercase().contains("geometry"), "{}", memory.0["gap"]);
    let mut second = viewer_with(&path, SIZE, Some(&memory));
    until_label(&mut second, WITH);
    let list = second.get_by_role_and_label(Role::ComboBox, "Residuals of");
    assert_eq!(list.value().as_deref(), Some("Geometry"));
}

#[test]
fn nothing_is_drawn_again_at_rest() {
    let (mut window, _folder) = opened();
    window.remove_cursor();
    let delay =
        |window: &common::Viewer<'_>| window.output().viewport_output[&ViewportId::ROOT].repaint_delay;
    until_still(&mut window);
    until(&mut window, "rest", |window| delay(window) == Duration::MAX);
    for _ in 0..3 {
        window.step();
        assert_eq!(delay(&window), Duration::MAX);
    }
}

#[test]
fn a_recording_with_a_report_in_its_folder_stays_a_recording() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["sequence.toml", "camera.toml", "field.toml", "frames.csv", "groundtruth.tum"] {
        fs::copy(walk().join(name), folder.path().join(name)).unwrap();
    }
    fs::create_dir(folder.path().join("images")).unwrap();
    for entry in fs::read_dir(walk().join("images")).unwrap().map(Result::unwrap) {
        fs::copy(entry.path(), folder.path().join("images").join(entry.file_name())).unwrap();
    }
    write(folder.path(), &report());
    let mut window = viewer(folder.path());
    until_label(&mut window, "Walk");
    assert!(!shows(&window, "Gap"));
}
