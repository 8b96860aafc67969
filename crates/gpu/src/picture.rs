//! A picture on the device: uploaded, converted to grey, blurred, masked and packed for the scoring kernels.

use std::sync::Arc;

use image::RgbImage;
use reality_sim_core::{
    camera::Camera,
    observation::{LineModel, ObservationKind},
    preprocess::{CELL_PX, Prepared, gaussian_kernel},
};

use crate::{
    GpuContext, GpuError,
    buffers::{storage, storage_of, uniform_of, write},
    kernel::{BoundKernel, Kernel, Step, groups},
    layout::PictureLayout,
};

/// Pixels per word; every row begins with a new word.
const PIXELS_OF_WORD: u32 = 4;
/// Threads per workgroup; each handles one word.
const PICTURE_THREADS: u32 = 64;

/// Uploads pictures and prepares them for scoring.
#[derive(Debug)]
pub(crate) struct PictureStage {
    sources: Sources,
    inside: wgpu::Buffer,
    texels: wgpu::TextureView,
    /// Kernels that run after the source's own one.
    kernels: Vec<BoundKernel>,
    groups: [u32; 2],
}

/// Buffers into which pictures are uploaded.
#[derive(Debug)]
enum Sources {
    /// Colour pictures in two buffers: the next one is uploaded while the current one is processed.
    Color { slots: [ColorSlot; 2], current: usize },
    /// Evidence for white lines, one value per pixel.
    Evidence(wgpu::Buffer),
}

#[derive(Debug)]
struct ColorSlot {
    buffer: wgpu::Buffer,
    /// Kept alive so that no other picture can take its address in memory.
    picture: Option<Arc<RgbImage>>,
    to_grey: BoundKernel,
}

/// Buffers that the kernels of a picture read and write.
struct Buffers {
    /// Size and settings of the picture.
    picture: wgpu::Buffer,
    blur_weights: wgpu::Buffer,
    /// Mask of the field's border.
    inside: wgpu::Buffer,
    grey: wgpu::Buffer,
    /// Intermediate result of the two-pass kernels.
    across: wgpu::Buffer,
    /// Picture that is scored.
    image: wgpu::Buffer,
    /// Number of words of the picture, four pixels each.
    words: u32,
}

impl Buffers {
    fn new(
        context: &GpuContext,
        camera: &Camera,
        model: &LineModel,
        blur_weights: &[f32],
    ) -> Result<Self, GpuError> {
        let row_words = camera.width.div_ceil(PIXELS_OF_WORD);
        let words = row_words * camera.height;
        let mask_columns = camera.width.div_ceil(CELL_PX);
        let mask_bits = mask_columns * camera.height.div_ceil(CELL_PX);
        let layout = PictureLayout {
            width: camera.width,
            height: camera.height,
            row_words,
            mask_columns,
            blur_radius: (blur_weights.len() / 2) as u32,
            nearness_cap: u32::from(model.nearness_cap()),
            padding_0: 0,
            padding_1: 0,
        };
        let padded_weights = [&[0.0; 3], blur_weights, &[0.0; 3]].concat();
        let bytes = bytes_of(words);
        Ok(Self {
            picture: uniform_of(context, "the picture's size", layout)?,
            blur_weights: storage_of(context, "the blur's weights", &padded_weights)?,
            inside: storage(context, "the border's mask", 4 * mask_bits.div_ceil(32) as usize)?,
            grey: storage(context, "the grey picture", bytes)?,
            image: storage(context, "the picture scored", bytes)?,
            across: storage(context, "the picture half done", size_of::<[f32; 4]>() * words as usize)?,
            words,
        })
    }

    /// Returns the kernels from evidence for white lines to the distance from them.
    fn distance_kernels(&self, context: &GpuContext) -> (Sources, Vec<BoundKernel>) {
        let Self { picture, grey, across, image, .. } = self;
        let bind = |name, buffers: &[&wgpu::Buffer]| Kernel::new(context, name).bind(context, buffers);
        let kernels = vec![
            bind("distance_rows", &[picture, grey, across]),
            bind("distance_columns", &[picture, across, image]),
            bind("nearness", &[picture, image]),
        ];
        (Sources::Evidence(grey.clone()), kernels)
    }

    /// Returns the kernels from a colour picture to a grey one, blurred or not.
    fn color_kernels(
        &self,
        context: &GpuContext,
        kind: ObservationKind,
        is_blurred: bool,
    ) -> Result<(Sources, Vec<BoundKernel>), GpuError> {
        let Self { picture, blur_weights, grey, across, image, .. } = self;
        let name = if kind == ObservationKind::Contrast { "whiteness" } else { "luma" };
        let to_grey = Kernel::new(context, name);
        let target = if is_blurred { grey } else { image };
        let slot = || {
            let buffer = storage(context, "the colour picture", 3 * bytes_of(self.words))?;
            let to_grey = to_grey.bind(context, &[picture, &buffer, target]);
            Ok(ColorSlot { buffer, picture: None, to_grey })
        };
        let bind = |name, buffers: &[&wgpu::Buffer]| Kernel::new(context, name).bind(context, buffers);
        let mut kernels = Vec::new();
        if is_blurred {
            kernels.push(bind("blur_rows", &[picture, grey, blur_weights, across]));
            kernels.push(bind("blur_columns", &[picture, across, blur_weights, image]));
        }
        Ok((Sources::Color { slots: [slot()?, slot()?], current: 0 }, kernels))
    }
}

