//! Distance transform: how far every pixel is from the nearest white one, exact up to a radius, first along the rows,
//! then along the columns (Saito and Toriwaki, "New algorithms for Euclidean distance transformation", 1994).

use image::GrayImage;
use rayon::prelude::*;

/// Grey levels per pixel of distance in [`distance_field`].
pub const DISTANCE_UNITS_PER_PX: f32 = 8.0;

/// Maximum distance that is searched, pixels: slightly more than 255 units can hold.
pub const DISTANCE_RADIUS_PX: u8 = 32;

/// Returns the distance of every pixel from the nearest white one, pixels × [`DISTANCE_UNITS_PER_PX`], rounded, clipped
/// at 255.
pub fn distance_field(evidence: &GrayImage) -> GrayImage {
    let (width, height) = evidence.dimensions();
    if width == 0 || height == 0 {
        return evidence.clone();
    }
    let across = distance_rows(evidence);
    let field = distance_columns(&across, width as usize);
    // The buffer holds exactly one value per pixel, as its size requires.
    GrayImage::from_raw(width, height, field).unwrap_or_default()
}

/// Returns the distance of every pixel from the nearest white one in its row, clipped at [`DISTANCE_RADIUS_PX`].
fn distance_rows(evidence: &GrayImage) -> Vec<u8> {
    let width = evidence.width() as usize;
    let mut across = vec![0_u8; evidence.len()];
    across.par_chunks_mut(width).zip(evidence.as_raw().par_chunks(width)).for_each(|(out, row)| {
        let mut since = DISTANCE_RADIUS_PX;
        let mut step = |out: &mut u8, white: u8| {
            since = if white > 0 { 0 } else { (since + 1).min(DISTANCE_RADIUS_PX) };
            *out = since;
        };
        out.iter_mut().zip(row).for_each(|(out, &white)| step(out, white));
        let mut since = DISTANCE_RADIUS_PX;
        for out in out.iter_mut().rev() {
            since = (*out).min((since + 1).min(DISTANCE_RADIUS_PX));
            *out = since;
        }
    });
    across
}

/// Combines the distances along the rows to the smallest distance over each column, in [`DISTANCE_UNITS_PER_PX`].
fn distance_columns(across: &[u8], width: usize) -> Vec<u8> {
    let radius = usize::from(DISTANCE_RADIUS_PX);
    let height = across.len() / width;
    let units: Vec<u8> = (0..=2 * radius * radius)
        .map(|squared| ((squared as f32).sqrt() * DISTANCE_UNITS_PER_PX + 0.5).min(255.0) as u8)
        .collect();
    let squares: Vec<u16> =
        across.iter().map(|&distance| u16::from(distance) * u16::from(distance)).collect();
    let mut field = vec![0_u8; across.len()];
    field.par_chunks_mut(width).enumerate().for_each_init(
        || vec![0_u16; width],
        |nearest, (y, out)| {
            nearest.fill(u16::MAX);
            for other in y.saturating_sub(radius)..(y + radius + 1).min(height) {
                let along = (y.abs_diff(other) * y.abs_diff(other)) as u16;
                for (nearest, &square) in nearest.iter_mut().zip(&squares[other * width..][..width]) {
                    *nearest = (*nearest).min(square + along);
                }
            }
            for (out, &squared) in out.iter_mut().zip(&*nearest) {
                *out = units[usize::from(squared)];
            }
        },
    );
    field
}

#[cfg(test)]
mod tests {
    use image::Luma;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn distances_are_euclidean(white in prop::collection::vec((0_u32..90, 0_u32..70), 0..6)) {
            let evidence =
                GrayImage::from_fn(90, 70, |u, v| Luma([if white.contains(&(u, v)) { 255 } else { 0 }]));
            for (u, v, value) in distance_field(&evidence).enumerate_pixels() {
                let distance = white
                    .iter()
                    .map(|&(x, y)| (f64::from(x) - f64::from(u)).hypot(f64::from(y) - f64::from(v)))
                    .fold(f64::INFINITY, f64::min);
                let expected = (distance * f64::from(DISTANCE_UNITS_PER_PX)).min(255.0);
                prop_assert!((f64::from(value.0[0]) - expected).abs() <= 0.501, "({u}, {v}): {value:?} {expected}");
            }
        }
    }

    #[test]
    fn tiny_pictures_survive() {
        assert_eq!(distance_field(&GrayImage::new(0, 0)).dimensions(), (0, 0));
        assert_eq!(distance_field(&GrayImage::from_pixel(1, 1, Luma([9]))).as_raw(), &[0]);
        assert_eq!(distance_field(&GrayImage::new(1, 3)).as_raw(), &[255; 3]);
    }
}
