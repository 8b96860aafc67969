//! The rays in which a shape is seen.

use glam::{DMat3, DVec3, Vec2, Vec3};

use crate::{lens::RayPatch, world::Shape};

/// Where a patch of rays lies to a cone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Side {
    /// None of its rays is in the cone.
    Outside,
    /// All of them are.
    Inside,
    /// Perhaps some.
    Edge,
}

/// The rays from the projection centre to a shape, in the camera's axes.
#[derive(Debug, Clone, Copy)]
pub(super) enum Cone {
    /// A convex quadrilateral: unit normals, pointing inwards, of the planes through the projection centre and its
    /// edges, in the order of the edges.
    Quad([Vec3; 4]),
    /// A circle.
    Disc(DiscCone),
    /// What is between two circles.
    Ring {
        /// The larger circle.
        outer: DiscCone,
        /// The smaller one.
        inner: DiscCone,
    },
}

impl Cone {
    /// `None` for a shape without area, or one that is seen edge on.
    pub(super) fn new(shape: &Shape, position_in_world: DVec3, camera_from_world: DMat3) -> Option<Self> {
        let disc = |center, radius_m| DiscCone::new(center, radius_m, position_in_world, camera_from_world);
        match *shape {
            Shape::Quad(corners) => quad_normals(corners.map(|corner| corner - position_in_world))
                .map(|normals| Self::Quad(normals.map(|normal| (camera_from_world * normal).as_vec3()))),
            Shape::Disc { center, radius_m } => disc(center, radius_m).map(Self::Disc),
            Shape::Ring { center, inner_m, outer_m } => {
                let outer = disc(center, outer_m)?;
                Some(disc(center, inner_m).map_or(Self::Disc(outer), |inner| Self::Ring { outer, inner }))
            }
        }
    }

    /// Where all rays of a patch lie; `Edge` where that takes more than a look.
    pub(super) fn side(&self, patch: &RayPatch) -> Side {
        match self {
            Self::Quad(normals) => quad_side(normals, patch),
            Self::Disc(disc) => disc.side(patch),
            Self::Ring { outer, inner } => match (outer.side(patch), inner.side(patch)) {
                (Side::Outside, _) | (_, Side::Inside) => Side::Outside,
                (Side::Inside, Side::Outside) => Side::Inside,
                _ => Side::Edge,
            },
        }
    }

    /// The fraction of a patch that the cone covers: exact for a straight edge or two opposite ones.
    pub(super) fn coverage(&self, patch: &RayPatch) -> f32 {
        match self {
            Self::Quad(normals) => quad_coverage(normals, patch),
            Self::Disc(disc) => disc.coverage(patch),
            Self::Ring { outer, inner } => {
                let outer = outer.coverage(patch);
                if outer > 0.0 { (outer - inner.coverage(patch)).max(0.0) } else { 0.0 }
            }
        }
    }
}

fn quad_normals(corners_from_position: [DVec3; 4]) -> Option<[DVec3; 4]> {
    let middle: DVec3 = corners_from_position.iter().sum();
    let mut normals = [DVec3::ZERO; 4];
    for (i, normal) in normals.iter_mut().enumerate() {
        let plane = corners_from_position[i].cross(corners_from_position[(i + 1) % 4]).try_normalize()?;
        *normal = plane * plane.dot(middle).signum();
    }
    Some(normals)
}

fn quad_side(normals: &[Vec3; 4], patch: &RayPatch) -> Side {
    let mut side = Side::Inside;
    for normal in normals {
        let middle = normal.dot(patch.center);
        let reach = 0.5 * (normal.dot(patch.across).abs() + normal.dot(patch.down).abs());
        if middle < -reach {
            return Side::Outside;
        }
        if middle < reach {
            side = Side::Edge;
        }
    }
    side
}

/// Opposite edges do not cross in the patch: what each cuts off adds up. Neighbours are as if at right angles.
fn quad_coverage(normals: &[Vec3; 4], patch: &RayPatch) -> f32 {
    let mut inside = [0.0; 4];
    for (inside, normal) in inside.iter_mut().zip(normals) {
        let change = [normal.dot(patch.across), normal.dot(patch.down)];
        *inside = positive_fraction(normal.dot(patch.center), change);
        if *inside == 0.0 {
            return 0.0;
        }
    }
    let between = |a: f32, b: f32| (a + b - 1.0).max(0.0);
    between(inside[0], inside[2]) * between(inside[1], inside[3])
}

/// Rays to a horizontal circle. With the ray scaled by `s` so that it would end in the circle's plane, the ray is
/// inside where `|offset| < radius s`; both sides are defined for every ray, those along the plane included.
#[derive(Debug, Clone, Copy)]
pub(super) struct DiscCone {
    /// `radius s` is this times the ray.
    radius: Vec3,
    /// The offset from the circle's centre, scaled by `s`, is these times the ray.
    offset: [Vec3; 2],
}

impl DiscCone {
    fn new(center: DVec3, radius_m: f64, position: DVec3, camera_from_world: DMat3) -> Option<Self> {
        let from_center = position - center;
        if !(radius_m > 0.0 && from_center.z != 0.0) {
            return None;
        }
        // The ray reaches the plane after −from_center.z / ray.z: `s` is the inverse.
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
            _ if inside < -reach => Side::Outside,
            _ if inside > reach => Side::Inside,
            _ => Side::Edge,
        }
    }

    /// As if the circle were straight within the patch.
    fn coverage(&self, patch: &RayPatch) -> f32 {
        let offset = self.offset(patch.center);
        let outwards = offset.normalize_or_zero();
        let change = |step: Vec3| self.radius.dot(step) - outwards.dot(self.offset(step));
        let middle = self.radius.dot(patch.center) - offset.length();
        positive_fraction(middle, [change(patch.across), change(patch.down)])
    }
}

/// The fraction of the unit square (x and y between −½ and ½) in which `middle + a x + b y` is positive.
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
