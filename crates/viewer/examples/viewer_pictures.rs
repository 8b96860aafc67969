//! Draws pictures of the viewer for the README without a window: `cargo run --release -p reality-sim-viewer --example
//! viewer_pictures` writes docs/images/viewer_*.jpg; with names as arguments (`walk`, `drive`, `gap`), only those.

#![allow(clippy::print_stdout, reason = "says what it wrote")]

use std::{
    error::Error,
    fs,
    path::{Path, PathBuf},
    thread,
    time::Duration,
};

use eframe::egui::{Key, Modifiers};
use egui_kittest::{Harness, kittest::Queryable};
use image::{DynamicImage, RgbImage, codecs::jpeg::JpegEncoder};
use reality_sim_core::sequence::{Sequence, save_image};
use reality_sim_gap::{Options, Recording, ReferenceSource, analyse};
use reality_sim_sensor::{Model, Renderer, SceneColors};
use reality_sim_viewer::{Device, ViewerApp, ViewerOptions};

type Window = Harness<'static, ViewerApp>;

/// Pause between steps.
const PAUSE: Duration = Duration::from_millis(20);
/// Largest number of steps to wait for.
const STEPS: usize = 3000;
/// Quality of the JPEG files.
const QUALITY: u8 = 66;
/// First distortion coefficient of the lens, true and with the hidden fault.
const LENS: [&str; 2] = ["[-0.058061286,", "[-0.043061286,"];

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let (images, walk) = (root.join("docs/images"), root.join("assets/walk"));
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|wanted| wanted == name);
    if is_wanted("walk") || is_wanted("drive") {
        walk_and_drive(&walk, &images)?;
    }
    if is_wanted("gap") {
        gap(&walk, &images)?;
    }
    Ok(())
}

fn walk_and_drive(walk: &Path, images: &Path) -> Result<(), Box<dyn Error>> {
    let mut window = open(walk);

    until(&mut window, "the walk", |window| window.query_by_label("Next").is_some());
    window.key_press(Key::Space);
    until(&mut window, "picture 30", |window| window.query_by_label_contains("picture 30 of").is_some());
    window.key_press(Key::Space);
    until(&mut window, "rest", |window| window.query_by_label("sure").is_some());
    save(&mut window, &images.join("viewer_walk.jpg"))?;

    window.key_press_modifiers(Modifiers::COMMAND, Key::Num2);
    until(&mut window, "the database", |window| window.query_by_label_contains("auto at x").is_some());
    for label in ["Wipe", "Labels", "Add robot"] {
        window.get_by_label(label).click();
        window.run_steps(2);
    }
    let seconds_pressed = 0.5;
    window.key_down(Key::W);
    window.run_steps((seconds_pressed / window.input().predicted_dt) as usize);
    window.key_up(Key::W);
    window.key_press(Key::B);
    for _ in 0..60 {
        window.step();
        thread::sleep(PAUSE);
    }
    save(&mut window, &images.join("viewer_drive.jpg"))
}

/// Draws the gap report on the walk with a badly calibrated lens.
fn gap(walk: &Path, images: &Path) -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let (recording, report) = (folder.path().join("badly-calibrated"), folder.path().join("found"));
    miscalibrate(walk, &recording)?;
    write_report(&recording, &report)?;
    let mut window = open(&report);
    until(&mut window, "the report", |window| window.query_by_label("Gap").is_some());
    window.run();
    save(&mut window, &images.join("viewer_gap.jpg"))
}

/// Copies a recording with a wrong camera file.
fn miscalibrate(walk: &Path, to: &Path) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(to.join("images"))?;
    for part in ["", "images"] {
        for entry in fs::read_dir(walk.join(part))? {
            let entry = entry?;
            if entry.file_type()?.is_file() {
                fs::copy(entry.path(), to.join(part).join(entry.file_name()))?;
            }
        }
    }
    let camera = fs::read_to_string(walk.join("camera.toml"))?;
    let [is, should] = LENS;
    assert!(camera.contains(is), "the walk has another lens");
    fs::write(to.join("camera.toml"), camera.replace(is, should))?;
    Ok(())
}

/// Finds the effects missing from the nominal model of a recording, and writes the report that the viewer reads.
fn write_report(recording: &Path, to: &Path) -> Result<(), Box<dyn Error>> {
    let sequence = Sequence::open(recording)?;
    let compared = Recording::new(
        &sequence,
        &sequence.reference_poses().collect::<Vec<_>>(),
        ReferenceSource::Measured,
        None,
    )?;
    let plain = Model::default();
    let analysis = analyse(&compared, &plain, &Options::default(), &|_| ())?;
    let frame = analysis.report.shown_frame;
    let pose = sequence.frames[frame].reference_pose.ok_or("the walk has ground truth")?;
    let draw = |model: &Model| -> Result<RgbImage, Box<dyn Error>> {
        let colors = SceneColors::new(&sequence.setup, &sequence.field);
        Ok(Renderer::with_model(&sequence.setup, &sequence.field, colors, model)?.draw(pose)?)
    };
    let pictures = to.join("pictures");
    save_image(&pictures.join("measured.png"), &sequence.load_image(frame)?)?;
    save_image(&pictures.join("before.png"), &draw(&plain)?)?;
    save_image(&pictures.join("after.png"), &draw(&analysis.model)?)?;
    fs::write(to.join("report.json"), serde_json::to_string(&analysis.report)?)?;
    Ok(())
}

fn open(path: &Path) -> Window {
    let device = Device::processor();
    let options =
        ViewerOptions { open: path.to_path_buf(), demonstration: None, model: None, devices: vec![device] };
    let builder = Harness::builder().with_size([1280.0, 820.0]).with_max_steps(16);
    builder.wgpu().build_eframe(|cc| ViewerApp::new(cc, options))
}

/// Runs the window and its threads until something is shown.
fn until(window: &mut Window, what: &str, is_there: impl Fn(&Window) -> bool) {
    for _ in 0..STEPS {
        window.step();
        if is_there(window) {
            return;
        }
        thread::sleep(PAUSE);
    }
    panic!("{what} did not come");
}

fn save(window: &mut Window, path: &PathBuf) -> Result<(), Box<dyn Error>> {
    window.remove_cursor();
    window.step();
    let picture = DynamicImage::from(window.render()?).into_rgb8();
    JpegEncoder::new_with_quality(fs::File::create(path)?, QUALITY).encode_image(&picture)?;
    println!("{}", path.display());
    Ok(())
}
