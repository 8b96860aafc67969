//! Bilinear colours of pictures at sixteen places, in three steps: the places' pixels, the pixels' words, the colours. What is
//! loaded from anywhere is no work for vectors, so that a step of its own, for many places at once, is faster.

use super::{
    Picture,
    lanes::{float, least, rounded},
};
use crate::camera::{LANES, Lanes, Pixels};

/// Parts of a pixel in which places are counted: two channels, each multiplied by so many, fit into one word.
const PARTS: u32 = 256;

/// Bits of a word that hold its first and its third byte.
const EVEN_BYTES: u32 = 0x00ff_00ff;

/// Sixteen places in a picture, and the four pixels around each.
#[derive(Clone, Copy)]
pub(crate) struct Taps {
    /// Numbers of the upper left pixels.
    first: [u32; LANES],
    /// Way to the right of and below the upper left pixel's centre, in [`PARTS`].
    beside: [[u32; LANES]; 2],
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
        Self { first: [0; LANES], beside: [[0; LANES]; 2], upper: [0; LANES], lower: [0; LANES] };

    /// Finds the pixels around places; a place beside the picture, or NaN, counts as one on its edge. Pictures have less than 32,768
    /// columns and rows.
    #[inline(always)]
    pub fn at(picture: &Picture, u: &Lanes, v: &Lanes) -> Self {
        let (right, bottom) =
            (float(picture.width.saturating_sub(1)), float(picture.height.saturating_sub(1)));
        let (mut inside_u, mut inside_v) = ([0.0_f32; LANES], [0.0_f32; LANES]);
        for i in 0..LANES {
            inside_u[i] = if u[i] > 0.0 { least(u[i], right) } else { 0.0 };
            inside_v[i] = if v[i] > 0.0 { least(v[i], bottom) } else { 0.0 };
        }
        Self::inside(picture, &inside_u, &inside_v)
    }

    /// Finds the pixels around places that lie inside the picture.
    #[inline(always)]
    pub fn inside(picture: &Picture, u: &Lanes, v: &Lanes) -> Self {
        let width = picture.width;
        let (last_column, last_row) = (width.max(2) - 2, picture.height.max(2) - 2);
        let mut taps = Self::NONE;
        for i in 0..LANES {
            let (u, v) = (rounded(u[i] * float(PARTS)), rounded(v[i] * float(PARTS)));
            // Of a picture smaller than its camera's, the last pixels.
            let (u, v) = (u.min((last_column + 1) * PARTS), v.min((last_row + 1) * PARTS));
            let (column, row) = ((u / PARTS).min(last_column), (v / PARTS).min(last_row));
            taps.beside[0][i] = u - column * PARTS;
            taps.beside[1][i] = v - row * PARTS;
            taps.first[i] = row * width + column;
        }
        taps
    }