fn bytes_of(words: u32) -> usize {
    4 * words as usize
}

impl PictureStage {
    /// Prepares for pictures of this camera, processed as the model needs them.
    pub fn new(context: &GpuContext, camera: &Camera, model: &LineModel) -> Result<Self, GpuError> {
        let blur_weights = gaussian_kernel(model.config.blur_sigma_px);
        let buffers = Buffers::new(context, camera, model, &blur_weights)?;
        let (sources, mut kernels) = match model.config.kind {
            ObservationKind::Distance => buffers.distance_kernels(context),
            kind => buffers.color_kernels(context, kind, blur_weights.len() > 1)?,
        };
        let Buffers { picture, inside, image, words, .. } = buffers;
        if model.is_masked() {
            kernels.push(Kernel::new(context, "mask").bind(context, &[&picture, &inside, &image]));
        }
        let texels = packed_texture(context, camera).create_view(&wgpu::TextureViewDescriptor::default());
        let pack = Kernel::new(context, "pack");
        kernels.push(pack.bind_all(context, &[(&picture).into(), (&image).into(), (&texels).into()]));
        let groups = groups(context, words.div_ceil(PICTURE_THREADS));
        Ok(Self { sources, inside, texels, kernels, groups })
    }

    /// Returns the packed picture that the scoring kernels read.
    pub fn texels(&self) -> &wgpu::TextureView {
        &self.texels
    }

    /// Loads a picture; it is uploaded unless that was done before.
    pub fn load(&mut self, context: &GpuContext, picture: &Prepared) {
        write(context, &self.inside, &picture.border.inside_bits());
        match &mut self.sources {
            Sources::Color { slots, current } => {
                let known = slots.iter().position(|slot| slot.holds(&picture.picture));
                *current = known.unwrap_or(1 - *current);
                if known.is_none() {
                    slots[*current].upload(context, &picture.picture);
                }
            }
            Sources::Evidence(buffer) => {
                let evidence = picture.evidence();
                write_rows(context, buffer, evidence.as_raw(), evidence.width(), 1);
            }
        }
    }

    /// Uploads the next picture while the current one stays in use.
    pub fn upload_next(&mut self, context: &GpuContext, next: &Arc<RgbImage>) {
        if let Sources::Color { slots, current } = &mut self.sources {
            slots[1 - *current].upload(context, next);
            // Writes wait for a submission: without one the copy would only begin with the next frame's work.
            context.queue.submit([]);
        }
    }

    /// Returns the steps that prepare the picture loaded last.
    pub fn steps(&self) -> impl Iterator<Item = Step<'_>> {
        let to_grey = match &self.sources {
            Sources::Color { slots, current } => Some(&slots[*current].to_grey),
            Sources::Evidence(_) => None,
        };
        to_grey.into_iter().chain(&self.kernels).map(|kernel| (kernel, self.groups))
    }
}

impl ColorSlot {
    fn holds(&self, picture: &Arc<RgbImage>) -> bool {
        self.picture.as_ref().is_some_and(|held| Arc::ptr_eq(held, picture))
    }

    fn upload(&mut self, context: &GpuContext, picture: &Arc<RgbImage>) {
        write_rows(context, &self.buffer, picture.as_raw(), picture.width(), 3);
        self.picture = Some(picture.clone());
    }
}

/// Creates the texture that holds four neighbouring pixels per texel.
fn packed_texture(context: &GpuContext, camera: &Camera) -> wgpu::Texture {
    use wgpu::TextureUsages as Usage;
    context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("the packed picture"),
        size: wgpu::Extent3d { width: camera.width, height: camera.height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Uint,
        usage: Usage::STORAGE_BINDING | Usage::TEXTURE_BINDING | Usage::COPY_SRC,
        view_formats: &[],
    })
}

/// Writes pixels of this many bytes each; every row is padded to whole words of four pixels.
fn write_rows(context: &GpuContext, buffer: &wgpu::Buffer, bytes: &[u8], width: u32, pixel_bytes: u32) {
    let row = (width * pixel_bytes) as usize;
    let filled = (width.next_multiple_of(PIXELS_OF_WORD) * pixel_bytes) as usize;
    if row == filled {
        return write(context, buffer, bytes);
    }
    let mut rows = vec![0; bytes.len() / row * filled];
    for (target, source) in rows.chunks_exact_mut(filled).zip(bytes.chunks_exact(row)) {
        target[..row].copy_from_slice(source);
    }
    write(context, buffer, &rows);
}

