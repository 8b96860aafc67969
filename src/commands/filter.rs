//! The particle filter on the way to something else: what `build` and `gap` share.

use std::sync::Arc;

use anyhow::anyhow;

use reality_sim::{
    LocalizerConfig, ObservationKind,
    pipeline::{Device, FilterPlan, OpenDevice, PipelineError},
};

use super::device::{BackendArgs, backend_error};

/// The filter with the usual settings, on the device that the options name.
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

/// Says which option helps where a file has no poses.
pub fn pose_error(error: PipelineError) -> anyhow::Error {
    match error {
        PipelineError::NoPoses { file } => {
            anyhow!("{}: holds no poses: make it with `tag --out`", file.display())
        }
        error => error.into(),
    }
}
