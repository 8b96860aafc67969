//! Lens in the form that loops over many points use: single precision, sixteen points at a time, no branches, no
//! transcendental functions.

#![expect(clippy::needless_range_loop, reason = "sixteen lanes in step: the form the compiler vectorises")]

use super::{Camera, Distortion};

/// Number of points handled together.
pub const LANES: usize = 16;

/// One value for each of sixteen points.
pub type Lanes = [f32; LANES];

/// Number of coefficients of the radial polynomial: enough for 0.01 px in a picture that sees up to 90° from the
/// optical axis, which a test checks.
pub const RADIAL_TERMS: usize = 11;

/// Map from a direction to a point in the plane of unit focal length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lens {
    /// Point `(x, y)/|p| · Σ cᵢ tⁱ`, with t = z/|p| mapped to [−1, 1]. For Kannala–Brandt, θ_d/sin θ is an even function
    /// of θ, hence a smooth function of cos θ = z/|p|: a short polynomial replaces square root and arc tangent.
    Radial {
        /// Coefficients cᵢ.
        coefficients: [f32; RADIAL_TERMS],
        /// Scale of t = scale · z/|p| + offset.
        scale: f32,
        /// Offset of t, see `scale`.
        offset: f32,
    },
    /// Point `(x, y)/z` with Brown–Conrady distortion k1, k2, p1, p2, k3.
    Perspective {
        /// Coefficients k1, k2, p1, p2, k3.
        distortion: [f32; 5],
    },
}

/// Camera for loops over many points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KernelCamera {
    /// Map from a direction to a point in the plane of unit focal length.
    pub lens: Lens,
    /// Focal length along the rows, pixels.
    pub fx: f32,
    /// Focal length along the columns, pixels.
    pub fy: f32,
    /// Column of the principal point, pixels.
    pub cx: f32,
    /// Row of the principal point, pixels.
    pub cy: f32,
    /// Largest valid column.
    pub max_u: f32,
    /// Largest valid row.
    pub max_v: f32,
    /// Cosine of the largest valid angle.
    pub min_cos: f32,
    /// Centre and squared radius of the image circle, pixels, if the lens does not fill the picture.
    pub circle: Option<[f32; 3]>,
}

impl KernelCamera {
    /// Converts a camera to single precision.
    pub fn new(camera: &Camera) -> Self {
        let min_cos = camera.max_angle_rad().min(max_seen_angle_rad(camera)).cos();
        let lens = match camera.distortion {
            Distortion::Pinhole => Lens::Perspective { distortion: [0.0; 5] },
            Distortion::Opencv(d) => {
                Lens::Perspective { distortion: [d.k1, d.k2, d.p1, d.p2, d.k3].map(|k| k as f32) }
            }
            Distortion::OpencvFisheye(lens) => radial(min_cos, |theta| lens.radius(theta)),
        };
        let circle = camera
            .image_circle
            .map(|circle| [circle.cx as f32, circle.cy as f32, (circle.radius * circle.radius) as f32]);
        Self {
            lens,
            fx: camera.fx as f32,
            fy: camera.fy as f32,
            cx: camera.cx as f32,
            cy: camera.cy as f32,
            max_u: (camera.width - 1) as f32,
            max_v: (camera.height - 1) as f32,
            min_cos: min_cos as f32,
            circle,
        }
    }
}

/// Pixels of sixteen points.
#[derive(Debug, Clone, Copy)]
pub struct Pixels {
    /// Columns, pixels from the first pixel's centre.
    pub u: Lanes,
    /// Rows, pixels from the first pixel's centre.
    pub v: Lanes,
    /// 1 where the point has a pixel, else 0.
    pub seen: Lanes,
    /// One over the distance from the camera, per metre.
    pub nearness: Lanes,
}

/// Places of sixteen points in the plane of a picture, whether the picture contains them or not.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Places {
    /// Columns, pixels.
    pub u: Lanes,
    /// Rows, pixels.
    pub v: Lanes,
    /// One over the distance from the camera, per metre.
    pub nearness: Lanes,
    /// Cosines of the angles from the optical axis. Places are right where these are at least the camera's smallest.
    pub cos: Lanes,
}

