//! Measures how fast a database is written and opened: the demonstration walk over and over, 10,000 images or as many as
//! given.
//!
//! `cargo run --release -p reality-sim-db --example throughput -- 10000`

use std::{error::Error, io::Write, path::Path, time::Instant};

use reality_sim_core::sequence::Sequence;
use reality_sim_db::{Database, PoseEstimate, PoseSource};

fn main() -> Result<(), Box<dyn Error>> {
    let count: usize = std::env::args().nth(1).map_or(Ok(10_000), |text| text.parse())?;
    let mut sequence = Sequence::open(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/walk"))?;
    sequence.frames = sequence.frames.iter().cycle().take(count).cloned().collect();
    let covariance = Some(nalgebra::Matrix6::identity());
    let poses: Vec<_> =
        sequence.reference_poses().map(|pose| pose.map(|pose| PoseEstimate { pose, covariance })).collect();
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("walk.db");
    let mut out = std::io::stdout();
    for name in ["added", "found there"] {
        let start = Instant::now();
        Database::create_or_open(&path)?.ingest(&sequence, &poses, &PoseSource::GroundTruth)?;
        writeln!(out, "{name}: {:.0} images a second", count as f64 / start.elapsed().as_secs_f64())?;
    }
    let start = Instant::now();
    let database = Database::open(&path)?;
    let images = database.images()?;
    writeln!(out, "opened with {} poses: {:.3} s", images.len(), start.elapsed().as_secs_f64())?;
    let start = Instant::now();
    for image in images.iter().take(500) {
        database.image_bytes(image.id)?;
    }
    writeln!(out, "bytes of 500 images: {:.3} s", start.elapsed().as_secs_f64())?;
    Ok(())
}
