//! Buffers on the device, refused where they exceed its limits.

use wgpu::BufferUsages as Usage;

use crate::{GpuContext, GpuError};

/// Creates a buffer that kernels read and write; the CPU can write to it and copy it back.
pub(crate) fn storage(
    context: &GpuContext,
    what: &'static str,
    bytes: usize,
) -> Result<wgpu::Buffer, GpuError> {
    buffer(context, what, bytes, Usage::STORAGE | Usage::COPY_DST | Usage::COPY_SRC)
}

/// Creates a buffer for a small structure that kernels read.
pub(crate) fn uniform<T>(context: &GpuContext, what: &'static str) -> Result<wgpu::Buffer, GpuError> {
    buffer(context, what, size_of::<T>(), Usage::UNIFORM | Usage::COPY_DST)
}

/// Creates a buffer into which results are copied for the CPU to read.
pub(crate) fn readback(
    context: &GpuContext,
    what: &'static str,
    bytes: usize,
) -> Result<wgpu::Buffer, GpuError> {
    buffer(context, what, bytes, Usage::MAP_READ | Usage::COPY_DST)
}

/// Creates a storage buffer with these values.
pub(crate) fn storage_of<T: bytemuck::Pod>(
    context: &GpuContext,
    what: &'static str,
    values: &[T],
) -> Result<wgpu::Buffer, GpuError> {
    let buffer = storage(context, what, size_of_val(values))?;
    write(context, &buffer, values);
    Ok(buffer)
}

/// Creates a uniform buffer with this value.
pub(crate) fn uniform_of<T: bytemuck::Pod>(
    context: &GpuContext,
    what: &'static str,
    value: T,
) -> Result<wgpu::Buffer, GpuError> {
    let buffer = uniform::<T>(context, what)?;
    write(context, &buffer, &[value]);
    Ok(buffer)
}

/// Overwrites the start of a buffer before the work that is submitted next.
pub(crate) fn write<T: bytemuck::Pod>(context: &GpuContext, buffer: &wgpu::Buffer, values: &[T]) {
    context.queue.write_buffer(buffer, 0, bytemuck::cast_slice(values));
}

fn buffer(
    context: &GpuContext,
    what: &'static str,
    bytes: usize,
    usage: Usage,
) -> Result<wgpu::Buffer, GpuError> {
    let limits = context.device.limits();
    let limit = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
    // Copies are made of whole words, and an empty buffer cannot be bound.
    let size = (bytes as u64).next_multiple_of(4).max(16);
    if size > limit {
        return Err(GpuError::TooLarge { what, bytes: size, limit });
    }
    let descriptor = wgpu::BufferDescriptor { label: Some(what), size, usage, mapped_at_creation: false };
    Ok(context.device.create_buffer(&descriptor))
}
