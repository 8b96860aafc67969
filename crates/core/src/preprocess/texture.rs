//! An 8-bit picture laid out for bilinear look-ups at many random positions.

use image::GrayImage;
use rayon::prelude::*;

/// Picture in which each texel holds its own value and that of its lower neighbour. A texel and the one to its right are four bytes, so
/// that a bilinear look-up costs one load instead of four, and a picture of 640 × 480 pixels takes 600 kB, which fits the cache of a core.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// Row by row, a power of two and one more.
    texels: Vec<[u8; 2]>,
}

impl Default for Texture {
    /// Returns a texture of one black pixel.
    fn default() -> Self {
        Self { width: 1, height: 1, texels: vec![[0; 2]; 2] }
    }
}

impl Texture {
    /// Packs a grey picture. Beyond the last row the value at the edge is repeated.
    pub fn pack(picture: &GrayImage) -> Self {
        let mut texture = Self::default();
        texture.repack(picture);
        texture
    }

    /// Packs another picture. If it has the size of the one before, nothing is allocated: fresh memory costs more than packing does.
    pub fn repack(&mut self, picture: &GrayImage) {
        let (width, height) = picture.dimensions();
        let values = picture.as_raw();
        if (self.width, self.height) != (width, height) {
            // Padded to a power of two, and by one more, which is read together with the one at its left, see `gather`.
            let texels = vec![[0; 2]; values.len().next_power_of_two() + 1];
            *self = Self { width, height, texels };
        }
        let row_length = width.max(1) as usize;
        let below = values.get(row_length..).unwrap_or_default();
        let last_row = &values[below.len()..];
        let rows_below = below.par_chunks(row_length).chain(last_row.par_chunks(row_length));
        let rows = self.texels.par_chunks_mut(row_length).zip(values.par_chunks(row_length).zip(rows_below));
        rows.for_each(|(row, (own, below))| {
            for (texel, (&own, &below)) in row.iter_mut().zip(own.iter().zip(below)) {
                *texel = [own, below];
            }
        });
    }

    /// Returns the values at these indices, counted row by row, and those of their lower, right and lower right neighbours, from the lowest
    /// byte to the highest; at an index beyond the last texel any values. Right of the last column are those of the next row's first.
    #[inline(always)]
    pub(crate) fn gather<const N: usize>(&self, mut indices: [u32; N]) -> [u32; N] {
        // Every constructor makes a power of two and one more. A mask without the highest bit keeps indices in half of the bits that an
        // address has, and they are loaded by half as many instructions.
        let mask = (self.texels.len() - 2) as u32 & (u32::MAX >> 1);
        for index in &mut indices {
            *index &= mask;
        }
        let mut values = [0; N];
        for (value, index) in values.iter_mut().zip(indices) {
            // SAFETY: the mask is the number of texels minus two, or its low bits, and no masked index is larger: two texels of two bytes
            // begin there. With checks, which keep the compiler from loading all lanes by one instruction, scoring takes half as long again
            // (`cargo bench -- scoring`).
            let two = unsafe { self.texels.as_ptr().add(index as usize).cast::<[u8; 4]>().read() };
            *value = u32::from_le_bytes(two);
        }
        values
    }

    /// Returns the bilinear value (0–255) at a position in pixels; positions outside are moved to the edge.
    pub fn sample(&self, u: f32, v: f32) -> f32 {
        let u = u.clamp(0.0, (self.width - 1) as f32);
        let v = v.clamp(0.0, (self.height - 1) as f32);
        // Neither is negative: cutting off their fractions is cheaper than rounding down, for which some processors have no instruction.
        let (column, row) = (u as usize, v as usize);
        let first = row * self.width as usize + column;
        let [[p00, p01], [p10, p11]] =
            [self.texels[first], self.texels[first + 1]].map(|texel| texel.map(f32::from));
        let (fu, fv) = (u - column as f32, v - row as f32);
        let (top, bottom) = (p00 + fu * (p10 - p00), p01 + fu * (p11 - p01));
        top + fv * (bottom - top)
    }
}

#[cfg(test)]
mod tests {
    use image::Luma;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn samples_are_bilinear(values in prop::collection::vec(any::<u8>(), 35), u in 0.0..6.0_f32, v in 0.0..4.0_f32) {
            let picture = GrayImage::from_raw(7, 5, values).unwrap();
            let at = |x: f32, y: f32| f32::from(picture.get_pixel((x as u32).min(6), (y as u32).min(4)).0[0]);
            let (x, y) = (u.floor(), v.floor());
            let (fx, fy) = (u - x, v - y);
            let expected = (1.0 - fy) * ((1.0 - fx) * at(x, y) + fx * at(x + 1.0, y))
                + fy * ((1.0 - fx) * at(x, y + 1.0) + fx * at(x + 1.0, y + 1.0));
            prop_assert!((Texture::pack(&picture).sample(u, v) - expected).abs() < 1e-3);
        }
    }

    #[test]
    fn gathered_values_are_those_at_the_indices_and_any_index_is_harmless() {
        for [width, height] in [[1, 1], [7, 5], [64, 32]] {
            let picture = GrayImage::from_fn(width, height, |u, v| Luma([(3 * u + 7 * v) as u8]));
            let texture = Texture::pack(&picture);
            for (index, (u, v)) in (0..height).flat_map(|v| (0..width).map(move |u| (u, v))).enumerate() {
                let value =
                    |right: u32, down: u32| picture.get_pixel(u + right, (v + down).min(height - 1)).0[0];
                let [[own, below, right, below_right], _] =
                    texture.gather([index as u32, 0]).map(u32::to_le_bytes);
                assert_eq!([own, below], [value(0, 0), value(0, 1)]);
                if u + 1 < width {
                    assert_eq!([right, below_right], [value(1, 0), value(1, 1)]);
                }
            }
            for index in [width * height, 2048, u32::MAX, u32::MAX / 3] {
                texture.gather([index]);
            }
        }
        let empty = Texture::pack(&GrayImage::new(0, 0));
        assert_eq!((empty.gather([9]), Texture::default().gather([u32::MAX])), ([0], [0]));
    }

    #[test]
    fn outside_the_edge_is_repeated() {
        let texture = Texture::pack(&GrayImage::from_fn(3, 2, |u, v| Luma([(10 * u + v) as u8])));
        assert_eq!(texture.sample(-5.0, 0.0), 0.0);
        assert_eq!(texture.sample(9.0, 9.0), 21.0);
    }
}
