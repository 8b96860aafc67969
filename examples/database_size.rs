//! What grows with a database, from 300 pictures to a million:
//!
//! `cargo run --release --example database_size` writes `docs/figures/database_size.md` and `database_size.svg`. It takes some minutes, and
//! 7 GB of the folder for temporary files.
//!
//! The pictures are those of the demonstration walk at a quarter of their size, over and over with poses that were never taken. Every
//! picture that is drawn decodes its neighbours anew, as where a place was not visited for long. How much an opening reads of the file is known on
//! Linux only; it is what a system that does not hold the file in memory waits for.

#[path = "../benches/counting.rs"]
mod counting;
#[path = "shared/curves.rs"]
mod curves;
#[path = "../benches/poses.rs"]
#[expect(dead_code, reason = "the metric of poses is for others")]
mod poses;

use std::{
    fmt::Write,
    fs,
    hint::black_box,
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

use anyhow::Context;
use plotters::prelude::SeriesLabelPosition;
use reality_sim::{
    Archive, CameraPose, Sequence, Synthesizer,
    db::{Database, PoseEstimate, PoseSource, coverage::Coverage},
    evaluation::percentile,
    image::imageops,
    nalgebra::Matrix6,
    synthesis::MethodKind,
};

use crate::{counting::measured, curves::Axes, poses::random_poses};

const IMAGES: [usize; 5] = [300, 3000, 30_000, 300_000, 1_000_000];
/// Number of pictures that are drawn of each database.
const DRAWN: usize = 200;
/// Columns and rows of the pictures.
const SIZE: [u32; 2] = [160, 120];
/// Edge of the cells of the coverage, metres, as `info` has it.
const CELL_M: f64 = 0.25;
/// Decoded pictures that are kept, bytes: none.
const CACHE_BYTES: usize = 0;
const OUT: &str = "docs/figures";

/// What was measured of one database while it was opened.
struct Opened {
    images: usize,
    file_bytes: u64,
    opening: Duration,
    /// Bytes that the opening read of the file, where the system tells.
    read_bytes: Option<u64>,
    held_bytes: usize,
    most_bytes: usize,
    coverage: Duration,
}

/// What was measured of one database.
struct Row {
    opened: Opened,
    blend: Visits,
    plane: Visits,
}

/// Median times of a picture by a method, milliseconds.
struct Visits {
    /// Where nothing was drawn before: some of the file may have to come from the disk.
    first_ms: f64,
    /// The same pictures once more: the system holds in memory what they are made of.
    again_ms: f64,
}

fn main() -> anyhow::Result<()> {
    let folder = tempfile::tempdir()?;
    let walk = smaller(&Sequence::open(Path::new("assets/walk"))?, folder.path())?;
    let databases = IMAGES.map(|images| open_measured(&walk, images, folder.path()));
    let (opened, synthesizers): (Vec<Opened>, Vec<Synthesizer>) =
        databases.into_iter().collect::<anyhow::Result<Vec<_>>>()?.into_iter().unzip();
    let blend = visits(&synthesizers, &MethodKind::Blend, 1)?;
    let plane = visits(&synthesizers, &MethodKind::Plane, 2)?;
    let row = |(opened, (blend, plane))| Row { opened, blend, plane };
    let rows: Vec<Row> = opened.into_iter().zip(blend.into_iter().zip(plane)).map(row).collect();
    write_table(&rows)?;
    plot(&rows)
}

/// Writes the pictures of a recording in a smaller size.
fn smaller(walk: &Sequence, folder: &Path) -> anyhow::Result<Sequence> {
    let mut small = Sequence { folder: folder.to_path_buf(), ..walk.clone() };
    small.setup.camera = walk.setup.camera.resized(SIZE)?;
    for (index, frame) in walk.frames.iter().enumerate() {
        let file = folder.join(&frame.image);
        fs::create_dir_all(file.parent().unwrap_or(folder))?;
        imageops::thumbnail(&walk.load_image(index)?, SIZE[0], SIZE[1]).save(&file)?;
    }
    Ok(small)
}

/// Makes a database of so many pictures, and measures it; no pictures are drawn yet.
fn open_measured(walk: &Sequence, images: usize, folder: &Path) -> anyhow::Result<(Opened, Synthesizer)> {
    let file = folder.join(format!("{images}.db"));
    fill(&file, walk, images)?;
    let (start, read_before) = (Instant::now(), read_so_far_bytes());
    let (archive, held_bytes, most_bytes) = measured(|| Archive::open(&file, CACHE_BYTES));
    let (archive, opening) = (archive?, start.elapsed());
    let read_bytes = read_so_far_bytes().zip(read_before).map(|(after, before)| after - before);
    let start = Instant::now();
    black_box(Coverage::new(archive.index(), archive.field(), archive.usual_pose(), CELL_M));
    let coverage = start.elapsed();
    let file_bytes = fs::metadata(&file)?.len();
    let opened = Opened { images, file_bytes, opening, read_bytes, held_bytes, most_bytes, coverage };
    Ok((opened, Synthesizer::new(Arc::new(archive))))
}

/// Returns how much this process has read of files, in memory or not.
fn read_so_far_bytes() -> Option<u64> {
    let counters = fs::read_to_string("/proc/self/io").ok()?;
    counters.lines().find_map(|line| line.strip_prefix("rchar: "))?.parse().ok()
}

fn fill(file: &Path, walk: &Sequence, images: usize) -> anyhow::Result<()> {
    let mut recording = walk.clone();
    recording.frames = walk.frames.iter().cycle().take(images).cloned().collect();
    // Some millimetres and tenths of a degree, as the filter's are.
    let covariance = Some(Matrix6::identity() * 1e-5);
    let estimate = |pose: CameraPose| Some(PoseEstimate { pose, covariance });
    let poses: Vec<_> = random_poses(images, 0).into_iter().map(estimate).collect();
    Database::create_or_open(file)?.ingest(&recording, &poses, &PoseSource::GroundTruth)?;
    Ok(())
}

/// Draws the same pictures twice from each database.
fn visits(synthesizers: &[Synthesizer], method: &MethodKind, seed: u64) -> anyhow::Result<Vec<Visits>> {
    let first = pictures_ms(synthesizers, method, seed)?;
    let again = pictures_ms(synthesizers, method, seed)?;
    let visits = first.into_iter().zip(again).map(|(first_ms, again_ms)| Visits { first_ms, again_ms });
    Ok(visits.collect())
}

/// Returns the median time of a picture at a random pose for each database, milliseconds. Only poses count at which all of them can draw one.
fn pictures_ms(synthesizers: &[Synthesizer], method: &MethodKind, seed: u64) -> anyhow::Result<Vec<f64>> {
    let mut times_ms = vec![Vec::new(); synthesizers.len()];
    for pose in random_poses(DRAWN, seed) {
        let timed = |synthesizer: &Synthesizer| {
            let start = Instant::now();
            let is_drawn = synthesizer.image_at(pose, method).is_ok();
            is_drawn.then(|| milliseconds(start.elapsed()))
        };
        // In turns: the machine's speed changes from minute to minute.
        let each: Vec<f64> = synthesizers.iter().map_while(timed).collect();
        if each.len() == synthesizers.len() {
            times_ms.iter_mut().zip(each).for_each(|(times_ms, time_ms)| times_ms.push(time_ms));
        }
    }
    let median = |mut times_ms: Vec<f64>| {
        times_ms.sort_by(f64::total_cmp);
        percentile(&times_ms, 0.5).context("no picture could be made")
    };
    times_ms.into_iter().map(median).collect()
}

fn write_table(rows: &[Row]) -> anyhow::Result<()> {
    let [width, height] = SIZE;
    let mut text = format!(
        "Made by `cargo run --release --example database_size`: pictures of {width} × {height} at random poses with covariances. A picture is \
         made at a random pose, its neighbours read and decoded, the median of {DRAWN}, the databases in turns: `blend` of six \
         neighbours, which overlap more where there are many pictures, and `plane` of one. The first visit of a pose waits for what the system no \
         longer holds of the file; the second one finds it in memory. Memory is what a counting allocator has handed out, without decoded \
         pictures.\n\n\
         | pictures | file, bytes a picture | opening | read by it, bytes a picture | memory, bytes a picture; most while opening | `blend`, first visit; second | `plane`, first visit; second | coverage |\n\
         |---|---|---|---|---|---|---|---|\n"
    );
    for Row { opened, blend, plane } in rows {
        let each = |bytes: usize| bytes / opened.images;
        writeln!(
            text,
            "| {} | {} | {:.1} ms | {} | {}; {} | {:.2}; {:.2} ms | {:.2}; {:.2} ms | {:.1} ms |",
            opened.images,
            opened.file_bytes / opened.images as u64,
            milliseconds(opened.opening),
            opened.read_bytes.map_or("–".to_owned(), |bytes| (bytes / opened.images as u64).to_string()),
            each(opened.held_bytes),
            each(opened.most_bytes),
            blend.first_ms,
            blend.again_ms,
            plane.first_ms,
            plane.again_ms,
            milliseconds(opened.coverage),
        )?;
    }
    let file = format!("{OUT}/database_size.md");
    fs::write(&file, text).with_context(|| format!("{file}: cannot be written"))
}

/// Plots the times over the number of pictures.
fn plot(rows: &[Row]) -> anyhow::Result<()> {
    type Value = fn(&Row) -> f64;
    let of: [(&str, Value); 4] = [
        ("opening", |row| milliseconds(row.opened.opening)),
        ("a picture: blend", |row| row.blend.first_ms),
        ("a picture: plane", |row| row.plane.first_ms),
        ("coverage", |row| milliseconds(row.opened.coverage)),
    ];
    let curves = of
        .map(|(name, value)| (name, rows.iter().map(|row| (row.opened.images as f64, value(row))).collect()));
    let axes = Axes { x: "pictures", y: "milliseconds", x_range: 250.0..1_200_000.0 };
    let file = Path::new(OUT).join("database_size.svg");
    curves::plot(&file, axes, &curves, &[], SeriesLabelPosition::UpperLeft)
}

fn milliseconds(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}
