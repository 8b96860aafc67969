//! Measurements of one picture: pieces of white line and blocks of plain carpet.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use image::RgbImage;

use crate::{
    measurement::{
        camera::FrameCamera,
        carpet::{CarpetBlock, Spectrum, measure_carpet},
        curve_index::CurveIndex,
        lines::{ExpectedLine, Line, measure_lines},
        luma::LUMA,
        quantity::{ColorChannel, Quantity},
        quantization::luma_steps,
        scalar::{Measurement, Subject},
    },
    thresholds::{MeasurementThresholds, Thresholds},
};

const THRESHOLDS: MeasurementThresholds = Thresholds::DEFAULT.measurement;

/// Measurements of one picture; by default, there are none.
#[derive(Debug, Clone, Default)]
pub(crate) struct FrameMeasurements {
    /// Projection centre in the world, metres.
    pub(crate) camera_in_world: DVec3,
    pub(crate) lines: Vec<Line>,
    /// Pieces of line that the model predicts in the picture, found or not.
    pub(crate) expected_lines: Vec<ExpectedLine>,
    pub(crate) blocks: Vec<CarpetBlock>,
    /// Quantisation steps of the coefficients in which noise was measured, grey levels.
    pub(crate) noise_steps: Vec<f64>,
    /// Mean over the picture of the nominally linear values of red, green and blue.
    pub(crate) mean_linear_rgb: [f64; 3],
}

/// Pieces of one curve that were found closer together than this are the same piece, pixels: the distance of pieces.
const SAME_PIECE_PX: f64 = Thresholds::DEFAULT.measurement.line.spacing_px;

/// Settings of the measurement of a picture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeasurementConfig {
    /// Largest distance at which lines are searched for from where the model predicts them, pixels.
    pub(crate) search_px: f64,
    /// Exponent of the camera's nominal encoding.
    pub(crate) gamma: f64,
}

/// Measures a picture. `bytes` is its encoded file, of which the quantisation is read.
pub(crate) fn measure_frame(
    camera: &FrameCamera<'_>,
    picture: &RgbImage,
    bytes: &[u8],
    config: MeasurementConfig,
) -> FrameMeasurements {
    let spectrum = Spectrum::new(&luma_steps(bytes));
    let blocks = measure_carpet(camera, picture, &spectrum);
    let (lines, expected_lines) = measure_lines(camera, picture, &blocks, config.search_px, config.gamma);
    FrameMeasurements {
        camera_in_world: camera.pose.position_in_world(),
        lines,
        expected_lines,
        blocks,
        noise_steps: spectrum.steps,
        mean_linear_rgb: mean_linear_rgb(picture, config.gamma),
    }
}

/// Returns the mean over a picture of the nominally linear values of its colours.
fn mean_linear_rgb(picture: &RgbImage, gamma: f64) -> [f64; 3] {
    let linear: Vec<f64> = (0..=u8::MAX).map(|value| (f64::from(value) / 255.0).powf(gamma)).collect();
    let mut sum = [0.0; 3];
    for pixel in picture.pixels() {
        pixel.0.iter().zip(&mut sum).for_each(|(value, sum)| *sum += linear[usize::from(*value)]);
    }
    sum.map(|sum| sum / f64::from(picture.width() * picture.height()).max(1.0))
}

impl FrameMeasurements {
    /// Returns these measurements with the pieces of line that were only found by `other`, the measurements of the same picture
    /// by another model.
    pub(crate) fn with_lines_of(mut self, other: &Self) -> Self {
        let own = self.lines.len();
        for line in &other.lines {
            let is_same = |found: &Line| {
                found.curve == line.curve && found.measured_px().distance(line.measured_px()) < SAME_PIECE_PX
            };
            if !self.lines[..own].iter().any(is_same) {
                self.lines.push(*line);
            }
        }
        self
    }

    /// Returns the number of expected pieces of line, clear of other things, that were not found. Pieces are counted curve by
    /// curve: another model's pieces of a curve stand for these.
    pub(crate) fn lost_lines(&self) -> usize {
        let mut lost: BTreeMap<CurveIndex, i32> = BTreeMap::new();
        for piece in self.expected_lines.iter().filter(|piece| !piece.is_hidden) {
            *lost.entry(piece.curve).or_default() += 1;
        }
        for line in self.lines.iter().filter(|line| line.is_expected) {
            *lost.entry(line.curve).or_default() -= 1;
        }
        lost.into_values().map(|count| count.max(0) as usize).sum()
    }

