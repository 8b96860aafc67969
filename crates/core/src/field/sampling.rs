//! Samples along the field's lines: evenly on the ground for scoring, evenly in the picture for measuring.

use glam::{DVec2, DVec3};

use super::{Curve, FieldDimensions, GoalPost};
use crate::{camera::Camera, pose::CameraPose};

/// A point on the centre of a white line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineSample {
    /// On the ground, world axes, metres.
    pub point_in_world: DVec2,
    /// Unit vector along the line.
    pub tangent_in_world: DVec2,
    /// Length of line that the sample stands for, metres.
    pub length_m: f64,
    /// Distance to the nearest other line, metres: small beside corners and crossings.
    pub clearance_m: f64,
    /// Index into [`FieldDimensions::curves`].
    pub curve: usize,
}

impl LineSample {
    /// Unit vector across the line, 90° counter-clockwise from the tangent.
    pub fn normal_in_world(&self) -> DVec2 {
        self.tangent_in_world.perp()
    }
}

/// Samples all lines so that neighbours are at most `spacing_m` apart; none lies on an end of a line, where two
/// lines would be counted at once.
pub fn sample_lines(field: &FieldDimensions, spacing_m: f64) -> Vec<LineSample> {
    let curves = field.curves();
    let mut samples = Vec::new();
    for (index, curve) in curves.iter().enumerate() {
        // At least one sample; the cast saturates, so that a spacing of zero cannot loop for ever.
        let count = (curve.length_m() / spacing_m).ceil().clamp(1.0, 1e6) as usize;
        samples.extend((0..count).map(|i| {
            line_sample(&curves, index, (i as f64 + 0.5) / count as f64, curve.length_m() / count as f64)
        }));
    }
    samples
}

fn line_sample(curves: &[Curve], index: usize, fraction: f64, length_m: f64) -> LineSample {
    let (point_in_world, tangent_in_world) = curves[index].at(fraction);
    let clearance_m = curves
        .iter()
        .enumerate()
        .filter(|(other, _)| *other != index)
        .map(|(_, other)| other.distance_m(point_in_world))
        .fold(f64::INFINITY, f64::min);
    LineSample { point_in_world, tangent_in_world, length_m, clearance_m, curve: index }
}

/// A sample together with where it is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisibleSample {
    /// The place on the line.
    pub sample: LineSample,
    /// Where it is seen.
    pub pixel: DVec2,
    /// Unit vector across the line in the picture, towards [`LineSample::normal_in_world`].
    pub normal_in_image: DVec2,
    /// Half the line's width in the picture, along that normal, pixels.
    pub half_width_px: f64,
}

/// Samples seen by a camera, at most about one every `spacing_px` along the line in the picture. Dropped are those
/// out of view, behind a goal post, or so near the rim or the horizon that the line's sides have no pixel.
pub fn visible_samples(
    field: &FieldDimensions,
    samples: &[LineSample],
    camera: &Camera,
    pose: CameraPose,
    spacing_px: f64,
) -> Vec<VisibleSample> {
    let camera_from_world = pose.rotation_world_from_camera().transpose();
    let project = |point: DVec2| {
        camera.project(camera_from_world * (point.extend(0.0) - pose.position_in_world())).ok()
    };
    let posts: Vec<GoalPost> = field.goals().iter().flat_map(|goal| goal.posts).collect();
    let mut kept: Vec<VisibleSample> = Vec::new();
    for &sample in samples {
        let half_width = sample.normal_in_world() * (field.line_width_m / 2.0);
        let (Some(pixel), Some(left), Some(right), Some(ahead)) = (
            project(sample.point_in_world),
            project(sample.point_in_world + half_width),
            project(sample.point_in_world - half_width),
            project(sample.point_in_world + sample.tangent_in_world * 1e-3),
        ) else {
            continue;
        };
        let Some(along) = (ahead - pixel).try_normalize() else { continue };
        let towards_left = left - right;
        let across = along.perp() * along.perp().dot(towards_left).signum();
        let too_dense = kept
            .last()
            .is_some_and(|last| last.sample.curve == sample.curve && last.pixel.distance(pixel) < spacing_px);
        if too_dense || posts.iter().any(|post| hides(post, pose, sample.point_in_world)) {
            continue;
        }
        kept.push(VisibleSample {
            sample,
            pixel,
            normal_in_image: across,
            half_width_px: 0.5 * across.dot(towards_left),
        });
    }
    kept
}

/// Whether an upright post stands between the camera and a point on the ground.
fn hides(post: &GoalPost, pose: CameraPose, point_in_world: DVec2) -> bool {
    let camera = pose.position_in_world();
    let ray: DVec3 = point_in_world.extend(0.0) - camera;
    let flat = ray.truncate();
    let fraction = (post.center - camera.truncate()).dot(flat) / flat.length_squared().max(f64::MIN_POSITIVE);
    let nearest = camera + fraction.clamp(0.0, 1.0) * ray;
    // A line may run under the post's foot: only what lies behind it is hidden.
    let in_front = fraction < 1.0 - post.radius_m / flat.length().max(f64::MIN_POSITIVE);
    in_front
        && fraction > 0.0
        && nearest.truncate().distance(post.center) < post.radius_m
        && nearest.z < post.height_m
}
