//! A white line's profile in the picture: where its middle is, how sharp its sides are, and where each colour has it.
//!
//! All pixels of a short piece of line are taken at their distance from the line's middle: as the line crosses the
//! grid of pixels at a slant, its side is sampled far finer than by one row of pixels (the slanted edge of ISO 12233).
//! The profile fitted is a bright bar between two flanks in linear light, blurred by a Gaussian, then encoded.

use glam::DVec2;
use image::RgbImage;
use nalgebra::{SMatrix, SVector};
use statrs::function::erf::erf;

/// Weights of luma, ITU-R BT.601.
pub(crate) const LUMA: [f64; 3] = [0.299, 0.587, 0.114];
/// Half the length of the piece of line, pixels.
const HALF_LENGTH_PX: f64 = 2.5;
/// Flank taken beyond the blurred side of the line, pixels.
const FLANK_PX: f64 = 4.0;
/// Standard deviation of the blur by colours kept at half the resolution: pixels in pairs, and between pairs drawn.
const CHROMA_PX: f64 = 0.9;
/// Flank that is left for colours at least, pixels.
const LEAST_FLANK_PX: f64 = 1.5;
/// Steps of Levenberg and Marquardt's method.
const MAX_STEPS: usize = 12;
/// Variances outside this are not those of a line's side, pixels squared; the least is a part of the pixel's own.
const VARIANCE_PX2: std::ops::RangeInclusive<f64> = 0.02..=60.0;
/// A fit is refused where what it leaves is more than this part of the line's contrast.
const MAX_RESIDUAL: f64 = 0.2;

/// A piece of line to look for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinePiece {
    /// Where its middle is expected.
    pub(crate) pixel: DVec2,
    /// Unit vector across it.
    pub(crate) normal: DVec2,
    /// Half its width along the normal, pixels.
    pub(crate) half_width_px: f64,
    /// Variance of the blur that is expected, the pixel's own included, pixels squared.
    pub(crate) variance_px2: f64,
}

/// What was measured of a piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Profile {
    /// From where its middle was expected to where it is, along the normal, pixels.
    pub(crate) offset_px: f64,
    /// Standard deviation of that by the fit alone.
    pub(crate) offset_sigma_px: f64,
    /// Variance of the blur along the normal, the pixel's own included, pixels squared.
    pub(crate) variance_px2: f64,
    /// Standard deviation of that by the fit alone.
    pub(crate) variance_sigma_px2: f64,
    /// Middles of red and blue along the normal against that of luma, pixels.
    pub(crate) color_offset_px: Option<[f64; 2]>,
    /// Part of luma's contrast that each colour has; they add up to 1.
    pub(crate) contrast_share: [f64; 3],
    /// Mean encoded values (0–1) of the line's inner part, where it is wide enough to have one.
    pub(crate) level: Option<[f64; 3]>,
}

/// Finds a piece near where it is expected: `found_px` from there along the normal, by a coarser search.
pub(crate) fn fit(picture: &RgbImage, gamma: f64, piece: &LinePiece, found_px: f64) -> Option<Profile> {
    let samples = samples(picture, piece, found_px)?;
    let bar = fit_bar(&samples, gamma, piece, found_px)?;
    let center = bar.values[0];
    let levels =
        [bar.values[2], bar.values[3], bar.values[4]].map(|linear| linear.max(0.0).powf(1.0 / gamma));
    let contrast = levels[0] - 0.5 * (levels[1] + levels[2]);
    (contrast > 0.02 && bar.residual < MAX_RESIDUAL * contrast).then_some(())?;
    let sharp_px = bar.values[1].sqrt();
    let (color_offset_px, contrast_share) = colors(&samples, center, piece.half_width_px, sharp_px)?;
    Some(Profile {
        offset_px: center,
        offset_sigma_px: bar.sigma[0],
        variance_px2: bar.values[1],
        variance_sigma_px2: bar.sigma[1],
        color_offset_px,
        contrast_share,
        level: inner_level(&samples, center, piece.half_width_px - 2.0 * sharp_px - 1.5),
    })
}

/// A pixel of the piece.
#[derive(Debug, Clone, Copy)]
struct Sample {
    /// From where the line's middle is expected, along the normal, pixels.
    across_px: f64,
    /// Encoded values, 0–1.
    rgb: [f64; 3],
    luma: f64,
}

