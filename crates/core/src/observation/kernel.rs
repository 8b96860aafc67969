//! Inner loop of all scoring: line samples are projected by a particle's pose and the lens, or interpolated between others that are, and a
//! texture is read there.
//!
//! It handles sixteen samples at a time, in plain arrays that the compiler turns into vector instructions.
//! Multiplications and additions are never fused, so that every processor gives the same bits.

use super::{
    interpolation::{Cubic, NODES},
    samples::{Block, Circle, Ground, Quad, Samples},
};
use crate::{
    camera::{KernelCamera, LANES, Lanes, Pixels, Places, inside_lanes, place_lanes, project_lanes},
    pose::CameraPose,
    preprocess::Texture,
};

/// Pose for points with z = 0: `camera = linear · ground + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraFromGround {
    /// One row for each of the camera's axes.
    pub linear: [[f32; 2]; 3],
    /// One component for each of the camera's axes, metres.
    pub offset: [f32; 3],
    /// Height of the camera above the ground, metres.
    pub height_m: f32,
}

impl CameraFromGround {
    /// Converts a pose to single precision.
    pub fn new(pose: CameraPose) -> Self {
        let rotation = pose.rotation_world_from_camera();
        let position = pose.position_in_world();
        let axes = [rotation.x_axis, rotation.y_axis, rotation.z_axis];
        Self {
            linear: axes.map(|axis| [axis.x as f32, axis.y as f32]),
            offset: axes.map(|axis| -axis.dot(position) as f32),
            height_m: position.z as f32,
        }
    }

    /// Returns whether a whole circle lies outside the lens's largest angle.
    #[inline(always)]
    fn is_beyond(&self, camera: &KernelCamera, circle: &Circle) -> bool {
        let [a, b] = circle.centre;
        let [x, y, z] = std::array::from_fn(|axis| {
            self.linear[axis][0] * a + self.linear[axis][1] * b + self.offset[axis]
        });
        let distance = (x * x + y * y + z * z).sqrt();
        // The circle's point with the smallest angle has at most this z, and at least this distance.
        let least_distance = distance - circle.radius.copysign(camera.min_cos);
        z + circle.radius < camera.min_cos * least_distance
    }

    /// Returns points in the camera's axes, metres.
    #[inline(always)]
    pub(super) fn in_camera(&self, ground: &Ground) -> [Lanes; 3] {
        let mut place = [[0.0_f32; LANES]; 3];
        for (axis, place) in place.iter_mut().enumerate() {
            let [a, b] = self.linear[axis];
            let offset = self.offset[axis];
            for i in 0..LANES {
                place[i] = a * ground[0][i] + b * ground[1][i] + offset;
            }
        }
        place
    }
}

/// Projects one of the points of all samples of a block; `None` if the camera sees none of them.
#[inline(always)]
pub(super) fn project_block<const N: usize>(
    camera: &KernelCamera,
    pose: &CameraFromGround,
    block: &Block<N>,
    point: usize,
) -> Option<Pixels> {
    if pose.is_beyond(camera, &block.circle) {
        return None;
    }
    project_lanes(camera, &pose.in_camera(&block.points[point]))
}

/// Interpolates one block of four between its nodes; `None` if the picture contains none of its lanes.
#[inline(always)]
fn interpolate_block(
    cubic: &Cubic,
    camera: &KernelCamera,
    nodes: &Places,
    block: usize,
    is_sample: &Lanes,
) -> Option<Pixels> {
    let mut pixels = Pixels {
        u: cubic.interpolate(&nodes.u, block),
        v: cubic.interpolate(&nodes.v, block),
        nearness: cubic.interpolate(&nodes.nearness, block),
        seen: [0.0; LANES],
    };
    if !inside_lanes(camera, &mut pixels) {
        return None;
    }
    for (seen, is_sample) in pixels.seen.iter_mut().zip(is_sample) {
        *seen *= is_sample;
    }
    Some(pixels)
}

/// Interpolates one block of a quad between its nodes, or projects it where that is not right; `None` if the camera sees none of its
/// samples. The last argument tells which of the blocks, and which of the points of all samples.
// Returning a struct of all nodes and their blocks instead, which would read better, takes a third longer: it is kept in memory.
#[inline(always)]
pub(super) fn see_block<const N: usize>(
    cubic: &Cubic,
    camera: &KernelCamera,
    pose: &CameraFromGround,
    quad: &Quad<N>,
    nodes: &Places,
    is_right: bool,
    [block, point]: [usize; 2],
) -> Option<Pixels> {
    if is_right {
        interpolate_block(cubic, camera, nodes, block, &quad.blocks[block].is_sample)
    } else {
        project_block(camera, pose, &quad.blocks[block], point)
    }
}

