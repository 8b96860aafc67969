//! Blocks of plain carpet: mean colour and variance of the noise.

use std::collections::BTreeMap;

use glam::DVec2;
use image::RgbImage;

use reality_sim_core::statistics::median;
use reality_sim_sensor::Chain;

use crate::{
    measurement::{
        camera::FrameCamera,
        luma::LUMA,
        quantization::{BLOCK, cosines},
        visibility::Visibility,
    },
    thresholds::{CarpetThresholds, Thresholds},
};

const THRESHOLDS: CarpetThresholds = Thresholds::DEFAULT.measurement.carpet;

/// Measurements of a square block of plain carpet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CarpetBlock {
    /// Pixel at the centre.
    pub(crate) pixel: DVec2,
    /// Point on the ground at the centre, world axes, metres.
    pub(crate) ground: DVec2,
    /// Mean encoded values of the colours, 0–1.
    pub(crate) level: [f64; 3],
    /// Sum of squares of the coefficients of [`Spectrum`], grey levels squared.
    pub(crate) energy: f64,
    /// Number of these coefficients; 0 where the edge of a shadow or of a thing runs through the block.
    pub(crate) coefficients: usize,
}

/// Coefficients of the cosine transform of luma in which noise is measured.
#[derive(Debug, Clone)]
pub(crate) struct Spectrum {
    cosines: [[f64; BLOCK]; BLOCK],
    /// Rows (vertical frequencies) and columns of the chosen coefficients.
    chosen: Vec<(usize, usize)>,
    /// Quantisation steps of the chosen coefficients in the file, grey levels.
    pub(crate) steps: Vec<f64>,
}

impl Spectrum {
    /// Chooses coefficients by frequency and by their quantisation steps (grey levels).
    pub(crate) fn new(steps: &[[f64; BLOCK]; BLOCK]) -> Self {
        let all = (0..BLOCK).flat_map(|row| (0..BLOCK).map(move |column| (row, column)));
        let [lowest, highest] = THRESHOLDS.noise_frequencies;
        let chosen: Vec<_> = all
            .filter(|&(row, column)| {
                (lowest..=highest).contains(&(row + column))
                    && steps[row][column] <= THRESHOLDS.most_quantization_step
            })
            .collect();
        let kept = chosen.iter().map(|&(row, column)| steps[row][column]).collect();
        Self { cosines: cosines(), chosen, steps: kept }
    }

    /// Returns the factor of a camera's encoding on noise at these frequencies, root mean square.
    pub(crate) fn amplitude(chain: &Chain) -> f64 {
        // Every block of every picture asks for it, and few models sharpen.
        if !chain.mixes_encoded_pixels() {
            return 1.0;
        }
        let [lowest, highest] = THRESHOLDS.noise_frequencies;
        let all = (0..BLOCK).flat_map(|row| (0..BLOCK).map(move |column| [row, column]));
        let measured = all.filter(|[row, column]| (lowest..=highest).contains(&(row + column)));
        let frequency = |index: usize| std::f64::consts::PI * index as f64 / BLOCK as f64;
        let squares = measured.map(|place| chain.encoded_amplitude(place.map(frequency)).powi(2));
        let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
        f64::sqrt(sum / count)
    }

    /// Returns the sum of squares of the chosen coefficients of 8 × 8 pixels.
    fn energy(&self, luma: &[[f64; BLOCK]; BLOCK]) -> f64 {
        let mut by_row = [[0.0; BLOCK]; BLOCK];
        for (row, values) in luma.iter().enumerate() {
            for (frequency, waves) in self.cosines.iter().enumerate() {
                by_row[row][frequency] = values.iter().zip(waves).map(|(value, wave)| value * wave).sum();
            }
        }
        let coefficient = |&(vertical, horizontal): &(usize, usize)| -> f64 {
            by_row.iter().zip(&self.cosines[vertical]).map(|(row, wave)| row[horizontal] * wave).sum()
        };
        self.chosen.iter().map(|place| coefficient(place).powi(2)).sum()
    }
}