/// The piece's pixels; none where a part of it is outside the picture.
fn samples(picture: &RgbImage, piece: &LinePiece, found_px: f64) -> Option<Vec<Sample>> {
    let reach = piece.half_width_px + 2.5 * piece.variance_px2.sqrt() + FLANK_PX;
    let middle = piece.pixel + found_px * piece.normal;
    let along = piece.normal.perp();
    let extent = reach * piece.normal.abs() + HALF_LENGTH_PX * along.abs();
    let (from, to) = ((middle - extent).ceil(), (middle + extent).floor());
    let size = DVec2::new(f64::from(picture.width()), f64::from(picture.height()));
    (from.cmpge(DVec2::ZERO).all() && to.cmple(size - 1.0).all()).then_some(())?;
    let mut samples = Vec::with_capacity((4.0 * reach * HALF_LENGTH_PX) as usize + 16);
    for v in from.y as u32..=to.y as u32 {
        for u in from.x as u32..=to.x as u32 {
            let place = DVec2::new(f64::from(u), f64::from(v)) - middle;
            let across = place.dot(piece.normal);
            if across.abs() <= reach && place.dot(along).abs() <= HALF_LENGTH_PX {
                let rgb = picture.get_pixel(u, v).0.map(|value| f64::from(value) / 255.0);
                let luma = rgb.iter().zip(LUMA).map(|(value, weight)| value * weight).sum();
                samples.push(Sample { across_px: across + found_px, rgb, luma });
            }
        }
    }
    Some(samples)
}

/// Middle, variance, and the linear levels of line, flank before and flank after it.
type Values = SVector<f64, 5>;

struct Bar {
    values: Values,
    sigma: Values,
    /// Root mean square of what is left, encoded.
    residual: f64,
}

/// Least squares by Levenberg and Marquardt's method.
fn fit_bar(samples: &[Sample], gamma: f64, piece: &LinePiece, found_px: f64) -> Option<Bar> {
    let mut values = start(samples, gamma, piece, found_px)?;
    let mut damping = 1e-3;
    let mut system = LinearSystem::new(samples, gamma, piece.half_width_px, &values);
    for _ in 0..MAX_STEPS {
        let mut damped = system.normal;
        for i in 0..5 {
            damped[(i, i)] *= 1.0 + damping;
        }
        let step = damped.cholesky()?.solve(&system.gradient);
        let mut next = values + step;
        next[1] = next[1].clamp(*VARIANCE_PX2.start(), *VARIANCE_PX2.end());
        for level in next.iter_mut().skip(2) {
            *level = level.max(1e-5);
        }
        let tried = LinearSystem::new(samples, gamma, piece.half_width_px, &next);
        if tried.squares < system.squares {
            let settled = (next - values).amax() < 1e-4;
            (values, system) = (next, tried);
            damping *= 0.2;
            if settled {
                break;
            }
        } else {
            damping *= 8.0;
            if damping > 1e6 {
                break;
            }
        }
    }
    let degrees = samples.len().checked_sub(5).filter(|&degrees| degrees > 10)? as f64;
    let covariance = system.normal.try_inverse()? * (system.squares / degrees);
    let edge = [*VARIANCE_PX2.start(), *VARIANCE_PX2.end()];
    let inside = edge.iter().all(|edge| (values[1] - edge).abs() > 1e-6);
    let near = (values[0] - found_px).abs() < piece.half_width_px + 2.0;
    (inside && near).then(|| Bar {
        values,
        sigma: covariance.diagonal().map(|variance| variance.max(0.0).sqrt()),
        residual: (system.squares / samples.len() as f64).sqrt(),
    })
}

/// Levels from the samples that lie surely inside and outside.
fn start(samples: &[Sample], gamma: f64, piece: &LinePiece, found_px: f64) -> Option<Values> {
    let mut sums = [(0.0, 0.0); 3];
    let blur = piece.variance_px2.sqrt();
    for sample in samples {
        let across = sample.across_px - found_px;
        let kind = if across.abs() < 0.6 * piece.half_width_px {
            0
        } else if across.abs() > piece.half_width_px + blur {
            1 + usize::from(across > 0.0)
        } else {
            continue;
        };
        sums[kind].0 += sample.luma;
        sums[kind].1 += 1.0;
    }
    let level = |(sum, count): (f64, f64)| (count > 0.0).then(|| (sum / count).max(1e-3).powf(gamma));
    Some(Values::new(
        found_px,
        piece.variance_px2.max(0.1),
        level(sums[0])?,
        level(sums[1])?,
        level(sums[2])?,
    ))
}

/// The normal equations at some values.
struct LinearSystem {
    normal: SMatrix<f64, 5, 5>,
    gradient: Values,
    squares: f64,
}

impl LinearSystem {
    fn new(samples: &[Sample], gamma: f64, half_width_px: f64, values: &Values) -> Self {
        let mut system = Self { normal: SMatrix::zeros(), gradient: Values::zeros(), squares: 0.0 };
        let sigma = values[1].sqrt();
        let (line, before, after) = (values[2], values[3], values[4]);
        for sample in samples {
            let from_middle = sample.across_px - values[0];
            let (low, high) = ((from_middle + half_width_px) / sigma, (from_middle - half_width_px) / sigma);
            let (rise, fall) = (cumulative(low), cumulative(high));
            let (steep_rise, steep_fall) = (density(low), density(high));
            let linear = (before + (line - before) * rise - (line - after) * fall).max(1e-5);
            let encoded = linear.powf(1.0 / gamma);
            let slope = encoded / (gamma * linear);
            let derivatives = slope
                * Values::new(
                    (-(line - before) * steep_rise + (line - after) * steep_fall) / sigma,
                    (-(line - before) * steep_rise * low + (line - after) * steep_fall * high)
                        / (2.0 * values[1]),
                    rise - fall,
                    1.0 - rise,
                    fall,
                );
            let residual = sample.luma - encoded;
            system.normal.ger(1.0, &derivatives, &derivatives, 1.0);
            system.gradient += residual * derivatives;
            system.squares += residual * residual;
        }
        system
    }
}

