//! What plain carpet looks like: block by block its colour, and the noise on it.

use glam::DVec2;
use image::RgbImage;

use crate::{
    jpeg::{BLOCK, cosines},
    profile::LUMA,
};

/// Frequencies of noise that are looked at, as the sum of row and column: texture of carpet is in the lower ones, a
/// JPEG file keeps little of the higher ones.
pub(crate) const FREQUENCIES: std::ops::RangeInclusive<usize> = 3..=6;
/// Coefficients that a file rounds to more than this many grey levels tell little of noise.
const MAX_STEP: f64 = 12.0;

/// What was measured of a square of plain carpet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Block {
    /// Its centre.
    pub(crate) pixel: DVec2,
    /// What is seen there, on the ground, metres.
    pub(crate) ground: DVec2,
    /// Mean encoded values, 0–1.
    pub(crate) level: [f64; 3],
    /// Sum of squares of the coefficients of [`Spectrum`], grey levels squared.
    pub(crate) energy: f64,
    /// How many coefficients that are.
    pub(crate) coefficients: usize,
}

/// The coefficients of luma that noise is measured in.
#[derive(Debug, Clone)]
pub(crate) struct Spectrum {
    cosines: [[f64; BLOCK]; BLOCK],
    chosen: Vec<(usize, usize)>,
    /// The file's rounding of each chosen one, grey levels.
    pub(crate) steps: Vec<f64>,
}

impl Spectrum {
    pub(crate) fn new(steps: &[[f64; BLOCK]; BLOCK]) -> Self {
        let all = (0..BLOCK).flat_map(|row| (0..BLOCK).map(move |column| (row, column)));
        let chosen: Vec<_> = all
            .filter(|&(row, column)| FREQUENCIES.contains(&(row + column)) && steps[row][column] <= MAX_STEP)
            .collect();
        let kept = chosen.iter().map(|&(row, column)| steps[row][column]).collect();
        Self { cosines: cosines(), chosen, steps: kept }
    }

    /// Sum of squares of the chosen coefficients of the 8 × 8 pixels from a corner.
    fn energy(&self, luma: &[[f64; BLOCK]; BLOCK]) -> f64 {
        let mut half = [[0.0; BLOCK]; BLOCK];
        for (row, values) in luma.iter().enumerate() {
            for (frequency, waves) in self.cosines.iter().enumerate() {
                half[row][frequency] = values.iter().zip(waves).map(|(value, wave)| value * wave).sum();
            }
        }
        let coefficient = |&(vertical, horizontal): &(usize, usize)| -> f64 {
            half.iter().zip(&self.cosines[vertical]).map(|(row, wave)| row[horizontal] * wave).sum()
        };
        self.chosen.iter().map(|place| coefficient(place).powi(2)).sum()
    }
}

/// Measures the square of `side` pixels (a multiple of 8) from a corner that lies on the file's grid of blocks.
pub(crate) fn measure(
    picture: &RgbImage,
    spectrum: &Spectrum,
    corner: [u32; 2],
    side: u32,
    ground: DVec2,
) -> Block {
    let mut sum = [0.0; 3];
    let mut energy = 0.0;
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
    }
    let pixels = f64::from(side * side);
    let middle = 0.5 * f64::from(side - 1);
    Block {
        pixel: DVec2::new(f64::from(corner[0]) + middle, f64::from(corner[1]) + middle),
        ground,
        level: sum.map(|sum| sum / (255.0 * pixels)),
        energy,
        coefficients: (parts * parts) as usize * spectrum.chosen.len(),
    }
}
