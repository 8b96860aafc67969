//! Rays in which a ring on the ground is visible.

use glam::{DMat3, DVec3, Vec2, Vec3};

use super::side::Side;
use crate::lens::RayPatch;

/// Rays between two concentric circles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ring {
    outer: Disc,
    /// Inner circle; `None` for a full disc.
    inner: Option<Disc>,
}

impl Ring {
    /// Builds a horizontal ring for a camera position. `None` for a ring without area.
    pub(super) fn new(
        center: DVec3,
        [inner_m, outer_m]: [f64; 2],
        position: DVec3,
        camera_from_world: DMat3,
    ) -> Option<Self> {
        let disc = |radius_m| Disc::new(center, radius_m, position, camera_from_world);
        Some(Self { outer: disc(outer_m)?, inner: disc(inner_m) })
    }

    pub(super) fn side(&self, patch: &RayPatch) -> Side {
        match (self.outer.side(patch), self.inner.map_or(Side::Outside, |inner| inner.side(patch))) {
            (Side::Outside, _) | (_, Side::Inside) => Side::Outside,
            (Side::Inside, Side::Outside) => Side::Inside,
            _ => Side::Edge,
        }
    }

    /// Returns the fraction of a patch inside, treating the circles as straight within it.
    pub(super) fn coverage(&self, patch: &RayPatch) -> f32 {
        let hole = self.inner.map_or(0.0, |inner| inner.coverage(patch));
        (self.outer.coverage(patch) - hole).max(0.0)
    }
}

/// Rays to a horizontal circle. With `s` the inverse of the factor by which a ray is stretched to end in the circle's
/// plane, the ray is inside where `s |offset| < s radius`; both sides are defined for every ray, even along the plane.
#[derive(Debug, Clone, Copy)]
struct Disc {
    /// Gives `s radius` as its dot product with the ray.
    radius: Vec3,
    /// Give the offset from the circle's centre, scaled by `s`, as their dot products with the ray.
    offset: [Vec3; 2],
}

impl Disc {
    fn new(center: DVec3, radius_m: f64, position: DVec3, camera_from_world: DMat3) -> Option<Self> {
        let from_center = position - center;
        if !(radius_m > 0.0 && from_center.z != 0.0) {
            return None;
        }
        // The ray meets the plane when scaled by −from_center.z / ray.z: `s` is the inverse.
        let scale = DVec3::new(0.0, 0.0, -1.0 / from_center.z);
        let in_camera = |form: DVec3| (camera_from_world * form).as_vec3();
        Some(Self {
            radius: in_camera(radius_m * scale),
            offset: [
                in_camera(DVec3::X + from_center.x * scale),
                in_camera(DVec3::Y + from_center.y * scale),
            ],
        })
    }

    fn offset(&self, ray: Vec3) -> Vec2 {
        Vec2::from_array(self.offset.map(|form| form.dot(ray)))
    }

    fn side(&self, patch: &RayPatch) -> Side {
        let inside = self.radius.dot(patch.center) - self.offset(patch.center).length();
        let reach = |step: Vec3| self.radius.dot(step).abs() + self.offset(step).length();
        let reach = 0.5 * (reach(patch.across) + reach(patch.down));
        match inside {
            _ if inside <= -reach => Side::Outside,
            _ if inside >= reach => Side::Inside,
            _ => Side::Edge,
        }
    }

    fn coverage(&self, patch: &RayPatch) -> f32 {
        let offset = self.offset(patch.center);
        let outwards = offset.normalize_or_zero();
        let change = |step: Vec3| self.radius.dot(step) - outwards.dot(self.offset(step));
        let middle = self.radius.dot(patch.center) - offset.length();
        positive_fraction(middle, [change(patch.across), change(patch.down)])
    }
}

/// Returns the fraction of the unit square (x and y between −½ and ½) in which `middle + a x + b y` is positive.
fn positive_fraction(middle: f32, [a, b]: [f32; 2]) -> f32 {
    let (larger, smaller) = (a.abs().max(b.abs()), a.abs().min(b.abs()));
    let reach = 0.5 * (larger + smaller);
    if middle >= reach {
        1.0
    } else if middle <= -reach {
        0.0
    } else if middle.abs() <= 0.5 * (larger - smaller) {
        0.5 + middle / larger
    } else {
        let corner = (reach - middle.abs()).powi(2) / (2.0 * larger * smaller);
        if middle > 0.0 { 1.0 - corner } else { corner }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn positive_fraction_is_the_fraction_of_points_that_are(
            middle in -1.2f32..1.2, a in -1.0f32..1.0, b in -1.0f32..1.0,
        ) {
            let offset = |i: u16| (f32::from(i) + 0.5) / 200.0 - 0.5;
            let values = (0..200).flat_map(|i| (0..200).map(move |j| middle + a * offset(i) + b * offset(j)));
            let positive = values.filter(|value| *value > 0.0).count() as f32 / 40_000.0;
            prop_assert!((positive_fraction(middle, [a, b]) - positive).abs() < 0.01);
        }
    }
}
