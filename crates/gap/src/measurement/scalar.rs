//! One scalar measurement with the covariates that models of it depend on.

use glam::DVec2;

use crate::measurement::quantity::Quantity;

/// One measured number, and where it was measured.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measurement {
    pub(crate) quantity: Quantity,
    /// Measured value in the quantity's unit; not a number where the quantity could not be measured.
    pub(crate) measured: f64,
    /// Standard deviation by the measurement alone.
    pub(crate) sigma: f64,
    pub(crate) pixel: DVec2,
    /// Point on the ground, world axes, metres.
    pub(crate) ground: DVec2,
    /// Unit vector across the line.
    pub(crate) normal: DVec2,
    /// Speed along the normal of what is seen, pixels a second.
    pub(crate) speed_px_s: f64,
    /// Half the line's width in the picture, pixels.
    pub(crate) half_width_px: f64,
    /// Cosine of the angle of incidence at which the ground is seen, 1 from straight above.
    pub(crate) cos_incidence: f64,
}

impl Measurement {
    /// A measurement at no place and across no line.
    pub(crate) fn nowhere(quantity: Quantity, measured: f64, sigma: f64) -> Self {
        Self {
            quantity,
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
