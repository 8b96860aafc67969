//! Pictures drawn from others on the device.

use std::sync::{Arc, Mutex, PoisonError};

use reality_sim_core::{
    backend::BackendError,
    camera::{Lanes, Lens},
    warp::{BlendWeights, MAX_SOURCES, Origin, Source, Target, Warper, complete},
};

use crate::{
    GpuContext, GpuError,
    buffers::{readback, storage, storage_of, uniform, write},
    finishing::{self, Finisher},
    kernel::{BoundKernel, Kernel, groups, run_steps},
    layers::Layers,
    layout::{DrawingLayout, SourceLayout, SourcesLayout},
    recent::Recent,
};

/// Threads per workgroup; each draws one pixel.
const THREADS: u32 = 64;
/// Number of cameras whose rays are kept.
const RAY_TABLES: usize = 4;

/// Rays in the layout of `RayTable`.
type Rays = Vec<[Lanes; 3]>;

/// One word with colour and source, and one with the trust.
type WarpedWords = [u32; 2];

/// Warper in a compute shader, see [`reality_sim_core::warp::blend`]. Inputs are kept on the device: a picture is uploaded
/// when it is first drawn from, and the rays of a camera when they are first used. Threads take turns.
#[derive(Debug)]
pub struct GpuWarper {
    context: Arc<GpuContext>,
    /// One kernel for each value of [`Lenses`].
    kernels: [Kernel; 3],
    drawing: wgpu::Buffer,
    sources: wgpu::Buffer,
    kept: Mutex<Kept>,
}

/// Buffers and textures that are kept from one picture to the next.
#[derive(Debug)]
struct Kept {
    layers: Layers,
    rays: Recent<Rays, wgpu::Buffer>,
    outputs: Outputs,
    /// Made for the first picture that stays on the device.
    finisher: Option<Finisher>,
}

/// Buffers for the pixels on their way back.
#[derive(Debug)]
struct Outputs {
    pixels: usize,
    warped: wgpu::Buffer,
    readback: wgpu::Buffer,
}

impl GpuWarper {
    /// Makes a warper for a device that is already open.
    pub fn new(context: Arc<GpuContext>) -> Result<Self, GpuError> {
        let kernel = |lenses: Lenses| {
            Kernel::with_constants(&context, "blend", &[("lenses", f64::from(lenses as u32))])
        };
        let kept = Kept {
            layers: Layers::new(&context, [0, 0])?,
            rays: Recent::new(RAY_TABLES),
            outputs: Outputs::new(&context, 0)?,
            finisher: None,
        };
        let warper = Self {
            kernels: [Lenses::Perspective, Lenses::Radial, Lenses::Mixed].map(kernel),
            drawing: uniform::<DrawingLayout>(&context, "the picture wanted")?,
            sources: uniform::<SourcesLayout>(&context, "the sources")?,
            kept: Mutex::new(kept),
            context,
        };
        warper.context.check()?;
        Ok(warper)
    }

    fn draw(
        &self,
        target: &Target,
        sources: &[Source],
        weights: &BlendWeights,
        colors: &mut [[u8; 3]],
    ) -> Result<Vec<Origin>, GpuError> {
        assert_eq!(colors.len(), target.rays.pixels(), "one colour for every pixel");
        let sources = &sources[..sources.len().min(MAX_SOURCES)];
        let words = self.words(target, sources, weights)?;
        let origin = |[word, trust]: &WarpedWords| Origin { source: (word >> 24) as u8, trust: *trust as u8 };
        let color = |[word, _]: &WarpedWords| [*word as u8, (word >> 8) as u8, (word >> 16) as u8];
        colors.iter_mut().zip(&words).for_each(|(drawn, words)| *drawn = color(words));
        let mut origins: Vec<Origin> = words.iter().map(origin).collect();
        complete(target.rays, colors, &mut origins);
        Ok(origins)
    }

    fn words(
        &self,
        target: &Target,
        sources: &[Source],
        weights: &BlendWeights,
    ) -> Result<Vec<WarpedWords>, GpuError> {
        let context = &*self.context;
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let (kernel, groups) = self.prepared(&mut kept, target, sources, weights)?;
        let outputs = &kept.outputs;
        let bytes = (target.rays.pixels() * size_of::<WarpedWords>()) as u64;
        context.submit(|encoder| {
            run_steps(encoder, [(&kernel, groups)]);
            encoder.copy_buffer_to_buffer(&outputs.warped, 0, &outputs.readback, 0, bytes);
        });
        context.read(&outputs.readback, bytes)
    }

    /// Creates a texture for [`GpuWarper::draw_into_texture`], in the format Rgba8Unorm: pictures are encoded as the recorded
    /// ones are, and a view of it in the format Rgba8UnormSrgb gives shaders linear light.
    pub fn texture(&self, size: [u32; 2]) -> Result<wgpu::Texture, GpuError> {
        finishing::texture(&self.context, size)
    }

