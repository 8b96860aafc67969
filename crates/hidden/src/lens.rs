//! Lenses, from the pixel to the ray: fisheyes as `OPENCV_FISHEYE` defines them, θ_d = θ (1 + k₁θ² + k₂θ⁴ + k₃θ⁶ + k₄θ⁸),
//! and perspective lenses as `OPENCV` does, r_d = r (1 + k₁r² + k₂r⁴), of which `PINHOLE` is the one that does not bend.
//!
//! Both may be decentred: to the plane point (x, y) with the radius θ or r are added p₁ 2xy + p₂ (r² + 2x²) and
//! p₁ (r² + 2y²) + p₂ 2xy, as in `OPENCV` and, for fisheyes, in COLMAP's `THIN_PRISM_FISHEYE`.

use glam::{DVec2, DVec3};

/// Number of steps in the search for the radius at which the polynomial stops growing.
const SCAN_STEPS: u32 = 2000;
/// Largest radius of a perspective lens: 79° from the axis.
const WIDEST_RADIUS: f64 = 5.0;
/// Number of steps of the search for the point that decentring moves to a place; each gains two digits or more.
const CENTERING_STEPS: u32 = 20;

/// Lens with one focal length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Focal length, pixels.
    pub focal_px: f64,
    /// Principal point, pixels; the first pixel's centre is (0, 0).
    pub center_px: DVec2,
    /// Bend along the radius.
    pub bend: Bend,
    /// Decentring p₁, p₂.
    pub p: [f64; 2],
}

/// Bend of a lens along the radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bend {
    /// Fisheye with k₁ … k₄ over the angle from the axis.
    Fisheye([f64; 4]),
    /// Perspective lens with k₁, k₂ over the tangent of the angle from the axis.
    Perspective([f64; 2]),
}

impl Bend {
    /// Adds to k₁, k₂ …; a perspective lens takes the first two.
    pub fn add(&mut self, change: [f64; 4]) {
        let add = |k: &mut [f64]| k.iter_mut().zip(change).for_each(|(k, change)| *k += change);
        match self {
            Self::Fisheye(k) => add(k),
            Self::Perspective(k) => add(k),
        }
    }

    /// Returns the bent radius and its derivative at the angle (fisheye) or the angle's tangent (perspective).
    fn distorted(&self, radius: f64) -> (f64, f64) {
        let square = radius * radius;
        match *self {
            Self::Fisheye([k1, k2, k3, k4]) => {
                let value = radius * (1.0 + square * (k1 + square * (k2 + square * (k3 + square * k4))));
                let slope =
                    1.0 + square * (3.0 * k1 + square * (5.0 * k2 + square * (7.0 * k3 + square * 9.0 * k4)));
                (value, slope)
            }
            Self::Perspective([k1, k2]) => {
                (radius * (1.0 + square * (k1 + square * k2)), 1.0 + square * (3.0 * k1 + square * 5.0 * k2))
            }
        }
    }

    fn widest(&self) -> f64 {
        match self {
            Self::Fisheye(_) => std::f64::consts::PI,
            Self::Perspective(_) => WIDEST_RADIUS,
        }
    }

    /// Returns the radius that is bent to this one, by Newton's method from a start nearby, which does without bounds.
    fn straight_near(&self, bent: f64, start: f64, largest: f64) -> Option<f64> {
        let mut radius = start;
        for _ in 0..8 {
            let (value, slope) = self.distorted(radius);
            let step = (value - bent) / slope;
            radius -= step;
            if step.abs() < 1e-13 && (0.0..=largest).contains(&radius) {
                return Some(radius);
            }
        }
        self.straight(bent, largest)
    }

    /// Returns the radius that is bent to this one, by Newton's method within shrinking bounds.
    fn straight(&self, bent: f64, largest: f64) -> Option<f64> {
        let (mut low, mut high) = (0.0, largest);
        if bent > self.distorted(high).0 {
            return None;
        }
        let mut radius = bent.min(largest);
        for _ in 0..60 {
            let (value, slope) = self.distorted(radius);
            if value > bent {
                high = radius;
            } else {
                low = radius;
            }
            let newton = radius - (value - bent) / slope;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - radius).abs() < 1e-12 {
                return Some(next);
            }
            radius = next;
        }
        Some(radius)
    }
}

impl Lens {
    /// Returns the largest angle (fisheye) or tangent (perspective) up to which the bent radius grows.
    pub fn largest_radius(&self) -> f64 {
        let radius = |step: u32| self.bend.widest() * f64::from(step) / f64::from(SCAN_STEPS);
        let grows = |step: &u32| self.bend.distorted(radius(*step)).1 > 0.0;
        radius((0..=SCAN_STEPS).take_while(grows).last().unwrap_or(0))
    }

    /// Returns the unit direction in the camera frame that a pixel sees; `None` beyond `largest_radius`.
    pub fn ray(&self, pixel: DVec2, largest_radius: f64) -> Option<DVec3> {
        let place = (pixel - self.center_px) / self.focal_px;
        if place.length() < 1e-12 && self.p == [0.0; 2] {
            return Some(DVec3::Z);
        }
        let is_centred_fisheye = matches!(self.bend, Bend::Fisheye(_)) && self.p == [0.0; 2];
        if is_centred_fisheye {
            let radius = place.length();
            let (sine, cosine) = self.bend.straight(radius, largest_radius)?.sin_cos();
            return Some((place * (sine / radius)).extend(cosine));
        }
        let point = self.unbent(place, largest_radius)?;
        let radius = point.length();
        Some(match self.bend {
            Bend::Fisheye(_) if radius < 1e-12 => DVec3::Z,
            Bend::Fisheye(_) => (point * (radius.sin() / radius)).extend(radius.cos()),
            Bend::Perspective(_) => point.extend(1.0).normalize_or(DVec3::Z),
        })
    }

