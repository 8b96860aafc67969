//! White lines of the pictures, wherever they are, compared with those of the field on the ground.

use glam::DVec2;
use rayon::prelude::*;
use reality_sim_core::{
    field::Curve,
    mount::MountPose,
    pose::CameraPose,
    preprocess::Preprocessor,
    sequence::{Sequence, SequenceError},
};

use super::picture_readings::{Reading, Sample};
use crate::{
    diagnostics::finding::Finding,
    thresholds::{Thresholds, WhiteLineThresholds},
};

const THRESHOLDS: WhiteLineThresholds = Thresholds::DEFAULT.workflow.white_lines;

/// Returns what is wrong with the recording as a whole: its pictures show no line, or not the lines of this field.
pub(super) fn fault(sample: &Sample<'_>) -> Option<Finding> {
    let sequence = sample.recording.sequence;
    let counted = sample.pictures.par_iter().map(|(pose, picture)| (*pose, picture.clone()));
    let white = counted.filter_map(|(pose, picture)| WhitePixels::new(sequence, pose, picture));
    let white = white.reduce_with(WhitePixels::plus)?;
    let [found, expected] = sample.counts(&Reading::as_it_stands(sample.recording));
    white.fault([found, expected], THRESHOLDS.least_pieces * sample.pictures.len() as f64)
}

/// Whether any picture shows a white line on the ground, as far as pitch, roll and height tell where that is.
///
/// # Errors
///
/// Returns an error if a picture that is looked at cannot be read.
pub fn shows_lines(sequence: &Sequence) -> Result<bool, SequenceError> {
    let every = sequence.frames.len().div_ceil(THRESHOLDS.pictures).max(1);
    let counted = (0..sequence.frames.len()).into_par_iter().step_by(every).map(|index| {
        let frame = &sequence.frames[index];
        let (height_m, ground) = (sequence.setup.mount_height_m, Default::default());
        let pose = CameraPose::new(ground, height_m, frame.pitch_rad, frame.roll_rad);
        Ok(WhitePixels::new(sequence, pose, sequence.load_image(index)?))
    });
    let counted = counted.collect::<Result<Vec<_>, SequenceError>>()?;
    let white = counted.into_iter().flatten().reduce(WhitePixels::plus);
    Ok(white.is_none_or(|white| white.are_any()))
}

/// Numbers of pixels.
#[derive(Debug, Clone, Copy, Default)]
struct WhitePixels {
    /// All pixels.
    all: f64,
    /// White pixels inside the border of the field.
    white: f64,
    /// White pixels on the ground near the camera.
    on_ground: f64,
    /// Those of them that lie near a line of the field.
    near_line: f64,
}

impl WhitePixels {
    /// Counts the pixels of a picture. None for a pose from which no ground is seen.
    fn new(sequence: &Sequence, pose: CameraPose, picture: image::RgbImage) -> Option<Self> {
        if !pose.is_finite() || pose.height_m <= 0.0 {
            return None;
        }
        let (camera, field) = (&sequence.setup.camera, &sequence.field);
        let prepared = Preprocessor::new(camera, field.line_width_m).prepare(picture, MountPose::of(pose));
        let curves = field.curves();
        let evidence = prepared.evidence();
        let mut pixels = Self { all: evidence.len() as f64, ..Self::default() };
        for (u, v, _) in evidence.enumerate_pixels().filter(|(_, _, value)| value.0[0] > 0) {
            pixels.white += 1.0;
            let pixel = DVec2::new(f64::from(u), f64::from(v));
            let Ok(ground) = camera.unproject_to_ground(pose, pixel) else { continue };
            let away_m = ground.distance(pose.planar().position_in_world());
            if away_m <= THRESHOLDS.farthest_heights * pose.height_m {
                pixels.on_ground += 1.0;
                let near_m = 0.5 * field.line_width_m + tolerance_m(away_m, pose.height_m);
                pixels.near_line += f64::from(is_near(&curves, ground, near_m));
            }
        }
        Some(pixels)
    }

