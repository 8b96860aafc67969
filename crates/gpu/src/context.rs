//! Choice of a graphics device, and its errors.

use std::sync::{Arc, Mutex, PoisonError, mpsc};

use crate::GpuError;

/// Number of errors kept for one device: the first few reveal the cause.
const KEPT_ERRORS: usize = 4;

/// Summary of an adapter, for people to choose from.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct AdapterSummary {
    /// Name of the adapter.
    pub name: String,
    /// Graphics interface: Vulkan, Metal or DX12.
    pub backend: String,
    /// Kind of device: discrete, integrated, virtual or running on the processor.
    pub kind: String,
    /// Name and version of the driver.
    pub driver: String,
    /// Whether the driver runs on the processor.
    pub is_processor: bool,
    /// Size of the largest buffer, bytes.
    pub max_buffer_bytes: u64,
    /// Size of the largest part of a buffer that a kernel can access, bytes.
    pub max_storage_buffer_bytes: u64,
    /// Largest number of workgroups along one dimension.
    pub max_workgroups: u32,
}

/// Open graphics device with its queue.
#[derive(Debug)]
pub struct GpuContext {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    adapter: AdapterSummary,
    errors: Arc<Mutex<Vec<String>>>,
}

/// Lists all adapters, the best first: discrete cards, then integrated ones, then drivers that run on the processor.
pub fn adapters() -> Vec<AdapterSummary> {
    found().iter().map(summary).collect()
}

fn found() -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
    let mut adapters = pollster::block_on(instance.enumerate_adapters(backends));
    adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    adapters
}

fn summary(adapter: &wgpu::Adapter) -> AdapterSummary {
    let info = adapter.get_info();
    AdapterSummary {
        name: info.name,
        backend: info.backend.to_string(),
        kind: match info.device_type {
            wgpu::DeviceType::DiscreteGpu => "graphics card",
            wgpu::DeviceType::IntegratedGpu => "graphics unit of the processor",
            wgpu::DeviceType::VirtualGpu => "graphics card of a virtual machine",
            wgpu::DeviceType::Cpu => "driver that runs on the processor",
            wgpu::DeviceType::Other => "unknown",
        }
        .to_owned(),
        is_processor: info.device_type == wgpu::DeviceType::Cpu,
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        max_buffer_bytes: adapter.limits().max_buffer_size,
        max_storage_buffer_bytes: adapter.limits().max_storage_buffer_binding_size,
        max_workgroups: adapter.limits().max_compute_workgroups_per_dimension,
    }
}

impl GpuContext {
    /// Opens the best adapter, or the best one whose name contains `name` (case is ignored).
    pub fn new(name: Option<&str>) -> Result<Self, GpuError> {
        let adapters = found();
        if adapters.is_empty() {
            return Err(GpuError::NoAdapter);
        }
        let wanted = name.unwrap_or_default().to_lowercase();
        let fits = |adapter: &&wgpu::Adapter| adapter.get_info().name.to_lowercase().contains(&wanted);
        let Some(adapter) = adapters.iter().find(fits) else {
            let names: Vec<String> = adapters.iter().map(|adapter| adapter.get_info().name).collect();
            return Err(GpuError::NoSuchAdapter {
                wanted: name.unwrap_or_default().to_owned(),
                found: names.join(", "),
            });
        };
        Self::open(adapter)
    }

    fn open(adapter: &wgpu::Adapter) -> Result<Self, GpuError> {
        let summary = summary(adapter);
        let available = adapter.limits();
        let required_limits = wgpu::Limits {
            max_storage_buffer_binding_size: available.max_storage_buffer_binding_size,
            max_buffer_size: available.max_buffer_size,
            ..wgpu::Limits::default()
        };
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("Reality Sim"),
            required_limits,
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).map_err(|error| {
            GpuError::NoDevice { adapter: summary.name.clone(), reason: error.to_string() }
        })?;
        let errors = Arc::new(Mutex::new(Vec::new()));
        let (uncaptured, lost) = (errors.clone(), errors.clone());
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| keep(&uncaptured, error.to_string())));
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                keep(&lost, format!("device lost: {message}"));
            }
        });
        Ok(Self { device, queue, adapter: summary, errors })
    }

    /// Makes a context of a device that belongs to somebody else, such as a simulator that draws with it. Its owner is told of
    /// errors that the device reports aside from calls; here they are not seen.
    pub fn shared(adapter: &wgpu::Adapter, device: wgpu::Device, queue: wgpu::Queue) -> Self {
        Self { device, queue, adapter: summary(adapter), errors: Arc::default() }
    }

    /// Returns the adapter in use.
    pub fn adapter(&self) -> &AdapterSummary {
        &self.adapter
    }

    /// Fails if the device has failed. The device reports a failure aside from the call that caused it, so every function
    /// of this package that submits work and reads nothing back ends with this check; [`GpuContext::read`] contains it.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        let errors = self.errors.lock().unwrap_or_else(PoisonError::into_inner);
        if errors.is_empty() { Ok(()) } else { Err(GpuError::Failed { reason: errors.join("; ") }) }
    }

    /// Submits the encoded commands as one piece of work.
    pub(crate) fn submit(&self, encode: impl FnOnce(&mut wgpu::CommandEncoder)) {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encode(&mut encoder);
        self.queue.submit([encoder.finish()]);
    }

    /// Waits for the work submitted so far and reads the first `bytes` of a buffer that can be mapped.
    pub(crate) fn read<T: bytemuck::Pod>(
        &self,
        buffer: &wgpu::Buffer,
        bytes: u64,
    ) -> Result<Vec<T>, GpuError> {
        let failed = |reason: String| {
            keep(&self.errors, reason.clone());
            GpuError::Failed { reason }
        };
        let (sender, receiver) = mpsc::channel();
        let slice = buffer.slice(..bytes);
        slice.map_async(wgpu::MapMode::Read, move |result| {
            // The receiver waits below; it is gone only if waiting has failed.
            let _ = sender.send(result);
        });
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(error.to_string()))?;
        self.check()?;
        match receiver.try_recv() {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(failed(error.to_string())),
            Err(_) => return Err(failed("the device did not answer".to_owned())),
        }
        let view = slice.get_mapped_range().map_err(|error| failed(error.to_string()))?;
        let values = bytemuck::pod_collect_to_vec(&view[..]);
        drop(view);
        buffer.unmap();
        Ok(values)
    }
}

/// Keeps the first few errors, each of them once.
fn keep(errors: &Mutex<Vec<String>>, message: String) {
    let mut errors = errors.lock().unwrap_or_else(PoisonError::into_inner);
    if errors.len() < KEPT_ERRORS && !errors.contains(&message) {
        errors.push(message);
    }
}
