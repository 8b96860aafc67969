//! Light in a part of a picture, with how much of each pixel it covers.

/// Rectangle of a picture with the light of what is drawn there, before the lens, row by row. What lies behind shines through
/// as far as pixels are not covered.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LightTile {
    /// First column in the picture.
    pub left: usize,
    /// First row in the picture.
    pub top: usize,
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// Linear red, green and blue, each times the covered part of the pixel.
    pub color: [Vec<f32>; 3],
    /// Covered part of each pixel, 0 to 1: one plane, or one each for red, green and blue.
    pub cover: Vec<Vec<f32>>,
}

impl LightTile {
    /// Makes a tile without light; with or without a plane of covered parts for each colour.
    pub fn empty([left, top]: [usize; 2], [width, height]: [usize; 2], splits_colors: bool) -> Self {
        let plane = || vec![0.0; width * height];
        let cover = (0..if splits_colors { 3 } else { 1 }).map(|_| plane()).collect();
        Self { left, top, width, height, color: [(); 3].map(|()| plane()), cover }
    }

    /// Returns the covered parts of the pixels in red (0), green (1) or blue (2).
    pub fn cover(&self, channel: usize) -> &[f32] {
        &self.cover[channel.min(self.cover.len() - 1)]
    }

    /// Whether something covers more than this part of a pixel.
    pub(crate) fn is_touched(&self, index: usize, least: f32) -> bool {
        self.cover.iter().any(|plane| plane[index] > least)
    }

    /// Blurs all planes along rows and columns. `weights` gives the weights of a pixel and of its neighbours on one side at a
    /// column and row of the tile, and is asked once for so many pixels of a row. Beyond the tile, light continues as at its
    /// sides.
    pub(crate) fn blur<'k>(&mut self, segment: usize, weights: impl Fn(f64, f64) -> &'k [f32]) {
        if self.width == 0 || self.height == 0 {
            return;
        }
        let (width, height) = (self.width, self.height);
        let segments: Vec<(usize, usize, &[f32])> = (0..height)
            .flat_map(|row| (0..width).step_by(segment).map(move |first| (row, first)))
            .map(|(row, first)| (row, first, weights(first as f64 + 0.5 * segment as f64, row as f64)))
            .collect();
        for plane in self.color.iter_mut().chain(&mut self.cover) {
            let across = blurred_rows(plane, width, segment, &segments);
            blur_columns(&across, plane, [width, height], segment, &segments);
        }
    }
}

fn blurred_rows(
    plane: &[f32],
    width: usize,
    segment: usize,
    segments: &[(usize, usize, &[f32])],
) -> Vec<f32> {
    let reach = segments.iter().map(|(_, _, weights)| weights.len()).max().unwrap_or(1) - 1;
    let mut padded = vec![0.0; width + 2 * reach];
    let mut blurred = vec![0.0; plane.len()];
    let mut padded_row = usize::MAX;
    for &(row, first, weights) in segments {
        let source = &plane[row * width..(row + 1) * width];
        if padded_row != row {
            padded[..reach].fill(source[0]);
            padded[reach..reach + width].copy_from_slice(source);
            padded[reach + width..].fill(source[width - 1]);
            padded_row = row;
        }
        let count = segment.min(width - first);
        let to = &mut blurred[row * width + first..][..count];
        let from = |offset: isize| &padded[(reach as isize + first as isize + offset) as usize..][..count];
        to.iter_mut().zip(from(0)).for_each(|(to, from)| *to = weights[0] * from);
        for (offset, weight) in weights.iter().enumerate().skip(1) {
            let sides = from(-(offset as isize)).iter().zip(from(offset as isize));
            to.iter_mut().zip(sides).for_each(|(to, (before, after))| *to += weight * (before + after));
        }
    }
    blurred
}

fn blur_columns(
    across: &[f32],
    plane: &mut [f32],
    [width, height]: [usize; 2],
    segment: usize,
    segments: &[(usize, usize, &[f32])],
) {
    for &(row, first, weights) in segments {
        let count = segment.min(width - first);
        let to = &mut plane[row * width + first..][..count];
        let from = |offset: isize| {
            let row = (row as isize + offset).clamp(0, height as isize - 1) as usize;
            &across[row * width + first..][..count]
        };
        to.iter_mut().zip(from(0)).for_each(|(to, from)| *to = weights[0] * from);
        for (offset, weight) in weights.iter().enumerate().skip(1) {
            let sides = from(-(offset as isize)).iter().zip(from(offset as isize));
            to.iter_mut().zip(sides).for_each(|(to, (before, after))| *to += weight * (before + after));
        }
    }
}
