//! The last step of a picture that stays on the device: what no source saw is filled, and the whole is written into a texture.
//! Twin: [`reality_sim_core::warp::complete`].

use crate::{
    GpuContext, GpuError,
    buffers::{readback, storage, uniform_of},
    kernel::{BoundKernel, Kernel, groups},
    layout::LevelsLayout,
};

/// Threads per workgroup, `LEVEL_THREADS` in `shaders/shared/levels.wgsl`.
const THREADS: u32 = 64;
/// Format of the textures that are drawn into.
pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Kernels that finish pictures.
#[derive(Debug)]
pub(crate) struct Finisher {
    half_size: Kernel,
    halved: Kernel,
    take_unknown: Kernel,
    complete: Kernel,
    levels: Option<Levels>,
}

/// Room for the levels of a picture.
#[derive(Debug)]
struct Levels {
    /// Columns and rows of the picture.
    size: [u32; 2],
    pixels: wgpu::Buffer,
    /// Every two neighbouring levels, the picture itself and the first level at the beginning.
    pairs: Vec<Pair>,
}

#[derive(Debug)]
struct Pair {
    layout: LevelsLayout,
    buffer: wgpu::Buffer,
}

impl Finisher {
    pub fn new(context: &GpuContext) -> Self {
        let kernel = |name| Kernel::new(context, name);
        Self {
            half_size: kernel("half_size"),
            halved: kernel("halved"),
            take_unknown: kernel("take_unknown"),
            complete: kernel("complete"),
            levels: None,
        }
    }

    /// Returns the steps from the words of a drawn picture of this size to a texture, with their numbers of workgroups.
    pub fn steps(
        &mut self,
        context: &GpuContext,
        size: [u32; 2],
        warped: &wgpu::Buffer,
        texture: &wgpu::TextureView,
    ) -> Result<Vec<(BoundKernel, [u32; 2])>, GpuError> {
        let levels = match self.levels.take().filter(|levels| levels.size == size) {
            Some(levels) => levels,
            None => Levels::new(context, size)?,
        };
        let Levels { pixels, pairs, .. } = self.levels.insert(levels);
        let groups = |[width, height]: [u32; 2]| groups(context, (width * height).div_ceil(THREADS));
        let mut steps = Vec::with_capacity(2 * pairs.len());
        for (number, Pair { layout, buffer }) in pairs.iter().enumerate() {
            let kernel = match number {
                0 => self.half_size.bind(context, &[buffer, pixels, warped]),
                _ => self.halved.bind(context, &[buffer, pixels]),
            };
            steps.push((kernel, groups(layout.coarse)));
        }
        for (number, Pair { layout, buffer }) in pairs.iter().enumerate().rev() {
            let kernel = match number {
                0 => self
                    .complete
                    .bind_all(context, &[buffer.into(), (&*pixels).into(), warped.into(), texture.into()]),
                _ => self.take_unknown.bind(context, &[buffer, pixels]),
            };
            steps.push((kernel, groups(layout.fine)));
        }
        Ok(steps)
    }
}

impl Levels {
    fn new(context: &GpuContext, size: [u32; 2]) -> Result<Self, GpuError> {
        let mut pairs = Vec::new();
        let mut fine = LevelsLayout::first(size);
        loop {
            let buffer = uniform_of(context, "two levels of a picture", fine)?;
            pairs.push(Pair { layout: fine, buffer });
            if fine.coarse == [1, 1] {
                break;
            }
            fine = fine.next();
        }
        let pixels = fine.first_coarse as usize + 1;
        let pixels = storage(context, "the levels of a picture", pixels * size_of::<[f32; 4]>())?;
        Ok(Self { size, pixels, pairs })
    }
}

/// Creates a texture to draw into: RGB, 8 bits per channel, encoded as the recorded pictures are (sRGB, usually); for shaders
/// that want linear light there is the view `Rgba8UnormSrgb`.
pub(crate) fn texture(context: &GpuContext, [width, height]: [u32; 2]) -> Result<wgpu::Texture, GpuError> {
    let limit = context.device.limits().max_texture_dimension_2d;
    if width > limit || height > limit || width == 0 || height == 0 {
        return Err(GpuError::TooManyPixels { width, height, limit });
    }
    let usage = wgpu::TextureUsages::STORAGE_BINDING
        | wgpu::TextureUsages::TEXTURE_BINDING
        | wgpu::TextureUsages::COPY_SRC;
    Ok(context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("the picture of a camera"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage,
        view_formats: &[FORMAT.add_srgb_suffix()],
    }))
}

/// Checks that a picture of this size can be written into a texture.
pub(crate) fn check(texture: &wgpu::Texture, [width, height]: [u32; 2]) -> Result<(), GpuError> {
    let fits = texture.width() == width
        && texture.height() == height
        && texture.format() == FORMAT
        && texture.usage().contains(wgpu::TextureUsages::STORAGE_BINDING);
    if fits {
        return Ok(());
    }
    let found = format!("{} x {} {:?}", texture.width(), texture.height(), texture.format());
    Err(GpuError::OtherTexture { width, height, found })
}

impl GpuContext {
    /// Reads a texture of [`crate::GpuWarper::texture`] back: red, green, blue and alpha, row by row from the top.
    pub fn read_texture(&self, texture: &wgpu::Texture) -> Result<Vec<[u8; 4]>, GpuError> {
        let [width, height] = [texture.width(), texture.height()];
        check(texture, [width, height])?;
        let texels_a_row = width.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT / 4);
        let bytes = 4 * texels_a_row as usize * height as usize;
        let target = readback(self, "the texture read back", bytes)?;
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * texels_a_row),
            rows_per_image: None,
        };
        self.submit(|encoder| {
            let target = wgpu::TexelCopyBufferInfo { buffer: &target, layout };
            encoder.copy_texture_to_buffer(texture.as_image_copy(), target, texture.size());
        });
        let texels: Vec<[u8; 4]> = self.read(&target, bytes as u64)?;
        let rows = texels.chunks(texels_a_row as usize);
        Ok(rows.flat_map(|row| &row[..width as usize]).copied().collect())
    }
}
