//! Measured against expected, number by number, each with where and when it was measured.

use glam::DVec2;
use reality_sim_core::pose::Motion2;

use crate::{
    linear_model::prediction::{self, NominalReflectance, Rounding},
    measurement::frame::{FrameCamera, FrameMeasurements},
};

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Channel {
    /// Offset of white lines along their normal, pixels.
    Geometry,
    /// Natural logarithm of lines' and carpet's linear values, for each colour.
    Photometry,
    /// Variance of the blur across a line, pixels squared.
    Sharpness,
    /// Offset of red and blue against luma along a line's normal, pixels.
    Color,
    /// Natural logarithm of the variance of luma on plain carpet.
    Noise,
    /// Increments of the odometry: forward and left in metres, turn in radians.
    Motion,
}

impl Channel {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Geometry, Self::Photometry, Self::Sharpness, Self::Color, Self::Noise, Self::Motion];

    /// As in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Geometry => "geometry",
            Self::Photometry => "photometry",
            Self::Sharpness => "sharpness",
            Self::Color => "color",
            Self::Noise => "noise",
            Self::Motion => "motion",
        }
    }

    /// Unit of its residuals.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Geometry | Self::Color => "px",
            Self::Sharpness => "px2",
            Self::Photometry | Self::Noise => "1",
            Self::Motion => "m or rad",
        }
    }
}

/// Rows of a channel that have one standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Group {
    pub(crate) channel: Channel,
    /// Photometry: 0–2 lines, 3–5 carpet. Colour: 0 red, 1 blue. Motion: 0 forward, 1 left, 2 turn.
    pub(crate) part: u8,
}

/// One number that was measured, and where.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    pub(crate) group: Group,
    /// As compared: measured minus expected is the residual.
    pub(crate) measured: f64,
    /// Standard deviation by the measurement alone.
    pub(crate) sigma: f64,
    pub(crate) pixel: DVec2,
    /// On the ground, world axes, metres.
    pub(crate) ground: DVec2,
    /// Unit vector across the line.
    pub(crate) normal: DVec2,
    /// How fast what is seen moves along the normal, pixels a second.
    pub(crate) speed_px_s: f64,
    /// Half the line's width in the picture, pixels.
    pub(crate) half_width_px: f64,
    /// Cosine of the angle at which the ground is seen, 1 from straight above.
    pub(crate) cos_incidence: f64,
}

impl Row {
    /// Of no place and across no line.
    fn nowhere(group: Group, measured: f64, sigma: f64) -> Self {
        Self {
            group,
            measured,
            sigma,
            pixel: DVec2::ZERO,
            ground: DVec2::ZERO,
            normal: DVec2::ZERO,
            speed_px_s: 0.0,
            half_width_px: 0.0,
            cos_incidence: 1.0,
        }
    }
}

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

/// What was measured in a frame, row by row, in the order of [`expected`].
pub(crate) fn measured(look: &FrameMeasurements, step: Option<Step>, context: Context<'_>) -> Vec<Row> {
    let cos = |ground: DVec2| (look.camera.z / look.camera.distance(ground.extend(0.0))).clamp(0.0, 1.0);
    let mut rows = Vec::new();
    for line in &look.lines {
        let profile = &line.profile;
        let mut push = |channel, part, measured: f64, sigma: f64| {
            let group = Group { channel, part };
            rows.push(Row {
                pixel: line.pixel,
                ground: line.ground,
                normal: line.normal,
                speed_px_s: line.speed_px_s,
                half_width_px: line.half_width_px,
                cos_incidence: cos(line.ground),
                ..Row::nowhere(group, measured, sigma)
            });
        };
        push(Channel::Geometry, 0, profile.offset_px, profile.offset_sigma_px);
        push(Channel::Sharpness, 0, profile.variance_px2, profile.variance_sigma_px2);
        let color = profile.color_offset_px.unwrap_or([f64::NAN; 2]);
        push(Channel::Color, 0, color[0], 0.0);
        push(Channel::Color, 1, color[1], 0.0);
        let level = profile.level.unwrap_or([f64::NAN; 3]);
        for (part, level) in (0..).zip(level) {
            push(Channel::Photometry, part, log_linear(level, context.gamma), 0.0);
        }
    }
    for block in &look.blocks {
        let mut push = |channel, part, measured: f64, sigma: f64| {
            let group = Group { channel, part };
            rows.push(Row {
                pixel: block.pixel,
                ground: block.ground,
                cos_incidence: cos(block.ground),
                ..Row::nowhere(group, measured, sigma)
            });
        };
        for (part, level) in (3..).zip(block.level) {
            push(Channel::Photometry, part, log_linear(level, context.gamma), 0.0);
        }
        let count = block.coefficients as f64;
        // The logarithm of a mean square of n normal numbers is below that of its expectation by 1/n in the mean.
        push(Channel::Noise, 0, (block.energy / count).ln() + 1.0 / count, (2.0 / count).sqrt());
    }
    if let Some(step) = step {
        let Motion2 { forward_m, left_m, turn_rad } = step.odometry;
        for (part, measured) in (0..).zip([forward_m, left_m, turn_rad]) {
            let group = Group { channel: Channel::Motion, part };
            rows.push(Row::nowhere(group, measured, 0.0));
        }
    }
    rows
}

/// What the model expects of each row of [`measured`]; not a number where it expects nothing.
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
