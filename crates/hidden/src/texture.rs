//! Blotches: smoothly interpolated random numbers on lattices.

use crate::random::Random;

/// Number of cells after which a lattice repeats; a power of two.
const PERIOD: i32 = 128;

/// Shift by a multiple of the period; no position in a hall is farther from the centre.
const SHIFT_CELLS: f32 = 1024.0;

/// Ratio of the standard deviation of smoothly interpolated numbers to that of the numbers themselves, averaged over a cell.
const INTERPOLATION_LOSS: f64 = 0.743;

/// Pattern over the plane with mean 0.
#[derive(Debug, Clone)]
pub struct Texture {
    layers: Vec<Layer>,
}

#[derive(Debug, Clone)]
struct Layer {
    cells_per_m: f32,
    values: Vec<f32>,
}

impl Texture {
    /// Adds up layers, each given by the size of its blotches in metres and its standard deviation.
    pub fn new(random: &mut Random, layers: &[(f64, f64)]) -> Self {
        let layers = layers.iter().map(|&(cell_m, deviation)| Layer {
            cells_per_m: (1.0 / cell_m) as f32,
            // A uniform distribution between ±√3 has a standard deviation of 1.
            values: (0..PERIOD * PERIOD)
                .map(|_| (random.between(-1.0, 1.0) * 3_f64.sqrt() * deviation / INTERPOLATION_LOSS) as f32)
                .collect(),
        });
        Self { layers: layers.collect() }
    }

    /// Returns the value at a position, metres.
    pub fn at(&self, x_m: f32, y_m: f32) -> f32 {
        self.layers.iter().map(|layer| layer.at(x_m, y_m)).sum()
    }
}

impl Layer {
    fn at(&self, x_m: f32, y_m: f32) -> f32 {
        // The shift by whole periods makes coordinates positive, where truncation rounds down and is much faster.
        let (x, y) = (x_m * self.cells_per_m + SHIFT_CELLS, y_m * self.cells_per_m + SHIFT_CELLS);
        let (column, row) = (x as i32, y as i32);
        let (s, t) = (smooth(x - column as f32), smooth(y - row as f32));
        let node = |right: i32, up: i32| {
            let (i, j) = ((column + right) & (PERIOD - 1), (row + up) & (PERIOD - 1));
            self.values[(j * PERIOD + i) as usize]
        };
        let low = node(0, 0) + s * (node(1, 0) - node(0, 0));
        let high = node(0, 1) + s * (node(1, 1) - node(0, 1));
        low + t * (high - low)
    }
}

/// Returns 3t² − 2t³, whose slope is 0 at both ends.
fn smooth(t: f32) -> f32 {
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_texture_has_the_requested_mean_and_deviation() {
        let texture = Texture::new(&mut Random::new(5), &[(0.15, 0.06), (0.05, 0.05)]);
        let values: Vec<f64> = (0..400)
            .flat_map(|i| (0..400).map(move |j| (i, j)))
            .map(|(i, j)| f64::from(texture.at(i as f32 * 0.0173, j as f32 * 0.0191)))
            .collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64;
        assert!(mean.abs() < 0.004, "{mean}");
        assert!((variance.sqrt() - 0.078).abs() < 0.006, "{}", variance.sqrt());
    }
}
