//! Counter-based random numbers: Philox 4×32-10 of Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011.
//!
//! A number depends only on the seed and on its use (frame, iteration, particle, purpose), so particles can be processed by
//! any thread or GPU, in any order.

/// What a random number is drawn for: each purpose has a stream of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Purpose {
    /// Placing particles at the start and at relocalization.
    Initialise = 1,
    /// Noise of the motion between two frames.
    Predict = 2,
    /// Diffusion between two iterations of a frame.
    Diffuse = 3,
    /// Resampling.
    Resample = 4,
    /// Noise of a simulated picture; the pixel's number takes the place of the particle's.
    Picture = 5,
    /// Poses and objects of a data set; the picture's number takes the place of the frame's.
    Dataset = 6,
}

/// Stream of random numbers for one seed, purpose, frame and iteration.
#[derive(Debug, Clone, Copy)]
pub struct Stream {
    key: [u32; 2],
    frame: u32,
    purpose_and_iteration: u32,
}

impl Stream {
    /// Returns the stream of this seed for one purpose in one iteration of one frame.
    pub fn new(seed: u64, purpose: Purpose, frame: u32, iteration: u32) -> Self {
        Self {
            key: [seed as u32, (seed >> 32) as u32],
            frame,
            purpose_and_iteration: (purpose as u32) << 24 | (iteration & 0x00ff_ffff),
        }
    }

    /// Returns four uniformly distributed words for one particle; count `block` up to get more than four.
    pub fn words(&self, particle: u32, block: u32) -> [u32; 4] {
        philox4x32_10([particle, block, self.frame, self.purpose_and_iteration], self.key)
    }

    /// Returns a uniformly distributed number in [0, 1).
    pub fn uniform(&self, particle: u32) -> f64 {
        unit(self.words(particle, 0)[0])
    }

    /// Returns six independent standard normal numbers for one particle, by the Box–Muller transform.
    pub fn normals(&self, particle: u32) -> [f64; 6] {
        let (a, b) = (self.words(particle, 0), self.words(particle, 1));
        let ([n0, n1], [n2, n3], [n4, n5]) =
            (box_muller(a[0], a[1]), box_muller(a[2], a[3]), box_muller(b[0], b[1]));
        [n0, n1, n2, n3, n4, n5]
    }
}

/// Maps the upper 24 bits to [0, 1): the same number in single and double precision.
fn unit(word: u32) -> f64 {
    f64::from(word >> 8) / f64::from(1_u32 << 24)
}

fn box_muller(a: u32, b: u32) -> [f64; 2] {
    // 1 − unit lies in (0, 1], where the logarithm is finite.
    let radius = (-2.0 * (1.0 - unit(a)).ln()).sqrt();
    let (sin, cos) = (std::f64::consts::TAU * unit(b)).sin_cos();
    [radius * cos, radius * sin]
}

fn philox4x32_10(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for _ in 0..10 {
        let p0 = u64::from(counter[0]) * 0xD251_1F53;
        let p1 = u64::from(counter[2]) * 0xCD9E_8D57;
        counter = [
            (p1 >> 32) as u32 ^ counter[1] ^ key[0],
            p1 as u32,
            (p0 >> 32) as u32 ^ counter[3] ^ key[1],
            p0 as u32,
        ];
        key = [key[0].wrapping_add(0x9E37_79B9), key[1].wrapping_add(0xBB67_AE85)];
    }
    counter
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks known answers from the authors' library Random123 (kat_vectors).
    #[test]
    fn philox_known_answers() {
        let cases = [
            ([0; 4], [0; 2], [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]),
            ([u32::MAX; 4], [u32::MAX; 2], [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ];
        for (counter, key, expected) in cases {
            assert_eq!(philox4x32_10(counter, key), expected);
        }
    }

    #[test]
    fn normals_have_the_moments_of_a_normal_distribution() {
        let stream = Stream::new(7, Purpose::Diffuse, 3, 1);
        let values: Vec<f64> = (0..20_000).flat_map(|particle| stream.normals(particle)).collect();
        let moment = |power: i32| values.iter().map(|v| v.powi(power)).sum::<f64>() / values.len() as f64;
        // Standard errors of the four moments of 120,000 numbers: 0.003, 0.004, 0.011, 0.028.
        assert!(moment(1).abs() < 0.015, "mean {}", moment(1));
        assert!((moment(2) - 1.0).abs() < 0.02, "variance {}", moment(2));
        assert!(moment(3).abs() < 0.05, "skewness {}", moment(3));
        assert!((moment(4) - 3.0).abs() < 0.14, "kurtosis {}", moment(4));
    }

    #[test]
    fn streams_of_different_purpose_differ() {
        let words = |purpose, frame, iteration| Stream::new(1, purpose, frame, iteration).words(0, 0);
        let first = words(Purpose::Predict, 0, 0);
        for other in
            [words(Purpose::Diffuse, 0, 0), words(Purpose::Predict, 1, 0), words(Purpose::Predict, 0, 1)]
        {
            assert_ne!(first, other);
        }
    }
}
