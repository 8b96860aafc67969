//! Workflow that is examined.

use std::error::Error;

use reality_sim::{
    Sequence,
    gap::{Options, Recording, RecordingError, ReferenceSource, analyse, gap_of, report::Report},
    sensor::Model,
};

/// Name of the workflow in the runs.
pub const NAME: &str = "gap";

/// Runs the workflow on a recording with its reference poses.
pub fn examine(sequence: &Sequence, options: &Options) -> Result<Report, Box<dyn Error>> {
    Ok(analyse(&open(sequence)?, &Model::default(), options, &|_| ())?.report)
}

/// Returns the gap that a model leaves.
pub fn gap_left(sequence: &Sequence, model: &Model, options: &Options) -> Result<f64, Box<dyn Error>> {
    Ok(gap_of(&open(sequence)?, model, options)?.before)
}

fn open(sequence: &Sequence) -> Result<Recording<'_>, RecordingError> {
    let poses: Vec<_> = sequence.reference_poses().collect();
    Recording::new(sequence, &poses, ReferenceSource::Measured, None)
}
