//! Quantisation of a JPEG file, which limits the noise that can be measured in its picture.

use std::f64::consts::PI;

use statrs::function::erf::erf;

/// Side of a block of the cosine transform, pixels.
pub(crate) const BLOCK: usize = 8;

/// Iterates over the coefficients of a block, as (row, column), in zigzag order (ITU-T T.81, figure 5).
fn zigzag() -> impl Iterator<Item = (usize, usize)> {
    (0..2 * BLOCK - 1).flat_map(|sum| {
        let range = sum.saturating_sub(BLOCK - 1)..=sum.min(BLOCK - 1);
        let diagonal: Vec<_> = range.map(|row| (row, sum - row)).collect();
        let up = sum % 2 == 0;
        (0..diagonal.len()).map(move |i| diagonal[if up { diagonal.len() - 1 - i } else { i }])
    })
}

/// Returns the quantisation steps of the coefficients of luma in grey levels, by row (vertical frequency) and column. Files
/// that are not JPEG have steps of 1, like pixel values.
pub(crate) fn luma_steps(bytes: &[u8]) -> [[f64; BLOCK]; BLOCK] {
    luma_table(bytes).unwrap_or([[1.0; BLOCK]; BLOCK])
}

/// Returns the quantisation table with destination 0, which encoders use for luma (ITU-T T.81, section B.2.4.1). None if the
/// bytes are not a whole JPEG header.
fn luma_table(bytes: &[u8]) -> Option<[[f64; BLOCK]; BLOCK]> {
    let mut rest = bytes.strip_prefix(&[0xFF, 0xD8])?;
    loop {
        let &[0xFF, marker, high, low, ..] = rest else { return None };
        let length = usize::from(u16::from_be_bytes([high, low]));
        let mut body = rest.get(4..2 + length)?;
        if marker == 0xDB {
            while let Some((&kind, tables)) = body.split_first() {
                let wide = kind >> 4 != 0;
                let size = if wide { 2 * BLOCK * BLOCK } else { BLOCK * BLOCK };
                let values = tables.get(..size)?;
                if kind & 0xF == 0 {
                    return Some(in_rows(values, wide));
                }
                body = &tables[size..];
            }
        }
        rest = rest.get(2 + length..)?;
    }
}

/// Arranges a table of 8-bit values, or 16-bit values if `wide`, by row and column.
fn in_rows(values: &[u8], wide: bool) -> [[f64; BLOCK]; BLOCK] {
    let mut table = [[1.0; BLOCK]; BLOCK];
    for (index, (row, column)) in zigzag().enumerate() {
        let step = if wide {
            u16::from_be_bytes([values[2 * index], values[2 * index + 1]])
        } else {
            u16::from(values[index])
        };
        table[row][column] = f64::from(step.max(1));
    }
    table
}

/// Returns the mean square of a normally distributed coefficient after rounding to multiples of a step.
pub(crate) fn rounded_variance(sigma: f64, step: f64) -> f64 {
    if sigma > 2.0 * step {
        // Sheppard's correction.
        return sigma * sigma + step * step / 12.0;
    }
    let beyond = |k: i32| 1.0 - erf((f64::from(k) - 0.5) * step / (sigma * std::f64::consts::SQRT_2));
    // P(|x| rounds to k or more) = erfc((k − ½) step / (√2 σ)); k² = Σ (2j − 1). What is beyond 8.3 σ rounds to nothing.
    let probable = (1..=20).map(|k| (k, beyond(k))).take_while(|(_, beyond)| *beyond > 0.0);
    probable.map(|(k, beyond)| f64::from(2 * k - 1) * beyond).sum::<f64>() * step * step
}

/// Returns the orthonormal basis of the cosine transform (DCT-II), by frequency and position.
pub(crate) fn cosines() -> [[f64; BLOCK]; BLOCK] {
    let mut table = [[0.0; BLOCK]; BLOCK];
    for (frequency, row) in table.iter_mut().enumerate() {
        let scale: f64 = if frequency == 0 { 1.0 / 8.0 } else { 2.0 / 8.0 };
        for (position, value) in row.iter_mut().enumerate() {
            *value = scale.sqrt() * (PI * (position as f64 + 0.5) * frequency as f64 / 8.0).cos();
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use image::{DynamicImage, RgbImage, codecs::jpeg::JpegEncoder};

    use super::*;

    #[test]
    fn the_steps_of_a_file_are_read_from_its_quantisation_table() {
        let mut bytes = Vec::new();
        let picture = DynamicImage::ImageRgb8(RgbImage::new(16, 16));
        picture.write_with_encoder(JpegEncoder::new_with_quality(&mut bytes, 50)).unwrap();
        let steps = luma_steps(&bytes);
        // Quality 50 uses table K.1 of ITU-T T.81: first row, first column, last coefficient.
        assert_eq!(steps[0], [16.0, 11.0, 10.0, 16.0, 24.0, 40.0, 51.0, 61.0]);
        assert_eq!(steps.map(|row| row[0]), [16.0, 12.0, 14.0, 14.0, 18.0, 24.0, 49.0, 72.0]);
        assert_eq!(steps[7][7], 99.0);
    }

    #[test]
    fn a_file_that_is_not_a_whole_jpeg_has_steps_of_one() {
        for bytes in
            [&b""[..], b"\x89PNG", b"\xFF\xD8", b"\xFF\xD8\xFF\xDB\x00\x43\x00", b"\xFF\xD8\xFF\xDB\xFF"]
        {
            assert_eq!(luma_steps(bytes), [[1.0; BLOCK]; BLOCK]);
        }
    }

    #[test]
    fn the_variance_of_rounded_noise_equals_its_numerical_integral() {
        for (sigma, step) in [(0.5, 3.0), (1.0, 1.0), (3.4, 5.0), (3.4, 12.0), (10.0, 4.0)] {
            // Numerical integral of the density over a fine grid.
            let mut expected = 0.0;
            for i in -20_000..=20_000 {
                let z = f64::from(i) * 4e-4;
                let rounded = (z * sigma / step).round() * step;
                expected += rounded * rounded * (-0.5 * z * z).exp() / (2.0 * PI).sqrt() * 4e-4;
            }
            let found = rounded_variance(sigma, step);
            assert!(
                (found - expected).abs() < 1e-3 * expected.max(0.01) + 2e-3,
                "{sigma} {step}: {found}, {expected}"
            );
        }
    }

    #[test]
    fn cosines_are_orthonormal() {
        let table = cosines();
        for i in 0..BLOCK {
            for j in 0..BLOCK {
                let product: f64 = table[i].iter().zip(&table[j]).map(|(a, b)| a * b).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
    }
}
