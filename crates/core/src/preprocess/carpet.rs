//! Colour of the carpet, learned from the picture itself.

/// Number of bins along each axis of the chromaticity histogram.
const BINS: usize = 48;
/// Weight of a colourless pixel; the weight of others grows with their distance from grey, about 0.1 for dull carpets.
const GREY_WEIGHT: f32 = 0.02;
/// Sum of the channels below which a pixel is too dark to have a usable chromaticity.
const MIN_SUM: u16 = 36;
/// Minimum spread of the carpet's chromaticity: JPEG's colour noise.
const MIN_SIGMA: f32 = 0.012;
/// Maximum spread of the carpet's chromaticity.
const MAX_SIGMA: f32 = 0.025;
/// Fraction by which a change of colour along the ground is followed at each step.
const DRIFT: f32 = 0.15;
/// Maximum distance of the followed colour from the learned one.
const MAX_DRIFT: f32 = 0.12;
/// Squared distance, in spreads, up to which a pixel may be carpet.
const GATE: f32 = 12.0;
/// Factor of that gate beside white lines, where JPEG's colour noise and the lines' own light reach. With 1, half of the lines' points
/// in real pictures were refused, with 3 a quarter, with 10 none; people and robots are refused with all.
const BESIDE_LINE: f32 = 10.0;

/// Gaussian distribution in chromaticity (r, g) = (R, G)/(R + G + B), together with a brightness: light changes
/// brightness more than colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarpetColor {
    /// Mean chromaticity (r, g).
    pub mean: [f32; 2],
    /// Inverse covariance: rr, rg, gg.
    inverse: [f32; 3],
    /// Mean of R + G + B.
    pub brightness: f32,
}

impl CarpetColor {
    /// Learns the most common colour among pixels that probably show carpet.
    pub fn learn(pixels: impl Iterator<Item = [u8; 3]>) -> Self {
        let samples: Vec<([f32; 2], f32)> = pixels.filter_map(chromaticity).collect();
        let mut color = Self { mean: peak(&samples), inverse: [400.0, 0.0, 400.0], brightness: 0.0 };
        for _ in 0..4 {
            color = color.refit(&samples);
        }
        color
    }

    /// Recomputes mean and covariance from the samples within the gate.
    fn refit(self, samples: &[([f32; 2], f32)]) -> Self {
        let (mut count, mut sum, mut squares, mut brightness) = (0.0, [0.0; 2], [0.0; 3], 0.0);
        for &([r, g], total) in samples {
            if self.distance_squared([r, g]) < GATE / 2.0 {
                let (dr, dg) = (r - self.mean[0], g - self.mean[1]);
                count += 1.0;
                sum = [sum[0] + dr, sum[1] + dg];
                squares = [squares[0] + dr * dr, squares[1] + dr * dg, squares[2] + dg * dg];
                brightness += total;
            }
        }
        if count < 10.0 {
            return self;
        }
        let shift = sum.map(|s| s / count);
        let floor = MIN_SIGMA * MIN_SIGMA;
        let [mut rr, mut rg, mut gg] = [
            squares[0] / count - shift[0] * shift[0] + floor,
            squares[1] / count - shift[0] * shift[1],
            squares[2] / count - shift[1] * shift[1] + floor,
        ];
        // A floor or a wall of nearly the same colour must not widen the distribution until it counts as carpet, too.
        let excess = (rr.max(gg) / (MAX_SIGMA * MAX_SIGMA)).max(1.0);
        [rr, rg, gg] = [rr / excess, rg / excess, gg / excess];
        let determinant = rr * gg - rg * rg;
        Self {
            mean: [self.mean[0] + shift[0], self.mean[1] + shift[1]],
            inverse: [gg / determinant, -rg / determinant, rr / determinant],
            brightness: brightness / count,
        }
    }

    fn distance_squared(&self, [r, g]: [f32; 2]) -> f32 {
        let (dr, dg) = (r - self.mean[0], g - self.mean[1]);
        let [rr, rg, gg] = self.inverse;
        rr * dr * dr + 2.0 * rg * dr * dg + gg * dg * dg
    }

