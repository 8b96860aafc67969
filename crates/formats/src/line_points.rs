//! Points along the field's lines, from which reconstructions may start.

use glam::{DVec2, DVec3};
use reality_sim_core::{
    camera::Camera,
    field::{FieldDimensions, sample_lines},
    pose::CameraPose,
};

/// Distance between neighbouring points on a line, metres. Chosen: an SPL field gets about a thousand points.
const SPACING_M: f64 = 0.1;

/// Colour of the points, sRGB: lines are white.
pub(crate) const LINE_SRGB: [u8; 3] = [255; 3];

/// Returns points on the centres of the field's lines, in the world, metres.
pub fn line_points(field: &FieldDimensions) -> Vec<DVec3> {
    sample_lines(field, SPACING_M).iter().map(|sample| sample.point_in_world.extend(0.0)).collect()
}

/// Returns those of `points` (in the world, metres) that a camera sees at a pose: their places among `points`, and pixels.
pub fn seen_points(camera: &Camera, pose: CameraPose, points: &[DVec3]) -> Vec<(usize, DVec2)> {
    let pixel =
        |(index, point): (usize, &DVec3)| Some((index, camera.project(pose.camera_from_world(*point)).ok()?));
    points.iter().enumerate().filter_map(pixel).collect()
}
