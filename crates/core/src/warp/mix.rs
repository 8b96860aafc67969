//! Mixing of what several sources show of the same sixteen pixels.

#![expect(clippy::needless_range_loop, reason = "sixteen lanes in step: the form the compiler vectorises")]

use super::{
    Origin,
    lanes::{largest_of, least, most, rounded},
    weights::{BlendWeights, MAX_SOURCES},
};
use crate::camera::{LANES, Lanes};

/// Rounds in which the weights of sources that disagree with the others are lowered.
const ROUNDS: usize = 3;

/// Change of the mean, in grey levels, below which it has settled: it is rounded to whole ones.
pub(crate) const SETTLED: f32 = 0.25;

/// Smallest sum of weights: less is nothing.
const LEAST_WEIGHT: f32 = 1e-12;

/// Colours and weights of one source at sixteen pixels.
#[derive(Clone, Copy)]
pub(crate) struct Opinion {
    /// Number of the source.
    pub number: u8,
    /// Red, green and blue, 0 to 255.
    pub color: [Lanes; 3],
    /// Weight before the source is compared with the others, 0 where it shows nothing.
    pub prior: Lanes,
    /// Weight that it has in the end.
    weight: Lanes,
}

impl Opinion {
    pub const NONE: Self =
        Self { number: Origin::NOWHERE, color: [[0.0; LANES]; 3], prior: [0.0; LANES], weight: [0.0; LANES] };
}

/// Opinions of the sources that show something.
#[derive(Clone, Copy)]
pub(crate) struct Opinions {
    all: [Opinion; MAX_SOURCES],
    count: usize,
}

impl Opinions {
    pub const NONE: Self = Self { all: [Opinion::NONE; MAX_SOURCES], count: 0 };

    #[inline(always)]
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Returns room for the opinion of the source with this number; it counts once it is kept.
    #[inline(always)]
    pub fn next(&mut self, number: usize) -> &mut Opinion {
        let opinion = &mut self.all[self.count];
        opinion.number = number as u8;
        opinion
    }

    /// Keeps the opinion formed last.
    #[inline(always)]
    pub fn keep(&mut self) {
        self.count += 1;
    }

    /// Mixes them; `sources` is the number of all sources, those that show nothing included. Rounds end before the last one
    /// where the mean changes by less than `settled` grey levels.
    #[inline(always)]
    pub fn mixed(&mut self, sources: usize, weights: &BlendWeights, settled: f32) -> Mixed {
        match &mut self.all[..self.count] {
            [] => Mixed::NONE,
            [alone] => of_one(alone, weights),
            several => mix(several, sources, weights, settled),
        }
    }
}

/// Sixteen pixels of a blended picture.
pub(crate) struct Mixed {
    color: [Lanes; 3],
    /// Number of the source that contributes most.
    source: Lanes,
    trust: Lanes,
}

impl Mixed {
    const NONE: Self =
        Self { color: [[0.0; LANES]; 3], source: [Origin::NOWHERE as f32; LANES], trust: [0.0; LANES] };

    /// Stores the pixels: sixteen, or fewer at the end of a row.
    #[inline(always)]
    pub fn write(&self, colors: &mut [[u8; 3]], origins: &mut [Origin]) {
        let (mut words, mut found) = ([0u32; LANES], [0u32; LANES]);
        for i in 0..LANES {
            words[i] =
                rounded(self.color[0][i]) | rounded(self.color[1][i]) << 8 | rounded(self.color[2][i]) << 16;
            found[i] = rounded(self.source[i]) | rounded(255.0 * self.trust[i]) << 8;
        }
        let bytes = packed(&words);
        let bytes = &bytes[..3 * colors.len().min(LANES)];
        colors.as_flattened_mut()[..bytes.len()].copy_from_slice(bytes);
        for (origin, word) in origins.iter_mut().zip(found) {
            let [source, trust, ..] = word.to_le_bytes();
            *origin = Origin { source, trust };
        }
    }
}

/// Returns three bytes of each word without gaps, and one byte more. A word is stored whole, and the next one over its last
/// byte: one store a pixel instead of three.
#[inline(always)]
fn packed(words: &[u32; LANES]) -> [u8; 3 * LANES + 1] {
    let mut bytes = [0; 3 * LANES + 1];
    for (i, word) in words.iter().enumerate() {
        bytes[3 * i..3 * i + 4].copy_from_slice(&word.to_le_bytes());
    }
    bytes
}

