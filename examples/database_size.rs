//! What grows with a database, from 300 pictures to a million:
//!
//! `cargo run --release --example database_size` writes `docs/figures/database_size.md` and `database_size.svg`. It takes some minutes, and
//! 6 GB of the folder for temporary files.
//!
//! The pictures are those of the demonstration walk at a quarter of their size, over and over with poses that were never taken. Every
//! picture that is drawn decodes its neighbours anew, as at the first visit of a place.

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

/// What was measured of one database.
struct Row {
    images: usize,
    file_bytes: u64,
    opening: Duration,
    held_bytes: usize,
    most_bytes: usize,
    /// Median time of a picture, milliseconds.
    picture_ms: f64,
    coverage: Duration,
}

fn main() -> anyhow::Result<()> {
    let folder = tempfile::tempdir()?;
    let walk = smaller(&Sequence::open(Path::new("assets/walk"))?, folder.path())?;
    let rows = IMAGES
        .map(|images| row(&walk, images, folder.path()))
        .into_iter()
        .collect::<anyhow::Result<Vec<_>>>()?;
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

/// Makes a database of so many pictures, and measures it.
fn row(walk: &Sequence, images: usize, folder: &Path) -> anyhow::Result<Row> {
    let file = folder.join(format!("{images}.db"));
    fill(&file, walk, images)?;
    let start = Instant::now();
    let (archive, held_bytes, most_bytes) = measured(|| Archive::open(&file, CACHE_BYTES));
    let (archive, opening) = (archive?, start.elapsed());
    let start = Instant::now();
    black_box(Coverage::new(archive.index(), archive.field(), archive.usual_pose(), CELL_M));
    let coverage = start.elapsed();
    let picture_ms = picture_ms(&Synthesizer::new(Arc::new(archive)))?;
    let file_bytes = fs::metadata(&file)?.len();
    fs::remove_file(&file)?;
    Ok(Row { images, file_bytes, opening, held_bytes, most_bytes, picture_ms, coverage })
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

/// Returns the median time of a picture at a random pose.
fn picture_ms(synthesizer: &Synthesizer) -> anyhow::Result<f64> {
    let mut times_ms = Vec::new();
    for pose in random_poses(DRAWN, 1) {
        let start = Instant::now();
        if synthesizer.image_at(pose, &MethodKind::Blend).is_ok() {
            times_ms.push(1e3 * start.elapsed().as_secs_f64());
        }
    }
    times_ms.sort_by(f64::total_cmp);
    percentile(&times_ms, 0.5).context("no picture could be made")
}

fn write_table(rows: &[Row]) -> anyhow::Result<()> {
    let [width, height] = SIZE;
    let mut text = format!(
        "Made by `cargo run --release --example database_size`: pictures of {width} × {height} at random poses with covariances. A picture is \
         `blend` of six at a random pose, its neighbours decoded anew, the median of {DRAWN}. Memory is what a counting allocator has handed \
         out, without decoded pictures.\n\n\
         | pictures | file, bytes a picture | opening | memory, bytes a picture; most while opening | a picture | coverage |\n\
         |---|---|---|---|---|---|\n"
    );
    for row in rows {
        let each = |bytes: usize| bytes / row.images;
        writeln!(
            text,
            "| {} | {} | {:.1} ms | {}; {} | {:.2} ms | {:.1} ms |",
            row.images,
            row.file_bytes / row.images as u64,
            milliseconds(row.opening),
            each(row.held_bytes),
            each(row.most_bytes),
            row.picture_ms,
            milliseconds(row.coverage),
        )?;
    }
    let file = format!("{OUT}/database_size.md");
    fs::write(&file, text).with_context(|| format!("{file}: cannot be written"))
}

/// Plots the times over the number of pictures.
fn plot(rows: &[Row]) -> anyhow::Result<()> {
    type Value = fn(&Row) -> f64;
    let of: [(&str, Value); 3] = [
        ("opening", |row| milliseconds(row.opening)),
        ("a picture", |row| row.picture_ms),
        ("coverage", |row| milliseconds(row.coverage)),
    ];
    let curves =
        of.map(|(name, value)| (name, rows.iter().map(|row| (row.images as f64, value(row))).collect()));
    let axes = Axes { x: "pictures", y: "milliseconds", x_range: 250.0..1_200_000.0 };
    let file = Path::new(OUT).join("database_size.svg");
    curves::plot(&file, axes, &curves, &[], SeriesLabelPosition::UpperLeft)
}

fn milliseconds(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}