/// The standard normal distribution.
fn cumulative(z: f64) -> f64 {
    0.5 * (1.0 + erf(z * std::f64::consts::FRAC_1_SQRT_2))
}

fn density(z: f64) -> f64 {
    (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt()
}

/// Middles of red and blue against luma by the centre of mass of what stands out of the flanks, and each colour's part
/// of the contrast. A centre of mass does not mind that a file keeps colours at half the resolution: averaging moves
/// none of it.
fn colors(
    samples: &[Sample],
    center: f64,
    half_width_px: f64,
    sharp_px: f64,
) -> Option<(Option<[f64; 2]>, [f64; 3])> {
    let reach =
        |side: f64| samples.iter().map(|sample| side * (sample.across_px - center)).fold(0.0, f64::max);
    let inner = half_width_px + 2.0 * sharp_px.hypot(CHROMA_PX) + 1.0;
    let inner = inner.min(reach(1.0).min(reach(-1.0)) - LEAST_FLANK_PX);
    let mut flank = [[0.0; 5]; 2];
    for sample in samples {
        let across = sample.across_px - center;
        if across.abs() > inner {
            let sums = &mut flank[usize::from(across > 0.0)];
            add(sums, &with_luma(sample), 1.0);
            sums[4] += 1.0;
        }
    }
    if flank.iter().any(|sums| sums[4] < 3.0) {
        return None;
    }
    let level = flank.map(|sums| [0, 1, 2, 3].map(|channel| sums[channel] / sums[4]));
    let (mut mass, mut moment) = ([0.0; 4], [0.0; 4]);
    let window = inner + 0.5;
    for sample in samples {
        let across = sample.across_px - center;
        if across.abs() <= window {
            // The flank runs from the one side's level to the other's under the line.
            let fraction = 0.5 + 0.5 * across / window;
            for (channel, value) in with_luma(sample).into_iter().enumerate() {
                let stands_out =
                    value - level[0][channel] - fraction * (level[1][channel] - level[0][channel]);
                mass[channel] += stands_out;
                moment[channel] += stands_out * across;
            }
        }
    }
    let total: f64 = (0..3).map(|channel| LUMA[channel] * mass[channel]).sum();
    (total > 0.0).then_some(())?;
    let share = [0, 1, 2].map(|channel| LUMA[channel] * mass[channel] / total);
    let middle = |channel: usize| moment[channel] / mass[channel] - moment[3] / mass[3];
    let clear = (0..3).all(|channel| mass[channel] > 0.3 * total);
    Some((clear.then(|| [middle(0), middle(2)]), share))
}

fn with_luma(sample: &Sample) -> [f64; 4] {
    let [r, g, b] = sample.rgb;
    [r, g, b, sample.luma]
}

fn add(sums: &mut [f64; 5], values: &[f64; 4], weight: f64) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

/// Mean values within some distance of the middle.
fn inner_level(samples: &[Sample], center: f64, within_px: f64) -> Option<[f64; 3]> {
    (within_px > 0.8).then_some(())?;
    let inside = samples.iter().filter(|sample| (sample.across_px - center).abs() < within_px);
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for sample in inside {
        for (sum, value) in sum.iter_mut().zip(sample.rgb) {
            *sum += value;
        }
        count += 1.0;
    }
    (count >= 6.0).then(|| sum.map(|sum| sum / count))
}

#[cfg(test)]
mod tests {
    use image::Rgb;
    use proptest::prelude::*;

    use super::*;

    const GAMMA: f64 = 2.2;

    /// A white bar on green, at a slant, its middle `offset_px` from the picture's; each colour shifted on its own. Every
    /// pixel is the mean of 8 × 8 points of a bar blurred by `sigma_px`: summed up, not by the fitted formula.
    fn bar(
        angle_rad: f64,
        offset_px: f64,
        half_width_px: f64,
        sigma_px: f64,
        shifts_px: [f64; 3],
    ) -> RgbImage {
        let normal = DVec2::from_angle(angle_rad);
        let covered = |across: f64| {
            // The Gaussian as 41 equal steps of ± 4 standard deviations.
            let (mut sum, mut total) = (0.0, 0.0);
            for step in -20..=20 {
                let z = f64::from(step) * 0.2;
                let weight = (-0.5 * z * z).exp();
                total += weight;
                sum += if (across + z * sigma_px).abs() < half_width_px { weight } else { 0.0 };
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

    /// As a JPEG file keeps it: red and blue against luma as means of 2 × 2 pixels, drawn again by weights 3 and 1 along
    /// each axis.
    fn with_halved_colors(picture: &RgbImage) -> RgbImage {
        let luma = |rgb: [u8; 3]| {
            rgb.iter().zip(LUMA).map(|(value, weight)| f64::from(*value) * weight).sum::<f64>()
        };
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
}
