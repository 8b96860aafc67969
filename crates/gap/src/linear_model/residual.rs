//! Measurements of a frame and what a model predicts of each.

use glam::DVec2;
use reality_sim_core::pose::Motion2;

use crate::{
    linear_model::prediction::{self, NominalReflectance, Rounding},
    measurement::frame::{FrameCamera, FrameMeasurements},
    measurement::quantity::{ColorChannel, Quantity},
    measurement::scalar::Measurement,
};

/// The next frame's odometry, as it is in the recording.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    pub(crate) until_s: f64,
    pub(crate) odometry: Motion2,
}

/// What stays the same for all frames.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Context<'a> {
    /// Of the camera's nominal encoding.
    pub(crate) gamma: f64,
    /// None where the camera's file does not tell how bright lines and carpet are.
    pub(crate) scene: Option<&'a NominalReflectance>,
    /// Whether the camera's file says what noise to expect.
    pub(crate) noise: bool,
    /// Whether it says how sharp the picture is.
    pub(crate) sharpness: bool,
}

/// What was measured in a frame, number by number, in the order of [`expected`].
pub(crate) fn measured(
    look: &FrameMeasurements,
    step: Option<Step>,
    context: Context<'_>,
) -> Vec<Measurement> {
    let cos = |ground: DVec2| (look.camera.z / look.camera.distance(ground.extend(0.0))).clamp(0.0, 1.0);
    let mut measurements = Vec::new();
    for line in &look.lines {
        let profile = &line.profile;
        let mut push = |quantity, measured: f64, sigma: f64| {
            measurements.push(Measurement {
                pixel: line.pixel,
                ground: line.ground,
                normal: line.normal,
                speed_px_s: line.speed_px_s,
                half_width_px: line.half_width_px,
                cos_incidence: cos(line.ground),
                ..Measurement::nowhere(quantity, measured, sigma)
            });
        };
        push(Quantity::LineOffset, profile.offset_px, profile.offset_sigma_px);
        push(Quantity::LineBlur, profile.variance_px2, profile.variance_sigma_px2);
        let [red, blue] = profile.color_offset_px.unwrap_or([f64::NAN; 2]);
        push(Quantity::RedOffset, red, 0.0);
        push(Quantity::BlueOffset, blue, 0.0);
        let level = profile.level.unwrap_or([f64::NAN; 3]);
        for (color, level) in ColorChannel::ALL.into_iter().zip(level) {
            push(Quantity::LineLevel(color), log_linear(level, context.gamma), 0.0);
        }
    }
    for block in &look.blocks {
        let mut push = |quantity, measured: f64, sigma: f64| {
            measurements.push(Measurement {
                pixel: block.pixel,
                ground: block.ground,
                cos_incidence: cos(block.ground),
                ..Measurement::nowhere(quantity, measured, sigma)
            });
        };
        for (color, level) in ColorChannel::ALL.into_iter().zip(block.level) {
            push(Quantity::CarpetLevel(color), log_linear(level, context.gamma), 0.0);
        }
        let count = block.coefficients as f64;
        // The logarithm of a mean square of n normal numbers is below that of its expectation by 1/n in the mean.
        push(Quantity::NoiseVariance, (block.energy / count).ln() + 1.0 / count, (2.0 / count).sqrt());
    }
    if let Some(step) = step {
        let Motion2 { forward_m, left_m, turn_rad } = step.odometry;
        for (quantity, measured) in Quantity::ODOMETRY.into_iter().zip([forward_m, left_m, turn_rad]) {
            measurements.push(Measurement::nowhere(quantity, measured, 0.0));
        }
    }
    measurements
}

/// What the model expects of each measurement of [`measured`]; not a number where it expects nothing.
pub(crate) fn expected(
    view: &FrameCamera<'_>,
    look: &FrameMeasurements,
    rounding: &Rounding,
    step: Option<Step>,
    context: Context<'_>,
) -> Vec<f64> {
    let mut values = Vec::new();
    for line in &look.lines {
        let expectation = prediction::line(view, line, context.scene);
        let Some(expectation) = expectation else {
            values.extend([f64::NAN; 7]);
            continue;
        };
        values.push(expectation.offset_px);
        values.push(if context.sharpness { expectation.variance_px2 } else { f64::NAN });
        values.extend(expectation.color_offset_px);
        let level = expectation.level.unwrap_or([f64::NAN; 3]);
        values.extend(level.map(|level| log_linear(level, context.gamma)));
    }
    for block in &look.blocks {
        let Some(scene) = context.scene else {
            values.extend([f64::NAN; 4]);
            continue;
        };
        let expectation = prediction::block(view, block, scene, rounding);
        values.extend(expectation.level.map(|level| log_linear(level, context.gamma)));
        values.push(if context.noise { expectation.noise.ln() } else { f64::NAN });
    }
    if let Some(step) = step {
        values.extend(prediction::odometry(view, step.until_s));
    }
    values
}

/// Natural logarithm of the linear value that the nominal encoding gives this mean value.
fn log_linear(encoded: f64, gamma: f64) -> f64 {
    // The larger of a missing value and a number would be the number.
    if encoded.is_nan() { encoded } else { gamma * encoded.max(1e-3).ln() }
}
