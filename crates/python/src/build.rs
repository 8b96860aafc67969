//! Building of databases.

use std::{path::PathBuf, sync::Arc};

use pyo3::prelude::*;
use reality_sim::{
    LocalizerConfig, ObservationKind, Sequence,
    db::Database,
    pipeline::{Event, FilterPlan, Plan, PoseChoice},
};

use crate::{error::failed, interruptible::check_signals};

/// Stores recordings in a database by pose, and returns the number of its pictures.
#[pyfunction]
#[pyo3(signature = (recordings, out, *, poses = None, tag = false, hall = true, clean = true, seed = 0))]
#[expect(clippy::too_many_arguments, reason = "Python's keywords")]
pub fn build(
    py: Python<'_>,
    recordings: Vec<PathBuf>,
    out: PathBuf,
    poses: Option<PathBuf>,
    tag: bool,
    hall: bool,
    clean: bool,
    seed: u64,
) -> PyResult<usize> {
    py.detach(|| {
        let open = |folder: &PathBuf| Sequence::open(folder).map(Arc::new).map_err(failed);
        let (databases, recordings): (Vec<_>, Vec<_>) =
            recordings.into_iter().partition(|path| Database::is_at(path));
        let recordings = recordings.iter().map(open).collect::<PyResult<Vec<_>>>()?;
        let poses = match poses {
            Some(file) => PoseChoice::File(file),
            None if tag => PoseChoice::Filter,
            None => PoseChoice::ReferenceElseFilter,
        };
        let filter = FilterPlan::default()
            .with_config(LocalizerConfig::new(ObservationKind::Contrast).with_seed(seed))
            .with_program(concat!("reality_sim for Python ", env!("CARGO_PKG_VERSION")));
        let plan = Plan::new(recordings, poses)
            .with_databases(databases)
            .with_filter(filter)
            .with_database(&out)
            .with_hall(hall)
            .with_clean_stage(clean);
        let mut stored = 0;
        for event in plan.start() {
            if let Event::Completed { images, .. } = event.map_err(failed)? {
                stored = images;
            }
            // Ctrl-C ends the work, and what was stored until then stays.
            check_signals()?;
        }
        Ok(stored)
    })
}
