//! Prediction of measurements by a model.
//!
//! [`Predictor::predict`] predicts all quantities of a piece of line or of a block of carpet at once and picks that of each
//! measurement. It assumes no order of the measurements.

use reality_sim_core::pose::Motion2;
use reality_sim_sensor::Chain;

use crate::{
    linear_model::rounding::Rounding,
    measurement::{
        camera::FrameCamera,
        carpet::CarpetBlock,
        frame::{FrameMeasurements, log_linear},
        lines::{APERTURE_PX2, Line},
        luma::LUMA,
        quantity::{ColorChannel, Quantity},
        scalar::{Measurement, Subject, component},
    },
    recording::NominalReflectance,
};

/// Nominal values that the camera's file gives.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nominal<'a> {
    /// Exponent of the camera's nominal encoding.
    pub(crate) gamma: f64,
    /// Reflectance of lines and carpet, if it is given.
    pub(crate) reflectance: Option<&'a NominalReflectance>,
    /// Whether the sensor's noise is given.
    pub(crate) noise: bool,
    /// Whether the width of the point spread function is given.
    pub(crate) sharpness: bool,
}

/// Predicts the measurements of one frame.
pub(crate) struct Predictor<'a> {
    pub(crate) camera: FrameCamera<'a>,
    pub(crate) frame: &'a FrameMeasurements,
    pub(crate) rounding: &'a Rounding,
    /// Time at which the odometry's step ends, where there is one.
    pub(crate) step_until_s: Option<f64>,
    pub(crate) nominal: Nominal<'a>,
}

impl Predictor<'_> {
    /// Returns the predicted value of each measurement, in the given order; not a number if the model predicts none.
    pub(crate) fn predict(&self, measurements: &[Measurement]) -> Vec<f64> {
        let mut predicted = Vec::with_capacity(measurements.len());
        for of_one in measurements.chunk_by(|one, next| one.subject == next.subject) {
            let prediction = self.subject(of_one[0].subject);
            predicted.extend(of_one.iter().map(|measurement| self.value(&prediction, measurement.quantity)));
        }
        predicted
    }

    fn subject(&self, subject: Subject) -> Prediction {
        match subject {
            Subject::Line(index) => self.line(&self.frame.lines[index]).map(Prediction::Line),
            Subject::Carpet(index) => self.block(&self.frame.blocks[index]).map(Prediction::Carpet),
            Subject::OdometryStep => self.step().map(Prediction::OdometryStep),
            Subject::Attitude => Some(Prediction::Attitude(self.attitude())),
        }
        .unwrap_or(Prediction::None)
    }

    /// Returns the prediction of one quantity of a subject.
    fn value(&self, prediction: &Prediction, quantity: Quantity) -> f64 {
        let log_level = |level: f64| log_linear(level, self.nominal.gamma);
        match (prediction, quantity) {
            (Prediction::Line(line), Quantity::LineOffset) => line.offset_px,
            (Prediction::Line(line), Quantity::LineBlur) if self.nominal.sharpness => line.variance_px2,
            (Prediction::Line(line), Quantity::RedOffset) => line.red_offset_px,
            (Prediction::Line(line), Quantity::BlueOffset) => line.blue_offset_px,
            (Prediction::Line(line), Quantity::LineLevel(color)) => {
                line.level.map_or(f64::NAN, |level| log_level(level[color as usize]))
            }
            (Prediction::Carpet(block), Quantity::CarpetLevel(color)) => {
                log_level(block.level[color as usize])
            }
            (Prediction::Carpet(block), Quantity::NoiseVariance) if self.nominal.noise => block.noise.ln(),
            (Prediction::OdometryStep(step), quantity) => component(*step, quantity),
            (Prediction::Attitude([pitch_rad, _]), Quantity::StatedPitch) => *pitch_rad,
            (Prediction::Attitude([_, roll_rad]), Quantity::StatedRoll) => *roll_rad,
            _ => f64::NAN,
        }
    }

    /// Predicts a piece of line. None if the model does not show it in the picture.
    fn line(&self, line: &Line) -> Option<LinePrediction> {
        let chain = self.camera.chain;
        let ground = self.camera.curve(line.curve)?.at(line.fraction).0;
        let offset = |channel: ColorChannel| {
            self.camera.project(ground, channel).map(|pixel| line.normal.dot(pixel - line.pixel))
        };
        let green = offset(ColorChannel::Green)?;
        let (red, blue) = if chain.splits_colors() {
            (offset(ColorChannel::Red)?, offset(ColorChannel::Blue)?)
        } else {
            (green, green)
        };
        let share = line.profile.contrast_share;
        let luma = share[0] * red + share[1] * green + share[2] * blue;
        let smear_px = chain.exposure_s() * line.speed_px_s;
        // The scatter of the colours' offsets about their mean widens the profile in luma.
        let apart_px2: f64 =
            share.iter().zip([red, green, blue]).map(|(share, offset)| share * (offset - luma).powi(2)).sum();
        let reflectance = self.nominal.reflectance.filter(|_| line.profile.level.is_some());
        let level = reflectance.map(|reflectance| {
            let light = chain.light(self.camera.time_s, line.pixel, Some(ground));
            [0, 1, 2]
                .map(|channel| mean_encoded(chain, reflectance.line_linear_rgb[channel] * light[channel]))
        });
        Some(LinePrediction {
            offset_px: luma,
            red_offset_px: red - luma,
            blue_offset_px: blue - luma,
            variance_px2: chain.psf_variance_px2(line.pixel)
                + APERTURE_PX2
                + apart_px2
                + smear_px * smear_px / 12.0,
            level,
        })
    }

    /// Predicts a block of carpet. None if the camera's file does not give the reflectance of carpet.
    fn block(&self, block: &CarpetBlock) -> Option<CarpetPrediction> {
        let reflectance = self.nominal.reflectance?;
        let chain = self.camera.chain;
        let light = chain.light(self.camera.time_s, block.pixel, Some(block.ground));
        let linear = [0, 1, 2].map(|channel| reflectance.carpet_linear_rgb[channel] * light[channel]);
        let variances =
            linear.iter().zip(LUMA).map(|(&linear, weight)| (weight * noise_sigma(chain, linear)).powi(2));
        let variance: f64 = variances.sum();
        Some(CarpetPrediction {
            level: linear.map(|linear| mean_encoded(chain, linear)),
            noise: self.rounding.mean_square(variance.sqrt()),
        })
    }

    /// Predicts the odometry's report of the motion to the next frame, from the reference trajectory.
    fn step(&self) -> Option<Motion2> {
        let until_s = self.step_until_s?;
        let FrameCamera { chain, trajectory, time_s, .. } = self.camera;
        let delay_s = chain.odometry_delay_s() - chain.clock_s();
        let at = |time_s: f64| trajectory.at(time_s - delay_s).planar();
        Some(chain.odometry(at(time_s).motion_to(at(until_s)), until_s - time_s))
    }

    /// Predicts pitch and roll by joints and IMU, from the reference trajectory.
    fn attitude(&self) -> [f64; 2] {
        let FrameCamera { chain, trajectory, time_s, .. } = self.camera;
        let pose = trajectory.at(time_s + chain.clock_s() - chain.attitude_delay_s());
        [pose.pitch_rad, pose.roll_rad]
    }
}

