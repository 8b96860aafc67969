//! Running times of kernels, by the device's own clock.

use crate::{GpuContext, GpuError, buffers::readback, kernel::Step};

/// Runs kernels one after the other, each in its own pass, and returns the seconds that each took.
pub(crate) fn timed_steps(context: &GpuContext, steps: &[Step<'_>]) -> Result<Vec<f64>, GpuError> {
    if !context.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
        return Err(GpuError::CannotTime { adapter: context.adapter().name.clone() });
    }
    let count = 2 * steps.len() as u32;
    let bytes = u64::from(count) * size_of::<u64>() as u64;
    let queries = context.device.create_query_set(&wgpu::QuerySetDescriptor {
        label: Some("timestamps"),
        ty: wgpu::QueryType::Timestamp,
        count,
    });
    let stamps = context.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("timestamps"),
        size: bytes,
        usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let target = readback(context, "the timestamps read back", bytes as usize)?;
    context.submit(|encoder| {
        for ((kernel, groups), query) in steps.iter().zip((0..count).step_by(2)) {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(kernel.name),
                timestamp_writes: Some(wgpu::ComputePassTimestampWrites {
                    query_set: &queries,
                    beginning_of_pass_write_index: Some(query),
                    end_of_pass_write_index: Some(query + 1),
                }),
            });
            kernel.run(&mut pass, *groups);
        }
        encoder.resolve_query_set(&queries, 0..count, &stamps, 0);
        encoder.copy_buffer_to_buffer(&stamps, 0, &target, 0, bytes);
    });
    let stamps: Vec<u64> = context.read(&target, bytes)?;
    let seconds_per_tick = f64::from(context.queue.get_timestamp_period()) * 1e-9;
    Ok(stamps.chunks_exact(2).map(|pair| pair[1].saturating_sub(pair[0]) as f64 * seconds_per_tick).collect())
}
