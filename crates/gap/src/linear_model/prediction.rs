//! What the model expects of everything that was measured.

use glam::{DVec2, DVec3};
use reality_sim_core::pose::Motion2;
use reality_sim_sensor::Chain;

use crate::{
    measurement::carpet::CarpetBlock,
    measurement::frame::{APERTURE_PX2, FrameCamera, Line},
    measurement::line_profile::LUMA,
    measurement::quantization::rounded_variance,
};

/// Linear values of the scene as the nominal camera records them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NominalReflectance {
    pub(crate) line_linear_rgb: [f64; 3],
    pub(crate) carpet_linear_rgb: [f64; 3],
}

/// What is expected of a piece of line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LineExpectation {
    /// Along the normal from where the line was when it was looked for, pixels: luma, then red and blue against luma.
    pub(crate) offset_px: f64,
    pub(crate) color_offset_px: [f64; 2],
    pub(crate) variance_px2: f64,
    pub(crate) level: Option<[f64; 3]>,
}

/// What is expected of a block of carpet.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BlockExpectation {
    pub(crate) level: [f64; 3],
    /// Mean square of a coefficient of luma, grey levels squared.
    pub(crate) noise: f64,
}

/// The expected measurements of a line. None where the model no longer sees it.
pub(crate) fn line(
    view: &FrameCamera<'_>,
    line: &Line,
    scene: Option<&NominalReflectance>,
) -> Option<LineExpectation> {
    let chain = view.chain;
    let ground = view.curves.get(line.curve)?.at(line.fraction).0;
    let offset =
        |channel: usize| view.project(ground, channel).map(|pixel| line.normal.dot(pixel - line.pixel));
    let green = offset(1)?;
    let (red, blue) = if chain.splits_colors() { (offset(0)?, offset(2)?) } else { (green, green) };
    let share = line.profile.contrast_share;
    let luma = share[0] * red + share[1] * green + share[2] * blue;
    let smear_px = chain.exposure_s() * line.speed_px_s;
    // Colours that are apart make luma broader.
    let apart_px2: f64 =
        share.iter().zip([red, green, blue]).map(|(share, offset)| share * (offset - luma).powi(2)).sum();
    let level = scene.filter(|_| line.profile.level.is_some()).map(|scene| {
        let light = chain.light(view.time_s, line.pixel, Some(ground));
        [0, 1, 2].map(|channel| mean_encoded(chain, scene.line_linear_rgb[channel] * light[channel]))
    });
    Some(LineExpectation {
        offset_px: luma,
        color_offset_px: [red - luma, blue - luma],
        variance_px2: chain.psf_variance_px2(line.pixel)
            + APERTURE_PX2
            + apart_px2
            + smear_px * smear_px / 12.0,
        level,
    })
}

/// The expected measurements of a block of carpet.
pub(crate) fn block(
    view: &FrameCamera<'_>,
    block: &CarpetBlock,
    scene: &NominalReflectance,
    rounding: &Rounding,
) -> BlockExpectation {
    let chain = view.chain;
    let light = chain.light(view.time_s, block.pixel, Some(block.ground));
    let linear = [0, 1, 2].map(|channel| scene.carpet_linear_rgb[channel] * light[channel]);
    let variance: f64 =
        linear.iter().zip(LUMA).map(|(&linear, weight)| (weight * noise_sigma(chain, linear)).powi(2)).sum();
    BlockExpectation {
        level: linear.map(|linear| mean_encoded(chain, linear)),
        noise: rounding.mean_square(variance.sqrt()),
    }
}

/// The mean of encoded values over the noise: three points of Gauss and Hermite.
fn mean_encoded(chain: &Chain, linear: f64) -> f64 {
    let encoded = |linear: f64| chain.encode(chain.respond(linear));
    let spread = (3.0 * chain.noise().variance(linear)).sqrt();
    (4.0 * encoded(linear) + encoded(linear - spread) + encoded(linear + spread)) / 6.0
}

/// Standard deviation of encoded values, grey levels: the chord over one standard deviation to either side.
fn noise_sigma(chain: &Chain, linear: f64) -> f64 {
    let encoded = |linear: f64| chain.encode(chain.respond(linear));
    let sigma = chain.noise().variance(linear).sqrt();
    127.5 * (encoded(linear + sigma) - encoded(linear - sigma))
}

/// What a file's rounding makes of noise, tabulated.
#[derive(Debug, Clone)]
pub(crate) struct Rounding {
    /// Mean square of a coefficient, for each step of the noise's standard deviation.
    table: Vec<f64>,
}

impl Rounding {
    const STEP: f64 = 0.1;
    const COUNT: usize = 400;

    pub(crate) fn new(steps: &[f64]) -> Self {
        let mean = |sigma: f64| {
            let sum: f64 = steps.iter().map(|&step| rounded_variance(sigma, step)).sum();
            // Pixel values are whole numbers in three colours: their rounding adds to luma.
            sum / steps.len().max(1) as f64 + LUMA.map(|weight| weight * weight / 12.0).iter().sum::<f64>()
        };
        Self { table: (0..=Self::COUNT).map(|i| mean((i as f64 * Self::STEP).max(1e-6))).collect() }
    }

    fn mean_square(&self, sigma: f64) -> f64 {
        let place = (sigma / Self::STEP).clamp(0.0, Self::COUNT as f64 - 1e-9);
        let index = place as usize;
        self.table[index] + (place - index as f64) * (self.table[index + 1] - self.table[index])
    }
}

/// The odometry that is expected between two times: forward, left, turn.
pub(crate) fn odometry(view: &FrameCamera<'_>, until_s: f64) -> [f64; 3] {
    let at = |time_s: f64| view.trajectory.at(time_s + view.chain.clock_s()).planar();
    reported(view.chain, at(view.time_s).motion_to(at(until_s)), until_s - view.time_s)
}

/// What the odometry makes of a movement: forward, left, turn.
pub(crate) fn reported(chain: &Chain, motion: Motion2, duration_s: f64) -> [f64; 3] {
    let Motion2 { forward_m, left_m, turn_rad } = chain.odometry(motion, duration_s);
    [forward_m, left_m, turn_rad]
}

/// Change of a ground point's pixel along a normal with the pose: rotations about the axes to the right, down and forward
/// of the heading (radians: pitch, yaw, roll of a level camera), then the position in the world (metres).
pub(crate) fn pose_gradient(view: &FrameCamera<'_>, ground: DVec2, normal: DVec2) -> Option<[f64; 6]> {
    let pose = view.pose;
    let rotation = pose.rotation_world_from_camera();
    let point = rotation.transpose() * (ground.extend(0.0) - pose.position_in_world());
    let (_, [du, dv]) = view.chain.camera().project_with_gradients(point).ok()?;
    let across = normal.x * du + normal.y * dv;
    // Turning the camera by ω moves points in its axes by −ω × p; a · (−ω × p) = ω · (a × p).
    let turn = rotation * across.cross(point);
    let (sin, cos) = pose.yaw_rad.sin_cos();
    let axes = [DVec3::new(sin, -cos, 0.0), DVec3::NEG_Z, DVec3::new(cos, sin, 0.0)];
    let [pitch, yaw, roll] = axes.map(|axis| turn.dot(axis));
    // Moving it by t moves them by −Rᵀ t.
    let shift = -(rotation * across);
    Some([pitch, yaw, roll, shift.x, shift.y, shift.z])
}
