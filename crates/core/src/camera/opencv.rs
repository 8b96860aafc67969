//! OPENCV: Brown, "Close-range camera calibration", 1971, with OpenCV's names and order.

use glam::DVec2;

use super::rim::{PINHOLE_MAX_ANGLE_RAD, last_growing_angle_rad};

/// Maximum number of Newton steps in [`Opencv::undistort`]; a few are enough except beside the rim.
const MAX_STEPS: usize = 100;

/// Maximum error of the distorted point, in focal lengths: a hundred-millionth of a pixel.
const PLACE_TOLERANCE: f64 = 1e-11;

/// Error below which no step is taken, in focal lengths: it would be rounding.
const PLACE_ROUNDING: f64 = 1e-15;

/// Brown–Conrady distortion: `x_d = x (1 + k₁r² + k₂r⁴ + k₃r⁶) + 2 p₁ x y + p₂ (r² + 2x²)`, and y likewise, for x =
/// X/Z, y = Y/Z.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Opencv {
    /// Radial coefficient of r².
    pub k1: f64,
    /// Radial coefficient of r⁴.
    pub k2: f64,
    /// First tangential coefficient.
    pub p1: f64,
    /// Second tangential coefficient.
    pub p2: f64,
    /// Radial coefficient of r⁶.
    pub k3: f64,
}

impl Opencv {
    fn radial(&self, r2: f64) -> f64 {
        1.0 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3))
    }

    /// Derivative of [`Opencv::radial`] with respect to r².
    fn radial_slope(&self, r2: f64) -> f64 {
        self.k1 + r2 * (2.0 * self.k2 + r2 * 3.0 * self.k3)
    }

    /// Returns the first angle at which the distortion stops growing in some direction, below the pinhole's limit.
    pub(super) fn max_angle_rad(&self) -> f64 {
        last_growing_angle_rad(PINHOLE_MAX_ANGLE_RAD, |angle_rad| self.least_determinant(angle_rad.tan()))
    }

    /// Returns the smallest determinant of the distortion's Jacobian on a circle.
    ///
    /// The Jacobian is symmetric and starts as the identity: if the determinant is positive all over a disc, the
    /// Jacobian is positive definite there, and no two points of the disc are mapped to one. With c the cosine between
    /// the point and (p₂, p₁), and τ = r |(p₂, p₁)|, the Jacobian is, along and across the radius, `[[slope + 6τc,
    /// −2τs], [−2τs, radial + 2τc]]`: its determinant is quadratic in c.
    fn least_determinant(&self, radius: f64) -> f64 {
        let r2 = radius * radius;
        let across = self.radial(r2);
        let along = across + 2.0 * r2 * self.radial_slope(r2);
        let tangential = radius * self.p1.hypot(self.p2);
        if tangential == 0.0 {
            return along * across;
        }
        let linear = (2.0 * along + 6.0 * across) * tangential;
        let quadratic = 16.0 * tangential * tangential;
        let cosine = (-linear / (2.0 * quadratic)).clamp(-1.0, 1.0);
        along * across - 0.25 * quadratic + cosine * (linear + cosine * quadratic)
    }

    pub(super) fn distort(&self, p: DVec2) -> DVec2 {
        let r2 = p.length_squared();
        let xy2 = 2.0 * p.x * p.y;
        let tangential = DVec2::new(
            self.p1 * xy2 + self.p2 * (r2 + 2.0 * p.x * p.x),
            self.p1 * (r2 + 2.0 * p.y * p.y) + self.p2 * xy2,
        );
        p * self.radial(r2) + tangential
    }

    /// Returns the gradients of x_d and y_d with respect to (x, y), one per row.
    pub(super) fn distort_gradients(&self, p: DVec2) -> [DVec2; 2] {
        let r2 = p.length_squared();
        let (radial, slope) = (self.radial(r2), self.radial_slope(r2));
        let mixed = 2.0 * p.x * p.y * slope + 2.0 * self.p1 * p.x + 2.0 * self.p2 * p.y;
        [
            DVec2::new(radial + 2.0 * p.x * p.x * slope + 2.0 * self.p1 * p.y + 6.0 * self.p2 * p.x, mixed),
            DVec2::new(mixed, radial + 2.0 * p.y * p.y * slope + 6.0 * self.p1 * p.y + 2.0 * self.p2 * p.x),
        ]
    }

    pub(super) fn parameter_gradients(&self, p: DVec2) -> [DVec2; 5] {
        let r2 = p.length_squared();
        let xy2 = 2.0 * p.x * p.y;
        [
            p * r2,
            p * r2 * r2,
            DVec2::new(xy2, r2 + 2.0 * p.y * p.y),
            DVec2::new(r2 + 2.0 * p.x * p.x, xy2),
            p * r2 * r2 * r2,
        ]
    }

    /// Inverts the distortion by Newton's method inside the valid disc. Each step is shortened until the error falls:
    /// the Jacobian is positive definite there, so some step length always reduces it.
    pub(super) fn undistort(&self, place: DVec2, max_angle_rad: f64) -> Option<DVec2> {
        if !place.length().is_finite() {
            return None;
        }
        let rim = max_angle_rad.tan();
        let error_at = |p: DVec2| self.distort(p) - place;
        let mut p = place.clamp_length_max(rim);
        let mut error = error_at(p);
        for _ in 0..MAX_STEPS {
            if error.length() <= PLACE_ROUNDING * (1.0 + place.length()) {
                break;
            }
            let Some(step) = self.newton_step(p, error) else { break };
            let shortened = (0..40).map(|halvings| (p - step * 0.5_f64.powi(halvings)).clamp_length_max(rim));
            let better =
                shortened.map(|next| (next, error_at(next))).find(|(_, e)| e.length() < error.length());
            let Some((next, next_error)) = better else { break };
            (p, error) = (next, next_error);
        }
        (error.length() <= PLACE_TOLERANCE * (1.0 + place.length())).then_some(p)
    }

    /// Returns the inverse Jacobian times the error.
    fn newton_step(&self, p: DVec2, error: DVec2) -> Option<DVec2> {
        let [dx, dy] = self.distort_gradients(p);
        let determinant = dx.x * dy.y - dx.y * dy.x;
        let step = DVec2::new(error.x * dy.y - error.y * dx.y, error.y * dx.x - error.x * dy.x) / determinant;
        // Beside the rim the determinant vanishes: a step longer than the disc is no better than one across it.
        step.is_finite().then(|| step.clamp_length_max(1.0 + 2.0 * p.length()))
    }
}
