//! Evidence for white lines: which pixels inside the field's border are white.

use image::GrayImage;
use rayon::prelude::*;

use super::{CELL_PX, FieldBorder};

/// Distance of the flanks from a pixel, in line widths; large enough to span a line that runs at 45°.
const FLANK_WIDTHS: f32 = 1.3;
/// Additional distance of the flanks, to allow for blur, pixels.
const FLANK_MARGIN_PX: f32 = 1.5;
/// Minimum height of a ridge, grey levels: anything lower is the carpet's texture or the sensor's noise.
const MIN_RIDGE: u8 = 10;

/// Parameters that give the width of white lines in the pictures of a camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineScale {
    /// Pixels per radian around the optical axis.
    pub focal_px: f32,
    /// Width of the white lines, metres.
    pub line_width_m: f32,
    /// Height of the camera above the carpet, metres.
    pub height_m: f32,
}

/// Step between the rows from which the picture's levels are learned.
const LEVEL_ROWS: usize = 4;

/// Returns the white pixels (255) on the field: brighter than the flanks just over a line's width away on both sides,
/// along the row or along the column. Light that varies over the carpet does not matter.
pub fn white_line_evidence(
    whiteness: &GrayImage,
    border: &FieldBorder,
    scale: LineScale,
    levels: &WhiteLevels,
) -> GrayImage {
    let mut evidence = ridges(whiteness, border, scale, 1);
    evidence.iter_mut().for_each(|value| *value = if *value > levels.threshold { 255 } else { 0 });
    evidence
}

/// Returns how bright lines and carpet are in a picture, and how much brighter than its flanks a white pixel must be:
/// Otsu's threshold among the pixels that stand out at all. Returns besides the pixels that are white in the rows from which this is
/// learned.
pub fn white_levels(
    whiteness: &GrayImage,
    border: &FieldBorder,
    scale: LineScale,
) -> (WhiteLevels, Vec<[u32; 2]>) {
    let ridges = ridges(whiteness, border, scale, LEVEL_ROWS);
    let width = whiteness.width().max(1) as usize;
    let rows =
        || ridges.chunks_exact(width).zip(whiteness.chunks_exact(width)).enumerate().step_by(LEVEL_ROWS);
    // Pixels that are no ridge at all would outnumber the lines.
    let candidates = || {
        rows()
            .flat_map(|(_, (ridges, white))| ridges.iter().zip(white))
            .filter(|(ridge, _)| **ridge > MIN_RIDGE)
    };
    let mut histogram = [0_u32; 256];
    candidates().for_each(|(&ridge, _)| histogram[usize::from(ridge)] += 1);
    let threshold = otsu(&histogram);
    let (mut line, mut flank, mut count) = (0.0, 0.0, 0.0_f32);
    for (&ridge, &white) in candidates().filter(|(ridge, _)| **ridge > threshold) {
        line += f32::from(white);
        flank += f32::from(white - ridge);
        count += 1.0;
    }
    let levels = match count > 0.0 {
        true => WhiteLevels { carpet: flank / count, line: line / count, threshold },
        false => WhiteLevels { threshold, ..WhiteLevels::default() },
    };
    let white = rows().flat_map(|(v, (ridges, _))| {
        let columns = (0..).zip(ridges).filter(|(_, ridge)| **ridge > threshold);
        columns.map(move |(u, _)| [u, v as u32])
    });
    (levels, white.collect())
}

/// Returns by how much each pixel inside the border, in some of the rows, is brighter than both its flanks, along the
/// row or along the column.
fn ridges(whiteness: &GrayImage, border: &FieldBorder, scale: LineScale, every: usize) -> GrayImage {
    let (width, height) = (whiteness.width() as usize, whiteness.height() as usize);
    let values = whiteness.as_raw();
    let ridge = |u: usize, v: usize, [across, along]: [usize; 2]| {
        let value = values[v * width + u];
        let rise = |a: usize, b: usize| value.saturating_sub(values[a].max(values[b]));
        let beside =
            (u >= across && u + across < width).then(|| rise(v * width + u - across, v * width + u + across));
        let above = (v >= along && v + along < height)
            .then(|| rise((v - along) * width + u, (v + along) * width + u));
        beside.unwrap_or(0).max(above.unwrap_or(0))
    };
    let mut ridges = vec![0_u8; values.len()];
    ridges.par_chunks_mut(width.max(1)).enumerate().filter(|(v, _)| v % every == 0).for_each(|(v, row)| {
        let cells = row.chunks_mut(CELL_PX as usize).zip((0..).step_by(CELL_PX as usize));
        for (found, first) in cells {
            let Some(flanks) = flank_distances(border, scale, [first as u32, v as u32]) else { continue };
            for (found, u) in found.iter_mut().zip(first..) {
                *found = ridge(u, v, flanks);
            }
        }
    });
    // The buffer holds exactly one value per pixel, as its size requires.
    GrayImage::from_raw(whiteness.width(), whiteness.height(), ridges).unwrap_or_default()
}

