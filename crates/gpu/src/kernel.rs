//! A compute shader, ready to run.

use crate::{GpuContext, shader};

/// Compute pipeline whose bindings are numbered from 0 in the order in which the shader declares them.
#[derive(Debug)]
pub(crate) struct Kernel {
    name: &'static str,
    pipeline: wgpu::ComputePipeline,
}

/// Kernel with the buffers that it works on.
#[derive(Debug)]
pub(crate) struct BoundKernel {
    pub name: &'static str,
    pipeline: wgpu::ComputePipeline,
    bindings: wgpu::BindGroup,
}

/// Buffer or texture that a kernel works on.
pub(crate) struct Binding<'a>(wgpu::BindingResource<'a>);

impl<'a> From<&'a wgpu::Buffer> for Binding<'a> {
    fn from(buffer: &'a wgpu::Buffer) -> Self {
        Self(buffer.as_entire_binding())
    }
}

impl<'a> From<&'a wgpu::TextureView> for Binding<'a> {
    fn from(view: &'a wgpu::TextureView) -> Self {
        Self(wgpu::BindingResource::TextureView(view))
    }
}

impl Kernel {
    /// Compiles the shader of this name.
    pub fn new(context: &GpuContext, name: &'static str) -> Self {
        Self::with_constants(context, name, &[])
    }

    /// Compiles the shader of this name with values for the constants that it leaves open.
    pub fn with_constants(context: &GpuContext, name: &'static str, constants: &[(&str, f64)]) -> Self {
        // A test ensures that every kernel has a file of its name, and that all imports exist.
        let source = shader::source(&format!("{name}.wgsl")).unwrap_or_default();
        let module = context.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let pipeline = context.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: None,
            module: &module,
            entry_point: Some(name),
            compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
            cache: None,
        });
        Self { name, pipeline }
    }

    pub fn bind(&self, context: &GpuContext, buffers: &[&wgpu::Buffer]) -> BoundKernel {
        let bindings: Vec<Binding<'_>> = buffers.iter().map(|&buffer| buffer.into()).collect();
        self.bind_all(context, &bindings)
    }

    /// Binds textures as well as buffers, otherwise like [`Kernel::bind`].
    pub fn bind_all(&self, context: &GpuContext, bindings: &[Binding<'_>]) -> BoundKernel {
        let entries: Vec<wgpu::BindGroupEntry<'_>> = bindings
            .iter()
            .zip(0..)
            .map(|(Binding(resource), binding)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
            .collect();
        let bindings = context.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.name),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        BoundKernel { name: self.name, pipeline: self.pipeline.clone(), bindings }
    }
}

/// Kernel with its number of workgroups along x and y.
pub(crate) type Step<'a> = (&'a BoundKernel, [u32; 2]);

impl BoundKernel {
    pub fn run(&self, pass: &mut wgpu::ComputePass<'_>, [x, y]: [u32; 2]) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.dispatch_workgroups(x, y, 1);
    }
}

/// Runs kernels one after the other; each sees what the earlier ones wrote.
pub(crate) fn run_steps<'a>(encoder: &mut wgpu::CommandEncoder, steps: impl IntoIterator<Item = Step<'a>>) {
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    for (kernel, groups) in steps {
        kernel.run(&mut pass, groups);
    }
}

/// Arranges this number of workgroups along x and y, since the device limits how many fit along one dimension.
pub(crate) fn groups(context: &GpuContext, count: u32) -> [u32; 2] {
    groups_within(count, context.device.limits().max_compute_workgroups_per_dimension)
}

fn groups_within(count: u32, most_along_one: u32) -> [u32; 2] {
    let along_x = count.clamp(1, most_along_one);
    [along_x, count.div_ceil(along_x).max(1)]
}

#[cfg(test)]
mod tests {
    use super::groups_within;

    #[test]
    fn more_workgroups_than_one_dimension_holds_go_into_two() {
        assert_eq!(groups_within(0, 65_535), [1, 1]);
        assert_eq!(groups_within(800, 65_535), [800, 1]);
        assert_eq!(groups_within(65_536, 65_535), [65_535, 2]);
        for count in [65_535, 65_537, 1_000_000] {
            let [x, y] = groups_within(count, 65_535);
            assert!(x <= 65_535 && y <= 65_535 && x * y >= count);
        }
    }
}