#[cfg(test)]
mod tests {
    use reality_sim_core::{
        camera::{Distortion, OpencvFisheye},
        field::FieldDimensions,
        filter::{Purpose, Stream},
        mount::MountPose,
        observation::ObservationConfig,
        preprocess::Preprocessor,
    };

    use super::*;
    use crate::{buffers::readback, kernel::run_steps, test_context};

    /// Draws a bright, noisy carpet with white stripes under a grey sky.
    fn scene(camera: &Camera, seed: u64) -> Arc<RgbImage> {
        let stream = Stream::new(seed, Purpose::Initialise, 0, 0);
        let horizon = camera.height / 3 + seed as u32 * 7;
        Arc::new(RgbImage::from_fn(camera.width, camera.height, |u, v| {
            let noise = (stream.words(u, v)[0] >> 28) as u8;
            image::Rgb(match (v < horizon, (u + 2 * v) % (60 + seed as u32) < 7) {
                (true, _) => [120 + noise; 3],
                (false, true) => [220 + noise; 3],
                (false, false) => [40 + noise, 130 + noise, 50],
            })
        }))
    }

    fn on_device(context: &GpuContext, stage: &PictureStage) -> Vec<u32> {
        let size = stage.texels.texture().size();
        // Rows in a buffer start at multiples of 256 bytes.
        let stride = (4 * size.width).next_multiple_of(256);
        let bytes = (stride * size.height) as usize;
        let target = readback(context, "the packed picture read back", bytes).unwrap();
        context.submit(|encoder| {
            run_steps(encoder, stage.steps());
            encoder.copy_texture_to_buffer(
                stage.texels.texture().as_image_copy(),
                wgpu::TexelCopyBufferInfo {
                    buffer: &target,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(stride),
                        rows_per_image: None,
                    },
                },
                size,
            );
        });
        let words: Vec<u32> = context.read(&target, bytes as u64).unwrap();
        words.chunks((stride / 4) as usize).flat_map(|row| row[..size.width as usize].to_vec()).collect()
    }

    /// Runs all kernels that prepare a picture, with rows that do and do not fill whole words.
    #[test]
    fn pictures_are_prepared_as_on_the_cpu() {
        let context = test_context();
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let mount = MountPose { height_m: 0.5, pitch_rad: 0.4, roll_rad: 0.05 };
        for [width, height] in [[320, 240], [317, 239]] {
            let lens = Distortion::OpencvFisheye(OpencvFisheye { k: [-0.05, 0.008, 0.0, 0.0] });
            let centre = [f64::from(width) / 2.0, f64::from(height) / 2.0];
            let camera = Camera::new([width, height], [110.0, 110.0, centre[0], centre[1]], lens).unwrap();
            let preprocessor = Preprocessor::new(&camera, field.line_width_m);
            for (kind, blur_sigma_px) in [
                (ObservationKind::Gauss, 1.5),
                (ObservationKind::Gauss, 0.0),
                (ObservationKind::Gauss, 6.0),
                (ObservationKind::Distance, 0.0),
                (ObservationKind::Contrast, 0.7),
            ] {
                let config = ObservationConfig::new(kind).with_blur_sigma_px(blur_sigma_px);
                let model = LineModel::new(&camera, &field, config);
                let mut stage = PictureStage::new(&context, &camera, &model).unwrap();
                for seed in 0..6 {
                    let picture = scene(&camera, seed);
                    if seed % 2 == 1 {
                        stage.upload_next(&context, &picture);
                    }
                    let prepared = preprocessor.prepare(picture, mount);
                    stage.load(&context, &prepared);
                    let image = model.image(&prepared);
                    assert!(!model.is_masked() || image.contains(&0), "something is masked");
                    let value = |u: u32, v: u32| image.get_pixel(u.min(width - 1), v.min(height - 1)).0[0];
                    let expected: Vec<u8> = image
                        .enumerate_pixels()
                        .flat_map(|(u, v, _)| {
                            [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(right, down)| value(u + right, v + down))
                        })
                        .collect();
                    let texels = on_device(&context, &stage);
                    // Where a value is halfway between two grey levels, the last digit of the blur decides.
                    let found: Vec<u8> = texels.iter().flat_map(|word| word.to_le_bytes()).collect();
                    let off = found.iter().zip(&expected).filter(|(a, b)| a != b).count();
                    let most = found.iter().zip(&expected).map(|(a, b)| a.abs_diff(*b)).max();
                    let allowed = if blur_sigma_px > 0.0 { found.len() / 500 } else { 0 };
                    assert!(
                        off <= allowed && most <= Some(1),
                        "{kind:?}, {blur_sigma_px} px, {width}x{height}, seed {seed}: {off} bytes differ, {most:?}"
                    );
                }
            }
        }
        context.check().unwrap();
    }
}
