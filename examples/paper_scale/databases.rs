//! Databases of the walk, with the filter's poses or with the true ones.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
    time::{Duration, Instant},
};

use reality_sim::{
    Sequence,
    evaluation::PoseError,
    pipeline::{Event, Plan, PoseChoice},
};

/// Database, and what it took.
pub struct Built {
    pub path: PathBuf,
    /// Errors of the poses, one for each picture that has one.
    pub errors: Vec<PoseError>,
    pub tagging: Duration,
    pub storing: Duration,
    pub surroundings: Duration,
}

/// Builds a database of a recording.
pub fn build(walk: &Sequence, poses: PoseChoice, path: &Path) -> anyhow::Result<Built> {
    let start = Instant::now();
    let (mut errors, mut tagging, mut storing) = (Vec::new(), Duration::ZERO, Duration::ZERO);
    for event in Plan::new([Arc::new(walk.clone())], poses).with_database(path).start() {
        match event? {
            Event::PosesFound { poses, .. } => {
                tagging = start.elapsed();
                let both = walk.reference_poses().zip(poses.estimates);
                errors.extend(both.filter_map(|(truth, found)| Some(PoseError::new(found?.pose, truth?))));
            }
            Event::Ingested { .. } => storing = start.elapsed() - tagging,
            _ => {}
        }
    }
    let surroundings = start.elapsed() - tagging - storing;
    Ok(Built { path: path.to_path_buf(), errors, tagging, storing, surroundings })
}
