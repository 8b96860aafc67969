//! Pictures of the viewer for the README, drawn without a window: `cargo run --release -p reality-sim-viewer --example
//! viewer_pictures` writes docs/images/viewer_*.jpg.

#![allow(clippy::print_stdout, reason = "says what it wrote")]

use std::{
    path::{Path, PathBuf},
    sync::Arc,
    thread,
    time::Duration,
};

use eframe::egui::{Key, Modifiers};
use egui_kittest::{Harness, kittest::Queryable};
use image::{DynamicImage, codecs::jpeg::JpegEncoder};
use reality_sim_core::backend::CpuBackend;
use reality_sim_viewer::{Device, ViewerApp, ViewerOptions};

type Window = Harness<'static, ViewerApp>;

/// Pauses between steps, and how many are waited for at most.
const PAUSE: Duration = Duration::from_millis(20);
const STEPS: usize = 3000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let images = root.join("docs/images");
    let mut window = open(&root.join("assets/walk"));

    until(&mut window, "the walk", |window| window.query_by_label("Next").is_some());
    window.key_press(Key::Space);
    until(&mut window, "picture 30", |window| window.query_by_label_contains("picture 30 of").is_some());
    window.key_press(Key::Space);
    until(&mut window, "rest", |window| window.query_by_label("sure").is_some());
    save(&mut window, &images.join("viewer_walk.jpg"))?;

    window.key_press_modifiers(Modifiers::COMMAND, Key::Num2);
    until(&mut window, "the database", |window| window.query_by_label_contains("auto at x").is_some());
    for label in ["Wipe", "neighbours", "triangulation"] {
        window.get_by_label(label).click();
        window.run_steps(2);
    }
    let seconds_pressed = 3.0;
    window.key_down(Key::W);
    window.run_steps((seconds_pressed / window.input().predicted_dt) as usize);
    window.key_up(Key::W);
    for _ in 0..60 {
        window.step();
        thread::sleep(PAUSE);
    }
    save(&mut window, &images.join("viewer_drive.jpg"))?;
    Ok(())
}

fn open(walk: &Path) -> Window {
    let device = Device { name: "processor".to_owned(), open: Arc::new(|| Ok(Arc::new(CpuBackend))) };
    let options = ViewerOptions {
        open: walk.to_path_buf(),
        demonstration: Some(walk.to_path_buf()),
        devices: vec![device],
    };
    let builder = Harness::builder().with_size([1280.0, 820.0]).with_max_steps(16);
    builder.wgpu().build_eframe(|cc| ViewerApp::new(cc, options))
}

/// Lets the window and its threads work until something is to be seen.
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

fn save(window: &mut Window, path: &PathBuf) -> Result<(), Box<dyn std::error::Error>> {
    window.remove_cursor();
    window.step();
    let picture = DynamicImage::from(window.render()?).into_rgb8();
    JpegEncoder::new_with_quality(std::fs::File::create(path)?, 88).encode_image(&picture)?;
    println!("{}", path.display());
    Ok(())
}
