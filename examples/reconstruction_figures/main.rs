//! Results of every method at poses that were not recorded:
//!
//! `cargo run --release --example reconstruction_figures -- RECORDING`
//!
//! writes `docs/reconstruction.md` with its pictures in `docs/images`; `scripts/figures` makes the recording, too.
//! RECORDING is a sequence with ground truth. Its first five sixths, the walk, are the database, and every other picture
//! of the rest is a probe, which is reconstructed. Then one part of the walk after the other is left out, reconstructed
//! from the rest, and localized in place of the true pictures.

mod gaps;
mod lines;
mod probes;

use std::{fs, path::Path, sync::Arc};

use anyhow::{Context, bail};
use reality_sim::{
    Archive, Sequence, Synthesizer,
    db::{Database, PoseEstimate, PoseSource},
    sequence::FrameRecord,
    synthesis::measure_hall,
};

const OUT: &str = "docs/reconstruction.md";
const IMAGES: &str = "docs/images";
/// Cargo's profile, which changes the times only.
const PROFILE: &str = if cfg!(debug_assertions) { "dev" } else { "release" };
const USAGE: &str = "usage: reconstruction_figures RECORDING";

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder] = arguments.as_slice() else { bail!(USAGE) };
    let (walk, probes) = parts(&Sequence::open(Path::new(folder))?);
    fs::create_dir_all(IMAGES).with_context(|| format!("{IMAGES}: cannot be made"))?;
    let mut text = format!(
        "# Reconstruction, measured\n\nMade by `bash scripts/figures {PROFILE}`, which makes the ray-traced recording `{folder}` and runs \
         `cargo run --profile {PROFILE} --example reconstruction_figures -- {folder}`. The first {} pictures of the recording are the \
         database; of the others, in which the robot walks on through the same hall, {} are reconstructed. The poses of the \
         recording have the noise of motion capture: 3 mm and 0.14° in every axis.\n",
        walk.frames.len(),
        probes.frames.len()
    );
    probes::write(&walk, &probes, &mut text)?;
    gaps::write(&walk, &mut text)?;
    fs::write(OUT, text).with_context(|| format!("{OUT}: cannot be written"))
}

/// Splits a recording into the walk for the database and the probes.
fn parts(recording: &Sequence) -> (Sequence, Sequence) {
    let (walk, rest) = recording.frames.split_at(recording.frames.len() * 5 / 6);
    let part = |frames: Vec<FrameRecord>| Sequence { frames, ..recording.clone() };
    (part(walk.to_vec()), part(rest.iter().step_by(2).cloned().collect()))
}

/// Stores a sequence's pictures at their true poses in a database, and opens it for pictures.
fn synthesizer(sequence: &Sequence) -> anyhow::Result<(tempfile::TempDir, Synthesizer)> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("walk.db");
    let mut database = Database::create_or_open(&path)?;
    let poses: Vec<_> = sequence.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
    database.ingest(sequence, &poses, &PoseSource::GroundTruth)?;
    let archive = Archive::open(&path, 1 << 30)?;
    if let Some(hall) = measure_hall(&archive)? {
        database.set_hall(archive.images()[0].field_id, &hall)?;
    }
    let archive = Arc::new(Archive::open(&path, 1 << 30)?);
    Ok((folder, Synthesizer::new(archive)))
}