    /// Returns the scalar measurements: those of each piece of line, then those of each block of carpet.
    pub(crate) fn measurements(&self, gamma: f64) -> Vec<Measurement> {
        let lines =
            (0..).zip(&self.lines).flat_map(|(index, line)| self.of_line(Subject::Line(index), line, gamma));
        let blocks = (0..)
            .zip(&self.blocks)
            .flat_map(|(index, block)| self.of_block(Subject::Carpet(index), block, gamma));
        lines.chain(blocks).collect()
    }

    fn of_line(&self, subject: Subject, line: &Line, gamma: f64) -> [Measurement; 7] {
        let profile = &line.profile;
        let [red, blue] = profile.color_offset_px.unwrap_or([f64::NAN; 2]);
        let level = profile.level.unwrap_or([f64::NAN; 3]).map(|level| log_level(level, gamma));
        let at_line = |quantity, measured, sigma| Measurement {
            pixel: line.pixel,
            ground: line.ground,
            normal: line.normal,
            speed_px_s: line.speed_px_s,
            half_width_px: line.half_width_px,
            cos_incidence: self.cos_incidence(line.ground),
            view_direction: self.view_direction(line.ground),
            ..Measurement::without_covariates(subject, quantity, measured, sigma)
        };
        [
            at_line(Quantity::LineOffset, profile.offset_px, profile.offset_sigma_px),
            at_line(Quantity::LineBlur, profile.variance_px2, profile.variance_sigma_px2),
            at_line(Quantity::RedOffset, red, 0.0),
            at_line(Quantity::BlueOffset, blue, 0.0),
            at_line(Quantity::LineLevel(ColorChannel::Red), level[0], 0.0),
            at_line(Quantity::LineLevel(ColorChannel::Green), level[1], 0.0),
            at_line(Quantity::LineLevel(ColorChannel::Blue), level[2], 0.0),
        ]
    }

    fn of_block(&self, subject: Subject, block: &CarpetBlock, gamma: f64) -> [Measurement; 4] {
        let level = block.level.map(|level| log_level(level, gamma));
        let count = block.coefficients as f64;
        let luma: f64 = block.level.iter().zip(LUMA).map(|(level, weight)| level * weight).sum();
        // The expected logarithm of the mean square of n normal variables is 1/n below the logarithm of their variance.
        let log_variance = if count > 0.0 { (block.energy / count).ln() + 1.0 / count } else { f64::NAN };
        let at_block = |quantity, measured, sigma| Measurement {
            pixel: block.pixel,
            ground: block.ground,
            cos_incidence: self.cos_incidence(block.ground),
            view_direction: self.view_direction(block.ground),
            luma_slope: luma / gamma,
            log_brightness: log_linear(luma, gamma),
            ..Measurement::without_covariates(subject, quantity, measured, sigma)
        };
        [
            at_block(Quantity::CarpetLevel(ColorChannel::Red), level[0], 0.0),
            at_block(Quantity::CarpetLevel(ColorChannel::Green), level[1], 0.0),
            at_block(Quantity::CarpetLevel(ColorChannel::Blue), level[2], 0.0),
            at_block(Quantity::NoiseVariance, log_variance, (2.0 / count).sqrt()),
        ]
    }

    /// Returns the cosine of the angle of incidence at which the camera sees a point on the ground.
    fn cos_incidence(&self, ground: DVec2) -> f64 {
        (self.camera_in_world.z / self.camera_in_world.distance(ground.extend(0.0))).clamp(0.0, 1.0)
    }

    /// Returns the horizontal part of the unit vector from the camera to a point on the ground.
    fn view_direction(&self, ground: DVec2) -> DVec2 {
        (ground.extend(0.0) - self.camera_in_world).normalize_or_zero().truncate()
    }
}

/// Returns [`log_linear`] of a measured level; not a number where it is too dark or too bright to tell the light.
fn log_level(encoded: f64, gamma: f64) -> f64 {
    let [darkest, brightest] = THRESHOLDS.level;
    if (darkest..=brightest).contains(&encoded) { log_linear(encoded, gamma) } else { f64::NAN }
}

/// Returns the natural logarithm of the linear value of a mean encoded value, by the nominal encoding
/// `linear = encoded^gamma`; not a number for a missing value.
pub(crate) fn log_linear(encoded: f64, gamma: f64) -> f64 {
    // `max` ignores missing values.
    if encoded.is_nan() { encoded } else { gamma * encoded.max(1e-3).ln() }
}