/// Projects sixteen points, given by x, y and z in the camera's axes, metres; `None` if the camera sees none of them. A
/// point that is NaN is not seen.
#[inline(always)]
pub fn project_lanes(camera: &KernelCamera, points_in_camera: &[Lanes; 3]) -> Option<Pixels> {
    let (nearness, cos) = directions(points_in_camera);
    let mut any = 0u32;
    for i in 0..LANES {
        any |= u32::from(cos[i] >= camera.min_cos);
    }
    if any == 0 {
        return None;
    }
    let [u, v] = places(camera, points_in_camera, &nearness, &cos);
    let mut pixels = Pixels { u, v, seen: [0.0; LANES], nearness };
    if !inside_lanes(camera, &mut pixels) {
        return None;
    }
    for i in 0..LANES {
        pixels.seen[i] = if cos[i] >= camera.min_cos { pixels.seen[i] } else { 0.0 };
    }
    Some(pixels)
}

/// Projects sixteen points like [`project_lanes`], without asking whether the camera sees them.
#[inline(always)]
pub(crate) fn place_lanes(camera: &KernelCamera, points_in_camera: &[Lanes; 3]) -> Places {
    let (nearness, cos) = directions(points_in_camera);
    let [u, v] = places(camera, points_in_camera, &nearness, &cos);
    Places { u, v, nearness, cos }
}

/// Returns one over the distances of points, and the cosines of their angles from the optical axis.
#[inline(always)]
fn directions([x, y, z]: &[Lanes; 3]) -> (Lanes, Lanes) {
    let mut inverse = [0.0_f32; LANES];
    let mut cos = [0.0_f32; LANES];
    for i in 0..LANES {
        inverse[i] = 1.0 / (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]).sqrt();
        cos[i] = z[i] * inverse[i];
    }
    (inverse, cos)
}

/// Returns columns and rows of points.
#[inline(always)]
fn places(camera: &KernelCamera, [x, y, z]: &[Lanes; 3], inverse: &Lanes, cos: &Lanes) -> [Lanes; 2] {
    let (mut u, mut v) = ([0.0_f32; LANES], [0.0_f32; LANES]);
    match &camera.lens {
        Lens::Radial { coefficients, scale, offset } => {
            let [c0, c1, c2, c3, c4, c5, c6, c7, c8, c9, c10] = *coefficients;
            for i in 0..LANES {
                let t = cos[i] * scale + offset;
                // Estrin's scheme: Horner's makes every step wait for the one before, and scoring takes a fifth longer.
                let (t2, t4) = (t * t, t * t * (t * t));
                let low = (c0 + c1 * t) + (c2 + c3 * t) * t2;
                let middle = (c4 + c5 * t) + (c6 + c7 * t) * t2;
                let high = (c8 + c9 * t) + c10 * t2;
                let h = low + t4 * (middle + t4 * high);
                let s = h * inverse[i];
                u[i] = camera.fx * (x[i] * s) + camera.cx;
                v[i] = camera.fy * (y[i] * s) + camera.cy;
            }
        }
        Lens::Perspective { distortion: [k1, k2, p1, p2, k3] } => {
            for i in 0..LANES {
                let depth = 1.0 / z[i];
                let (a, b) = (x[i] * depth, y[i] * depth);
                let r2 = a * a + b * b;
                let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
                let ab2 = 2.0 * a * b;
                let da = a * radial + p1 * ab2 + p2 * (r2 + 2.0 * a * a);
                let db = b * radial + p1 * (r2 + 2.0 * b * b) + p2 * ab2;
                u[i] = camera.fx * da + camera.cx;
                v[i] = camera.fy * db + camera.cy;
            }
        }
    }
    [u, v]
}

