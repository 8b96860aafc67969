//! Where, along the normal of a projected line, the white line really is: the distance model of the paper made
//! sub-pixel.

use glam::DVec2;

use crate::{field::VisibleSample, preprocess::Texture};

/// Step along a profile, pixels.
const STEP_PX: f64 = 0.5;
/// A line measured this much wider or narrower than projected is something else.
const WIDTH_RATIO: std::ops::RangeInclusive<f64> = 0.6..=1.7;

/// Settings of [`measure_offsets`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasureConfig {
    /// Lines are looked for up to this far from where they are projected, pixels.
    pub search_px: f64,
    /// Least difference between line and both flanks, grey levels.
    pub min_contrast: f64,
}

/// A white line found beside a projected one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineOffset {
    /// The projected sample.
    pub visible: VisibleSample,
    /// From the projected to the measured centre, along the sample's normal in the picture, pixels.
    pub offset_px: f64,
    /// Measured width over projected width.
    pub width_ratio: f64,
}

/// Measures every sample whose line is found, both of its edges included.
pub fn measure_offsets(
    texture: &Texture,
    samples: &[VisibleSample],
    config: MeasureConfig,
) -> Vec<LineOffset> {
    let mut profile = Vec::new();
    samples.iter().filter_map(|sample| measure(texture, sample, config, &mut profile)).collect()
}

fn measure(
    texture: &Texture,
    sample: &VisibleSample,
    config: MeasureConfig,
    profile: &mut Vec<f64>,
) -> Option<LineOffset> {
    // Narrower than this, a line is as wide as the lens and the pixels blur it.
    let half_width_px = sample.half_width_px.max(0.6);
    let flank_px = half_width_px.clamp(1.0, 4.0) + 1.0;
    let reach_px = config.search_px + half_width_px + flank_px;
    let steps = (reach_px / STEP_PX).ceil() as i32;
    profile.clear();
    for step in -steps..=steps {
        profile.push(value_at(texture, sample.pixel + f64::from(step) * STEP_PX * sample.normal_in_image)?);
    }
    let place = |index: f64| (index - f64::from(steps)) * STEP_PX;
    let peak = best_match(profile, half_width_px / STEP_PX, flank_px / STEP_PX, config.min_contrast)?;
    let (left, right) = edges(profile, peak, half_width_px / STEP_PX, flank_px / STEP_PX)?;
    let offset_px = 0.5 * (place(left) + place(right));
    let width_ratio = (place(right) - place(left)) / (2.0 * half_width_px);
    // A thin line's width is the blur's, not the line's.
    let width_fits = WIDTH_RATIO.contains(&width_ratio) || half_width_px < 1.5 && width_ratio < 3.0;
    (offset_px.abs() <= config.search_px && width_fits).then_some(LineOffset {
        visible: *sample,
        offset_px,
        width_ratio,
    })
}

fn value_at(texture: &Texture, pixel: DVec2) -> Option<f64> {
    let inside = pixel.x >= 0.0
        && pixel.y >= 0.0
        && pixel.x <= f64::from(texture.width) - 1.0
        && pixel.y <= f64::from(texture.height) - 1.0;
    inside.then(|| f64::from(texture.sample(pixel.x as f32, pixel.y as f32)))
}

fn mean(profile: &[f64], from: f64, to: f64) -> Option<f64> {
    let (first, last) = (from.round().max(0.0) as usize, to.round() as usize);
    let values = profile.get(first..=last)?;
    Some(values.iter().sum::<f64>() / values.len() as f64)
}

/// The index around which a bright bar stands out most from the brighter of its flanks.
fn best_match(profile: &[f64], half_width: f64, flank: f64, min_contrast: f64) -> Option<usize> {
    let margin = (half_width + flank).ceil() as usize;
    let middle = profile.len() / 2;
    let mut best = None;
    let mut best_score = min_contrast;
    for index in margin..profile.len().saturating_sub(margin) {
        let centre = index as f64;
        let inside = mean(profile, centre - 0.7 * half_width, centre + 0.7 * half_width)?;
        let left = mean(profile, centre - half_width - flank, centre - half_width - 0.3 * flank)?;
        let right = mean(profile, centre + half_width + 0.3 * flank, centre + half_width + flank)?;
        // Of two bars alike the nearer one is the line.
        let nearness = 1.0 - 0.3 * index.abs_diff(middle) as f64 / middle as f64;
        let contrast = inside - left.max(right);
        if contrast > min_contrast && contrast * nearness > best_score {
            (best, best_score) = (Some(index), contrast * nearness);
        }
    }
    best
}

