//! Scalar measurements, with the covariates that their predictions depend on.

use glam::DVec2;
use reality_sim_core::pose::Motion2;

use crate::measurement::quantity::Quantity;

/// Subject of a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Subject {
    /// Piece of line, by its index in the frame's measurements.
    Line(usize),
    /// Block of carpet, by its index in the frame's measurements.
    Carpet(usize),
    /// Odometry step to the next frame.
    OdometryStep,
    /// Pitch and roll by joints and IMU.
    Attitude,
}

/// Scalar measurement.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measurement {
    pub(crate) subject: Subject,
    pub(crate) quantity: Quantity,
    /// Measured value in the quantity's unit; not a number if it could not be measured.
    pub(crate) measured: f64,
    /// Standard deviation by the fit of this measurement alone, in the quantity's unit.
    pub(crate) sigma: f64,
    /// Pixel of the predicted position.
    pub(crate) pixel: DVec2,
    /// Point on the ground, world axes, metres.
    pub(crate) ground: DVec2,
    /// Unit vector across the line in the picture.
    pub(crate) normal: DVec2,
    /// Speed of the line's image along the normal, pixels per second.
    pub(crate) speed_px_s: f64,
    /// Half the width of the line in the picture, pixels.
    pub(crate) half_width_px: f64,
    /// Cosine of the angle of incidence at which the ground is seen; 1 from straight above.
    pub(crate) cos_incidence: f64,
    /// Horizontal part of the unit vector from the camera to the point on the ground, world axes.
    pub(crate) view_direction: DVec2,
    /// Derivative of encoded luma (0–1) by the logarithm of the light, by the nominal encoding.
    pub(crate) luma_slope: f64,
    /// Natural logarithm of the linear value of luma, by the nominal encoding.
    pub(crate) log_brightness: f64,
}

impl Measurement {
    /// Creates a measurement whose covariates are all neutral.
    pub(crate) fn without_covariates(
        subject: Subject,
        quantity: Quantity,
        measured: f64,
        sigma: f64,
    ) -> Self {
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
            view_direction: DVec2::ZERO,
            luma_slope: 0.0,
            log_brightness: 0.0,
        }
    }

    /// Returns the two measurements of pitch and roll by joints and IMU, radians.
    pub(crate) fn of_attitude([pitch_rad, roll_rad]: [f64; 2]) -> [Self; 2] {
        let [pitch, roll] = Quantity::STATED;
        [(pitch, pitch_rad), (roll, roll_rad)].map(|(quantity, angle_rad)| {
            Self::without_covariates(Subject::Attitude, quantity, angle_rad, 0.0)
        })
    }

    /// Returns the three measurements of an odometry step.
    pub(crate) fn of_odometry(step: Motion2) -> [Self; 3] {
        Quantity::ODOMETRY.map(|quantity| {
            Self::without_covariates(Subject::OdometryStep, quantity, component(step, quantity), 0.0)
        })
    }
}

/// Returns the component of a planar motion that a quantity of the odometry measures; not a number for other quantities.
pub(crate) fn component(motion: Motion2, quantity: Quantity) -> f64 {
    match quantity {
        Quantity::OdometryForward => motion.forward_m,
        Quantity::OdometryLeft => motion.left_m,
        Quantity::OdometryTurn => motion.turn_rad,
        _ => f64::NAN,
    }
}
