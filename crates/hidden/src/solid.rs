//! Things in the hall: boxes, tubes and balls, and the first hit of a ray.

use std::ops::Range;

use glam::{Vec2, Vec3};

/// Thing with several parts inside a bounding sphere, which saves testing the parts.
#[derive(Debug, Clone)]
pub struct Thing {
    /// Centre of the sphere around all parts, metres.
    pub center: Vec3,
    /// Radius of the sphere, metres.
    pub radius: f32,
    parts: Vec<Part>,
}

/// Surface of one colour.
#[derive(Debug, Clone, Copy)]
pub struct Part {
    shape: Shape,
    rgb: Vec3,
}

#[derive(Debug, Clone, Copy)]
enum Shape {
    /// Upright box, turned about the vertical.
    Box {
        center: Vec3,
        half: Vec3,
        heading: Vec2,
    },
    /// Tube between two points, open at the ends.
    Tube {
        from: Vec3,
        along: Vec3,
        length: f32,
        radius: f32,
    },
    Ball {
        center: Vec3,
        radius: f32,
    },
}

impl Part {
    /// Makes an upright box; `heading_rad` is the direction of its first half side.
    pub fn cuboid(center: Vec3, half: Vec3, heading_rad: f32, rgb: Vec3) -> Self {
        Self { shape: Shape::Box { center, half, heading: Vec2::from_angle(heading_rad) }, rgb }
    }

    /// Makes a round tube from one point to another.
    pub fn tube(from: Vec3, to: Vec3, radius: f32, rgb: Vec3) -> Self {
        let length = from.distance(to);
        Self { shape: Shape::Tube { from, along: (to - from) / length, length, radius }, rgb }
    }

    /// Makes a ball.
    pub fn ball(center: Vec3, radius: f32, rgb: Vec3) -> Self {
        Self { shape: Shape::Ball { center, radius }, rgb }
    }

    /// Returns centre and radius of a bounding sphere.
    fn bound(&self) -> (Vec3, f32) {
        match self.shape {
            Shape::Box { center, half, .. } => (center, half.length()),
            Shape::Tube { from, along, length, radius } => {
                (from + along * (length / 2.0), length / 2.0 + radius)
            }
            Shape::Ball { center, radius } => (center, radius),
        }
    }

    /// Returns the distance to the surface within a range, and its normal.
    fn hit(&self, origin: Vec3, direction: Vec3, range: Range<f32>) -> Option<(f32, Vec3)> {
        match self.shape {
            Shape::Box { center, half, heading } => hit_box(origin - center, direction, half, heading, range),
            Shape::Tube { from, along, length, radius } => {
                let start = origin - from;
                let flat = |vector: Vec3| vector - along * vector.dot(along);
                let (near, side) = hit_ball(flat(start), flat(direction), radius, range)?;
                (0.0..=length).contains(&(start + direction * near).dot(along)).then_some((near, side))
            }
            Shape::Ball { center, radius } => hit_ball(origin - center, direction, radius, range),
        }
    }
}

impl Thing {
    /// Makes a thing of these parts, at least one.
    pub fn new(parts: Vec<Part>) -> Self {
        let bounds: Vec<_> = parts.iter().map(Part::bound).collect();
        let center = bounds.iter().map(|(center, _)| *center).sum::<Vec3>() / bounds.len() as f32;
        let reach = |(other, radius): &(Vec3, f32)| center.distance(*other) + radius;
        Self { center, radius: bounds.iter().map(reach).fold(0.0, f32::max), parts }
    }

    /// Returns the thing moved by a vector.
    pub fn moved(&self, way: Vec3) -> Self {
        let mut moved = self.clone();
        moved.center += way;
        for part in &mut moved.parts {
            match &mut part.shape {
                Shape::Box { center, .. } | Shape::Ball { center, .. } => *center += way,
                Shape::Tube { from, .. } => *from += way,
            }
        }
        moved
    }

    /// Returns distance and colour of a ray's first hit before `limit`; surfaces are lit slightly more from above.
    pub fn hit(&self, origin: Vec3, direction: Vec3, limit: f32) -> Option<(f32, Vec3)> {
        let to_center = self.center - origin;
        let along = to_center.dot(direction);
        if to_center.length_squared() - along * along > self.radius * self.radius {
            return None;
        }
        let mut nearest = None;
        let mut limit = limit;
        for part in &self.parts {
            if let Some((distance, normal)) = part.hit(origin, direction, 0.01..limit) {
                limit = distance;
                nearest = Some((distance, part.rgb * (0.75 + 0.2 * normal.z + 0.05 * normal.x)));
            }
        }
        nearest
    }
}

fn hit_ball(start: Vec3, direction: Vec3, radius: f32, range: Range<f32>) -> Option<(f32, Vec3)> {
    let (a, b) = (direction.length_squared(), start.dot(direction));
    let root = b * b - a * (start.length_squared() - radius * radius);
    if root < 0.0 {
        return None;
    }
    let near = (-b - root.sqrt()) / a;
    range.contains(&near).then(|| (near, (start + direction * near) / radius))
}

fn hit_box(
    start: Vec3,
    direction: Vec3,
    half: Vec3,
    heading: Vec2,
    range: Range<f32>,
) -> Option<(f32, Vec3)> {
    let inward =
        |v: Vec3| Vec3::new(v.x * heading.x + v.y * heading.y, v.y * heading.x - v.x * heading.y, v.z);
    let (start, direction) = (inward(start), inward(direction));
    let entries = (-start - half * direction.signum()) / direction;
    let exits = (-start + half * direction.signum()) / direction;
    let near = entries.max_element();
    if near > exits.min_element() || !range.contains(&near) {
        return None;
    }
    let face = Vec3::from(entries.cmpge(Vec3::splat(near)));
    Some((near, -face * direction.signum()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_meet_surfaces_where_they_are() {
        let white = Vec3::ONE;
        let along_x = |part: Part| Thing::new(vec![part]).hit(Vec3::ZERO, Vec3::X, 100.0).map(|(d, _)| d);
        let close = |distance: Option<f32>, expected: f32| (distance.unwrap() - expected).abs() < 1e-5;
        let center = Vec3::new(5.0, 0.1, 0.0);
        assert!(close(along_x(Part::cuboid(center, Vec3::splat(1.0), 0.0, white)), 4.0));
        let diagonal = std::f32::consts::FRAC_PI_4;
        let center = Vec3::new(5.0, 0.0, 0.0);
        assert!(close(along_x(Part::cuboid(center, Vec3::splat(1.0), diagonal, white)), 5.0 - 2_f32.sqrt()));
        assert!(close(along_x(Part::ball(center, 0.5, white)), 4.5));
        let (low, high) = (center - Vec3::Z, center + Vec3::Z);
        assert!(close(along_x(Part::tube(low, high, 0.5, white)), 4.5));
        assert!(along_x(Part::tube(low + 2.0 * Vec3::Z, high + 2.0 * Vec3::Z, 0.5, white)).is_none());
        assert!(along_x(Part::ball(-center, 0.5, white)).is_none(), "behind");
    }
}