/// Side of a block of carpet, pixels: half as large in small pictures.
fn block_side(picture: &RgbImage) -> u32 {
    if picture.width() >= THRESHOLDS.large_blocks_from_width_px { 2 * BLOCK as u32 } else { BLOCK as u32 }
}

/// Measures every block of the picture that shows nothing but plain carpet.
pub(crate) fn measure_carpet(
    camera: &FrameCamera<'_>,
    picture: &RgbImage,
    spectrum: &Spectrum,
) -> Vec<CarpetBlock> {
    let side = block_side(picture);
    let visibility = Visibility::new(camera);
    let corners = (0..picture.height() / side)
        .flat_map(|row| (0..picture.width() / side).map(move |column| [column * side, row * side]));
    let plain: Vec<([u32; 2], DVec2)> =
        corners.filter_map(|corner| Some((corner, visibility.plain_carpet(corner, side)?))).collect();
    let measure = |(corner, point)| measure_block(picture, spectrum, corner, side, point);
    thinned(plain).into_iter().map(measure).collect()
}

/// Keeps some of the blocks where many show the same piece of the ground: those near the camera, which would outweigh all
/// others. Blocks are given with a point on the ground, world axes, metres.
fn thinned(blocks: Vec<([u32; 2], DVec2)>) -> Vec<([u32; 2], DVec2)> {
    let square = |point: DVec2| {
        let place = (point / THRESHOLDS.thinned_square_m).floor();
        [place.x as i32, place.y as i32]
    };
    let mut counts: BTreeMap<[i32; 2], usize> = BTreeMap::new();
    blocks.iter().for_each(|(_, point)| *counts.entry(square(*point)).or_default() += 1);
    let mut seen: BTreeMap<[i32; 2], usize> = BTreeMap::new();
    let mut is_kept = |point: DVec2| {
        let square = square(point);
        let index = seen.entry(square).or_default();
        *index += 1;
        // The next of the blocks that are kept is due whenever a share of all has passed.
        let due = |index: usize| index * THRESHOLDS.most_blocks_in_square / counts[&square];
        counts[&square] <= THRESHOLDS.most_blocks_in_square || due(*index) > due(*index - 1)
    };
    blocks.into_iter().filter(|(_, point)| is_kept(*point)).collect()
}

/// Measures the square of `side` pixels (a multiple of 8) from a corner that lies on the file's grid of blocks.
fn measure_block(
    picture: &RgbImage,
    spectrum: &Spectrum,
    corner: [u32; 2],
    side: u32,
    ground: DVec2,
) -> CarpetBlock {
    let mut sum = [0.0; 3];
    let mut energy = 0.0;
    // Luma of the block's quarters.
    let mut quarters = [0.0; 4];
    let parts = side / BLOCK as u32;
    for part in 0..parts * parts {
        let from = [corner[0] + BLOCK as u32 * (part % parts), corner[1] + BLOCK as u32 * (part / parts)];
        let mut luma = [[0.0; BLOCK]; BLOCK];
        for (row, values) in luma.iter_mut().enumerate() {
            for (column, value) in values.iter_mut().enumerate() {
                let rgb = picture.get_pixel(from[0] + column as u32, from[1] + row as u32).0.map(f64::from);
                *value = rgb.iter().zip(LUMA).map(|(value, weight)| value * weight).sum();
                for (sum, value) in sum.iter_mut().zip(rgb) {
                    *sum += value;
                }
            }
        }
        energy += spectrum.energy(&luma);
        for (row, values) in luma.iter().enumerate() {
            for (column, value) in values.iter().enumerate() {
                let [u, v] = [from[0] + column as u32 - corner[0], from[1] + row as u32 - corner[1]];
                quarters[(2 * (2 * v / side) + 2 * u / side) as usize] += value;
            }
        }
    }
    let (darkest, brightest) = quarters
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(low, high), &quarter| (low.min(quarter), high.max(quarter)));
    let is_even = brightest < (1.0 + THRESHOLDS.most_unevenness) * darkest;
    let pixels = f64::from(side * side);
    let middle = 0.5 * f64::from(side - 1);
    CarpetBlock {
        pixel: DVec2::new(f64::from(corner[0]) + middle, f64::from(corner[1]) + middle),
        ground,
        level: sum.map(|sum| sum / (255.0 * pixels)),
        energy,
        coefficients: if is_even { (parts * parts) as usize * spectrum.chosen.len() } else { 0 },
    }
}

