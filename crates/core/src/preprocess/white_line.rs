//! The evidence for white lines: which pixels inside the field's border are white, and how far every pixel is from one.

use image::GrayImage;

use super::FieldBorder;

/// White pixels (255) on the field, by Otsu's threshold between carpet and lines among the pixels inside the border.
pub fn white_line_evidence(whiteness: &GrayImage, border: &FieldBorder) -> (GrayImage, WhiteLevels) {
    let mut histogram = [0_u32; 256];
    for (u, v, pixel) in whiteness.enumerate_pixels().filter(|(u, v, _)| (u + v) % 2 == 0) {
        if border.contains(u, v) {
            histogram[usize::from(pixel.0[0])] += 1;
        }
    }
    let levels = WhiteLevels::from_histogram(&histogram);
    let mut evidence = whiteness.clone();
    border.mask(&mut evidence);
    for value in evidence.iter_mut() {
        *value = if *value > levels.threshold { 255 } else { 0 };
    }
    (evidence, levels)
}

/// Whiteness (0–255) of carpet and lines in one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WhiteLevels {
    /// Mean below the threshold.
    pub carpet: f32,
    /// Mean above the threshold.
    pub line: f32,
    /// Largest value that is not white.
    pub threshold: u8,
}

impl WhiteLevels {
    /// Otsu, "A threshold selection method from gray-level histograms", 1979. Two values at least one grey level apart
    /// are returned whatever the histogram.
    fn from_histogram(histogram: &[u32; 256]) -> Self {
        let total: f64 = histogram.iter().map(|&n| f64::from(n)).sum();
        let moment: f64 = histogram.iter().enumerate().map(|(value, &n)| value as f64 * f64::from(n)).sum();
        let (mut below, mut below_moment) = (0.0, 0.0);
        let mut best = (0.0, Self { carpet: 0.0, line: 255.0, threshold: 127 });
        for (value, &n) in histogram.iter().enumerate().take(255) {
            below += f64::from(n);
            below_moment += value as f64 * f64::from(n);
            let above = total - below;
            if below == 0.0 || above <= 0.0 {
                continue;
            }
            let (low, high) = (below_moment / below, (moment - below_moment) / above);
            let between = below * above * (high - low).powi(2);
            if between > best.0 {
                let levels = Self {
                    carpet: low as f32,
                    line: (high as f32).max(low as f32 + 1.0),
                    threshold: value as u8,
                };
                best = (between, levels);
            }
        }
        best.1
    }

    /// How much brighter lines are than carpet.
    pub fn contrast(&self) -> f32 {
        self.line - self.carpet
    }
}

/// Distance of every pixel from the nearest white one, pixels × [`DISTANCE_UNITS_PER_PX`], cut at 255: two passes of
/// the 5-7-11 chamfer (Borgefors, 1986), at most 2 % from the Euclidean distance.
pub fn distance_field(evidence: &GrayImage) -> GrayImage {
    const FAR: u16 = 255 * 5;
    let (width, height) = (evidence.width() as usize, evidence.height() as usize);
    // A frame of two far pixels on every side spares all tests for the edge.
    let stride = width + 4;
    let mut field = vec![FAR; stride * (height + 4)];
    for (y, row) in evidence.as_raw().chunks_exact(width.max(1)).enumerate() {
        for (target, &white) in field[(y + 2) * stride + 2..].iter_mut().zip(row) {
            *target = if white > 0 { 0 } else { FAR };
        }
    }
    let s = stride;
    let inner = |y: usize| (y + 2) * s + 2;
    for y in 0..height {
        for at in inner(y)..inner(y) + width {
            let straight = field[at - 1].min(field[at - s]) + 5;
            let diagonal = field[at - s - 1].min(field[at - s + 1]) + 7;
            let knight = field[at - 2 * s - 1]
                .min(field[at - 2 * s + 1])
                .min(field[at - s - 2].min(field[at - s + 2]))
                + 11;
            field[at] = field[at].min(straight).min(diagonal).min(knight);
        }
    }
    for y in (0..height).rev() {
        for at in (inner(y)..inner(y) + width).rev() {
            let straight = field[at + 1].min(field[at + s]) + 5;
            let diagonal = field[at + s + 1].min(field[at + s - 1]) + 7;
            let knight = field[at + 2 * s + 1]
                .min(field[at + 2 * s - 1])
                .min(field[at + s + 2].min(field[at + s - 2]))
                + 11;
            field[at] = field[at].min(straight).min(diagonal).min(knight);
        }
    }
    GrayImage::from_fn(evidence.width(), evidence.height(), |u, v| {
        let fifths = f32::from(field[inner(v as usize) + u as usize]);
        image::Luma([(fifths / 5.0 * DISTANCE_UNITS_PER_PX).min(255.0) as u8])
    })
}

/// Grey levels per pixel of distance in [`distance_field`].
pub const DISTANCE_UNITS_PER_PX: f32 = 8.0;
