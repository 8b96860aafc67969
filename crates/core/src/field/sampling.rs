//! Samples along the field's lines: evenly spaced on the ground for scoring, evenly in the picture for measuring.

use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;

use super::{Curve, FieldDimensions, GoalPost};
use crate::{camera::Camera, pose::CameraPose};

/// Minimum spacing, metres: it keeps the number of samples of any field within memory.
const LEAST_SPACING_M: f64 = 1e-3;

/// Point on the centre of a white line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineSample {
    /// Point on the ground, world axes, metres.
    pub point_in_world: DVec2,
    /// Unit vector along the line.
    pub tangent_in_world: DVec2,
    /// Length of line that the sample stands for, metres.
    pub length_m: f64,
    /// Distance to the nearest other line, metres: small near corners and crossings.
    pub clearance_m: f64,
    /// Index into [`FieldDimensions::curves`].
    pub curve: usize,
}

impl LineSample {
    /// Returns the unit vector across the line, 90° counter-clockwise from the tangent.
    pub fn normal_in_world(&self) -> DVec2 {
        self.tangent_in_world.perp()
    }
}

/// Samples all lines so that neighbours are at most `spacing_m` (1 mm at least) apart. No sample lies on an end of a
/// line, where two lines would be counted at once.
pub fn sample_lines(field: &FieldDimensions, spacing_m: f64) -> Vec<LineSample> {
    let curves = field.curves();
    let mut samples = Vec::new();
    for (index, curve) in curves.iter().enumerate() {
        // `max` also replaces a spacing that is not a number.
        let count = (curve.length_m() / spacing_m.max(LEAST_SPACING_M)).ceil().max(1.0) as usize;
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

/// Sample together with its position in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisibleSample {
    /// Sample on the line.
    pub sample: LineSample,
    /// Position in the picture, pixels.
    pub pixel: DVec2,
    /// Unit vector across the line in the picture, towards [`LineSample::normal_in_world`].
    pub normal_in_image: DVec2,
    /// Half the line's width in the picture, along that normal, pixels; above 0.
    pub half_width_px: f64,
}

/// Returns the samples seen by a camera, at most about one every `spacing_px` along the line in the picture. Samples
/// are dropped if they are out of view, behind a goal post, or so near the rim or the horizon that the sides of the
/// line have no pixel or its width is zero.
pub fn visible_samples(
    field: &FieldDimensions,
    samples: &[LineSample],
    camera: &Camera,
    pose: CameraPose,
    spacing_px: f64,
) -> Vec<VisibleSample> {
    let camera_from_world = pose.rotation_world_from_camera().transpose();
    let placed = PlacedCamera { camera, pose, camera_from_world };
    let posts: Vec<GoalPost> = field.goals().iter().flat_map(|goal| goal.posts).collect();
    let lines = samples.par_chunk_by(|a, b| a.curve == b.curve);
    let seen = lines.map(|line| {
        let mut kept: Vec<VisibleSample> = Vec::new();
        for &sample in line {
            let Ok(pixel) = camera.project(placed.in_camera(sample.point_in_world)) else { continue };
            // Most samples are too dense: this is asked first.
            let too_dense = kept.last().is_some_and(|last| last.pixel.distance(pixel) < spacing_px);
            if !too_dense && !posts.iter().any(|post| hides(post, pose, sample.point_in_world)) {
                kept.extend(placed.see(sample, field.line_width_m));
            }
        }
        kept
    });
    seen.flatten_iter().collect()
}

/// Camera at its pose.
struct PlacedCamera<'a> {
    camera: &'a Camera,
    pose: CameraPose,
    camera_from_world: DMat3,
}

impl PlacedCamera<'_> {
    /// Returns a point on the ground in the camera's axes, metres.
    fn in_camera(&self, point_in_world: DVec2) -> DVec3 {
        self.camera_from_world * (point_in_world.extend(0.0) - self.pose.position_in_world())
    }

    /// Projects a sample of a line of this width; `None` if it is out of view.
    fn see(&self, sample: LineSample, line_width_m: f64) -> Option<VisibleSample> {
        let (pixel, [du, dv]) =
            self.camera.project_with_gradients(self.in_camera(sample.point_in_world)).ok()?;
        let half_width = sample.normal_in_world() * (line_width_m / 2.0);
        let left = self.camera.project(self.in_camera(sample.point_in_world + half_width)).ok()?;
        let right = self.camera.project(self.in_camera(sample.point_in_world - half_width)).ok()?;
        let tangent_in_camera = self.camera_from_world * sample.tangent_in_world.extend(0.0);
        let along = DVec2::new(du.dot(tangent_in_camera), dv.dot(tangent_in_camera)).try_normalize()?;
        let across = along.perp() * along.perp().dot(left - right).signum();
        let half_width_px = 0.5 * across.dot(left - right);
        let visible = VisibleSample { sample, pixel, normal_in_image: across, half_width_px };
        (half_width_px > 0.0).then_some(visible)
    }
}

/// Returns whether an upright post stands between the camera and a point on the ground, or on that point.
fn hides(post: &GoalPost, pose: CameraPose, point_in_world: DVec2) -> bool {
    let camera = pose.position_in_world();
    let flat = point_in_world - camera.truncate();
    let length_m = flat.length().max(f64::MIN_POSITIVE);
    let direction = flat / length_m;
    let to_post = post.center - camera.truncate();
    let along_m = to_post.dot(direction);
    let half_chord_m = (post.radius_m * post.radius_m - to_post.perp_dot(direction).powi(2)).sqrt();
    // NaN if the line of sight passes beside the post: then every comparison is false.
    let (entry_m, exit_m) = (along_m - half_chord_m, along_m + half_chord_m);
    // The line of sight descends all the way: it is lowest where it leaves the post.
    let lowest_m = camera.z * (1.0 - (exit_m / length_m).min(1.0));
    half_chord_m > 0.0 && entry_m < length_m && exit_m > 0.0 && lowest_m < post.height_m
}
