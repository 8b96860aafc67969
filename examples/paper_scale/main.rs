//! The paper at its own size: 10,000 pictures tagged by the filter, built into a database, and reconstructed where others were taken,
//! beside the same with true poses.
//!
//! `cargo run --release --example paper_scale -- record FOLDER [FRAMES]` makes the recordings, which are ray-traced: three quarters of an
//! hour and 600 MB for the 10,000 frames that are made if FRAMES is left out.
//! `cargo run --release --example paper_scale -- measure FOLDER` does all else, and writes `docs/figures/paper_scale.md` and
//! `docs/images/crossing.jpg`.

mod databases;
mod recording;
mod routes;

use std::{
    fmt::Write,
    fs,
    path::Path,
    time::{Duration, Instant},
};

use anyhow::{Context, bail};
use reality_sim::{evaluation::ErrorStatistics, pipeline::PoseChoice};

use crate::{
    databases::Built,
    recording::Recordings,
    routes::{Error, Route},
};

const OUT: &str = "docs/figures/paper_scale.md";
const PICTURE: &str = "docs/images/crossing.jpg";
/// The paper's number of pictures.
const FRAMES: usize = 10_000;
const USAGE: &str = "usage: paper_scale record FOLDER [FRAMES] | measure FOLDER";

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments.as_slice() {
        ["record", folder] => recording::record(Path::new(folder), FRAMES),
        ["record", folder, frames] => recording::record(Path::new(folder), frames.parse().context(USAGE)?),
        ["measure", folder] => measure(folder),
        _ => bail!(USAGE),
    }
}

fn measure(folder: &str) -> anyhow::Result<()> {
    let start = Instant::now();
    let recordings = Recordings::open(Path::new(folder))?;
    let temporary = tempfile::tempdir()?;
    let build = |poses, name| databases::build(&recordings.walk, poses, &temporary.path().join(name));
    let tagged = build(PoseChoice::Filter, "tagged.db")?;
    let routes = |built: &Built| routes::measure(&recordings, built);
    let through_tags = routes(&tagged)?;
    let main_job = start.elapsed();
    let memory_mb = peak_memory_mb()?;
    let with_truth = build(PoseChoice::ReferenceElseFilter, "true.db")?;
    let through_truth = routes(&with_truth)?;

    let mut text = format!(
        "# The paper at its own size\n\nMade by `bash scripts/paper`, which makes the ray-traced recordings `{folder}` and runs \
         `cargo run --release --example paper_scale -- measure {folder}`: a random walk over the paper's field, {} pictures of 640 × 480 \
         pixels, whose poses the filter finds itself (`contrast`, smoothed, from the pose of the first picture); and pictures of the same hall at true poses, \
         on a grid of 30 cm with all headings and along a straight crossing, which are reconstructed. All true poses are exact.\n\n",
        recordings.walk.frames.len()
    );
    times(&tagged, main_job, memory_mb, &mut text)?;
    tags(&tagged, &recordings, &mut text)?;
    for (tags, truth) in through_tags.iter().zip(&through_truth) {
        compare(tags, truth, &mut text)?;
    }
    routes::show(&recordings.crossing, &through_tags[1], &through_truth[1], Path::new(PICTURE))?;
    writeln!(
        text,
        "\n![The crossing](../images/crossing.jpg)\n\nThe straight crossing, as the paper's Figs. 10 to 12. From top to bottom: true pictures, \
         reconstructed (`blend`) through the filter's poses, through the true poses, drawn from the field's model."
    )?;
    fs::write(OUT, text).with_context(|| format!("{OUT}: cannot be written"))
}

fn times(tagged: &Built, main_job: Duration, memory_mb: f64, text: &mut String) -> anyhow::Result<()> {
    let minutes = |time: Duration| time.as_secs_f64() / 60.0;
    writeln!(text, "| two cores | |\n|---|---|")?;
    writeln!(text, "| tagging, with smoothing | {:.1} min |", minutes(tagged.tagging))?;
    writeln!(text, "| storing | {:.1} min |", minutes(tagged.storing))?;
    writeln!(
        text,
        "| measuring the hall, finding the clean stage | {:.1} min |",
        minutes(tagged.surroundings)
    )?;
    writeln!(
        text,
        "| all of it, with the pictures of both routes and their comparison | {:.1} min |",
        minutes(main_job)
    )?;
    writeln!(text, "| memory at most (resident) | {memory_mb:.0} MB |")?;
    Ok(())
}

fn tags(tagged: &Built, recordings: &Recordings, text: &mut String) -> anyhow::Result<()> {
    let Some(error) = ErrorStatistics::new(&tagged.errors) else { bail!("the filter is sure of no pose") };
    writeln!(
        text,
        "\n{} of {} pictures have a pose that the filter is sure of. Their error is {:.2} cm in the mean, {:.2} cm in the median, below {:.2} cm in 95 %, \
         {:.1} cm at most; {} are lost (off by more than half a metre or half a radian).",
        error.frames,
        recordings.walk.frames.len(),
        100.0 * error.mean_m,
        100.0 * error.median_m,
        100.0 * error.p95_m,
        100.0 * error.max_m,
        error.lost_frames,
    )?;
    Ok(())
}

fn compare(tags: &Route, truth: &Route, text: &mut String) -> anyhow::Result<()> {
    writeln!(
        text,
        "\n## {}: {} pictures\n\nPSNR of the field and of the whole picture, means over the pictures; error: of the pose that the filter \
         (`contrast`, 800 particles, from a start 5 cm and 3° off) finds in the reconstructed picture, mean and median.\n\n\
         | method | poses of the database | PSNR of the field | PSNR | error |\n|---|---|---|---|---|",
        tags.name, tags.pictures
    )?;
    writeln!(text, "| true picture | | | | {} |", tags.true_error.words())?;
    for (method, by_tags) in &tags.methods {
        for (poses, figures) in [("the filter's", by_tags), ("true", &truth.methods[method])] {
            writeln!(
                text,
                "| `{method}` | {poses} | {:.2} dB | {:.2} dB | {} |",
                figures.psnr_field_db,
                figures.psnr_db,
                figures.error.as_ref().map_or_else(String::new, Error::words)
            )?;
        }
    }
    Ok(())
}

/// Returns the most memory that the process has had so far, MB. Linux only.
fn peak_memory_mb() -> anyhow::Result<f64> {
    let status = fs::read_to_string("/proc/self/status")?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))
        .context("the memory's peak is not told")?;
    let kib: f64 = line.trim().trim_end_matches("kB").trim().parse()?;
    Ok(kib * 1024.0 / 1e6)
}
