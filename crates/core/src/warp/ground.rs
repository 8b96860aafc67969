//! Colours that a picture shows at points of the ground.

use super::{Source, sampling::sample};
use crate::camera::{LANES, Lanes, project_lanes};

/// What a picture shows at sixteen points of the ground.
#[derive(Debug, Clone, Copy)]
pub struct GroundColors {
    /// Red, green and blue as recorded, 0 to 255; meaningless where a point is not shown.
    pub color: [Lanes; 3],
    /// 1 where the picture shows the point, 0 where it does not see it, or its mask hides it.
    pub shown: Lanes,
    /// One over the distance from the camera, per metre.
    pub nearness: Lanes,
}

/// Returns what a source shows at sixteen points of the ground, given by x and y in the world, metres. `None` if it sees none of
/// them. Nothing hides the points but the source's own mask.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
pub fn ground_colors(source: &Source, points: &[Lanes; 2]) -> Option<GroundColors> {
    let [x, y, z] = source.placement.position_in_world;
    let mut in_camera = [[0.0_f32; LANES]; 3];
    for (coordinates, [a, b, c]) in in_camera.iter_mut().zip(source.placement.axes_in_world) {
        for (i, coordinate) in coordinates.iter_mut().enumerate() {
            *coordinate = a * (points[0][i] - x) + b * (points[1][i] - y) - c * z;
        }
    }
    let pixels = project_lanes(source.camera, &in_camera)?;
    let samples = sample(source.picture, &pixels);
    let mut shown = pixels.seen;
    for (shown, unmasked) in shown.iter_mut().zip(samples.shown) {
        *shown *= unmasked;
    }
    Some(GroundColors { color: samples.color, shown, nearness: pixels.nearness })
}
