//! An 8-bit picture laid out for bilinear look-ups at many random positions.

use image::GrayImage;

/// Picture in which each texel holds its own value and those of its right, lower and lower right neighbours in one
/// 32-bit word, so that a bilinear look-up costs one load instead of four.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    pub(crate) width: u32,
    pub(crate) height: u32,
    texels: Vec<u32>,
}

impl Default for Texture {
    /// Returns a texture of one black pixel.
    fn default() -> Self {
        Self { width: 1, height: 1, texels: vec![0] }
    }
}

impl Texture {
    /// Returns one word per texel, row by row: its own value in the lowest byte, then those of its right, lower and
    /// lower right neighbours. The number of words is padded to a power of two.
    pub fn texels(&self) -> &[u32] {
        &self.texels
    }

    /// Packs a grey picture. Beyond the last column and row the value at the edge is repeated.
    pub fn pack(picture: &GrayImage) -> Self {
        let (width, height) = picture.dimensions();
        let values = picture.as_raw();
        let mut texels = Vec::with_capacity(values.len().next_power_of_two());
        for y in 0..height as usize {
            let row = &values[y * width as usize..][..width as usize];
            let below = &values[(y + 1).min(height as usize - 1) * width as usize..][..width as usize];
            let word =
                |x: usize, right: usize| u32::from_le_bytes([row[x], row[right], below[x], below[right]]);
            texels.extend((0..row.len() - 1).map(|x| word(x, x + 1)));
            texels.push(word(row.len() - 1, row.len() - 1));
        }
        // Padded to a power of two, see `gather`.
        texels.resize(texels.len().next_power_of_two(), 0);
        Self { width, height, texels }
    }

    /// Returns the texels at these indices, row by row; at one beyond the last texel any other one.
    #[inline(always)]
    pub(crate) fn gather<const N: usize>(&self, mut indices: [u32; N]) -> [u32; N] {
        // Every constructor makes at least one texel, and their number a power of two.
        let mask = (self.texels.len() - 1) as u32;
        for index in &mut indices {
            *index &= mask;
        }
        let mut texels = [0; N];
        for (texel, index) in texels.iter_mut().zip(indices) {
            // SAFETY: the mask is the number of texels minus one, or its low bits, and no masked index is larger. With checks, which
            // keep the compiler from loading all lanes by one instruction, scoring takes half as long again (`cargo bench -- scoring`).
            *texel = unsafe { *self.texels.get_unchecked(index as usize) };
        }
        texels
    }

    /// Returns the bilinear value (0–255) at a position in pixels; positions outside are moved to the edge.
    pub fn sample(&self, u: f32, v: f32) -> f32 {
        let u = u.clamp(0.0, (self.width - 1) as f32);
        let v = v.clamp(0.0, (self.height - 1) as f32);
        // Neither is negative: cutting off their fractions is cheaper than rounding down, for which some processors have no instruction.
        let (column, row) = (u as usize, v as usize);
        let texel = self.texels[row * self.width as usize + column];
        let [p00, p10, p01, p11] = texel.to_le_bytes().map(f32::from);
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
    fn gathered_texels_are_those_at_the_indices_and_any_index_is_harmless() {
        for [width, height] in [[1, 1], [7, 5], [64, 32]] {
            let texture =
                Texture::pack(&GrayImage::from_fn(width, height, |u, v| Luma([(3 * u + 7 * v) as u8])));
            let count = texture.texels().len() as u32;
            assert!(count.is_power_of_two());
            for index in 0..count {
                assert_eq!(
                    texture.gather([index, 0]),
                    [texture.texels()[index as usize], texture.texels()[0]]
                );
            }
            for index in [count, u32::MAX, u32::MAX / 3] {
                assert!(texture.texels().contains(&texture.gather([index])[0]));
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
