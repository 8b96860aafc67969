//! Bilinear colours of pictures at sixteen places, in three steps: the places' pixels, the pixels' words, the colours. What is
//! loaded from anywhere is no work for vectors, so that a step of its own, for many places at once, is faster.

#![expect(clippy::needless_range_loop, reason = "sixteen lanes in step: the form the compiler vectorises")]

use super::{
    Picture,
    lanes::{at_or_below, float, least},
};
use crate::camera::{LANES, Lanes, Pixels};

/// Sixteen places in a picture, and the four pixels around each.
#[derive(Clone, Copy)]
pub(crate) struct Taps {
    /// Numbers of the upper left pixels.
    first: [u32; LANES],
    /// Parts of a pixel to the right of and below the upper left one's centre.
    beside: [Lanes; 2],
    /// Words of the two upper pixels, the left one in the low half.
    upper: [u64; LANES],
    /// Words of the two lower pixels.
    lower: [u64; LANES],
}

/// Colours at sixteen places.
pub(crate) struct Samples {
    /// Red, green and blue, 0–255.
    pub color: [Lanes; 3],
    /// 1 where the scene is shown, 0 where the picture's mask hides it.
    pub shown: Lanes,
}

/// Returns the bilinear colours of a picture; values at places that are not seen are meaningless.
#[inline(always)]
pub(crate) fn sample(picture: &Picture, pixels: &Pixels) -> Samples {
    let mut taps = [Taps::at(picture, &pixels.u, &pixels.v)];
    load(picture, &mut taps);
    taps[0].samples()
}

impl Taps {
    pub const NONE: Self =
        Self { first: [0; LANES], beside: [[0.0; LANES]; 2], upper: [0; LANES], lower: [0; LANES] };

    /// Finds the pixels around places; a place beside the picture, or NaN, counts as one on its edge.
    #[inline(always)]
    pub fn at(picture: &Picture, u: &Lanes, v: &Lanes) -> Self {
        let width = picture.width;
        let (last_column, last_row) = (width.max(2) - 2, picture.height.max(2) - 2);
        let (right, bottom) = (float(last_column + 1), float(last_row + 1));
        let mut taps = Self::NONE;
        for i in 0..LANES {
            let u = if u[i] > 0.0 { least(u[i], right) } else { 0.0 };
            let v = if v[i] > 0.0 { least(v[i], bottom) } else { 0.0 };
            let (column, row) = (at_or_below(u).min(last_column), at_or_below(v).min(last_row));
            taps.beside[0][i] = u - float(column);
            taps.beside[1][i] = v - float(row);
            taps.first[i] = row * width + column;
        }
        taps
    }

    /// Interpolates.
    #[inline(always)]
    pub fn samples(&self) -> Samples {
        let (mut a, mut b) = ([0u32; LANES], [0u32; LANES]);
        let (mut c, mut d) = ([0u32; LANES], [0u32; LANES]);
        for i in 0..LANES {
            (a[i], b[i]) = (self.upper[i] as u32, (self.upper[i] >> 32) as u32);
            (c[i], d[i]) = (self.lower[i] as u32, (self.lower[i] >> 32) as u32);
        }
        let mut samples = Samples { color: [[0.0; LANES]; 3], shown: [0.0; LANES] };
        for i in 0..LANES {
            let mask = (a[i] & b[i] & c[i] & d[i]) >> 24;
            samples.shown[i] = if mask == u32::from(Picture::SHOWN) { 1.0 } else { 0.0 };
        }
        let mut share = [[0.0_f32; LANES]; 4];
        for i in 0..LANES {
            let [right, below] = [self.beside[0][i], self.beside[1][i]];
            share[3][i] = right * below;
            share[2][i] = below - share[3][i];
            share[1][i] = right - share[3][i];
            share[0][i] = 1.0 - right - share[2][i];
        }
        for channel in 0..3 {
            let shift = 8 * channel as u32;
            for i in 0..LANES {
                samples.color[channel][i] = share[0][i] * float(a[i] >> shift & 255)
                    + share[1][i] * float(b[i] >> shift & 255)
                    + share[2][i] * float(c[i] >> shift & 255)
                    + share[3][i] * float(d[i] >> shift & 255);
            }
        }
        samples
    }
}

/// Loads the words of the pixels around places.
#[inline(never)]
pub(crate) fn load(picture: &Picture, taps: &mut [Taps]) {
    let width = picture.width as usize;
    for Taps { first, upper, lower, .. } in taps {
        for ((&first, upper), lower) in first.iter().zip(upper).zip(lower) {
            let first = first as usize;
            // A picture of one column or row has no second one.
            if let Some(window) = picture.pixels.get(first..first + width + 2) {
                *upper = pair(window[0], window[1]);
                *lower = pair(window[width], window[width + 1]);
            }
        }
    }
}

/// Puts two neighbouring pixels into one number, so that both are loaded at once.
#[inline(always)]
fn pair(left: u32, right: u32) -> u64 {
    u64::from(left) | u64::from(right) << 32
}
