//! Profiles of rendered bars.

use glam::DVec2;
use image::{Rgb, RgbImage};
use proptest::prelude::*;

use super::{LinePiece, Profile, fit};
use crate::measurement::luma::LUMA;

const GAMMA: f64 = 2.2;

/// Returns a slanted white bar on green, its middle `offset_px` from that of the picture, with each colour shifted. Every
/// pixel is the mean of 8 × 8 points of a bar blurred by `sigma_px`, summed numerically instead of by the fitted formula.
fn bar(angle_rad: f64, offset_px: f64, half_width_px: f64, sigma_px: f64, shifts_px: [f64; 3]) -> RgbImage {
    let normal = DVec2::from_angle(angle_rad);
    let covered = |across: f64| {
        // Gaussian in 41 equal cells within ± 4 standard deviations. A cell counts by the part of it that the bar covers: by
        // its middle alone, the sides of a bar along a row or column of pixels would be off by up to half a cell.
        let cell_px = 0.2 * sigma_px;
        let (mut sum, mut total) = (0.0, 0.0);
        for step in -20..=20 {
            let z = f64::from(step) * 0.2;
            let weight = (-0.5 * z * z).exp();
            let inside_px = half_width_px - (across + z * sigma_px).abs();
            total += weight;
            sum += weight * (inside_px / cell_px + 0.5).clamp(0.0, 1.0);
        }
        sum / total
    };
    RgbImage::from_fn(60, 60, |u, v| {
        let levels = [(0.04, 0.65), (0.144, 0.667), (0.05, 0.646)];
        let mut value = [0.0; 3];
        for part in 0..64 {
            let place = DVec2::new(
                f64::from(u) + (f64::from(part % 8) - 3.5) / 8.0,
                f64::from(v) + (f64::from(part / 8) - 3.5) / 8.0,
            );
            let across = (place - 30.0).dot(normal) - offset_px;
            for channel in 0..3 {
                let (dark, bright) = levels[channel];
                value[channel] += (dark + (bright - dark) * covered(across - shifts_px[channel])) / 64.0;
            }
        }
        Rgb(value.map(|value| (255.0 * value.powf(1.0 / GAMMA)).round() as u8))
    })
}