/// Marks the places that the picture contains; returns false if it contains none.
#[inline(always)]
pub(crate) fn inside_lanes(camera: &KernelCamera, pixels: &mut Pixels) -> bool {
    let (max_u, max_v) = (camera.max_u, camera.max_v);
    let mut any = 0u32;
    for i in 0..LANES {
        let (u, v) = (pixels.u[i], pixels.v[i]);
        let seen = (u >= 0.0) & (u <= max_u) & (v >= 0.0) & (v <= max_v);
        pixels.seen[i] = if seen { 1.0 } else { 0.0 };
        any |= u32::from(seen);
    }
    if any == 0 {
        return false;
    }
    if let Some([circle_u, circle_v, radius_squared]) = camera.circle {
        for i in 0..LANES {
            let (du, dv) = (pixels.u[i] - circle_u, pixels.v[i] - circle_v);
            let inside = du * du + dv * dv <= radius_squared;
            pixels.seen[i] = if inside { pixels.seen[i] } else { 0.0 };
        }
    }
    true
}

/// Returns the largest angle seen in the picture's corners: the polynomial need not hold beyond it.
fn max_seen_angle_rad(camera: &Camera) -> f64 {
    let (right, bottom) = (f64::from(camera.width - 1), f64::from(camera.height - 1));
    let corners = [(0.0, 0.0), (right, 0.0), (0.0, bottom), (right, bottom)];
    corners
        .iter()
        .map(|&(u, v)| {
            camera
                .unproject(glam::DVec2::new(u, v))
                .map_or(camera.max_angle_rad(), |ray| ray.z.clamp(-1.0, 1.0).acos())
        })
        .fold(0.0, f64::max)
}

/// Interpolates θ_d/sin θ over cos θ in [min_cos, 1] at Chebyshev nodes; returns a power series.
fn radial(min_cos: f64, radius: impl Fn(f64) -> f64) -> Lens {
    use std::f64::consts::PI;
    let count = RADIAL_TERMS;
    // cos θ = centre + half · t. A rim at 180° is a pole of 1/sin θ: stop just short of it.
    let low = min_cos.max(-0.99);
    let (centre, half) = (0.5 * (1.0 + low), 0.5 * (1.0 - low));
    let node = |j: usize| (PI * (j as f64 + 0.5) / count as f64).cos();
    let value = |t: f64| {
        let theta = (centre + half * t).clamp(-1.0, 1.0).acos();
        radius(theta) / theta.sin()
    };
    let chebyshev: Vec<f64> = (0..count)
        .map(|k| {
            let sum: f64 = (0..count)
                .map(|j| value(node(j)) * (PI * k as f64 * (j as f64 + 0.5) / count as f64).cos())
                .sum();
            sum * if k == 0 { 1.0 } else { 2.0 } / count as f64
        })
        .collect();
    Lens::Radial {
        coefficients: power_series(&chebyshev).map(|c| c as f32),
        scale: (1.0 / half) as f32,
        offset: (-centre / half) as f32,
    }
}

/// Rewrites Σ cₖ Tₖ(t) as Σ aᵢ tⁱ.
fn power_series(chebyshev: &[f64]) -> [f64; RADIAL_TERMS] {
    let mut sum = [0.0; RADIAL_TERMS];
    let (mut previous, mut current) = ([0.0; RADIAL_TERMS], [0.0; RADIAL_TERMS]);
    current[0] = 1.0;
    for (order, &coefficient) in chebyshev.iter().enumerate() {
        for (total, term) in sum.iter_mut().zip(current) {
            *total += coefficient * term;
        }
        // T₁ = t; Tₙ₊₁ = 2 t Tₙ − Tₙ₋₁.
        let factor = if order == 0 { 1.0 } else { 2.0 };
        let mut next = [0.0; RADIAL_TERMS];
        for i in 0..RADIAL_TERMS {
            let shifted = if i > 0 { current[i - 1] } else { 0.0 };
            next[i] = factor * shifted - if order == 0 { 0.0 } else { previous[i] };
        }
        (previous, current) = (current, next);
    }
    sum
}
