//! The lens: θ_d = θ (1 + k₁θ² + k₂θ⁴ + k₃θ⁶ + k₄θ⁸), pixel = f θ_d (x, y)/r + c, as `OPENCV_FISHEYE` is defined.
//!
//! Casting rays only needs the direction from a pixel to its ray.

use glam::{DVec2, DVec3};

/// Number of steps in the search for the angle at which the polynomial stops growing.
const SCAN_STEPS: u32 = 2000;

/// Fisheye lens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fisheye {
    /// Focal length, pixels.
    pub focal_px: f64,
    /// Principal point, pixels; the first pixel's centre is (0, 0).
    pub center_px: DVec2,
    /// k₁ … k₄.
    pub k: [f64; 4],
}

impl Fisheye {
    /// Returns θ_d and its derivative at an angle from the optical axis.
    fn distorted(&self, angle_rad: f64) -> (f64, f64) {
        let square = angle_rad * angle_rad;
        let [k1, k2, k3, k4] = self.k;
        let value = angle_rad * (1.0 + square * (k1 + square * (k2 + square * (k3 + square * k4))));
        let slope = 1.0 + square * (3.0 * k1 + square * (5.0 * k2 + square * (7.0 * k3 + square * 9.0 * k4)));
        (value, slope)
    }

    /// Returns the largest angle up to which θ_d grows, at most π, radians.
    pub fn max_angle_rad(&self) -> f64 {
        let angle = |step: u32| std::f64::consts::PI * f64::from(step) / f64::from(SCAN_STEPS);
        let grows = |step: &u32| self.distorted(angle(*step)).1 > 0.0;
        angle((0..=SCAN_STEPS).take_while(grows).last().unwrap_or(0))
    }

    /// Returns the unit direction in the camera frame that a pixel sees; `None` beyond `max_angle_rad`.
    pub fn ray(&self, pixel: DVec2, max_angle_rad: f64) -> Option<DVec3> {
        let plane = (pixel - self.center_px) / self.focal_px;
        let radius = plane.length();
        if radius < 1e-12 {
            return Some(DVec3::Z);
        }
        let angle_rad = self.angle(radius, max_angle_rad)?;
        let (sine, cosine) = angle_rad.sin_cos();
        Some((plane * (sine / radius)).extend(cosine))
    }

    /// Returns the angle with this θ_d, by Newton's method within shrinking bounds.
    fn angle(&self, radius: f64, max_angle_rad: f64) -> Option<f64> {
        let (mut low, mut high) = (0.0, max_angle_rad);
        if radius > self.distorted(high).0 {
            return None;
        }
        let mut angle = radius.min(max_angle_rad);
        for _ in 0..60 {
            let (value, slope) = self.distorted(angle);
            if value > radius {
                high = angle;
            } else {
                low = angle;
            }
            let newton = angle - (value - radius) / slope;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - angle).abs() < 1e-12 {
                return Some(next);
            }
            angle = next;
        }
        Some(angle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_go_to_their_pixels_by_the_formula() {
        let lens = Fisheye {
            focal_px: 211.8,
            center_px: DVec2::new(321.0, 238.0),
            k: [-0.0663, 0.00994, -0.0011, 5.5e-5],
        };
        let max_angle_rad = lens.max_angle_rad();
        for (u, v) in [(0.0, 0.0), (639.0, 479.0), (321.0, 238.5), (100.0, 400.0), (500.2, 20.7)] {
            let ray = lens.ray(DVec2::new(u, v), max_angle_rad).unwrap();
            let across = ray.x.hypot(ray.y);
            let t = across.atan2(ray.z);
            let [k1, k2, k3, k4] = lens.k;
            let bent = t + k1 * t.powi(3) + k2 * t.powi(5) + k3 * t.powi(7) + k4 * t.powi(9);
            let pixel = DVec2::new(ray.x, ray.y) * (lens.focal_px * bent / across) + lens.center_px;
            assert!(pixel.distance(DVec2::new(u, v)) < 1e-7, "{pixel}");
            assert!((ray.length() - 1.0).abs() < 1e-12);
        }
    }
}