    /// Draws the picture that [`Warper::blend`] draws into a texture of the context's device, for a simulator that goes on with
    /// it there: nothing is read back, and the call returns before the device has drawn. What the queue is given afterwards
    /// sees the picture.
    pub fn draw_into_texture(
        &self,
        target: &Target,
        sources: &[Source],
        weights: &BlendWeights,
        texture: &wgpu::Texture,
    ) -> Result<(), GpuError> {
        let context = &*self.context;
        let size = [target.rays.width, target.rays.height];
        finishing::check(texture, size)?;
        let sources = &sources[..sources.len().min(MAX_SOURCES)];
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            usage: Some(wgpu::TextureUsages::STORAGE_BINDING),
            ..Default::default()
        });
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let warp = self.prepared(&mut kept, target, sources, weights)?;
        let Kept { outputs, finisher, .. } = &mut *kept;
        let finisher = finisher.get_or_insert_with(|| Finisher::new(context));
        let finish = finisher.steps(context, size, &outputs.warped, &view)?;
        let steps = std::iter::once(&warp).chain(&finish);
        context.submit(|encoder| run_steps(encoder, steps.map(|(kernel, groups)| (kernel, *groups))));
        context.check()
    }

    /// Uploads what a picture needs, and returns the kernel that draws it, with its number of workgroups.
    fn prepared(
        &self,
        kept: &mut Kept,
        target: &Target,
        sources: &[Source],
        weights: &BlendWeights,
    ) -> Result<(BoundKernel, [u32; 2]), GpuError> {
        let context = &*self.context;
        let pixels = target.rays.pixels();
        kept.make_room(context, pixels, sources)?;
        let Kept { layers, rays, outputs, .. } = kept;
        let mut layouts: SourcesLayout = bytemuck::Zeroable::zeroed();
        for (layout, source) in layouts.iter_mut().zip(sources) {
            *layout = SourceLayout::new(source, layers.layer(context, source.picture)?);
        }
        let rays = rays.get_or_make(target.rays.blocks(), |_| ray_buffer(context, target.rays.blocks()))?;
        write(context, &self.sources, &layouts);
        write(context, &self.drawing, &[DrawingLayout::new(target, sources.len(), weights)]);
        let bindings = [
            (&self.drawing).into(),
            (&self.sources).into(),
            (&*rays).into(),
            layers.view().into(),
            (&outputs.warped).into(),
        ];
        let kernel = self.kernels[lenses(sources) as usize].bind_all(context, &bindings);
        Ok((kernel, groups(context, (pixels as u32).div_ceil(THREADS))))
    }
}

impl Warper for GpuWarper {
    fn blend_into(
        &self,
        target: &Target,
        sources: &[Source],
        weights: &BlendWeights,
        colors: &mut [[u8; 3]],
    ) -> Result<Vec<Origin>, BackendError> {
        Ok(self.draw(target, sources, weights, colors)?)
    }
}

impl Kept {
    /// Makes room for a picture with this many pixels from these sources.
    fn make_room(&mut self, context: &GpuContext, pixels: usize, sources: &[Source]) -> Result<(), GpuError> {
        let size = sources.iter().fold(self.layers.size(), |[width, height], source| {
            [width.max(source.picture.width), height.max(source.picture.height)]
        });
        if size != self.layers.size() {
            self.layers = Layers::new(context, size)?;
        }
        if pixels > self.outputs.pixels {
            self.outputs = Outputs::new(context, pixels)?;
        }
        Ok(())
    }
}

impl Outputs {
    fn new(context: &GpuContext, pixels: usize) -> Result<Self, GpuError> {
        let bytes = pixels * size_of::<WarpedWords>();
        Ok(Self {
            pixels,
            warped: storage(context, "the picture drawn", bytes)?,
            readback: readback(context, "the picture read back", bytes)?,
        })
    }
}

/// Values of `lenses` in `shaders/blend.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Lenses {
    Perspective,
    Radial,
    Mixed,
}

fn lenses(sources: &[Source]) -> Lenses {
    let is_radial = |source: &Source| matches!(source.camera.lens, Lens::Radial { .. });
    match sources.iter().filter(|source| is_radial(source)).count() {
        0 => Lenses::Perspective,
        count if count == sources.len() => Lenses::Radial,
        _ => Lenses::Mixed,
    }
}

/// Uploads rays for the kernel: 0 where a pixel sees nothing, since shaders need not support NaN.
fn ray_buffer(context: &GpuContext, rays: &Rays) -> Result<wgpu::Buffer, GpuError> {
    let known = |value: &f32| if value.is_nan() { 0.0 } else { *value };
    let values: Vec<f32> = rays.as_flattened().as_flattened().iter().map(known).collect();
    storage_of(context, "the rays of a camera", &values)
}

#[cfg(test)]
mod tests {
    use reality_sim_core::{
        camera::{Camera, Distortion, KernelCamera},
        field::FieldDimensions,
        pose::{CameraPose, Pose2},
        warp::{Hall, Picture, Placement, ProxyGeometry, RayTable, Warped, blend},
    };

    use super::*;
    use crate::test_context;

