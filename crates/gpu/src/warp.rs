//! Pictures drawn from others on the device.

use std::sync::{Arc, Mutex, PoisonError};

use reality_sim_core::{
    backend::BackendError,
    camera::{Lanes, Lens},
    warp::{BlendWeights, MAX_SOURCES, Origin, Source, Target, Warped, Warper},
};

use crate::{
    GpuContext, GpuError,
    buffers::{readback, storage, storage_of, uniform, write},
    kernel::{Kernel, groups, run_steps},
    layers::Layers,
    layout::{SceneLayout, SourceLayout, SourcesLayout},
    recent::Recent,
};

/// Threads of a workgroup, a pixel each.
const THREADS: u32 = 64;
/// Cameras whose rays are kept.
const RAY_TABLES: usize = 4;

/// Rays as `RayTable` has them.
type Rays = Vec<[Lanes; 3]>;

/// Colour and source in a word, then the trust.
type WarpedWords = [u32; 2];

/// Pictures by a compute shader, see [`reality_sim_core::warp::blend`]. What it draws from is kept on the device: a picture
/// is uploaded when it is first drawn from, the rays of a camera when they are first followed. Threads take turns.
#[derive(Debug)]
pub struct GpuWarper {
    context: Arc<GpuContext>,
    /// One for each kind of lenses.
    kernels: [Kernel; 3],
    scene: wgpu::Buffer,
    sources: wgpu::Buffer,
    kept: Mutex<Kept>,
}

/// What one picture leaves for the next.
#[derive(Debug)]
struct Kept {
    layers: Layers,
    rays: Recent<Rays, wgpu::Buffer>,
    outputs: Outputs,
}

/// Pixels on their way back.
#[derive(Debug)]
struct Outputs {
    pixels: usize,
    warped: wgpu::Buffer,
    readback: wgpu::Buffer,
}

impl GpuWarper {
    /// On a device that was opened before.
    pub fn new(context: Arc<GpuContext>) -> Result<Self, GpuError> {
        let kernel = |lenses: Lenses| {
            Kernel::with_constants(&context, "blend", &[("lenses", f64::from(lenses as u32))])
        };
        let kept = Kept {
            layers: Layers::new(&context, [0, 0])?,
            rays: Recent::new(RAY_TABLES),
            outputs: Outputs::new(&context, 0)?,
        };
        let warper = Self {
            kernels: [Lenses::Perspective, Lenses::Radial, Lenses::Mixed].map(kernel),
            scene: uniform::<SceneLayout>(&context, "the picture wanted")?,
            sources: uniform::<SourcesLayout>(&context, "the sources")?,
            kept: Mutex::new(kept),
            context,
        };
        warper.context.status()?;
        Ok(warper)
    }

    fn drawn(
        &self,
        target: &Target,
        sources: &[Source],
        weights: &BlendWeights,
    ) -> Result<Vec<WarpedWords>, GpuError> {
        let context = &*self.context;
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let pixels = target.rays.width as usize * target.rays.height as usize;
        kept.make_room(context, pixels, sources)?;
        let Kept { layers, rays, outputs } = &mut *kept;
        let mut layouts: SourcesLayout = bytemuck::Zeroable::zeroed();
        for (layout, source) in layouts.iter_mut().zip(sources) {
            *layout = SourceLayout::new(source, layers.layer(context, source.picture)?);
        }
        let rays = rays.get_or_make(target.rays.blocks(), |_| ray_buffer(context, target.rays.blocks()))?;
        write(context, &self.sources, &layouts);
        write(context, &self.scene, &[SceneLayout::new(target, sources.len(), weights)]);
        let bindings = [
            (&self.scene).into(),
            (&self.sources).into(),
            (&*rays).into(),
            layers.view().into(),
            (&outputs.warped).into(),
        ];
        let kernel = self.kernels[lenses(sources) as usize].bind_all(context, &bindings);
        let groups = groups(context, (pixels as u32).div_ceil(THREADS));
        let bytes = (pixels * size_of::<WarpedWords>()) as u64;
        context.submit(|encoder| {
            run_steps(encoder, [(&kernel, groups)]);
            encoder.copy_buffer_to_buffer(&outputs.warped, 0, &outputs.readback, 0, bytes);
        });
        context.read(&outputs.readback, bytes)
    }
}

impl Warper for GpuWarper {
    fn blend(
        &self,
        target: &Target,
        sources: &[Source],
        weights: &BlendWeights,
    ) -> Result<Warped, BackendError> {
        let sources = &sources[..sources.len().min(MAX_SOURCES)];
        let words = self.drawn(target, sources, weights)?;
        let origin = |[word, trust]: &WarpedWords| Origin { source: (word >> 24) as u8, trust: *trust as u8 };
        let color = |[word, _]: &WarpedWords| [*word as u8, (word >> 8) as u8, (word >> 16) as u8];
        let warped =
            Warped { colors: words.iter().map(color).collect(), origins: words.iter().map(origin).collect() };
        Ok(warped.filled(target.rays.width as usize))
    }
}

impl Kept {
    /// Room for a picture of so many pixels from these sources.
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

/// What `lenses` means in `shaders/blend.wgsl`.
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

/// Rays for the kernel: 0 where a pixel sees nothing, since shaders need not know NaN.
fn ray_buffer(context: &GpuContext, rays: &Rays) -> Result<wgpu::Buffer, GpuError> {
    let known = |value: &f32| if value.is_nan() { 0.0 } else { *value };
    let values: Vec<f32> = rays.as_flattened().as_flattened().iter().map(known).collect();
    storage_of(context, "the rays of a camera", &values)
}
