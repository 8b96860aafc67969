//! Comparison of the shaders with their twins on the CPU, on seeded scenes with every lens model.

use std::sync::Arc;

use image::{Rgb, RgbImage};
use reality_sim_core::{
    backend::BackendError,
    camera::{Camera, Distortion, ImageCircle, InvalidCamera, Opencv, OpencvFisheye},
    field::FieldDimensions,
    filter::{Filter, FilterConfig, PlanarSigma, Purpose, Resampling, ScoredFilter, Stream},
    mount::{MountPose, MountPoseSigma},
    observation::{CpuScorer, ObservationConfig, ObservationKind, Scorer},
    pose::{CameraPose, Pose2, wrap_angle},
    preprocess::Preprocessor,
};

use crate::{GpuContext, GpuFilter, GpuScorer};

/// Relative difference allowed between sums along the lines. The order of the additions leaves 6e-5, measured in pictures of noise, with light and
/// dark beside each other everywhere.
pub const SCORE_TOLERANCE: f64 = 2e-4;
/// Fraction of poses allowed to have a sample at the picture's edge that only one twin sees.
pub const EDGE_TOLERANCE: f64 = 0.03;
/// Number of poses per scene.
const POSES: u32 = 200;

/// Difference between a scoring kernel and its twin.
#[derive(Debug, Clone, PartialEq)]
pub struct ScoreComparison {
    /// Observation model.
    pub kind: ObservationKind,
    /// Camera model, by COLMAP's name.
    pub lens: &'static str,
    /// Number of poses scored.
    pub poses: usize,
    /// Number of poses that see any line.
    pub seeing: usize,
    /// Largest relative difference of a pose's sum, not counting samples at the picture's edge.
    pub worst: f64,
    /// Fraction of the poses with a sample at the picture's edge that only one of the two sees.
    pub edges: f64,
}

impl ScoreComparison {
    /// Whether both compute the same.
    pub fn agrees(&self) -> bool {
        self.worst <= SCORE_TOLERANCE && self.edges <= EDGE_TOLERANCE && 2 * self.seeing > self.poses
    }
}

/// Compares every observation model with every lens on this many scenes.
pub fn compare_scores(context: &Arc<GpuContext>, scenes: u64) -> Result<Vec<ScoreComparison>, BackendError> {
    let field = FieldDimensions::preset("humanoid-kidsize-2010").expect("a preset of the core");
    let cameras = cameras().expect("lenses that are valid");
    let mut comparisons = Vec::new();
    for kind in ObservationKind::ALL {
        // A picture of noise has no field border.
        let config = ObservationConfig::new(kind).with_mask_border(false);
        for camera in &cameras {
            let gpu = GpuScorer::new(context.clone(), camera, &field, config)?;
            let cpu = CpuScorer::new(camera, &field, config);
            comparisons.push(compare(kind, camera, &field, gpu, cpu, scenes)?);
        }
    }
    Ok(comparisons)
}

/// Differences between the filter's kernels and their twins.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FilterComparison {
    /// Number of updates, each of one iteration with new particles.
    pub updates: usize,
    /// Number of updates whose best particle agrees to 0.1 mm and 0.1 mrad.
    pub same_best: usize,
    /// Number of survivors in all updates.
    pub survivors: usize,
    /// Number of survivors that are the same particle in the same slot.
    pub same_survivors: usize,
}

impl FilterComparison {
    /// Whether both compute the same: a particle whose expected number of copies is nearly whole may get one more or less.
    pub fn agrees(&self) -> bool {
        self.same_best == self.updates && 50 * (self.survivors - self.same_survivors) <= self.survivors
    }
}

/// Compares one iteration of the filter with systematic resampling on this many scenes.
pub fn compare_filters(context: &Arc<GpuContext>, scenes: u64) -> Result<FilterComparison, BackendError> {
    let field = FieldDimensions::preset("humanoid-kidsize-2010").expect("a preset of the core");
    let camera = &cameras().expect("lenses that are valid")[0];
    let observation =
        ObservationConfig::new(ObservationKind::Gauss).with_mask_border(false).with_alpha(3000.0);
    let sigma = PlanarSigma { position_m: 0.1, yaw_rad: 0.08 };
    let mut comparison = FilterComparison::default();
    for seed in 0..scenes {
        let config = FilterConfig::default()
            .with_seed(seed)
            .with_iterations(1)
            .with_resampling(Resampling::Systematic)
            .with_mount_sigma(Some(MountPoseSigma::default()));
        let (picture, poses) = scene(camera, seed);
        let mount = MountPose::of(poses[0]);
        let prepared = Preprocessor::new(camera, field.line_width_m).prepare(picture, mount);
        let mut gpu = GpuFilter::new(context.clone(), camera, &field, observation, config)?;
        let mut cpu = ScoredFilter::new(Box::new(CpuScorer::new(camera, &field, observation)), config);
        let iterate = |filter: &mut dyn Filter| -> Result<_, BackendError> {
            filter.load(&prepared)?;
            filter.initialize(&[(poses[0].planar(), 1.0)], sigma)?;
            Ok((filter.update(mount, sigma)?.pose, filter.particles()?))
        };
        let (found, expected) = (iterate(&mut gpu)?, iterate(&mut cpu)?);
        let is_same = |a: CameraPose, b: CameraPose| {
            let turn_rad = wrap_angle(a.yaw_rad - b.yaw_rad).abs();
            (a.x_m - b.x_m).abs().max((a.y_m - b.y_m).abs()).max(turn_rad) < 1e-4
        };
        comparison.updates += 1;
        comparison.same_best += usize::from(is_same(found.0, expected.0));
        comparison.survivors += expected.1.len();
        comparison.same_survivors +=
            found.1.iter().zip(&expected.1).filter(|(a, b)| is_same(**a, **b)).count();
    }
    Ok(comparison)
}