fn piece(angle_rad: f64, half_width_px: f64) -> LinePiece {
    let normal = DVec2::from_angle(angle_rad);
    LinePiece { pixel: DVec2::splat(30.0), normal, half_width_px, variance_px2: 0.5 }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn middle_and_blur_of_a_slanted_line_are_measured_to_a_few_hundredths(
        angle_rad in 0.0..6.2_f64,
        offset_px in -3.0..3.0_f64,
        half_width_px in 1.5..6.0_f64,
        sigma_px in 0.3..1.6_f64,
    ) {
        let picture = bar(angle_rad, offset_px, half_width_px, sigma_px, [0.0; 3]);
        let found = fit(&picture, GAMMA, &piece(angle_rad, half_width_px), offset_px + 0.4).unwrap();
        prop_assert!((found.offset_px - offset_px).abs() < 0.03, "{} at {}", found.offset_px, offset_px);
        let variance_px2 = sigma_px * sigma_px + 1.0 / 12.0;
        let tolerance = 0.05 + 0.06 * variance_px2;
        prop_assert!((found.variance_px2 - variance_px2).abs() < tolerance, "{} for {}", found.variance_px2, variance_px2);
    }

    #[test]
    fn each_colour_is_found_where_it_is(
        angle_rad in 0.0..6.2_f64,
        half_width_px in 1.5..5.0_f64,
        red_px in -0.3..0.3_f64,
        blue_px in -0.3..0.3_f64,
    ) {
        let picture = bar(angle_rad, 0.2, half_width_px, 0.6, [red_px, 0.0, blue_px]);
        let found = fit(&picture, GAMMA, &piece(angle_rad, half_width_px), 0.0).unwrap();
        let [red, blue] = found.color_offset_px.unwrap();
        let share = found.contrast_share;
        let luma = share[0] * red_px + share[2] * blue_px;
        prop_assert!((share.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        prop_assert!((red - (red_px - luma)).abs() < 0.05, "{red} for {red_px}");
        prop_assert!((blue - (blue_px - luma)).abs() < 0.05, "{blue} for {blue_px}");
    }
}

/// Returns the picture as a JPEG file stores it: red and blue against luma are averaged over 2 × 2 pixels, and interpolated
/// with weights 3 and 1 along each axis.
fn with_halved_colors(picture: &RgbImage) -> RgbImage {
    let luma =
        |rgb: [u8; 3]| rgb.iter().zip(LUMA).map(|(value, weight)| f64::from(*value) * weight).sum::<f64>();
    let against = |u: u32, v: u32, channel: usize| {
        let rgb = picture.get_pixel(u, v).0;
        f64::from(rgb[channel]) - luma(rgb)
    };
    let half = |column: i64, row: i64, channel: usize| {
        let corner = [column, row].map(|place| 2 * place.clamp(0, 29) as u32);
        let pixels = [(0, 0), (1, 0), (0, 1), (1, 1)];
        pixels.iter().map(|(du, dv)| against(corner[0] + du, corner[1] + dv, channel)).sum::<f64>() / 4.0
    };
    RgbImage::from_fn(60, 60, |u, v| {
        let near = [u, v].map(|place| i64::from(place / 2));
        let next = [u, v].map(|place| i64::from(place / 2) + if place % 2 == 0 { -1 } else { 1 });
        let drawn = |channel: usize| {
            0.5625 * half(near[0], near[1], channel)
                + 0.1875 * (half(next[0], near[1], channel) + half(near[0], next[1], channel))
                + 0.0625 * half(next[0], next[1], channel)
        };
        let luma = luma(picture.get_pixel(u, v).0);
        let (red, blue) = (luma + drawn(0), luma + drawn(2));
        let green = (luma - LUMA[0] * red - LUMA[2] * blue) / LUMA[1];
        Rgb([red, green, blue].map(|value| value.round().clamp(0.0, 255.0) as u8))
    })
}

#[test]
fn colors_kept_at_half_the_resolution_are_where_they_were() {
    for (red_px, blue_px) in [(0.3, -0.3), (-0.3, 0.3)] {
        let pieces: Vec<Profile> = (0..32)
            .filter_map(|step| {
                let angle_rad = 0.2 * f64::from(step);
                let picture = with_halved_colors(&bar(angle_rad, 0.1, 2.0, 0.6, [red_px, 0.0, blue_px]));
                fit(&picture, GAMMA, &piece(angle_rad, 2.0), 0.1)
            })
            .collect();
        let apart = |profile: &Profile| profile.color_offset_px.map(|[red, blue]| red - blue);
        let apart: Vec<f64> = pieces.iter().filter_map(apart).collect();
        let mean = apart.iter().sum::<f64>() / apart.len() as f64;
        assert!(apart.len() > 24, "{}", apart.len());
        assert!((mean / (red_px - blue_px) - 1.0).abs() < 0.03, "{mean}");
    }
}

#[test]
fn the_inner_part_of_a_wide_line_has_its_colour_and_a_thin_one_has_none() {
    let picture = bar(0.4, 0.0, 6.0, 0.5, [0.0; 3]);
    let level = fit(&picture, GAMMA, &piece(0.4, 6.0), 0.0).unwrap().level.unwrap();
    for (level, linear) in level.into_iter().zip([0.65_f64, 0.667, 0.646]) {
        assert!((level - linear.powf(1.0 / GAMMA)).abs() < 0.004);
    }
    let thin = bar(0.4, 0.0, 1.0, 0.5, [0.0; 3]);
    assert_eq!(fit(&thin, GAMMA, &piece(0.4, 1.0), 0.0).unwrap().level, None);
}

#[test]
fn a_line_that_is_cut_off_at_white_has_its_middle_and_no_blur() {
    let mut picture = bar(0.7, 1.3, 4.0, 1.2, [0.0; 3]);
    assert!(fit(&picture, GAMMA, &piece(0.7, 4.0), 1.3).unwrap().variance_px2.is_finite());
    // More light, of which the file keeps what is below white.
    picture.pixels_mut().for_each(|pixel| pixel.0 = pixel.0.map(|value| value.saturating_add(value / 2)));
    let profile = fit(&picture, GAMMA, &piece(0.7, 4.0), 1.3).unwrap();
    assert!((profile.offset_px - 1.3).abs() < 0.05, "{}", profile.offset_px);
    assert!(profile.variance_px2.is_nan(), "{}", profile.variance_px2);
}

#[test]
fn plain_carpet_is_no_line() {
    let picture = RgbImage::from_pixel(60, 60, Rgb([60, 105, 65]));
    assert_eq!(fit(&picture, GAMMA, &piece(0.4, 2.0), 0.0), None);
}

#[test]
fn a_piece_at_the_rim_is_not_measured() {
    let picture = bar(0.4, 0.0, 2.0, 0.5, [0.0; 3]);
    let at_rim = LinePiece { pixel: DVec2::new(2.0, 30.0), ..piece(0.4, 2.0) };
    assert_eq!(fit(&picture, GAMMA, &at_rim, 0.0), None);
}
