//! The scoring kernels: sums along the lines for every pose in a buffer.

use reality_sim_core::{
    camera::Lens,
    observation::{LineModel, ObservationKind},
    preprocess::WhiteLevels,
};

use crate::{
    GpuContext, GpuError,
    buffers::{uniform, uniform_of, write},
    kernel::{Binding, BoundKernel, Kernel, groups},
    layout::{BlockLayout, CameraLayout, SettingsLayout},
};

/// Poses per workgroup, `POSES` in `shaders/shared/scoring.wgsl`.
const POSES: u32 = 8;

/// Camera and samples of a field's lines on the device.
#[derive(Debug)]
pub(crate) struct LineScoring {
    model: LineModel,
    levels: WhiteLevels,
    kernel: Kernel,
    camera: wgpu::Buffer,
    settings: wgpu::Buffer,
    blocks: wgpu::TextureView,
    block_count: u32,
}

impl LineScoring {
    /// Prepares the kernels of a model.
    pub fn new(context: &GpuContext, model: LineModel) -> Result<Self, GpuError> {
        let kernel = match model.config.kind {
            ObservationKind::Contrast => "contrast_along_lines",
            ObservationKind::Gauss | ObservationKind::Distance => "sum_along_lines",
        };
        let is_radial = matches!(model.camera.lens, Lens::Radial { .. });
        let blocks: Vec<BlockLayout> = model.blocks().iter().map(BlockLayout::from).collect();
        Ok(Self {
            levels: WhiteLevels::default(),
            kernel: Kernel::with_constants(context, kernel, &[("is_radial", f64::from(u8::from(is_radial)))]),
            camera: uniform_of(context, "the camera", CameraLayout::from(&model.camera))?,
            settings: uniform::<SettingsLayout>(context, "the scoring's settings")?,
            blocks: block_texture(context, &blocks),
            block_count: blocks.len() as u32,
            model,
        })
    }

    /// Returns the model that is scored.
    pub fn model(&self) -> &LineModel {
        &self.model
    }

    /// Sets how bright lines and carpet are in the picture that is scored next.
    pub fn set_levels(&mut self, levels: WhiteLevels) {
        self.levels = levels;
    }

    pub fn bind(
        &self,
        context: &GpuContext,
        texels: &wgpu::TextureView,
        poses: &wgpu::Buffer,
        sums: &wgpu::Buffer,
    ) -> BoundKernel {
        let [camera, settings] = [&self.camera, &self.settings].map(Binding::from);
        self.kernel.bind_all(
            context,
            &[camera, settings, (&self.blocks).into(), texels.into(), poses.into(), sums.into()],
        )
    }

    /// Sets the number of poses and returns the workgroups that they need.
    pub fn configure(&self, context: &GpuContext, poses: usize) -> [u32; 2] {
        let groups = groups(context, (poses as u32).div_ceil(POSES));
        let scale = self.model.contrast_scale(&self.levels);
        let mut settings = SettingsLayout::new(self.block_count, scale);
        (settings.poses, settings.groups_along_x) = (poses as u32, groups[0]);
        write(context, &self.settings, &[settings]);
        groups
    }
}

/// Stores the line samples as a texture: drivers that run on a processor read a texture faster than a buffer.
fn block_texture(context: &GpuContext, blocks: &[BlockLayout]) -> wgpu::TextureView {
    const IN_ROW: usize = 32;
    const ROW_BYTES: usize = IN_ROW * size_of::<BlockLayout>();
    let mut rows = blocks.to_vec();
    rows.resize(blocks.len().next_multiple_of(IN_ROW).max(IN_ROW), bytemuck::Zeroable::zeroed());
    let size = wgpu::Extent3d {
        width: (ROW_BYTES / size_of::<[f32; 4]>()) as u32,
        height: (rows.len() / IN_ROW) as u32,
        depth_or_array_layers: 1,
    };
    let texture = context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("the line samples"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Uint,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(ROW_BYTES as u32),
        rows_per_image: None,
    };
    context.queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&rows), layout, size);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
