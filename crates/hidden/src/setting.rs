//! What a recording is made in: camera, robot, hall, and what the files beside the pictures say of brightness.

use glam::DVec2;
use reality_sim_core::sequence::Photometry;

use crate::{
    blur::PointSpread, carpet::CarpetPlan, jpeg::Storage, log::Errors, nominal::Nominal, trajectory::Gait,
};

/// Distance that the camera keeps inside the lines, metres.
const INSIDE_M: f64 = 0.5;
/// Pictures per second.
const RATE_HZ: f64 = 5.0;

/// Camera, robot and hall before anything is hidden.
#[derive(Debug, Clone)]
pub struct Setting {
    /// Camera and field.
    pub nominal: Nominal,
    /// What the files say of brightness, noise and sharpness.
    pub stated: Photometry,
    /// Point spread of the lens.
    pub psf: PointSpread,
    /// Format of the pictures.
    pub storage: Storage,
    /// Pictures per second.
    pub rate_hz: f64,
    /// The robot's gait.
    pub gait: Gait,
    /// Errors of what is logged.
    pub errors: Errors,
    /// Extent of the path along x and y on either side of the middle, metres.
    pub reach_m: DVec2,
    /// Drawn hall; none is the standard one.
    pub hall: Option<HallPlan>,
}

/// Drawn properties of a hall. Colours are linear.
#[derive(Debug, Clone, PartialEq)]
pub struct HallPlan {
    /// The carpet.
    pub carpet: CarpetPlan,
    /// Size of the spots at which the paint is worn, metres, and standard deviation of its reflectance.
    pub wear: (f64, f64),
    /// Standard deviation of the reflectance from line to line.
    pub line_spread: f64,
    /// Size and depth of the raggedness of the paint's edges, metres.
    pub edges: (f64, f64),
    /// Colour of the lamps, relative to white.
    pub lamp_rgb: [f64; 3],
    /// Height of the ceiling, metres.
    pub ceiling_m: f64,
    /// Colours of the goals at +x and −x.
    pub goal_rgb: [[f64; 3]; 2],
    /// Whether there is a ball.
    pub has_ball: bool,
    /// Number of robots on the field.
    pub robots: u64,
    /// Number of people beside it.
    pub people: u64,
}

impl Setting {
    /// Draws the camera of a small humanoid in an even hall; all nominal values are true.
    pub fn standard(seed: u64, size: [u32; 2]) -> Self {
        let nominal = Nominal::new(seed, size);
        Self {
            stated: nominal.photometry(),
            psf: PointSpread::gaussian(nominal.light.psf_sigma_px),
            storage: Storage::STANDARD,
            rate_hz: RATE_HZ,
            gait: Gait::STANDARD,
            errors: Errors::STANDARD,
            reach_m: DVec2::new(nominal.field.length_m, nominal.field.width_m) / 2.0 - INSIDE_M,
            hall: None,
            nominal,
        }
    }
}
