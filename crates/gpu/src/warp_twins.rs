//! Comparison of the warp shader with its twin on the CPU, on seeded scenes with every lens model among the sources.

use std::sync::Arc;

use reality_sim_core::{
    backend::BackendError,
    camera::{Camera, Distortion, ImageCircle, InvalidCamera, KernelCamera, Opencv, OpencvFisheye},
    field::FieldDimensions,
    filter::{Purpose, Stream},
    mount::MountPose,
    pose::{CameraPose, Pose2},
    warp::{
        BlendWeights, Hall, MAX_SOURCES, Origin, Picture, Placement, ProxyGeometry, RayTable, Source, Target,
        Warper, blend,
    },
};

use crate::{GpuContext, GpuError, GpuWarper};

/// Fraction of the pixels that may differ by more than one grey level, come from another source, or differ in trust by
/// more than two. Rounding decides at the edges of goals, of the proxy geometry and of what a source sees, and between two
/// sources of equal weight.
pub const WARP_TOLERANCE: f64 = 1e-4;

/// Difference between the shader and its twin.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WarpComparison {
    /// Number of pixels drawn.
    pub pixels: usize,
    /// Number of pixels that a source saw.
    pub seen: usize,
    /// Number of pixels with a channel that differs by more than one grey level.
    pub other_color: usize,
    /// Number of pixels from another source.
    pub other_source: usize,
    /// Number of pixels whose trust differs by more than two.
    pub other_trust: usize,
    /// Number of pixels with a channel that differs by more than one grey level in the picture that stays on the device.
    pub other_texel: usize,
}

impl WarpComparison {
    /// Whether both draw the same.
    pub fn agrees(&self) -> bool {
        let most = (WARP_TOLERANCE * self.pixels as f64) as usize;
        let is_same = [self.other_color, self.other_source, self.other_trust, self.other_texel]
            .iter()
            .all(|&off| off <= most);
        is_same && 2 * self.seen > self.pixels
    }
}

/// Compares pictures from every number of sources, zero included, on this many scenes.
pub fn compare_warps(context: &Arc<GpuContext>, scenes: u64) -> Result<WarpComparison, BackendError> {
    let field = FieldDimensions::preset("humanoid-kidsize-2010").expect("a preset of the core");
    let cameras = cameras().expect("lenses that are valid");
    let kernel_cameras: Vec<KernelCamera> = cameras.iter().map(KernelCamera::new).collect();
    let tables: Vec<RayTable> = cameras.iter().map(RayTable::new).collect();
    let warper = GpuWarper::new(context.clone())?;
    let mut comparison = WarpComparison::default();
    for seed in 0..scenes {
        let scene = Scene::new(seed, &cameras);
        let proxy = ProxyGeometry::new(&Hall::usual(&field), &field).holding(scene.pose);
        let target =
            Target { rays: &tables[scene.camera], placement: Placement::new(scene.pose), proxy: &proxy };
        let sources: Vec<Source> =
            scene.taken.iter().map(|taken| taken.source(&kernel_cameras[taken.camera])).collect();
        let found = warper.blend(&target, &sources, &BlendWeights::default())?;
        let expected = blend(&target, &sources, &BlendWeights::default());
        comparison.pixels += expected.colors.len();
        comparison.seen += expected.origins.iter().filter(|origin| origin.source != Origin::NOWHERE).count();
        for (a, b) in found.colors.iter().zip(&expected.colors) {
            comparison.other_color += usize::from((0..3).any(|channel| a[channel].abs_diff(b[channel]) > 1));
        }
        for (a, b) in texels(context, &warper, &target, &sources)?.iter().zip(&expected.colors) {
            comparison.other_texel += usize::from((0..3).any(|channel| a[channel].abs_diff(b[channel]) > 1));
        }
        for (a, b) in found.origins.iter().zip(&expected.origins) {
            comparison.other_source += usize::from(a.source != b.source);
            comparison.other_trust += usize::from(a.trust.abs_diff(b.trust) > 2);
        }
    }
    Ok(comparison)
}

/// Draws into a texture, and reads it back.
fn texels(
    context: &GpuContext,
    warper: &GpuWarper,
    target: &Target,
    sources: &[Source],
) -> Result<Vec<[u8; 4]>, GpuError> {
    let texture = warper.texture([target.rays.width, target.rays.height])?;
    warper.draw_into_texture(target, sources, &BlendWeights::default(), &texture)?;
    context.read_texture(&texture)
}

