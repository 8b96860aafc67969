//! Random numbers: SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014).

use std::f64::consts::TAU;

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
    fn streams_of_the_same_seed_differ() {
        let first = |purpose, number| Random::stream(3, purpose, number).next_u64();
        assert_ne!(first("gait", 0), first("lens", 0));
        assert_ne!(first("noise", 0), first("noise", 1));
        assert_eq!(first("noise", 1), first("noise", 1));
    }
}
