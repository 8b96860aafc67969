//! OPENCV_FISHEYE: Kannala and Brandt, "A generic camera model and calibration method for conventional, wide-angle,
//! and fish-eye lenses", PAMI 2006, with OpenCV's four coefficients.

use glam::{DVec2, DVec3};

use super::rim::last_growing_angle_rad;

/// Maximum number of Newton steps in [`OpencvFisheye::undistort`]; bisection takes over if a step leaves the bracket.
const MAX_STEPS: usize = 100;

/// Largest angle that a fisheye can take, radians: the direction straight back would be seen all around the rim.
const FISHEYE_MAX_ANGLE_RAD: f64 = 179.9 * std::f64::consts::PI / 180.0;

/// Kannala–Brandt distortion: `θ_d = θ (1 + k₁θ² + k₂θ⁴ + k₃θ⁶ + k₄θ⁸)` with θ the angle from the optical axis; θ_d is
/// the radius in the plane of unit focal length.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OpencvFisheye {
    /// Coefficients k₁ … k₄.
    pub k: [f64; 4],
}

impl OpencvFisheye {
    /// Returns θ_d, the radius in the plane of unit focal length.
    pub fn radius(&self, theta_rad: f64) -> f64 {
        let t2 = theta_rad * theta_rad;
        let [k1, k2, k3, k4] = self.k;
        theta_rad * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))))
    }

    /// Returns dθ_d/dθ.
    fn slope(&self, theta_rad: f64) -> f64 {
        let t2 = theta_rad * theta_rad;
        let [k1, k2, k3, k4] = self.k;
        1.0 + t2 * (3.0 * k1 + t2 * (5.0 * k2 + t2 * (7.0 * k3 + t2 * 9.0 * k4)))
    }

    /// Returns the first angle at which θ_d stops growing, at most 179.9°.
    pub(super) fn max_angle_rad(&self) -> f64 {
        last_growing_angle_rad(FISHEYE_MAX_ANGLE_RAD, |angle_rad| self.slope(angle_rad))
    }

    pub(super) fn distort(&self, point_in_camera: DVec3) -> DVec2 {
        let across = point_in_camera.truncate();
        let r = across.length();
        if r <= f64::EPSILON * point_in_camera.z.abs() {
            return across / point_in_camera.z.abs().max(f64::MIN_POSITIVE);
        }
        across * (self.radius(r.atan2(point_in_camera.z)) / r)
    }

    pub(super) fn distort_gradients(&self, point_in_camera: DVec3) -> [DVec3; 2] {
        let (x, y, z) = point_in_camera.into();
        let r = x.hypot(y);
        let squared = point_in_camera.length_squared();
        if r <= 1e-9 * z.abs() {
            return [DVec3::new(1.0 / z, 0.0, 0.0), DVec3::new(0.0, 1.0 / z, 0.0)];
        }
        let theta = r.atan2(z);
        let (radius, slope) = (self.radius(theta), self.slope(theta));
        // d θ_d = slope (z dr − r dz) / |p|², dr = (x dx + y dy) / r.
        let (ux, uy) = (x / r, y / r);
        let along = slope * z / squared;
        let across = radius / r;
        let depth = -slope * r / squared;
        [
            DVec3::new(along * ux * ux + across * uy * uy, (along - across) * ux * uy, depth * ux),
            DVec3::new((along - across) * ux * uy, along * uy * uy + across * ux * ux, depth * uy),
        ]
    }

    pub(super) fn parameter_gradients(&self, point_in_camera: DVec3) -> [DVec2; 4] {
        let across = point_in_camera.truncate();
        let theta = across.length().atan2(point_in_camera.z);
        let direction = across.normalize_or_zero();
        [3, 5, 7, 9].map(|power| direction * theta.powi(power))
    }

    pub(super) fn undistort(&self, place: DVec2, max_angle_rad: f64) -> Option<DVec3> {
        let radius = place.length();
        let rim = self.radius(max_angle_rad);
        if !radius.is_finite() || radius > rim * (1.0 + 1e-12) {
            return None;
        }
        let theta = self.angle_at(radius.min(rim), max_angle_rad);
        let (sin, cos) = theta.sin_cos();
        Some((place.normalize_or_zero() * sin).extend(cos))
    }

    /// Returns the angle whose θ_d is `radius`, by Newton's method inside a shrinking bracket.
    fn angle_at(&self, radius: f64, max_angle_rad: f64) -> f64 {
        let (mut low, mut high) = (0.0, max_angle_rad);
        let mut theta = radius.min(max_angle_rad);
        for _ in 0..MAX_STEPS {
            let excess = self.radius(theta) - radius;
            if excess > 0.0 {
                high = theta;
            } else {
                low = theta;
            }
            let newton = theta - excess / self.slope(theta);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - theta).abs() <= 1e-15 * (1.0 + theta) {
                return next;
            }
            theta = next;
        }
        theta
    }
}