/// Two sums over the samples of a pose, lane by lane.
type Sums = [Lanes; 2];

/// Adds up the lanes of every pose.
fn totals(all: &[Sums]) -> Vec<[f32; 2]> {
    all.iter().map(|sums| sums.map(|lanes| lanes.iter().sum())).collect()
}

/// Returns bilinear values (0–255) at sixteen pixels; 0 for points that are not seen.
#[inline(always)]
pub(crate) fn sample_block(texture: &Texture, pixels: &Pixels) -> Lanes {
    /// 1.5 · 2²³: adding it leaves the nearest integer of a float in the low bits of its mantissa.
    const SHIFT: f32 = 12_582_912.0;
    const INTEGER_BITS: u32 = 0x003f_ffff;
    let mut index = [0u32; LANES];
    let (mut fu, mut fv) = ([0.0_f32; LANES], [0.0_f32; LANES]);
    for i in 0..LANES {
        let (u, v) = (pixels.u[i], pixels.v[i]);
        let (column, row) = ((u - 0.5) + SHIFT, (v - 0.5) + SHIFT);
        fu[i] = u - (column - SHIFT);
        fv[i] = v - (row - SHIFT);
        let (column, row) = (column.to_bits() & INTEGER_BITS, row.to_bits() & INTEGER_BITS);
        index[i] = row.wrapping_mul(texture.width).wrapping_add(column);
    }
    // The index of a point that is not seen may be any number; what is read there is not used.
    let values = texture.gather(index);
    let mut value = [0.0_f32; LANES];
    for i in 0..LANES {
        let p00 = (values[i] & 255) as f32;
        let p01 = (values[i] >> 8 & 255) as f32;
        let p10 = (values[i] >> 16 & 255) as f32;
        let p11 = (values[i] >> 24) as f32;
        let top = p00 + fu[i] * (p10 - p00);
        let bottom = p01 + fu[i] * (p11 - p01);
        value[i] = if pixels.seen[i] > 0.0 { top + fv[i] * (bottom - top) } else { 0.0 };
    }
    value
}

/// Returns the sum of the texture's values over all samples seen, and the number of these samples, for each pose.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
pub(super) fn sum_along_lines(
    texture: &Texture,
    camera: &KernelCamera,
    poses: &[CameraFromGround],
    samples: &Samples<1>,
) -> Vec<[f32; 2]> {
    sum_on_any_processor(texture, camera, poses, samples)
}

/// Computes [`sum_along_lines`] in every build.
#[inline(always)]
pub(super) fn sum_on_any_processor(
    texture: &Texture,
    camera: &KernelCamera,
    poses: &[CameraFromGround],
    samples: &Samples<1>,
) -> Vec<[f32; 2]> {
    let cubic = Cubic::new();
    let mut all: Vec<Sums> = vec![[[0.0; LANES]; 2]; poses.len()];
    // All poses take a block before the next one: they mostly see the same blocks, so that the processor foresees which.
    for quad in &samples.quads {
        for (pose, sums) in poses.iter().zip(&mut all) {
            if pose.is_beyond(camera, &quad.circle) {
                continue;
            }
            let nodes = place_lanes(camera, &pose.in_camera(&quad.nodes[0]));
            for (block, wrong) in quad.limits.wrong(&nodes).into_iter().enumerate() {
                let Some(pixels) = see_block(&cubic, camera, pose, quad, &nodes, wrong == 0, [block, 0])
                else {
                    continue;
                };
                add_values(texture, &pixels, sums);
            }
        }
    }
    totals(&all)
}

#[inline(always)]
fn add_values(texture: &Texture, pixels: &Pixels, [sum, seen]: &mut Sums) {
    let value = sample_block(texture, pixels);
    for i in 0..LANES {
        sum[i] += value[i];
        seen[i] += pixels.seen[i];
    }
}

