//! Prediction of measurements by a model.
//!
//! [`Predictor::predict`] predicts each measurement on its own; what those of one piece of line or block of carpet share is
//! predicted once. It assumes no order of the measurements.

use glam::DVec2;
use reality_sim_core::pose::Motion2;
use reality_sim_sensor::{Chain, Stage, Surface};

use crate::{
    linear_model::{mean_reflectance::MeanReflectance, rounding::Rounding},
    measurement::{
        camera::FrameCamera,
        carpet::{CarpetBlock, Spectrum},
        frame::{FrameMeasurements, log_linear},
        lines::{APERTURE_PX2, Line},
        luma::LUMA,
        quantity::{ColorChannel, Quantity},
        scalar::{Measurement, Subject, component},
    },
};

/// Values that predictions start from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nominal {
    /// Exponent of the camera's nominal encoding.
    pub(crate) gamma: f64,
    pub(crate) reflectance: MeanReflectance,
    /// Whether the sensor's noise is given.
    pub(crate) noise: bool,
}

/// Whether an effect of this stage changes the prediction of a quantity.
pub(crate) fn changes(stage: Stage, quantity: Quantity) -> bool {
    match quantity {
        Quantity::LineOffset | Quantity::RedOffset | Quantity::BlueOffset => {
            matches!(stage, Stage::World | Stage::Motion | Stage::Mount | Stage::Lens)
        }
        Quantity::LineBlur => {
            matches!(stage, Stage::World | Stage::Motion | Stage::Mount | Stage::Lens | Stage::Encoding)
        }
        Quantity::LineLevel(_) | Quantity::CarpetLevel(_) => {
            matches!(stage, Stage::World | Stage::Lens | Stage::Exposure | Stage::Sensor | Stage::Encoding)
        }
        // The light is that which was measured, wherever it comes from.
        Quantity::NoiseVariance => matches!(stage, Stage::Sensor | Stage::Encoding),
        Quantity::OdometryForward | Quantity::OdometryLeft | Quantity::OdometryTurn => {
            matches!(stage, Stage::Motion | Stage::Odometry)
        }
        Quantity::StatedPitch | Quantity::StatedRoll => matches!(stage, Stage::Motion | Stage::Odometry),
    }
}

/// Predicts the measurements of one frame.
pub(crate) struct Predictor<'a> {
    pub(crate) camera: FrameCamera<'a>,
    pub(crate) frame: &'a FrameMeasurements,
    pub(crate) rounding: &'a Rounding,
    /// Time at which the odometry's step ends, where there is one.
    pub(crate) step_until_s: Option<f64>,
    pub(crate) nominal: Nominal,
    /// Time by which the clock of odometry, joints and IMU is ahead of the pictures', seconds.
    pub(crate) own_clock_s: f64,
}

impl Predictor<'_> {
    /// Returns the predicted value of each measurement, in the given order; not a number if the model predicts none.
    pub(crate) fn predict(&self, measurements: &[Measurement]) -> Vec<f64> {
        self.predict_where(measurements, |_| true)
    }

    /// Predicts the measurements of some quantities; the others are not a number.
    pub(crate) fn predict_where(
        &self,
        measurements: &[Measurement],
        is_wanted: impl Fn(Quantity) -> bool,
    ) -> Vec<f64> {
        let mut predicted = Vec::with_capacity(measurements.len());
        for of_one in measurements.chunk_by(|one, next| one.subject == next.subject) {
            let mut known = Known::default();
            predicted.extend(of_one.iter().map(|measurement| {
                let is_wanted = is_wanted(measurement.quantity);
                if is_wanted { self.value(measurement, &mut known) } else { f64::NAN }
            }));
        }
        predicted
    }

    /// Predicts one measurement of a subject, of which `known` holds what was predicted before.
    fn value(&self, measurement: &Measurement, known: &mut Known) -> f64 {
        match (measurement.subject, measurement.quantity) {
            (Subject::Line(index), Quantity::LineLevel(color)) => {
                let line = &self.frame.lines[index];
                if line.profile.level.is_none() {
                    return f64::NAN;
                }
                self.log_level(Surface::Line, color, known, line.pixel, line.ground)
            }
            (Subject::Line(index), quantity) => {
                let line = *known.line.get_or_insert_with(|| self.line(&self.frame.lines[index]));
                line.map_or(f64::NAN, |line| match quantity {
                    Quantity::LineOffset => line.offset_px,
                    Quantity::LineBlur => line.variance_px2,
                    Quantity::RedOffset => line.red_offset_px,
                    Quantity::BlueOffset => line.blue_offset_px,
                    _ => f64::NAN,
                })
            }
            (Subject::Carpet(index), Quantity::CarpetLevel(color)) => {
                let block = &self.frame.blocks[index];
                self.log_level(Surface::Carpet, color, known, block.pixel, block.ground)
            }
            (Subject::Carpet(index), Quantity::NoiseVariance) if self.nominal.noise => {
                log_noise(self.camera.chain, self.rounding, &self.frame.blocks[index])
            }
            (Subject::OdometryStep, quantity) => {
                let step = *known.step.get_or_insert_with(|| self.step());
                step.map_or(f64::NAN, |step| component(step, quantity))
            }
            (Subject::Attitude, Quantity::StatedPitch) => self.attitude()[0],
            (Subject::Attitude, Quantity::StatedRoll) => self.attitude()[1],
            _ => f64::NAN,
        }
    }

    /// Predicts the logarithm of the nominally linear value of a surface.
    fn log_level(
        &self,
        surface: Surface,
        color: ColorChannel,
        known: &mut Known,
        pixel: DVec2,
        ground: DVec2,
    ) -> f64 {
        let chain = self.camera.chain;
        let light = known.light.get_or_insert_with(|| chain.light(self.camera.time_s, pixel, Some(ground)));
        let reflectance = match surface {
            Surface::Line => &self.nominal.reflectance.line,
            Surface::Carpet => &self.nominal.reflectance.carpet,
        };
        let light = chain.reflectance(surface) * light[color as usize];
        let linear = reflectance.linear_rgb[color as usize] * light + self.veil(color);
        log_linear(mean_encoded(chain, linear), self.nominal.gamma)
    }

    /// Returns the light that is scattered over the picture, of which the mean has its share already.
    fn veil(&self, color: ColorChannel) -> f64 {
        let share = self.camera.chain.glare();
        if share == 0.0 {
            return 0.0;
        }
        let encoded = self.frame.mean_linear_rgb[color as usize].powf(1.0 / self.nominal.gamma);
        share / (1.0 + share) * self.camera.chain.linear_of(encoded)
    }

    /// Predicts the geometry of a piece of line. None if the model does not show it in the picture.
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
        Some(LinePrediction {
            offset_px: luma,
            red_offset_px: red - luma,
            blue_offset_px: blue - luma,
            variance_px2: chain.encoded_variance_px2(
                chain.psf_variance_px2(line.pixel) + APERTURE_PX2 + apart_px2 + smear_px * smear_px / 12.0,
            ),
        })
    }

    /// Predicts the odometry's report of the motion to the next frame, from the reference trajectory.
    fn step(&self) -> Option<Motion2> {
        let until_s = self.step_until_s?;
        let FrameCamera { chain, trajectory, time_s, .. } = self.camera;
        let delay_s = chain.odometry_delay_s() - chain.clock_s() - self.own_clock_s;
        let at = |time_s: f64| trajectory.at(time_s - delay_s).planar();
        Some(chain.odometry(at(time_s).motion_to(at(until_s)), until_s - time_s))
    }

    /// Predicts pitch and roll by joints and IMU, from the reference trajectory.
    fn attitude(&self) -> [f64; 2] {
        let FrameCamera { chain, trajectory, time_s, .. } = self.camera;
        let pose = trajectory.at(time_s + chain.clock_s() + self.own_clock_s - chain.attitude_delay_s());
        [pose.pitch_rad, pose.roll_rad]
    }
}