    fn plus(self, other: Self) -> Self {
        Self {
            all: self.all + other.all,
            white: self.white + other.white,
            on_ground: self.on_ground + other.on_ground,
            near_line: self.near_line + other.near_line,
        }
    }

    /// Whether there are more white pixels than a few.
    fn are_any(&self) -> bool {
        self.white >= THRESHOLDS.least_white * self.all
    }

    /// Returns what these pixels say of the recording, with the pieces of line that are found and expected.
    fn fault(&self, [found, expected]: [f64; 2], least_expected: f64) -> Option<Finding> {
        if !self.are_any() {
            return (found <= THRESHOLDS.found_by_chance * expected).then_some(Finding::NoLines);
        }
        if self.on_ground < THRESHOLDS.least_judged * self.all {
            return None;
        }
        let near = self.near_line / self.on_ground;
        // Where the lines that the field has are found, the camera and the poses are right and the others are foreign.
        let is_aligned = expected < least_expected || found >= THRESHOLDS.aligned * expected;
        let least_near = if is_aligned { THRESHOLDS.least_near_aligned } else { THRESHOLDS.least_near };
        let missed = if expected > 0.0 { 1.0 - found / expected } else { 0.0 };
        (near < least_near).then_some(Finding::ForeignLines { share: 1.0 - near, missed })
    }
}

/// Returns how far from its line on the ground a white pixel may be: an angle of the camera that is off moves it so far.
fn tolerance_m(away_m: f64, height_m: f64) -> f64 {
    let per_rad_m = (away_m * away_m + height_m * height_m) / height_m;
    (THRESHOLDS.tolerance_rad * per_rad_m).min(THRESHOLDS.tolerance_m)
}

fn is_near(curves: &[Curve], ground: DVec2, near_m: f64) -> bool {
    curves.iter().any(|curve| curve.distance_m(ground) <= near_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(white: f64, near: f64) -> WhitePixels {
        WhitePixels { all: 1e5, white, on_ground: white, near_line: near * white }
    }

    fn fault(pixels: WhitePixels, counts: [f64; 2]) -> Option<Finding> {
        pixels.fault(counts, 40.0)
    }

    #[test]
    fn pictures_without_white_pixels_show_no_lines() {
        assert_eq!(fault(pixels(0.0, 0.0), [0.0, 700.0]), Some(Finding::NoLines));
        assert_eq!(fault(pixels(0.0, 0.0), [0.0, 0.0]), Some(Finding::NoLines));
        // Faint lines are no white ones, and are found nevertheless.
        assert_eq!(fault(pixels(0.0, 0.0), [300.0, 700.0]), None);
    }

    #[test]
    fn lines_are_foreign_where_the_fields_own_are_found_and_most_others_are_not_on_it() {
        let foreign = |share: f64| 1.0 - share;
        let found = Finding::ForeignLines { share: foreign(0.42), missed: 0.25 };
        assert_eq!(fault(pixels(1e3, 0.42), [600.0, 800.0]), Some(found));
        assert_eq!(fault(pixels(1e3, 0.42), [200.0, 800.0]), None);
        assert_eq!(fault(pixels(1e3, 0.7), [600.0, 800.0]), None);
        assert!(fault(pixels(1e3, 0.1), [30.0, 800.0]).is_some());
    }

    #[test]
    fn a_few_white_pixels_of_a_blurred_picture_are_not_judged() {
        assert_eq!(fault(pixels(15.0, 0.1), [0.0, 800.0]), None);
    }

    #[test]
    fn far_lines_may_be_farther_off() {
        assert!(tolerance_m(0.3, 0.5) < tolerance_m(0.8, 0.5));
        assert_eq!(tolerance_m(5.0, 0.5), THRESHOLDS.tolerance_m);
    }
}