/// Parameters of the contrast model that depend on the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContrastScale {
    /// One over the Michelson contrast of lines and carpet in this picture.
    pub per_contrast: f32,
    /// Offset added to the brightness in the denominator of the contrast, so that noise in the dark is no line, grey
    /// levels.
    pub dark_level: f32,
    /// Width in the picture up to which a line does not count, pixels: the sensor does not resolve it.
    pub min_width_px: f32,
    /// One over the additional width from which a line counts fully, per pixel.
    pub per_width_px: f32,
    /// Area in the picture of one sample's piece of line, seen from 1 m above and 1 m away, divided by the area that
    /// counts fully. It falls with the third power of the distance: two for the distance, one for the foreshortening.
    pub relative_area: f32,
}

/// Minimum contrast: something dark in place of a line, such as the edge of an obstacle, is no worse than no line.
const MIN_CONTRAST: f32 = -0.25;

/// Returns Σ weight · contrast and Σ weight over all samples seen with both flanks, for each pose. Contrast is the Michelson contrast
/// of the centre and the brighter flank, in units of the picture's line contrast, clipped to [[`MIN_CONTRAST`], 1].
/// Light that varies over the field does not change it.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
pub(super) fn contrast_along_lines(
    texture: &Texture,
    camera: &KernelCamera,
    poses: &[CameraFromGround],
    samples: &Samples<3>,
    scale: ContrastScale,
) -> Vec<[f32; 2]> {
    contrast_on_any_processor(texture, camera, poses, samples, scale)
}

/// Computes [`contrast_along_lines`] in every build.
#[inline(always)]
pub(super) fn contrast_on_any_processor(
    texture: &Texture,
    camera: &KernelCamera,
    poses: &[CameraFromGround],
    samples: &Samples<3>,
    scale: ContrastScale,
) -> Vec<[f32; 2]> {
    let cubic = Cubic::new();
    let mut all: Vec<Sums> = vec![[[0.0; LANES]; 2]; poses.len()];
    for quad in &samples.quads {
        for (pose, sums) in poses.iter().zip(&mut all) {
            if pose.is_beyond(camera, &quad.circle) {
                continue;
            }
            let [centre, left, right] = [
                place_lanes(camera, &pose.in_camera(&quad.nodes[0])),
                place_lanes(camera, &pose.in_camera(&quad.nodes[1])),
                place_lanes(camera, &pose.in_camera(&quad.nodes[2])),
            ];
            let [a, b, c] = [&centre, &left, &right].map(|nodes| quad.limits.wrong(nodes));
            let wrong: [u32; NODES] = std::array::from_fn(|block| a[block] | b[block] | c[block]);
            for (block, wrong) in wrong.into_iter().enumerate() {
                let is_right = wrong == 0;
                let Some(centre) = see_block(&cubic, camera, pose, quad, &centre, is_right, [block, 0])
                else {
                    continue;
                };
                let Some(left) = see_block(&cubic, camera, pose, quad, &left, is_right, [block, 1]) else {
                    continue;
                };
                let Some(right) = see_block(&cubic, camera, pose, quad, &right, is_right, [block, 2]) else {
                    continue;
                };
                add_contrasts(texture, &scale, pose, [&centre, &left, &right], sums);
            }
        }
    }
    totals(&all)
}

#[inline(always)]
fn add_contrasts(
    texture: &Texture,
    scale: &ContrastScale,
    pose: &CameraFromGround,
    [centre, left, right]: [&Pixels; 3],
    [contrast, weight]: &mut Sums,
) {
    let area_at_1_m = scale.relative_area * pose.height_m;
    let line = sample_block(texture, centre);
    let (flank_left, flank_right) = (sample_block(texture, left), sample_block(texture, right));
    for i in 0..LANES {
        let (du, dv) = (left.u[i] - right.u[i], left.v[i] - right.v[i]);
        // The flanks lie two line widths apart.
        let width_px = 0.5 * (du * du + dv * dv).sqrt();
        let seen = centre.seen[i] * left.seen[i] * right.seen[i];
        let resolved = (width_px - scale.min_width_px) * scale.per_width_px;
        let near = centre.nearness[i];
        let area = area_at_1_m * near * near * near;
        let w = if seen > 0.0 { resolved.min(area).clamp(0.0, 1.0) } else { 0.0 };
        let flank = flank_left[i].max(flank_right[i]);
        let c = (line[i] - flank) / (line[i] + flank + scale.dark_level) * scale.per_contrast;
        contrast[i] += w * c.clamp(MIN_CONTRAST, 1.0);
        weight[i] += w;
    }
}
