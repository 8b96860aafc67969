//! What JaC@5 and JaC@10 are worth: measures them at the reference poses of recordings, and at poses and focal lengths that are wrong by
//! a known amount. The thresholds of `reality_sim::quality` come from its tables.
//! `cargo run --release --example line_quality -- assets/walk assets/pitch`; with `FOLDER@10` only every tenth picture.

#![expect(clippy::print_stdout, reason = "an example shows what it does")]

use std::{env, error::Error, f64::consts::TAU, path::Path, time::Instant};

use reality_sim::{
    Camera, CameraPose, Sequence,
    filter::{Purpose, Stream},
    localization::mount_of_frame,
    preprocess::{LinePoints, Preprocessor},
    quality::{LineAgreement, LineMeter, RecordingQuality},
};
