//! Recorded pictures on the device: layers of one texture, from which a kernel can choose.

use std::{convert::Infallible, sync::Arc};

use reality_sim_core::warp::{MAX_SOURCES, Picture};

use crate::{GpuContext, GpuError, recent::Recent};

/// Memory budget of the layers, bytes; exceeded only where pictures are too large for it.
const BUDGET_BYTES: usize = 64 << 20;

/// Uploaded pictures: as many as the budget allows, and at least as many as one reconstruction needs.
#[derive(Debug)]
pub(crate) struct Layers {
    view: wgpu::TextureView,
    /// Columns and rows of the largest picture that fits.
    size: [u32; 2],
    layer_of: Recent<Picture, u32>,
}

impl Layers {
    /// Allocates layers for pictures with this many columns and rows.
    pub fn new(context: &GpuContext, [width, height]: [u32; 2]) -> Result<Self, GpuError> {
        let limits = context.device.limits();
        let limit = limits.max_texture_dimension_2d;
        if width > limit || height > limit {
            return Err(GpuError::TooManyPixels { width, height, limit });
        }
        // A texture has at least one texel.
        let size = [width.max(1), height.max(1)];
        let picture_bytes = size_of::<u32>() * size[0] as usize * size[1] as usize;
        let most = limits.max_texture_array_layers as usize;
        let layers = (BUDGET_BYTES / picture_bytes).clamp(MAX_SOURCES, most.max(MAX_SOURCES));
        let texture = context.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("the recorded pictures"),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: layers as u32 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Uint,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        Ok(Self { view, size, layer_of: Recent::new(layers) })
    }

    /// Returns the columns and rows of the largest picture that fits.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns a view of all layers for kernels.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.view
    }

    /// Returns the layer of a picture, which is uploaded unless it is there already. It keeps its layer while up to seven
    /// others are requested.
    pub fn layer(&mut self, context: &GpuContext, picture: &Arc<Picture>) -> Result<u32, GpuError> {
        let Picture { width, height, ref pixels } = **picture;
        if pixels.len() as u64 != u64::from(width) * u64::from(height) {
            return Err(GpuError::NotAPicture { width, height, words: pixels.len() });
        }
        if pixels.is_empty() {
            return Ok(0);
        }
        let texture = self.view.texture();
        let Ok(layer) = self.layer_of.get_or_make(picture, |slot| {
            let layer = slot as u32;
            let target = wgpu::TexelCopyTextureInfo {
                origin: wgpu::Origin3d { z: layer, ..Default::default() },
                ..texture.as_image_copy()
            };
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(size_of::<u32>() as u32 * width),
                rows_per_image: None,
            };
            let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
            context.queue.write_texture(target, bytemuck::cast_slice(pixels), layout, size);
            Ok::<_, Infallible>(layer)
        });
        Ok(*layer)
    }
}