fn compare(
    kind: ObservationKind,
    camera: &Camera,
    field: &FieldDimensions,
    mut gpu: GpuScorer,
    mut cpu: CpuScorer,
    scenes: u64,
) -> Result<ScoreComparison, BackendError> {
    let lens = camera.distortion.colmap_name();
    let mut comparison = ScoreComparison { kind, lens, poses: 0, seeing: 0, worst: 0.0, edges: 0.0 };
    let mut edges = 0;
    for seed in 0..scenes {
        let (picture, poses) = scene(camera, seed);
        let prepared =
            Preprocessor::new(camera, field.line_width_m).prepare(picture, MountPose::of(poses[0]));
        gpu.load(&prepared)?;
        cpu.set_picture(&prepared);
        for (pose, gpu) in poses.iter().zip(gpu.sums(&poses)?) {
            let ([sum, weight], [gpu_sum, gpu_weight]) = (cpu.sums(pose).map(f64::from), gpu.map(f64::from));
            // One sample more or less at the edge adds its value and its weight.
            let weight_of_edges = (weight - gpu_weight).abs();
            let [largest_value, least_weight] =
                if kind == ObservationKind::Contrast { [1.0, 1e-2] } else { [255.0, 0.5] };
            let is_edge = weight_of_edges > least_weight;
            let difference = ((sum - gpu_sum).abs() - largest_value * weight_of_edges).max(0.0);
            comparison.worst = comparison.worst.max(difference / sum.abs().max(weight).max(1.0));
            comparison.poses += 1;
            comparison.seeing += usize::from(weight > 0.0);
            edges += usize::from(is_edge);
        }
    }
    comparison.edges = f64::from(edges as u32) / comparison.poses.max(1) as f64;
    Ok(comparison)
}

/// Returns one camera of every model, and one with an image circle.
pub(crate) fn cameras() -> Result<Vec<Camera>, InvalidCamera> {
    let fisheye = |k| Distortion::OpencvFisheye(OpencvFisheye { k });
    let opencv = Opencv { k1: -0.12, k2: 0.03, p1: 0.001, p2: -0.002, k3: 0.0 };
    let circle = ImageCircle { cx: 300.0, cy: 390.0, radius: 380.0 };
    Ok(vec![
        Camera::new([640, 480], [214.9, 214.9, 319.5, 239.5], fisheye([-0.058, 0.0082, -0.0009, 0.00005]))?,
        Camera::new([608, 800], [330.2, 330.2, 292.1, 401.3], fisheye([-0.033, 0.001, 0.0, 0.0]))?
            .with_image_circle(Some(circle)),
        Camera::new([640, 480], [620.0, 618.0, 306.9, 231.7], Distortion::Opencv(opencv))?,
        // The width is not a multiple of four pixels.
        Camera::new([317, 239], [250.0, 250.0, 160.0, 120.0], Distortion::Pinhole)?,
    ])
}

/// Makes a picture with light and dark at all scales, and poses all over the field.
pub(crate) fn scene(camera: &Camera, seed: u64) -> (RgbImage, Vec<CameraPose>) {
    let stream = Stream::new(seed, Purpose::Initialise, 0, 0);
    let picture = RgbImage::from_fn(camera.width, camera.height, |u, v| {
        let value = stream.words(u / (1 + v % 7), v / 5)[0] as u8;
        Rgb([value / 2, value, value / 3 + 20])
    });
    let poses = (0..POSES).map(|index| {
        let n = stream.normals(index + 1000);
        let mount = MountPose {
            height_m: 0.5 + 0.05 * n[3].clamp(-3.0, 3.0),
            pitch_rad: 0.3 + 0.2 * n[4],
            roll_rad: 0.1 * n[5],
        };
        mount.at(Pose2::new(1.5 * n[0], n[1], 2.0 * n[2]))
    });
    (picture, poses.collect())
}
