//! Buffers on the device, if it allows their size.

use wgpu::BufferUsages as Usage;

use crate::{GpuContext, GpuError};

/// What a kernel reads and writes; the CPU can write it and have it copied back.
pub(crate) fn storage(
    context: &GpuContext,
    what: &'static str,
    bytes: usize,
) -> Result<wgpu::Buffer, GpuError> {
    buffer(context, what, bytes, Usage::STORAGE | Usage::COPY_DST | Usage::COPY_SRC)
}

/// A small structure that kernels read.
pub(crate) fn uniform<T>(context: &GpuContext, what: &'static str) -> Result<wgpu::Buffer, GpuError> {
    buffer(context, what, size_of::<T>(), Usage::UNIFORM | Usage::COPY_DST)
}

/// Where results are copied to be read.
pub(crate) fn readback(
    context: &GpuContext,
    what: &'static str,
    bytes: usize,
) -> Result<wgpu::Buffer, GpuError> {
    buffer(context, what, bytes, Usage::MAP_READ | Usage::COPY_DST)
}

/// A buffer with these values.
pub(crate) fn storage_of<T: bytemuck::Pod>(
    context: &GpuContext,
    what: &'static str,
    values: &[T],
) -> Result<wgpu::Buffer, GpuError> {
    let buffer = storage(context, what, size_of_val(values))?;
    write(context, &buffer, values);
    Ok(buffer)
}

/// A small structure with this value.
pub(crate) fn uniform_of<T: bytemuck::Pod>(
    context: &GpuContext,
    what: &'static str,
    value: T,
) -> Result<wgpu::Buffer, GpuError> {
    let buffer = uniform::<T>(context, what)?;
    write(context, &buffer, &[value]);
    Ok(buffer)
}

/// Overwrites the front of a buffer before the work submitted next.
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
    // Copies are of whole words, and an empty buffer cannot be bound.
    let size = (bytes as u64).next_multiple_of(4).max(16);
    if size > limit {
        return Err(GpuError::TooLarge { what, bytes: size, limit });
    }
    let descriptor = wgpu::BufferDescriptor { label: Some(what), size, usage, mapped_at_creation: false };
    Ok(context.device.create_buffer(&descriptor))
}
