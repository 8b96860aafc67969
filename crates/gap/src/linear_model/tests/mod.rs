//! The linearised model, compared with differences of the full prediction.

mod nuisance_columns;
mod odometry_steps;
mod parameter_columns;
mod pose_gradient;

use std::path::Path;

use reality_sim_core::sequence::Sequence;

use crate::recording::{Recording, ReferenceSource};

/// Opens a recording of a walk with a fisheye camera, all nominal values given.
fn sequence() -> Sequence {
    Sequence::open(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/pitch")).unwrap()
}

/// Returns the first frames of the recording, with the measured poses.
fn recording(sequence: &Sequence) -> Recording<'_> {
    let poses: Vec<_> = sequence.reference_poses().collect();
    Recording::new(sequence, &poses, ReferenceSource::Measured, Some(0..12)).unwrap()
}