    /// Returns the point of the plane of angles or tangents that is seen at a place.
    fn unbent(&self, place: DVec2, largest_radius: f64) -> Option<DVec2> {
        let mut point = place.clamp_length_max(largest_radius);
        for _ in 0..CENTERING_STEPS {
            let centred = place - self.decentring(point);
            let bent = centred.length();
            let radius = self.bend.straight_near(bent, point.length(), largest_radius)?;
            let next = if bent < 1e-12 { centred } else { centred * (radius / bent) };
            let step = next.distance(point);
            point = next;
            if step < 1e-12 {
                break;
            }
        }
        Some(point)
    }

    fn decentring(&self, point: DVec2) -> DVec2 {
        let [p1, p2] = self.p;
        let (square, twice) = (point.length_squared(), 2.0 * point.x * point.y);
        DVec2::new(
            p1 * twice + p2 * (square + 2.0 * point.x * point.x),
            p1 * (square + 2.0 * point.y * point.y) + p2 * twice,
        )
    }

    /// Returns the pixel at which a direction in the camera frame is seen, without regard to where the lens ends; `None`
    /// behind a perspective lens.
    pub fn pixel(&self, direction: DVec3) -> Option<DVec2> {
        let across = direction.truncate().length();
        let radius = match self.bend {
            Bend::Fisheye(_) => across.atan2(direction.z),
            Bend::Perspective(_) if direction.z <= 0.0 => return None,
            Bend::Perspective(_) => across / direction.z,
        };
        let unit = if across < 1e-12 { DVec2::ZERO } else { direction.truncate() / across };
        let place = unit * self.bend.distorted(radius).0 + self.decentring(unit * radius);
        Some(self.center_px + self.focal_px * place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FISHEYE: Lens = Lens {
        focal_px: 211.8,
        center_px: DVec2::new(321.0, 238.0),
        bend: Bend::Fisheye([-0.0663, 0.00994, -0.0011, 5.5e-5]),
        p: [0.0; 2],
    };

    #[test]
    fn rays_go_to_their_pixels_by_the_formula() {
        let largest = FISHEYE.largest_radius();
        for (u, v) in [(0.0, 0.0), (639.0, 479.0), (321.0, 238.5), (100.0, 400.0), (500.2, 20.7)] {
            let ray = FISHEYE.ray(DVec2::new(u, v), largest).unwrap();
            let across = ray.x.hypot(ray.y);
            let t = across.atan2(ray.z);
            let bent = t - 0.0663 * t.powi(3) + 0.00994 * t.powi(5) - 0.0011 * t.powi(7) + 5.5e-5 * t.powi(9);
            let pixel = DVec2::new(ray.x, ray.y) * (FISHEYE.focal_px * bent / across) + FISHEYE.center_px;
            assert!(pixel.distance(DVec2::new(u, v)) < 1e-7, "{pixel}");
            assert!((ray.length() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn perspective_rays_go_to_their_pixels_by_the_formula_of_brown_and_conrady() {
        let lens =
            Lens { focal_px: 500.0, bend: Bend::Perspective([-0.21, 0.05]), p: [0.002, -0.0015], ..FISHEYE };
        for (u, v) in [(0.0, 0.0), (639.0, 479.0), (321.0, 238.0), (100.0, 400.0), (600.2, 20.7)] {
            let ray = lens.ray(DVec2::new(u, v), lens.largest_radius()).unwrap();
            let (x, y) = (ray.x / ray.z, ray.y / ray.z);
            let r2 = x * x + y * y;
            let radial = 1.0 - 0.21 * r2 + 0.05 * r2 * r2;
            let xd = x * radial + 2.0 * 0.002 * x * y - 0.0015 * (r2 + 2.0 * x * x);
            let yd = y * radial + 0.002 * (r2 + 2.0 * y * y) - 2.0 * 0.0015 * x * y;
            let pixel = DVec2::new(500.0 * xd + 321.0, 500.0 * yd + 238.0);
            assert!(pixel.distance(DVec2::new(u, v)) < 1e-7, "{pixel} {u} {v}");
            assert!((ray.length() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn decentred_fisheyes_see_at_a_pixel_what_they_show_there() {
        let lens = Lens { p: [0.003, -0.002], ..FISHEYE };
        let largest = lens.largest_radius();
        for (u, v) in [(0.0, 0.0), (639.0, 479.0), (321.0, 238.5), (100.0, 400.0)] {
            let pixel = DVec2::new(u, v);
            let ray = lens.ray(pixel, largest).unwrap();
            assert!(lens.pixel(ray).unwrap().distance(pixel) < 1e-6);
            assert!(FISHEYE.pixel(ray).unwrap().distance(pixel) > 0.0);
        }
        let corner = FISHEYE.ray(DVec2::ZERO, largest).unwrap();
        assert!(lens.pixel(corner).unwrap().length() > 1.0, "the corner moves by a pixel and more");
    }
}
