//! Random numbers: SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014).

use std::{f64::consts::TAU, sync::LazyLock};

/// Stream of random numbers that is the same on every machine.
#[derive(Debug, Clone)]
pub struct Random {
    state: u64,
}

impl Random {
    /// Starts the stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// Starts a separate stream for each purpose: an additional draw for one purpose changes no other.
    pub fn stream(seed: u64, purpose: &str, number: u64) -> Self {
        let mut random = Self::new(seed);
        for value in purpose.bytes().map(u64::from).chain([number]) {
            random.state = random.next_u64() ^ value.wrapping_mul(0xff51_afd7_ed55_8ccd);
        }
        random
    }

    /// Draws 64 random bits.
    pub fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Draws uniformly from 0 to below 1.
    pub fn uniform(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Draws uniformly between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Draws one of 0 … `count` − 1.
    pub fn below(&mut self, count: u64) -> u64 {
        (self.uniform() * count as f64) as u64
    }

    /// Draws −1 or 1.
    pub fn sign(&mut self) -> f64 {
        if self.next_u64() & 1 == 0 { 1.0 } else { -1.0 }
    }

    /// Draws from the normal distribution with mean 0 and standard deviation 1 (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (TAU * self.uniform()).cos()
    }
}

/// Number of a table's normal numbers.
const DEVIATES: usize = 1 << 16;

/// Equally likely normal numbers, the largest of which is 4.3: each is the middle, in probability, of its part of the normal
/// distribution.
static TABLE: LazyLock<Vec<f32>> = LazyLock::new(|| {
    (0..DEVIATES).map(|index| quantile((index as f64 + 0.5) / DEVIATES as f64) as f32).collect()
});

/// Stream of normal numbers from a table, several times as fast as [`Random::normal`].
pub struct Deviates {
    values: &'static [f32],
    random: Random,
    bits: u64,
    left: u32,
}

impl Deviates {
    /// Starts drawing with these random bits.
    pub fn new(random: Random) -> Self {
        Self { values: &TABLE, random, bits: 0, left: 0 }
    }

    /// Draws a normal number.
    pub fn draw(&mut self) -> f64 {
        if self.left == 0 {
            (self.bits, self.left) = (self.random.next_u64(), 4);
        }
        let value = self.values[(self.bits & 0xffff) as usize];
        self.bits >>= 16;
        self.left -= 1;
        f64::from(value)
    }
}

/// Returns the normal distribution's quantile by bisection of [`normal_part`].
fn quantile(part: f64) -> f64 {
    let (mut low, mut high) = (-6.0, 6.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if normal_part(middle) < part { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Returns the part of the normal distribution below a number: Abramowitz and Stegun 1964, formula 26.2.17, to 8·10⁻⁸.
pub fn normal_part(number: f64) -> f64 {
    const B: [f64; 5] = [0.319_381_530, -0.356_563_782, 1.781_477_937, -1.821_255_978, 1.330_274_429];
    let t = 1.0 / (1.0 + 0.231_641_9 * number.abs());
    let polynomial = B.iter().rev().fold(0.0, |sum, b| (sum + b) * t);
    let above = (-0.5 * number * number).exp() / TAU.sqrt() * polynomial;
    if number < 0.0 { above } else { 1.0 - above }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_numbers_have_the_moments_of_a_normal_distribution() {
        let mut random = Random::new(1);
        let count = 200_000;
        let mut sums = [0.0; 4];
        for _ in 0..count {
            let value = random.normal();
            for (power, sum) in (1..).zip(&mut sums) {
                *sum += value.powi(power) / f64::from(count);
            }
        }
        assert!(sums[0].abs() < 0.01 && (sums[1] - 1.0).abs() < 0.02, "{sums:?}");
        assert!(sums[2].abs() < 0.03 && (sums[3] - 3.0).abs() < 0.1, "{sums:?}");
    }

    #[test]
    fn a_table_of_normal_numbers_has_the_moments_too() {
        let mut stream = Deviates::new(Random::new(4));
        let count = 200_000;
        let values: Vec<f64> = (0..count).map(|_| stream.draw()).collect();
        let moment = |power| values.iter().map(|value| value.powi(power)).sum::<f64>() / f64::from(count);
        assert!(moment(1).abs() < 0.01 && (moment(2) - 1.0).abs() < 0.02, "{} {}", moment(1), moment(2));
        assert!((moment(4) - 3.0).abs() < 0.1, "{}", moment(4));
        assert!((normal_part(1.959_964) - 0.975).abs() < 1e-6);
    }

    #[test]
    fn streams_of_the_same_seed_differ() {
        let first = |purpose, number| Random::stream(3, purpose, number).next_u64();
        assert_ne!(first("gait", 0), first("lens", 0));
        assert_ne!(first("noise", 0), first("noise", 1));
        assert_eq!(first("noise", 1), first("noise", 1));
    }
}