/// Returns what one source shows, with which nothing disagrees.
#[inline(always)]
fn of_one(opinion: &Opinion, weights: &BlendWeights) -> Mixed {
    let mut mixed = Mixed::NONE;
    let number = f32::from(opinion.number);
    for i in 0..LANES {
        let prior = opinion.prior[i];
        let is_shown = prior > 0.0;
        for channel in 0..3 {
            mixed.color[channel][i] = if is_shown { opinion.color[channel][i] } else { 0.0 };
        }
        mixed.source[i] = if is_shown { number } else { mixed.source[i] };
        mixed.trust[i] = if is_shown { trust(prior, 1.0, weights) } else { 0.0 };
    }
    mixed
}

/// Returns the trust in a pixel whose best source has this weight, 0 to 1; `agreement` is the share of the sources' weights that
/// is left after they were compared.
#[inline(always)]
fn trust(best: f32, agreement: f32, weights: &BlendWeights) -> f32 {
    let penalty = 1.0 / most(best, LEAST_WEIGHT).sqrt() - weights.softness;
    least(agreement / (1.0 + most(penalty, 0.0)), 1.0)
}

#[inline(always)]
fn mix(opinions: &mut [Opinion], sources: usize, weights: &BlendWeights, settled: f32) -> Mixed {
    let (mut best, mut before) = ([0.0_f32; LANES], [0.0_f32; LANES]);
    for opinion in opinions.iter_mut() {
        opinion.weight = opinion.prior;
        for i in 0..LANES {
            best[i] = most(best[i], opinion.prior[i]);
            before[i] += opinion.prior[i];
        }
    }
    let mut mean = weighted_mean(opinions);
    if sources >= 3 {
        for _ in 0..ROUNDS {
            lower_outliers(opinions, &mean, weights.disagreement);
            let before = mean;
            mean = weighted_mean(opinions);
            if largest_difference(&mean, &before) < settled {
                break;
            }
        }
    }
    let (mut source, mut largest) = ([f32::from(Origin::NOWHERE); LANES], [0.0_f32; LANES]);
    let mut total = [0.0_f32; LANES];
    for opinion in opinions.iter() {
        let number = f32::from(opinion.number);
        for i in 0..LANES {
            let weight = opinion.weight[i];
            source[i] = if weight > largest[i] { number } else { source[i] };
            largest[i] = most(largest[i], weight);
            total[i] += weight;
        }
    }
    let mut trusts = [0.0_f32; LANES];
    for i in 0..LANES {
        let found = trust(best[i], total[i] / most(before[i], LEAST_WEIGHT), weights);
        trusts[i] = if largest[i] > 0.0 { found } else { 0.0 };
    }
    Mixed { color: mean, source, trust: trusts }
}

/// Lowers the weights of colours that are far from the mean.
#[inline(always)]
fn lower_outliers(opinions: &mut [Opinion], mean: &[Lanes; 3], disagreement: f32) {
    let per_square = 1.0 / (disagreement * disagreement);
    for opinion in opinions {
        for i in 0..LANES {
            let mut square = 0.0;
            for channel in 0..3 {
                let difference = opinion.color[channel][i] - mean[channel][i];
                square += difference * difference;
            }
            opinion.weight[i] = opinion.prior[i] / (1.0 + per_square * square);
        }
    }
}

#[inline(always)]
fn largest_difference(a: &[Lanes; 3], b: &[Lanes; 3]) -> f32 {
    let mut largest = [0.0_f32; LANES];
    for channel in 0..3 {
        for i in 0..LANES {
            largest[i] = most(largest[i], (a[channel][i] - b[channel][i]).abs());
        }
    }
    largest_of(&largest)
}

#[inline(always)]
fn weighted_mean(opinions: &[Opinion]) -> [Lanes; 3] {
    let (mut sum, mut total) = ([[0.0_f32; LANES]; 3], [LEAST_WEIGHT; LANES]);
    for opinion in opinions {
        for i in 0..LANES {
            let weight = opinion.weight[i];
            total[i] += weight;
            for channel in 0..3 {
                sum[channel][i] += weight * opinion.color[channel][i];
            }
        }
    }
    for i in 0..LANES {
        let share = 1.0 / total[i];
        for channel in 0..3 {
            sum[channel][i] *= share;
        }
    }
    sum
}
