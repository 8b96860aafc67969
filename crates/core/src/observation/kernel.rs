//! Inner loop of all scoring: ground points are projected by a particle's pose and the lens, and a texture is read
//! there.
//!
//! It handles sixteen points at a time, in plain arrays that the compiler turns into vector instructions.
//! Multiplications and additions are never fused, so that every processor gives the same bits.

use crate::{
    camera::{KernelCamera, LANES, Lanes, Pixels, project_lanes},
    pose::CameraPose,
    preprocess::Texture,
};

/// Sixteen ground points: neighbours on a line, hence close together.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Block {
    /// x and y, metres. A block with fewer points is padded with NaN, which no camera sees.
    place: [Lanes; 2],
    /// Centre of a circle that contains all points.
    centre: [f32; 2],
    radius: f32,
}

impl Block {
    fn new(points: &[glam::DVec2]) -> Self {
        let mut place = [[f32::NAN; LANES]; 2];
        for (lane, point) in points.iter().enumerate() {
            place[0][lane] = point.x as f32;
            place[1][lane] = point.y as f32;
        }
        let centre = points.iter().sum::<glam::DVec2>() / points.len() as f64;
        let radius = points.iter().map(|point| point.distance(centre)).fold(0.0, f64::max);
        // The radius is a little larger, to allow for rounding.
        Self { place, centre: [centre.x as f32, centre.y as f32], radius: 1.001 * radius as f32 + 1e-4 }
    }
}

/// Ground points in blocks of sixteen.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct GroundPoints {
    pub blocks: Vec<Block>,
}

impl GroundPoints {
    pub fn new(points: impl Iterator<Item = glam::DVec2>) -> Self {
        let points: Vec<_> = points.collect();
        let blocks = points.chunks(LANES).map(Block::new).collect();
        Self { blocks }
    }

    /// Returns all points.
    pub fn points(&self) -> impl Iterator<Item = [f32; 2]> {
        let lanes = self.blocks.iter().flat_map(|block| block.place[0].into_iter().zip(block.place[1]));
        lanes.filter(|(x, _)| !x.is_nan()).map(|(x, y)| [x, y])
    }
}

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

    /// Returns whether a whole block lies outside the lens's largest angle, judged by the block's circle alone.
    #[inline(always)]
    fn is_beyond(&self, camera: &KernelCamera, block: &Block) -> bool {
        let [a, b] = block.centre;
        let [x, y, z] = std::array::from_fn(|axis| {
            self.linear[axis][0] * a + self.linear[axis][1] * b + self.offset[axis]
        });
        let distance = (x * x + y * y + z * z).sqrt();
        // The circle's point with the smallest angle has at most this z, and at least this distance.
        let least_distance = distance - block.radius.copysign(camera.min_cos);
        z + block.radius < camera.min_cos * least_distance
    }
}

/// Projects a block; `None` if the camera sees none of it.
#[inline(always)]
pub(crate) fn project_block(camera: &KernelCamera, pose: &CameraFromGround, block: &Block) -> Option<Pixels> {
    if pose.is_beyond(camera, block) {
        return None;
    }
    let ground = &block.place;
    let mut place = [[0.0_f32; LANES]; 3];
    for (axis, place) in place.iter_mut().enumerate() {
        let [a, b] = pose.linear[axis];
        let offset = pose.offset[axis];
        for i in 0..LANES {
            place[i] = a * ground[0][i] + b * ground[1][i] + offset;
        }
    }
    project_lanes(camera, &place)
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
    let texel = texture.gather(index);
    let mut value = [0.0_f32; LANES];
    for i in 0..LANES {
        let p00 = (texel[i] & 255) as f32;
        let p10 = (texel[i] >> 8 & 255) as f32;
        let p01 = (texel[i] >> 16 & 255) as f32;
        let p11 = (texel[i] >> 24) as f32;
        let top = p00 + fu[i] * (p10 - p00);
        let bottom = p01 + fu[i] * (p11 - p01);
        value[i] = if pixels.seen[i] > 0.0 { top + fv[i] * (bottom - top) } else { 0.0 };
    }
    value
}

/// Returns the sum of the texture's values over all points seen, and the number of these points.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
pub(crate) fn sum_along_lines(
    texture: &Texture,
    camera: &KernelCamera,
    pose: &CameraFromGround,
    points: &GroundPoints,
) -> [f32; 2] {
    sum_on_any_processor(texture, camera, pose, points)
}

/// Computes [`sum_along_lines`] in every build.
#[inline(always)]
pub(super) fn sum_on_any_processor(
    texture: &Texture,
    camera: &KernelCamera,
    pose: &CameraFromGround,
    points: &GroundPoints,
) -> [f32; 2] {
    let (mut sum, mut seen) = ([0.0_f32; LANES], [0.0_f32; LANES]);
    for block in &points.blocks {
        let Some(pixels) = project_block(camera, pose, block) else { continue };
        let value = sample_block(texture, &pixels);
        for i in 0..LANES {
            sum[i] += value[i];
            seen[i] += pixels.seen[i];
        }
    }
    [sum.iter().sum(), seen.iter().sum()]
}

/// Centre, left flank and right flank of line samples, in blocks of sixteen.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct LinePoints {
    pub centre: GroundPoints,
    pub left: GroundPoints,
    pub right: GroundPoints,
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

/// Returns Σ weight · contrast and Σ weight over all samples seen with both flanks. Contrast is the Michelson contrast
/// of the centre and the brighter flank, in units of the picture's line contrast, clipped to [[`MIN_CONTRAST`], 1].
/// Light that varies over the field does not change it.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
pub(crate) fn contrast_along_lines(
    texture: &Texture,
    camera: &KernelCamera,
    pose: &CameraFromGround,
    points: &LinePoints,
    scale: ContrastScale,
) -> [f32; 2] {
    contrast_on_any_processor(texture, camera, pose, points, scale)
}

/// Computes [`contrast_along_lines`] in every build.
#[inline(always)]
pub(super) fn contrast_on_any_processor(
    texture: &Texture,
    camera: &KernelCamera,
    pose: &CameraFromGround,
    points: &LinePoints,
    scale: ContrastScale,
) -> [f32; 2] {
    let area_at_1_m = scale.relative_area * pose.height_m;
    let (mut contrast, mut weight) = ([0.0_f32; LANES], [0.0_f32; LANES]);
    for ((centre, left), right) in
        points.centre.blocks.iter().zip(&points.left.blocks).zip(&points.right.blocks)
    {
        let Some(centre) = project_block(camera, pose, centre) else { continue };
        let Some(left) = project_block(camera, pose, left) else { continue };
        let Some(right) = project_block(camera, pose, right) else { continue };
        let line = sample_block(texture, &centre);
        let (flank_left, flank_right) = (sample_block(texture, &left), sample_block(texture, &right));
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
    [contrast.iter().sum(), weight.iter().sum()]
}
