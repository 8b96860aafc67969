//! Lenses with a rational polynomial (OpenCV's eight coefficients) as ones without the denominator, or as fisheyes: fitted over
//! the picture, with the largest error.

use glam::{DMat3, DVec2, DVec3};
use reality_sim_core::camera::{Distortion, Opencv, OpencvFisheye};

/// Number of radii at which lenses are compared.
const RADII: usize = 200;

/// Directions at which they are compared: tangential distortion is not the same all around.
const DIRECTIONS: usize = 16;

/// Distortion with a rational polynomial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rational {
    /// Coefficients of r², r⁴, r⁶ above, then below.
    pub k: [f64; 6],
    /// Tangential coefficients.
    pub p: [f64; 2],
}

/// Lens that stands for another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LensFit {
    /// Lens.
    pub distortion: Distortion,
    /// Largest error over the picture, pixels.
    pub error_px: f64,
}

impl Rational {
    /// Returns the factor by which a point at a distance from the axis is moved, at focal length 1.
    fn factor(&self, radius: f64) -> f64 {
        let square = radius * radius;
        let [k1, k2, k3, k4, k5, k6] = self.k;
        let polynomial = |a: f64, b: f64, c: f64| 1.0 + square * (a + square * (b + square * c));
        polynomial(k1, k2, k3) / polynomial(k4, k5, k6)
    }

    fn distorted(&self, point: DVec2) -> DVec2 {
        point * self.factor(point.length()) + tangential(self.p, point)
    }
}

fn tangential([p1, p2]: [f64; 2], point: DVec2) -> DVec2 {
    let square = point.length_squared();
    let product = 2.0 * point.x * point.y;
    DVec2::new(
        p1 * product + p2 * (square + 2.0 * point.x * point.x),
        p1 * (square + 2.0 * point.y * point.y) + p2 * product,
    )
}

/// Finds the nearest lens without a denominator or fisheye.
pub fn fit(rational: Rational, [fx, fy, cx, cy]: [f64; 4], [width, height]: [u32; 2]) -> LensFit {
    let corner = [0.0, f64::from(width)].into_iter().flat_map(|x| [0.0, f64::from(height)].map(|y| [x, y]));
    let reach = corner.map(|[x, y]| ((x - cx) / fx).hypot((y - cy) / fy)).fold(0.0, f64::max);
    let radii = radii_up_to(&rational, reach);
    let opencv = opencv(&rational, &radii);
    let fisheye = fisheye(&rational, &radii);
    [opencv, fisheye]
        .into_iter()
        .map(|lens| LensFit { distortion: lens, error_px: error_px(&rational, lens, &radii, fx.max(fy)) })
        .min_by(|a, b| a.error_px.total_cmp(&b.error_px))
        .unwrap_or(LensFit { distortion: Distortion::Pinhole, error_px: f64::INFINITY })
}

/// Returns distances from the axis up to that which the lens shows at a distance in the picture.
fn radii_up_to(rational: &Rational, reach: f64) -> Vec<f64> {
    let shown = |radius: f64| radius * rational.factor(radius);
    let (mut low, mut high) = (0.0, 50.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if shown(middle) < reach { low = middle } else { high = middle }
    }
    (1..=RADII).map(|index| high * index as f64 / RADII as f64).collect()
}

/// Fits three coefficients of the radius' even powers, by least squares of distances in the picture.
fn opencv(rational: &Rational, radii: &[f64]) -> Distortion {
    let rows = radii.iter().map(|&r| {
        let powers = DVec3::new(r.powi(3), r.powi(5), r.powi(7));
        (powers, r * rational.factor(r) - r)
    });
    let [k1, k2, k3] = least_squares(rows).to_array();
    let [p1, p2] = rational.p;
    Distortion::Opencv(Opencv { k1, k2, p1, p2, k3 })
}

/// Fits three coefficients of the angle's even powers.
fn fisheye(rational: &Rational, radii: &[f64]) -> Distortion {
    let rows = radii.iter().map(|&r| {
        let angle = r.atan();
        (DVec3::new(angle.powi(3), angle.powi(5), angle.powi(7)), r * rational.factor(r) - angle)
    });
    let [k1, k2, k3] = least_squares(rows).to_array();
    Distortion::OpencvFisheye(OpencvFisheye { k: [k1, k2, k3, 0.0] })
}

/// Solves the normal equations, scaled to keep them solvable.
fn least_squares(rows: impl Iterator<Item = (DVec3, f64)> + Clone) -> DVec3 {
    let scale = rows.clone().fold(DVec3::splat(1e-12), |scale, (powers, _)| scale.max(powers.abs()));
    let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for (powers, value) in rows {
        let powers = powers / scale;
        matrix += DMat3::from_cols(powers * powers.x, powers * powers.y, powers * powers.z);
        right += powers * value;
    }
    matrix.inverse() * right / scale
}

/// Returns the largest distance between the points that both lenses show, pixels.
fn error_px(rational: &Rational, lens: Distortion, radii: &[f64], focal_px: f64) -> f64 {
    let directions = (0..DIRECTIONS).map(|index| std::f64::consts::TAU * index as f64 / DIRECTIONS as f64);
    let points = directions.flat_map(|angle| radii.iter().map(move |r| DVec2::from_angle(angle) * *r));
    let error = |point: DVec2| {
        let error = (rational.distorted(point) - shown(lens, point)).length() * focal_px;
        if error.is_finite() { error } else { f64::INFINITY }
    };
    points.map(error).fold(0.0, f64::max)
}

fn shown(lens: Distortion, point: DVec2) -> DVec2 {
    let radius = point.length();
    match lens {
        Distortion::Pinhole => point,
        Distortion::Opencv(Opencv { k1, k2, p1, p2, k3 }) => {
            let square = radius * radius;
            point * (1.0 + square * (k1 + square * (k2 + square * k3))) + tangential([p1, p2], point)
        }
        Distortion::OpencvFisheye(OpencvFisheye { k: [k1, k2, k3, k4] }) => {
            let (angle, square) = (radius.atan(), radius.atan().powi(2));
            let polynomial = 1.0 + square * (k1 + square * (k2 + square * (k3 + square * k4)));
            point * (angle * polynomial / radius)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rational_lens_that_is_nearly_a_polynomial_is_found() {
        let rational = Rational { k: [-0.3, 0.1, 0.0, 0.01, 0.001, 0.0], p: [0.001, -0.0005] };
        let found = fit(rational, [500.0, 500.0, 319.5, 239.5], [640, 480]);
        assert!(found.error_px < 0.05, "{found:?}");
    }

    #[test]
    fn a_lens_with_a_pole_in_the_picture_is_not_found() {
        let rational = Rational { k: [0.0, 0.0, 0.0, -4.0, 0.0, 0.0], p: [0.0, 0.0] };
        assert!(fit(rational, [500.0, 500.0, 319.5, 239.5], [640, 480]).error_px > 1.0);
    }
}
