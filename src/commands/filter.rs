//! Configuration of the particle filter that `build` and `gap` share.

use std::sync::Arc;

use anyhow::anyhow;

use reality_sim::{
    LocalizerConfig, ObservationKind,
    pipeline::{Device, FilterPlan, OpenDevice, PipelineError},
};

use super::device::{BackendArgs, backend_error};

/// Returns the filter with default settings, on the device that the options name.
pub fn filter_plan(backend: &BackendArgs, seed: u64) -> FilterPlan {
    let backend = backend.clone();
    let open: OpenDevice = Arc::new(move || {
        let device = backend.device().map_err(backend_error)?;
        Ok(Device { name: device.name.to_owned(), backend: device.backend })
    });
    FilterPlan::default()
        .with_config(LocalizerConfig::new(ObservationKind::Contrast).with_seed(seed))
        .with_device(open)
        .with_program(concat!("reality-sim ", env!("CARGO_PKG_VERSION")))
}

/// Adds the option that remedies a file without poses.
pub fn pose_error(error: PipelineError) -> anyhow::Error {
    match error {
        PipelineError::NoPoses { file } => {
            anyhow!("{}: contains no poses of these pictures: make it with `tag --out`", file.display())
        }
        error => error.into(),
    }
}
