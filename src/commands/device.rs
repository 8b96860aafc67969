//! Choice of the device that a command computes on.

use std::sync::Arc;

use anyhow::bail;
use clap::Args;

use reality_sim::backend::{Backend, BackendError, CpuBackend, DeviceChoice};

use super::choice::one_of;

/// Device to compute on.
#[derive(Debug, Clone, Args)]
pub struct BackendArgs {
    /// Device to compute on; auto takes a graphics card if there is one
    #[arg(long, value_parser = one_of::<DeviceChoice>(DeviceChoice::ALL.map(DeviceChoice::name)), default_value_t)]
    backend: DeviceChoice,
    /// Use the graphics adapter whose name contains NAME; `reality-sim doctor` lists them
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

/// Device that was chosen.
pub struct Device {
    pub backend: Arc<dyn Backend>,
    /// Name of the backend: `cpu` or `gpu`.
    pub name: &'static str,
    /// Name of the graphics adapter, if the device is one.
    pub adapter: Option<String>,
    /// Reason why the device is not the graphics card, in a sentence; `None` if nobody would ask.
    pub reason: Option<String>,
}

impl Device {
    fn processor(reason: Option<String>) -> Self {
        Self { backend: Arc::new(CpuBackend), name: DeviceChoice::Cpu.name(), adapter: None, reason }
    }
}

impl BackendArgs {
    /// Refuses a graphics adapter for the CPU.
    pub fn check_usage(&self) -> Result<(), String> {
        match (self.backend, &self.adapter) {
            (DeviceChoice::Cpu, Some(_)) => {
                Err("--adapter has no effect with --backend cpu: leave one of them out".to_owned())
            }
            _ => Ok(()),
        }
    }

    /// Returns the processor, for an option that no graphics card supports.
    pub fn processor_only(&self, option: &str) -> anyhow::Result<Device> {
        if self.backend == DeviceChoice::Gpu || self.adapter.is_some() {
            bail!("{option}: is not supported on graphics cards: leave it out, or use --backend cpu");
        }
        Ok(Device::processor(None))
    }

    /// Opens the requested device.
    #[cfg(feature = "gpu")]
    pub fn device(&self) -> anyhow::Result<Device> {
        use reality_sim::gpu::{GpuBackend, GpuContext};

        if self.backend == DeviceChoice::Cpu {
            return Ok(Device::processor(None));
        }
        let is_asked_for = self.backend == DeviceChoice::Gpu || self.adapter.is_some();
        let context = match GpuContext::new(self.adapter.as_deref()) {
            Ok(context) => context,
            Err(error) if is_asked_for => return Err(error.into()),
            Err(error) => return Ok(Device::processor(Some(error.to_string()))),
        };
        if !is_asked_for && context.adapter().is_processor {
            let reason = "there is no graphics card, only a driver that runs on the processor".to_owned();
            return Ok(Device::processor(Some(reason)));
        }
        let adapter = Some(context.adapter().name.clone());
        let backend = Arc::new(GpuBackend::new(Arc::new(context)));
        Ok(Device { backend, name: DeviceChoice::Gpu.name(), adapter, reason: None })
    }

    /// Returns the processor: this build supports nothing else.
    #[cfg(not(feature = "gpu"))]
    pub fn device(&self) -> anyhow::Result<Device> {
        if self.backend == DeviceChoice::Gpu || self.adapter.is_some() {
            bail!(
                "reality-sim: was built without support of graphics cards: use --backend cpu, or build it with the feature `gpu`"
            );
        }
        Ok(Device::processor(None))
    }
}

/// Wraps the error of a device that cannot be opened; keeps the device's own error, if there is one.
#[cfg(feature = "gpu")]
pub fn backend_error(error: anyhow::Error) -> BackendError {
    error.downcast::<reality_sim::gpu::GpuError>().map_or_else(BackendError::new, BackendError::from)
}

/// Wraps the error of a device that cannot be opened.
#[cfg(not(feature = "gpu"))]
pub fn backend_error(error: anyhow::Error) -> BackendError {
    BackendError::new(error)
}

/// Lists the devices that the viewer offers, the default first.
#[cfg(feature = "viewer")]
pub fn all() -> Vec<reality_sim_viewer::Device> {
    use reality_sim_viewer::Device;

    let open = |backend: DeviceChoice, adapter: Option<String>| {
        let args = BackendArgs { backend, adapter };
        move || args.device().map(|device| device.backend).map_err(backend_error)
    };
    let kinds = [DeviceChoice::Auto, DeviceChoice::Cpu].map(|kind| Device::new(kind, open(kind, None)));
    let adapters = adapter_names()
        .into_iter()
        .map(|name| Device::adapter(name.clone(), open(DeviceChoice::Gpu, Some(name))));
    kinds.into_iter().chain(adapters).collect()
}

/// Returns the names of this machine's graphics adapters.
#[cfg(all(feature = "viewer", feature = "gpu"))]
fn adapter_names() -> Vec<String> {
    reality_sim::gpu::adapters().into_iter().map(|adapter| adapter.name).collect()
}

/// Returns no names: this build does not support graphics adapters.
#[cfg(all(feature = "viewer", not(feature = "gpu")))]
fn adapter_names() -> Vec<String> {
    Vec::new()
}
