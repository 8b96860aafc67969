//! Results of every method at poses that were not recorded:
//!
//! `cargo run --release --example reconstruction_figures -- WALK PROBES`
//!
//! writes `docs/reconstruction.md` with its pictures in `docs/images`. WALK is a sequence with ground truth, PROBES one
//! that was recorded in the same hall. First the walk is the database and the probes are reconstructed; then one part of
//! the walk after the other is left out, reconstructed from the rest, and localized in place of the true pictures.

mod gaps;
mod lines;
mod probes;

use std::{fs, path::Path, sync::Arc};

use anyhow::{Context, bail};
use reality_sim::{
    Archive, Sequence, Synthesizer,
    db::{Database, PoseEstimate, PoseSource},
    synthesis::measure_hall,
};

const OUT: &str = "docs/reconstruction.md";
const IMAGES: &str = "docs/images";
const USAGE: &str = "usage: reconstruction_figures WALK PROBES";

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [walk, probes] = arguments.as_slice() else { bail!(USAGE) };
    let (walk, probes) = (Sequence::open(Path::new(walk))?, Sequence::open(Path::new(probes))?);
    fs::create_dir_all(IMAGES).with_context(|| format!("{IMAGES}: cannot be made"))?;
    let mut text = format!(
        "# Reconstruction, measured\n\nMade by `cargo run --release --example reconstruction_figures -- WALK PROBES`: \
         `{}` ({} pictures) is the database, `{}` ({} pictures, none of them in the database) is reconstructed.\n",
        walk.name,
        walk.frames.len(),
        probes.name,
        probes.frames.len()
    );
    probes::write(&walk, &probes, &mut text)?;
    gaps::write(&walk, &mut text)?;
    fs::write(OUT, text).with_context(|| format!("{OUT}: cannot be written"))
}

/// Stores a sequence's pictures at their true poses in a database, and opens it for pictures.
fn synthesizer(sequence: &Sequence) -> anyhow::Result<(tempfile::TempDir, Synthesizer)> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("walk.db");
    let mut database = Database::create_or_open(&path)?;
    let poses: Vec<_> = sequence.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
    database.ingest(sequence, &poses, &PoseSource::GroundTruth, |_| ())?;
    let archive = Archive::open(&path, 1 << 30)?;
    if let Some(hall) = measure_hall(&archive)? {
        database.set_hall(archive.images()[0].field_id, &hall)?;
    }
    let archive = Arc::new(Archive::open(&path, 1 << 30)?);
    Ok((folder, Synthesizer::new(archive)))
}
