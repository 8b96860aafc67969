//! OPENCV: Brown, "Close-range camera calibration", 1971, with OpenCV's names and order.

use glam::DVec2;

/// `x_d = x (1 + k₁r² + k₂r⁴ + k₃r⁶) + 2 p₁ x y + p₂ (r² + 2x²)`, and y alike, for x = X/Z, y = Y/Z.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Opencv {
    /// Radial, r².
    pub k1: f64,
    /// Radial, r⁴.
    pub k2: f64,
    /// Tangential.
    pub p1: f64,
    /// Tangential.
    pub p2: f64,
    /// Radial, r⁶.
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

    /// The first angle at which the radial part stops growing, below that of a pinhole.
    pub(super) fn max_angle_rad(&self) -> f64 {
        const STEPS: u32 = 4096;
        let slope = |angle: f64| {
            let r2 = angle.tan().powi(2);
            self.radial(r2) + 2.0 * r2 * self.radial_slope(r2)
        };
        let angle = |step: u32| super::PINHOLE_MAX_ANGLE_RAD * f64::from(step) / f64::from(STEPS);
        let Some(falling) = (1..=STEPS).find(|&step| slope(angle(step)) <= 0.0) else {
            return super::PINHOLE_MAX_ANGLE_RAD;
        };
        let (mut low, mut high) = (angle(falling - 1), angle(falling));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if slope(middle) > 0.0 { low = middle } else { high = middle }
        }
        low
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

    /// Rows: gradients of x_d and y_d with respect to (x, y).
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

    /// Newton's method in two dimensions, damped so that it stays within the valid angle.
    pub(super) fn undistort(&self, place: DVec2, max_angle_rad: f64) -> Option<DVec2> {
        let rim = max_angle_rad.tan();
        let mut p = place.clamp_length_max(rim);
        for _ in 0..100 {
            let error = self.distort(p) - place;
            let [dx, dy] = self.distort_gradients(p);
            let determinant = dx.x * dy.y - dx.y * dy.x;
            if !error.is_finite() || determinant.abs() < 1e-300 {
                return None;
            }
            let step =
                DVec2::new(error.x * dy.y - error.y * dx.y, error.y * dx.x - error.x * dy.x) / determinant;
            let next = (p - step.clamp_length_max(0.5 + p.length())).clamp_length_max(rim * 1.0001);
            if (next - p).length() <= 1e-15 * (1.0 + p.length()) {
                p = next;
                break;
            }
            p = next;
        }
        ((self.distort(p) - place).length() <= 1e-9 * (1.0 + place.length())).then_some(p)
    }
}