    /// Returns whether a chromaticity is that of the carpet.
    pub(super) fn is_near(&self, chroma: [f32; 2]) -> bool {
        self.distance_squared(chroma) < GATE
    }

    /// Returns whether a pixel beside a line may be carpet: not clearly of another colour.
    pub(super) fn may_be_carpet(&self, rgb: [u8; 3]) -> bool {
        chromaticity(rgb).is_some_and(|(chroma, _)| self.distance_squared(chroma) < BESIDE_LINE * GATE)
    }

    /// Returns this colour moved a little towards another, but never far from the learned one.
    pub(super) fn drifted(&self, towards: [f32; 2], learned: &Self) -> Self {
        let moved = |axis: usize| {
            let mean = self.mean[axis] + DRIFT * (towards[axis] - self.mean[axis]);
            mean.clamp(learned.mean[axis] - MAX_DRIFT, learned.mean[axis] + MAX_DRIFT)
        };
        Self { mean: [moved(0), moved(1)], ..*self }
    }

    /// Returns whether a pixel may be a white line: bright for this carpet, and nearly colourless.
    fn may_be_line(&self, rgb: [u8; 3]) -> bool {
        let [low, high] = [rgb.into_iter().min().unwrap_or(0), rgb.into_iter().max().unwrap_or(0)];
        let colourless = u16::from(low) * 4 > u16::from(high) * 3;
        colourless && rgb.iter().map(|&c| f32::from(c)).sum::<f32>() > 1.2 * self.brightness
    }
}

/// Sum of the chromaticities of some pixels, without white lines.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ColorSum {
    /// Number of pixels.
    pub count: f32,
    sum: [f32; 2],
}

impl ColorSum {
    pub fn add(&mut self, rgb: [u8; 3], carpet: &CarpetColor) {
        if carpet.may_be_line(rgb) {
            return;
        }
        // A pixel too dark to have a colour is as far from the carpet's colour as grey is.
        let ([r, g], _) = chromaticity(rgb).unwrap_or(([1.0 / 3.0; 2], 0.0));
        self.count += 1.0;
        self.sum = [self.sum[0] + r, self.sum[1] + g];
    }

    pub fn mean(&self) -> Option<[f32; 2]> {
        (self.count > 0.0).then(|| self.sum.map(|sum| sum / self.count))
    }
}

fn chromaticity([r, g, b]: [u8; 3]) -> Option<([f32; 2], f32)> {
    let sum = u16::from(r) + u16::from(g) + u16::from(b);
    let total = f32::from(sum);
    (sum >= MIN_SUM).then(|| ([f32::from(r) / total, f32::from(g) / total], total))
}

/// Returns the centre of the 3×3 bins with the largest total weight. Robots, shoes and shadows are grey: a colourless
/// pixel counts little, so that the robot's own shoulder in front of the camera is not taken for the carpet.
fn peak(samples: &[([f32; 2], f32)]) -> [f32; 2] {
    const GREY: f32 = 1.0 / 3.0;
    let bin = |value: f32| ((value * BINS as f32) as usize).min(BINS - 1);
    let mut histogram = vec![[0.0_f32; BINS]; BINS];
    for ([r, g], _) in samples {
        histogram[bin(*r)][bin(*g)] += GREY_WEIGHT + (r - GREY).hypot(g - GREY);
    }
    let block = |r: usize, g: usize| -> f32 {
        histogram[r - 1..=r + 1].iter().map(|row| row[g - 1..=g + 1].iter().sum::<f32>()).sum()
    };
    let middles = (1..BINS - 1).flat_map(|r| (1..BINS - 1).map(move |g| (r, g)));
    let best = middles.max_by(|&(r, g), &(s, h)| block(r, g).total_cmp(&block(s, h)));
    let (r, g) = best.unwrap_or((BINS / 3, BINS / 3));
    [r, g].map(|bin| (bin as f32 + 0.5) / BINS as f32)
}