/// Returns the distances of a pixel's flanks along the row and along the column, pixels; `None` outside the border.
pub(super) fn flank_distances(
    border: &FieldBorder,
    scale: LineScale,
    [u, v]: [u32; 2],
) -> Option<[usize; 2]> {
    let depression = border.depression(u, v);
    if depression <= 0.0 {
        return None;
    }
    let per_depression = scale.focal_px * scale.line_width_m / scale.height_m.max(0.01);
    let across_px = FLANK_WIDTHS * per_depression * depression;
    Some([across_px, across_px * depression].map(|distance_px| (distance_px + FLANK_MARGIN_PX) as usize))
}

/// Returns the threshold of Otsu, "A threshold selection method from gray-level histograms", 1979.
fn otsu(histogram: &[u32; 256]) -> u8 {
    let total: f64 = histogram.iter().map(|&n| f64::from(n)).sum();
    let moment: f64 = histogram.iter().enumerate().map(|(value, &n)| value as f64 * f64::from(n)).sum();
    let (mut below, mut below_moment) = (0.0, 0.0);
    let mut best = (0.0, 127);
    for (value, &n) in histogram.iter().enumerate().take(255) {
        below += f64::from(n);
        below_moment += value as f64 * f64::from(n);
        let above = total - below;
        if below > 0.0 && above > 0.0 {
            let between = below * above * (below_moment / below - (moment - below_moment) / above).powi(2);
            if between > best.0 {
                best = (between, value as u8);
            }
        }
    }
    best.1
}

/// Whiteness (0–255) of the lines and of the carpet beside them in one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WhiteLevels {
    /// Mean beside the lines.
    pub carpet: f32,
    /// Mean on the lines.
    pub line: f32,
    /// Threshold: a pixel brighter than both its flanks by more than this is white.
    pub threshold: u8,
}

impl Default for WhiteLevels {
    /// Returns the levels used if no line is seen: black carpet, white lines.
    fn default() -> Self {
        Self { carpet: 0.0, line: 255.0, threshold: 0 }
    }
}

impl WhiteLevels {
    /// Returns the Michelson contrast of lines and carpet, with `dark_level` added to the brightness in the
    /// denominator.
    pub fn michelson(&self, dark_level: f32) -> f32 {
        ((self.line - self.carpet) / (self.line + self.carpet + dark_level)).max(0.05)
    }

    /// Returns how much brighter lines are than carpet, grey levels.
    pub fn contrast(&self) -> f32 {
        self.line - self.carpet
    }
}

#[cfg(test)]
mod tests {
    use crate::{mount::MountPose, preprocess::Preprocessor, test_scene};

    #[test]
    fn evidence_is_where_lines_are_drawn() {
        let (camera, field) = (test_scene::fisheye(), test_scene::field());
        for pose in test_scene::poses() {
            let mount = MountPose::of(pose);
            let picture = test_scene::render(&camera, pose, &field);
            let prepared = Preprocessor::new(&camera, field.line_width_m).prepare(picture, mount);
            let evidence = prepared.evidence();
            let (mut right, mut wrong) = (0, 0);
            for (u, v, _) in evidence.enumerate_pixels().filter(|(_, _, pixel)| pixel.0[0] > 0) {
                let pixel = glam::DVec2::new(f64::from(u), f64::from(v));
                let ground = camera.unproject_to_ground(pose, pixel).unwrap();
                let distance_m =
                    field.curves().iter().map(|c| c.distance_m(ground)).fold(f64::INFINITY, f64::min);
                // A pixel far away covers much ground.
                let reach_m = 0.5 * field.line_width_m
                    + 0.02 * (ground - pose.position_in_world().truncate()).length_squared();
                if distance_m <= reach_m { right += 1 } else { wrong += 1 }
            }
            assert!(right > 500 && wrong * 50 < right, "{right} right, {wrong} wrong");
            assert!(
                (prepared.levels.line - 228.0).abs() < 25.0 && (prepared.levels.carpet - 60.0).abs() < 25.0,
                "{:?}",
                prepared.levels
            );
        }
    }
}