/// What was predicted of one subject; None inside where the model predicts nothing.
#[derive(Default)]
struct Known {
    line: Option<Option<LinePrediction>>,
    /// Factors on the light.
    light: Option<[f64; 3]>,
    step: Option<Option<Motion2>>,
}

/// Predicted geometry of a piece of line. Offsets are along the normal.
#[derive(Debug, Clone, Copy)]
struct LinePrediction {
    /// Offset in luma from the pixel at which the line was searched, pixels.
    offset_px: f64,
    /// Offset in red against luma, pixels.
    red_offset_px: f64,
    /// Offset in blue against luma, pixels.
    blue_offset_px: f64,
    /// Variance of the blur, pixels squared.
    variance_px2: f64,
}

/// Nodes and weights of Gauss–Hermite quadrature over a standard normal variable.
const FEW_NODES: [(f64, f64); 3] =
    [(0.0, 2.0 / 3.0), (-1.732_050_807_568_877, 1.0 / 6.0), (1.732_050_807_568_877, 1.0 / 6.0)];
/// The same with more nodes, for noise that reaches below black, where values are clipped.
const MANY_NODES: [(f64, f64); 9] = [
    (0.0, 0.406_349_206_349_206),
    (-1.023_255_663_789_133, 0.244_097_502_894_939),
    (1.023_255_663_789_133, 0.244_097_502_894_939),
    (-2.076_847_978_677_83, 0.049_916_406_765_218),
    (2.076_847_978_677_83, 0.049_916_406_765_218),
    (-3.205_429_002_856_47, 0.002_789_141_321_231),
    (3.205_429_002_856_47, 0.002_789_141_321_231),
    (-4.512_745_863_399_783, 0.000_022_345_844_007_746),
    (4.512_745_863_399_783, 0.000_022_345_844_007_746),
];

/// Returns the mean encoded value over the noise.
fn mean_encoded(chain: &Chain, linear: f64) -> f64 {
    let sigma = chain.noise().variance(linear).sqrt();
    let nodes: &[(f64, f64)] = if sigma < 0.2 * linear { &FEW_NODES } else { &MANY_NODES };
    nodes.iter().map(|(node, weight)| weight * chain.encode(chain.respond(linear + node * sigma))).sum()
}

/// Predicts the logarithm of the mean square of a coefficient of luma on a block of carpet, grey levels squared, for the light
/// that its measured levels tell.
pub(crate) fn log_noise(chain: &Chain, rounding: &Rounding, block: &CarpetBlock) -> f64 {
    let of_color = |(&level, weight): (&f64, f64)| {
        let sigma = noise_sigma(chain, chain.linear_of(level));
        (weight * sigma).powi(2)
    };
    let variance: f64 = block.level.iter().zip(LUMA).map(of_color).sum();
    rounding.mean_square(variance.sqrt() * Spectrum::amplitude(chain)).ln()
}

/// Returns the standard deviation of encoded values in grey levels: half the difference between the encoded values one
/// standard deviation above and below.
fn noise_sigma(chain: &Chain, linear: f64) -> f64 {
    let encoded = |linear: f64| chain.encode(chain.respond(linear));
    let sigma = chain.noise().variance(linear).sqrt();
    127.5 * (encoded(linear + sigma) - encoded(linear - sigma))
}
