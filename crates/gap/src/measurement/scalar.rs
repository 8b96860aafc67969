//! One scalar measurement with the covariates that predictions of it depend on.

use glam::DVec2;
use reality_sim_core::pose::Motion2;

use crate::measurement::quantity::Quantity;

/// What a number was measured of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Subject {
    /// A piece of line, by its index in the frame's measurements.
    Line(usize),
    /// A block of carpet, by its index in the frame's measurements.
    Carpet(usize),
    /// The step of the odometry to the next frame.
    OdometryStep,
}

/// One measured number.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measurement {
    pub(crate) subject: Subject,
    pub(crate) quantity: Quantity,
    /// Measured value in the quantity's unit; not a number where it could not be measured.
    pub(crate) measured: f64,
    /// Standard deviation by the measurement alone.
    pub(crate) sigma: f64,
    pub(crate) pixel: DVec2,
    /// Point on the ground, world axes, metres.
    pub(crate) ground: DVec2,
    /// Unit vector across the line.
    pub(crate) normal: DVec2,
    /// Speed along the normal of the line's image, pixels a second.
    pub(crate) speed_px_s: f64,
    /// Half the line's width in the picture, pixels.
    pub(crate) half_width_px: f64,
    /// Cosine of the angle of incidence at which the ground is seen, 1 from straight above.
    pub(crate) cos_incidence: f64,
}

impl Measurement {
    /// A measurement without covariates.
    pub(crate) fn nowhere(subject: Subject, quantity: Quantity, measured: f64, sigma: f64) -> Self {
        Self {
            subject,
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

    /// The three numbers of a step of the odometry.
    pub(crate) fn of_odometry(step: Motion2) -> [Self; 3] {
        Quantity::ODOMETRY
            .map(|quantity| Self::nowhere(Subject::OdometryStep, quantity, component(step, quantity), 0.0))
    }
}

/// The component of a planar motion that a quantity of the odometry stands for; not a number for any other quantity.
pub(crate) fn component(motion: Motion2, quantity: Quantity) -> f64 {
    match quantity {
        Quantity::OdometryForward => motion.forward_m,
        Quantity::OdometryLeft => motion.left_m,
        Quantity::OdometryTurn => motion.turn_rad,
        _ => f64::NAN,
    }
}
