//! Projection of curves on the ground into a picture, point by point through the lens: with distortion, straight lines
//! in the world do not stay straight in the picture.

use glam::DVec2;

use super::FieldDimensions;
use crate::{camera::Camera, pose::CameraPose};

/// Distance in the picture between neighbouring points where the curve is nearest to the camera, pixels, approximately.
const SPACING_PX: f64 = 6.0;
/// Maximum distance between neighbouring points on the ground, metres.
const MAX_SPACING_M: f64 = 0.02;
/// Maximum distance in the picture at which points are joined, pixels: beyond it the curve is out of view in between.
const MAX_STEP_PX: f64 = 20.0;

/// Returns the field's lines seen from a pose as polylines, pixels. `sideways_m` is 0 for the lines' centres, and plus
/// or minus half their width for their edges.
pub fn project_lines(
    camera: &Camera,
    field: &FieldDimensions,
    pose: CameraPose,
    sideways_m: f64,
) -> Vec<Vec<DVec2>> {
    let placed = PlacedCamera { camera, pose };
    let curve_seen = |curve: super::Curve| {
        let count = placed.steps(curve.length_m());
        placed.polylines((0..=count).map(move |step| {
            let (point, tangent) = curve.at(step as f64 / count as f64);
            point + sideways_m * tangent.perp()
        }))
    };
    field.curves().into_iter().flat_map(curve_seen).collect()
}

/// Returns a closed polygon on the ground seen from a pose as polylines, pixels. Corners are in the same axes as the
/// pose, metres.
pub fn project_polygon(camera: &Camera, corners: &[DVec2], pose: CameraPose) -> Vec<Vec<DVec2>> {
    let placed = PlacedCamera { camera, pose };
    let side = |(from, to): (&DVec2, &DVec2)| {
        let (from, to, count) = (*from, *to, placed.steps(from.distance(*to)));
        placed.polylines((0..=count).map(move |step| from.lerp(to, step as f64 / count as f64)))
    };
    corners.iter().zip(corners.iter().cycle().skip(1)).flat_map(side).collect()
}

/// Camera at its pose.
struct PlacedCamera<'a> {
    camera: &'a Camera,
    pose: CameraPose,
}

impl PlacedCamera<'_> {
    /// Returns the number of steps in which a length on the ground is drawn.
    fn steps(&self, length_m: f64) -> usize {
        let spacing_m = SPACING_PX * self.pose.height_m / self.camera.fx.max(self.camera.fy);
        (length_m / spacing_m.clamp(1e-3, MAX_SPACING_M)).ceil().max(1.0) as usize
    }

    /// Joins points of the ground that are seen next to each other.
    fn polylines(&self, points: impl Iterator<Item = DVec2>) -> Vec<Vec<DVec2>> {
        let mut polylines: Vec<Vec<DVec2>> = vec![Vec::new()];
        let mut before: Option<DVec2> = None;
        for point in points {
            let pixel = self.camera.project(self.pose.camera_from_world(point.extend(0.0))).ok();
            if let Some(pixel) = pixel {
                if before.is_none_or(|before| before.distance(pixel) >= MAX_STEP_PX) {
                    polylines.push(Vec::new());
                }
                polylines.last_mut().into_iter().for_each(|polyline| polyline.push(pixel));
            }
            before = pixel;
        }
        polylines.retain(|polyline| polyline.len() > 1);
        polylines
    }
}