/// Returns the median encoded value of each colour over the blocks. None without blocks.
pub(crate) fn median_level(blocks: &[CarpetBlock]) -> Option<[f64; 3]> {
    (!blocks.is_empty())
        .then(|| [0, 1, 2].map(|channel| median(blocks.iter().map(|block| block.level[channel]))))
}

/// Whether the pixels around a point have the colour of carpet, whose encoded values are given.
pub(crate) fn is_carpet(picture: &RgbImage, pixel: DVec2, carpet_level: [f64; 3]) -> bool {
    let around_px = THRESHOLDS.averaged_half_side_px;
    let mut sums = [0.0; 3];
    for dv in -around_px..=around_px {
        for du in -around_px..=around_px {
            let (u, v) = (pixel.x.round() as i64 + du, pixel.y.round() as i64 + dv);
            let at = u32::try_from(u).ok().zip(u32::try_from(v).ok());
            let Some(color) = at.and_then(|(u, v)| picture.get_pixel_checked(u, v)) else { return false };
            color.0.iter().zip(&mut sums).for_each(|(value, sum)| *sum += f64::from(*value));
        }
    }
    let within = |ratio: f64, factor: f64| (1.0 / factor..=factor).contains(&ratio);
    let [red, green, blue] = [0, 1, 2].map(|channel| sums[channel] / carpet_level[channel].max(1e-3));
    let pixels = 255.0 * ((2 * around_px + 1) * (2 * around_px + 1)) as f64;
    within(red / green, THRESHOLDS.same_hue_factor)
        && within(blue / green, THRESHOLDS.same_hue_factor)
        && within(green / pixels, THRESHOLDS.same_brightness_factor)
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;

    const CARPET: [u8; 3] = [52, 120, 60];

    fn is_carpet_of(color: [u8; 3]) -> bool {
        let picture = RgbImage::from_pixel(20, 20, Rgb(color));
        is_carpet(&picture, DVec2::splat(9.0), CARPET.map(|value| f64::from(value) / 255.0))
    }

    #[test]
    fn darker_carpet_is_carpet_and_objects_on_it_are_not() {
        assert!(is_carpet_of(CARPET) && is_carpet_of([33, 78, 37]));
        for (what, color) in [
            ("line", [205, 210, 204]),
            ("robot", [25, 26, 28]),
            ("ball", [230, 110, 30]),
            ("blurred line", [95, 148, 100]),
        ] {
            assert!(!is_carpet_of(color), "{what}");
        }
    }

    #[test]
    fn a_point_outside_the_picture_shows_no_carpet() {
        let picture = RgbImage::from_pixel(20, 20, Rgb(CARPET));
        assert!(!is_carpet(&picture, DVec2::new(-3.0, 5.0), [0.2, 0.47, 0.23]));
    }

    #[test]
    fn the_median_level_is_that_of_most_blocks() {
        let block = |green: f64| CarpetBlock {
            pixel: DVec2::ZERO,
            ground: DVec2::ZERO,
            level: [0.2, green, 0.23],
            energy: 0.0,
            coefficients: 0,
        };
        assert_eq!(median_level(&[block(0.5), block(0.48), block(0.05)]).unwrap()[1], 0.48);
        assert!(median_level(&[]).is_none());
    }
}