    fn camera(size: [u32; 2]) -> Camera {
        let [u, v] = size.map(|pixels| f64::from(pixels) / 2.0);
        Camera::new(size, [30.0, 30.0, u, v], Distortion::Pinhole).unwrap()
    }

    fn pose(x_m: f64) -> CameraPose {
        CameraPose::new(Pose2::new(x_m, 0.0, 0.0), 0.5, 0.3, 0.0)
    }

    /// Makes a picture of one colour.
    fn plain([width, height]: [u32; 2], value: u8) -> Arc<Picture> {
        let word = u32::from_le_bytes([value, 255 - value, 7, Picture::SHOWN]);
        Arc::new(Picture { width, height, pixels: vec![word; (width * height) as usize] })
    }

    /// Draws at a size from pictures along a line, asserts that the CPU draws the same, and returns it.
    fn drawn(warper: &GpuWarper, size: [u32; 2], pictures: &[Arc<Picture>]) -> Warped {
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let proxy = ProxyGeometry::new(&Hall::usual(&field), &field);
        let rays = RayTable::new(&camera(size));
        let target = Target { rays: &rays, placement: Placement::new(pose(0.0)), proxy: &proxy };
        let cameras: Vec<KernelCamera> = pictures
            .iter()
            .map(|picture| KernelCamera::new(&camera([picture.width.max(2), picture.height.max(2)])))
            .collect();
        let source = |(number, camera): (usize, _)| Source {
            camera,
            placement: Placement::new(pose(-0.05 * number as f64)),
            picture: &pictures[number],
            gain: [1.0; 3],
        };
        let sources: Vec<Source> = cameras.iter().enumerate().map(source).collect();
        let found = warper.blend(&target, &sources, &BlendWeights::default()).unwrap();
        let expected = blend(&target, &sources, &BlendWeights::default());
        assert_eq!(found.colors.len(), (size[0] * size[1]) as usize);
        for (a, b) in found.colors.iter().zip(&expected.colors) {
            assert!((0..3).all(|channel| a[channel].abs_diff(b[channel]) <= 1), "{a:?}, not {b:?}");
        }
        assert!(found.origins.iter().zip(&expected.origins).all(|(a, b)| a.source == b.source));
        found
    }

    #[test]
    fn pictures_of_any_size_are_drawn_from_pictures_of_any_size() {
        let warper = GpuWarper::new(test_context()).unwrap();
        let pictures = [plain([60, 40], 10), plain([33, 71], 200), plain([0, 0], 0), plain([90, 20], 90)];
        for size in [[1, 1], [1, 50], [50, 1], [63, 5], [130, 70]] {
            drawn(&warper, size, &[]);
            drawn(&warper, size, &pictures[..1]);
            drawn(&warper, size, &pictures);
        }
        // More sources than are ever blended.
        drawn(&warper, [40, 30], &vec![pictures[0].clone(); MAX_SOURCES + 3]);
    }

    #[test]
    fn a_new_picture_is_never_taken_for_an_old_one() {
        let warper = GpuWarper::new(test_context()).unwrap();
        let lasting = plain([40, 30], 128);
        // More pictures than there are layers; each is dropped before the next one is made.
        for number in 0..300 {
            let value = (number % 200) as u8 + 20;
            let warped = drawn(&warper, [20, 16], &[plain([40, 30], value)]);
            assert!(warped.colors.contains(&[value, 255 - value, 7]));
            if number % 100 == 50 {
                drawn(&warper, [20, 16], &[lasting.clone(), plain([40, 30], value)]);
            }
        }
        // The same with all of them alive.
        let pictures: Vec<_> = (0..300).map(|number| plain([40, 30], (number % 251) as u8)).collect();
        pictures.chunks(MAX_SOURCES).chain(pictures.chunks(3)).for_each(|pictures| {
            drawn(&warper, [20, 16], pictures);
        });
    }

    #[test]
    fn what_the_device_cannot_draw_from_is_refused_and_the_rest_goes_on() {
        let context = test_context();
        let warper = GpuWarper::new(context.clone()).unwrap();
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let proxy = ProxyGeometry::new(&Hall::usual(&field), &field);
        let (camera, placement) = (camera([20, 16]), Placement::new(pose(0.0)));
        let (rays, camera) = (RayTable::new(&camera), KernelCamera::new(&camera));
        let target = Target { rays: &rays, placement, proxy: &proxy };
        let wide = context.device.limits().max_texture_dimension_2d + 1;
        let torn = Arc::new(Picture { pixels: vec![0; 7], ..(*plain([40, 30], 0)).clone() });
        for (picture, words) in [(plain([wide, 2], 0), "scale it down"), (torn, "has 7 words")] {
            let source = Source { camera: &camera, placement, picture: &picture, gain: [1.0; 3] };
            let error = warper.blend(&target, &[source], &BlendWeights::default()).unwrap_err();
            assert!(error.to_string().contains(words), "{error}");
        }
        drawn(&warper, [20, 16], &[plain([40, 30], 50)]);
        context.check().unwrap();
    }
}
