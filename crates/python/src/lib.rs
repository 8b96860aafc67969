//! Native part of the Python package `reality_sim`: a thin face on the Rust library. Signatures and documentation for users are in
//! `python/reality_sim/_native.pyi`.

#![expect(clippy::needless_pass_by_value, reason = "Python hands arguments over")]

mod build;
mod database;
mod dataset;
mod error;
mod gap;
mod interruptible;
mod layers;
mod lens;
mod pictures;
mod pose;
mod renderer;
mod study;
mod tag;

use pyo3::prelude::*;

/// Recorded pictures for simulators.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::{
        build::build,
        database::Database,
        dataset::dataset,
        error::{Error, NoPicture},
        gap::gap,
        layers::{Ball, Cube, Humanoid, Layer},
        lens::Lens,
        renderer::{Frame, FrameLabels, Renderer, SeenObject},
        study::{study, study_settings, use_threads},
        tag::{TagErrors, Tags, tag},
    };

    /// Mark of a pixel that shows no object.
    #[pymodule_export]
    const NO_OBJECT: u16 = reality_sim::simulator::NO_OBJECT;

    /// Version of the library.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");

    /// Hash of the library's sources.
    #[pymodule_export]
    const SOURCES: &str = env!("REALITY_SIM_SOURCES");
}