/// Returns small cameras: one of every model, and one with an image circle.
fn cameras() -> Result<Vec<Camera>, InvalidCamera> {
    let fisheye = |k| Distortion::OpencvFisheye(OpencvFisheye { k });
    let opencv = Opencv { k1: -0.12, k2: 0.03, p1: 0.001, p2: -0.002, k3: 0.0 };
    let circle = ImageCircle { cx: 75.0, cy: 97.5, radius: 95.0 };
    Ok(vec![
        Camera::new([160, 120], [53.7, 53.7, 79.5, 59.5], fisheye([-0.058, 0.0082, -0.0009, 0.00005]))?,
        Camera::new([152, 200], [82.5, 82.5, 73.0, 100.3], fisheye([-0.033, 0.001, 0.0, 0.0]))?
            .with_image_circle(Some(circle)),
        Camera::new([160, 120], [155.0, 154.5, 76.7, 57.9], Distortion::Opencv(opencv))?,
        // Rows end in the middle of a block.
        Camera::new([159, 119], [125.0, 125.0, 80.0, 60.0], Distortion::Pinhole)?,
    ])
}

/// Pose to draw from, and pictures seen from other poses around it. Cameras are given by their position in the list.
struct Scene {
    camera: usize,
    pose: CameraPose,
    taken: Vec<Taken>,
}

/// Picture taken at a pose.
struct Taken {
    camera: usize,
    pose: CameraPose,
    picture: Arc<Picture>,
    gain: [f32; 3],
}

impl Scene {
    /// Makes a scene with anything from no source to the largest number. In every other scene with the largest number, all
    /// sources have the same camera.
    fn new(seed: u64, cameras: &[Camera]) -> Self {
        let stream = Stream::new(seed, Purpose::Initialise, 0, 0);
        let round = seed as usize / (MAX_SOURCES + 1);
        let camera = |number: usize| (seed as usize + round % 2 * number) % cameras.len();
        let n = stream.normals(0);
        let mount = MountPose { height_m: 0.5, pitch_rad: 0.3 + 0.1 * n[3], roll_rad: 0.1 * n[4] };
        let planar = Pose2::new(1.5 * n[0], n[1], 2.0 * n[2]);
        let taken = |number: usize| {
            let n = stream.normals(number as u32 + 1);
            let planar =
                Pose2::new(planar.x_m + 0.3 * n[0], planar.y_m + 0.3 * n[1], planar.yaw_rad + 0.3 * n[2]);
            let mount = MountPose {
                height_m: mount.height_m * (1.0 + 0.1 * n[5].clamp(-3.0, 3.0)),
                pitch_rad: mount.pitch_rad + 0.1 * n[3],
                roll_rad: mount.roll_rad + 0.1 * n[4],
            };
            let camera = camera(number);
            let gain =
                [0, 1, 2].map(|channel| 0.8 + 0.5 * stream.uniform(100 + 3 * number as u32 + channel) as f32);
            let picture = Arc::new(picture(&cameras[camera], &stream, number as u32));
            Taken { camera, pose: mount.at(planar), picture, gain }
        };
        let taken = (0..seed as usize % (MAX_SOURCES + 1)).map(taken).collect();
        Self { camera: camera(1), pose: mount.at(planar), taken }
    }
}

impl Taken {
    fn source<'a>(&'a self, camera: &'a KernelCamera) -> Source<'a> {
        Source { camera, placement: Placement::new(self.pose), picture: &self.picture, gain: self.gain }
    }
}

/// Draws waves in all three channels, with noise on top and a masked disc.
fn picture(camera: &Camera, stream: &Stream, number: u32) -> Picture {
    let pixel = |index: u32| {
        let (u, v) = (index % camera.width, index / camera.width);
        let words = stream.words(index, 1000 + number);
        let channel = |channel: u32| {
            let wave = (0.05 * f64::from((channel + 1) * u + number * v)).sin();
            (120.0 + 80.0 * wave) as u8 + (words[channel as usize] >> 27) as u8
        };
        // A disc in every picture is hidden.
        let from_disc = [u.abs_diff(camera.width / 3), v.abs_diff(camera.height / 2)];
        let is_hidden = from_disc.iter().map(|px| px * px).sum::<u32>() < 300;
        let mask = if is_hidden { Picture::HIDDEN } else { Picture::SHOWN };
        u32::from_le_bytes([channel(0), channel(1), channel(2), mask])
    };
    let pixels = (0..camera.width * camera.height).map(pixel).collect();
    Picture { width: camera.width, height: camera.height, pixels }
}