    /// Takes the places of those pixels whose surface is `face`.
    #[inline(always)]
    pub fn take(&mut self, other: &Self, surfaces: &Lanes, face: f32) {
        for (i, &surface) in surfaces.iter().enumerate() {
            let is_taken = surface == face;
            self.first[i] = if is_taken { other.first[i] } else { self.first[i] };
            for axis in 0..2 {
                self.beside[axis][i] = if is_taken { other.beside[axis][i] } else { self.beside[axis][i] };
            }
        }
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
        let (mut red_blue, mut green) = ([0u32; LANES], [0u32; LANES]);
        for i in 0..LANES {
            let [right, below] = [self.beside[0][i], self.beside[1][i]];
            let both = (right * below + PARTS / 2) / PARTS;
            let (upper_right, lower_left) = (right - both, below - both);
            let own = PARTS - right - lower_left;
            // The products of two channels lie side by side: together the shares are 256, so that neither exceeds its half.
            red_blue[i] = own * (a[i] & EVEN_BYTES)
                + upper_right * (b[i] & EVEN_BYTES)
                + lower_left * (c[i] & EVEN_BYTES)
                + both * (d[i] & EVEN_BYTES);
            green[i] = own * (a[i] >> 8 & 255)
                + upper_right * (b[i] >> 8 & 255)
                + lower_left * (c[i] >> 8 & 255)
                + both * (d[i] >> 8 & 255);
        }
        let mut samples = Samples { color: [[0.0; LANES]; 3], shown: [0.0; LANES] };
        for i in 0..LANES {
            samples.color[0][i] = float(red_blue[i] & 0xffff) / float(PARTS);
            samples.color[1][i] = float(green[i]) / float(PARTS);
            samples.color[2][i] = float(red_blue[i] >> 16) / float(PARTS);
            let mask = (a[i] & b[i] & c[i] & d[i]) >> 24;
            samples.shown[i] = if mask == u32::from(Picture::SHOWN) { 1.0 } else { 0.0 };
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Returns the bilinear colour at a place inside a picture.
    fn bilinear(picture: &Picture, u: f64, v: f64) -> [f64; 3] {
        let (column, row) = (u.floor() as u32, v.floor() as u32);
        let (right, below) = (u - f64::from(column), v - f64::from(row));
        let pixel = |u: u32, v: u32| {
            let index = v.min(picture.height - 1) * picture.width + u.min(picture.width - 1);
            picture.pixels[index as usize].to_le_bytes().map(f64::from)
        };
        std::array::from_fn(|channel| {
            (1.0 - right) * (1.0 - below) * pixel(column, row)[channel]
                + right * (1.0 - below) * pixel(column + 1, row)[channel]
                + (1.0 - right) * below * pixel(column, row + 1)[channel]
                + right * below * pixel(column + 1, row + 1)[channel]
        })
    }

    proptest! {
        /// A place is off by at most half a part along each axis, and the share of the farthest pixel by half a part.
        #[test]
        fn colors_are_bilinear_up_to_the_parts_of_a_pixel(
            pixels in prop::collection::vec(any::<[u8; 3]>(), 5 * 4),
            places in prop::collection::vec((0.0f32..=1.0, 0.0f32..=1.0), LANES),
        ) {
            let words = pixels.iter().map(|[r, g, b]| u32::from_le_bytes([*r, *g, *b, Picture::SHOWN]));
            let picture = Picture { width: 5, height: 4, pixels: words.collect() };
            let u: Lanes = std::array::from_fn(|i| 4.0 * places[i].0);
            let v: Lanes = std::array::from_fn(|i| 3.0 * places[i].1);
            let mut taps = [Taps::inside(&picture, &u, &v)];
            load(&picture, &mut taps);
            let samples = taps[0].samples();
            for i in 0..LANES {
                let exact = bilinear(&picture, f64::from(u[i]), f64::from(v[i]));
                prop_assert_eq!(samples.shown[i], 1.0);
                for (channel, exact) in exact.into_iter().enumerate() {
                    let off = (f64::from(samples.color[channel][i]) - exact).abs();
                    prop_assert!(off <= 4.0 * 0.5 / f64::from(PARTS) * 255.0, "{off} at {} {}", u[i], v[i]);
                }
            }
        }

        #[test]
        fn what_is_interpolated_from_a_hidden_pixel_is_hidden(hidden in 0_usize..12, u in 0.0f32..3.0, v in 0.0f32..2.0) {
            let mut picture = Picture { width: 4, height: 3, pixels: vec![u32::from_le_bytes([9, 9, 9, Picture::SHOWN]); 12] };
            picture.hide(|index| index == hidden);
            let mut taps = [Taps::inside(&picture, &[u; LANES], &[v; LANES])];
            load(&picture, &mut taps);
            let (away_u, away_v) = ((u - (hidden % 4) as f32).abs(), (v - (hidden / 4) as f32).abs());
            // Places count in parts of a pixel.
            let edge = 2.0 / PARTS as f32;
            let shown = taps[0].samples().shown[0];
            if away_u > 1.0 + edge || away_v > 1.0 + edge {
                prop_assert_eq!(shown, 1.0);
            } else if away_u < 1.0 - edge && away_v < 1.0 - edge {
                prop_assert_eq!(shown, 0.0);
            }
        }
    }
}