/// Where the profile crosses half height on both sides of a bar, in steps.
fn edges(profile: &[f64], peak: usize, half_width: f64, flank: f64) -> Option<(f64, f64)> {
    let centre = peak as f64;
    let inside = mean(profile, centre - 0.5 * half_width, centre + 0.5 * half_width)?;
    let left = mean(profile, centre - half_width - flank, centre - half_width - 0.3 * flank)?;
    let right = mean(profile, centre + half_width + 0.3 * flank, centre + half_width + flank)?;
    let reach = (half_width + flank).ceil() as usize;
    let crossing = |from: usize, to: usize, level: f64| {
        let (high, low) = (profile[from], profile[to]);
        (high >= level && low < level).then(|| (high - level) / (high - low))
    };
    let below = (0..reach).find_map(|i| {
        let (from, to) = (peak.checked_sub(i)?, peak.checked_sub(i + 1)?);
        Some(from as f64 - crossing(from, to, 0.5 * (inside + left))?)
    })?;
    let above = (0..reach).find_map(|i| {
        let (from, to) = (peak + i, peak + i + 1);
        (to < profile.len()).then_some(())?;
        Some(from as f64 + crossing(from, to, 0.5 * (inside + right))?)
    })?;
    Some((below, above))
}

#[cfg(test)]
mod tests {
    use image::{GrayImage, Luma};
    use proptest::prelude::*;

    use super::*;
    use crate::field::LineSample;

    /// A bright vertical bar with its centre at a fraction of a pixel, each pixel the exact share it is covered.
    fn bar(centre: f64, width: f64) -> Texture {
        let covered = |u: f64| {
            ((u + 0.5).min(centre + width / 2.0) - (u - 0.5).max(centre - width / 2.0)).clamp(0.0, 1.0)
        };
        Texture::pack(&GrayImage::from_fn(80, 20, |u, _| {
            Luma([(40.0 + 180.0 * covered(f64::from(u))).round() as u8])
        }))
    }

    fn sample(u: f64, width: f64) -> VisibleSample {
        let sample = LineSample {
            point_in_world: DVec2::ZERO,
            tangent_in_world: DVec2::Y,
            length_m: 0.1,
            clearance_m: 1.0,
            curve: 0,
        };
        VisibleSample {
            sample,
            pixel: DVec2::new(u, 10.0),
            normal_in_image: DVec2::X,
            half_width_px: width / 2.0,
        }
    }

    proptest! {
        #[test]
        fn offsets_are_measured_to_a_small_fraction_of_a_pixel(centre in 36.0..44.0_f64, width in 2.0..8.0_f64, shift in -4.0..4.0_f64) {
            let config = MeasureConfig { search_px: 6.0, min_contrast: 50.0 };
            let found = measure_offsets(&bar(centre, width), &[sample(centre + shift, width)], config);
            prop_assert_eq!(found.len(), 1);
            prop_assert!((found[0].offset_px + shift).abs() < 0.12, "{} instead of {}", found[0].offset_px, -shift);
        }
    }

    #[test]
    fn what_is_no_line_of_that_width_is_not_measured() {
        let config = MeasureConfig { search_px: 5.0, min_contrast: 50.0 };
        assert!(measure_offsets(&bar(40.0, 20.0), &[sample(40.0, 3.0)], config).is_empty(), "a wall");
        assert!(measure_offsets(&bar(70.0, 4.0), &[sample(40.0, 4.0)], config).is_empty(), "too far away");
        assert!(measure_offsets(&bar(40.0, 4.0), &[sample(2.0, 4.0)], config).is_empty(), "at the edge");
    }
}
