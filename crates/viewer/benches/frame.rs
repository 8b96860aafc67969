//! Benchmark of the time that the window's own thread spends on a frame: `cargo bench -p reality-sim-viewer`.

use std::{
    hint::black_box,
    path::Path,
    thread,
    time::{Duration, Instant},
};

use criterion::{Criterion, criterion_group, criterion_main};
use eframe::egui::Key;
use egui_kittest::{
    Harness,
    kittest::{NodeT, Queryable},
};
use reality_sim_viewer::{Device, ViewerApp, ViewerOptions};

/// Pause between two frames: about the time that the filter takes for a picture, so that many frames show a new one.
const PAUSE: Duration = Duration::from_millis(40);

type Window = Harness<'static, ViewerApp>;

criterion_group!(benches, frames);
criterion_main!(benches);

/// Measures frames of the demonstration: pictures of 640 × 480 pixels, 800 particles.
fn frames(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("viewer");
    group.sample_size(10).measurement_time(Duration::from_secs(8));
    group.bench_function("frame_while_paused", |bencher| {
        let mut window = window();
        bencher.iter(|| frame(&mut window));
    });
    group.bench_function("frame_while_playing", |bencher| {
        let mut window = window();
        bencher.iter_custom(|frames| (0..frames).map(|_| frame_with_new_picture(&mut window)).sum());
    });
    group.finish();
}

fn window() -> Window {
    let walk = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/walk");
    let device = Device::processor();
    let options = ViewerOptions { open: walk, demonstration: None, devices: vec![device] };
    let builder = Harness::builder().with_size([1280.0, 820.0]);
    let mut window = builder.wgpu().build_eframe(|cc| ViewerApp::new(cc, options));
    while window.query_by_label("Camera picture").is_none() {
        window.step();
        thread::sleep(PAUSE);
    }
    for label in ["Speed", "as fast as the filter"] {
        window.get_by_label(label).click();
        window.run_steps(2);
    }
    window
}

/// Runs layout, input, uploads and tessellation; the graphics device's own work is not included.
fn frame(window: &mut Window) {
    window.step();
    let output = window.output();
    black_box(window.ctx.tessellate(output.shapes.clone(), output.pixels_per_point));
}

/// Returns the time of the next frame that shows a new picture; other frames are left out.
fn frame_with_new_picture(window: &mut Window) -> Duration {
    loop {
        if window.query_by_label("Play").is_some() {
            window.key_press(Key::Space);
            window.step();
        }
        thread::sleep(PAUSE);
        let before = picture_shown(window);
        let begin = Instant::now();
        frame(window);
        let taken = begin.elapsed();
        if picture_shown(window) != before {
            return taken;
        }
    }
}

/// Returns the description of the current picture.
fn picture_shown(window: &Window) -> String {
    let texts = window.query_all_by_label_contains("picture ").map(|node| {
        let node = node.accesskit_node();
        node.label().or_else(|| node.value()).unwrap_or_default()
    });
    texts.filter(|text| text.starts_with("picture ")).collect()
}