/// Prediction of all quantities of one subject.
enum Prediction {
    Line(LinePrediction),
    Carpet(CarpetPrediction),
    OdometryStep(Motion2),
    /// Pitch and roll, radians.
    Attitude([f64; 2]),
    /// Nothing is predicted.
    None,
}

/// Predicted quantities of a piece of line. Offsets are along the normal.
struct LinePrediction {
    /// Offset in luma from the pixel at which the line was searched, pixels.
    offset_px: f64,
    /// Offset in red against luma, pixels.
    red_offset_px: f64,
    /// Offset in blue against luma, pixels.
    blue_offset_px: f64,
    /// Variance of the blur, pixels squared.
    variance_px2: f64,
    /// Mean encoded values (0–1) by colour channel, if the line's inner part was measured.
    level: Option<[f64; 3]>,
}

/// Predicted quantities of a block of carpet.
struct CarpetPrediction {
    /// Mean encoded values (0–1) by colour channel.
    level: [f64; 3],
    /// Mean square of a coefficient of luma, grey levels squared.
    noise: f64,
}

/// Returns the mean encoded value over the noise, by Gauss–Hermite quadrature with three nodes.
fn mean_encoded(chain: &Chain, linear: f64) -> f64 {
    let encoded = |linear: f64| chain.encode(chain.respond(linear));
    let spread = (3.0 * chain.noise().variance(linear)).sqrt();
    (4.0 * encoded(linear) + encoded(linear - spread) + encoded(linear + spread)) / 6.0
}

/// Returns the standard deviation of encoded values in grey levels: half the difference between the encoded values one
/// standard deviation above and below.
fn noise_sigma(chain: &Chain, linear: f64) -> f64 {
    let encoded = |linear: f64| chain.encode(chain.respond(linear));
    let sigma = chain.noise().variance(linear).sqrt();
    127.5 * (encoded(linear + sigma) - encoded(linear - sigma))
}
