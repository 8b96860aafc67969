//! Proxy geometry: the shape that stands for the world, on which the ray of a pixel ends.
//!
//! The ground is the plane z = 0, exactly. Each goal is two upright *billboards*: its frame, from which posts and crossbar
//! do not stand out by more than half their thickness, and its back. All else (walls, ceiling, what stands in front of
//! them) is taken to lie on a box around the field. Together they are the *proxy geometry*, which is closed: the map from
//! one picture to another has no seam where the ground ends.

use glam::{DVec2, DVec3};

use crate::{field::FieldDimensions, pose::CameraPose};

/// Walls stand this far from the carpet until more is known, metres.
const USUAL_WALLS_M: f64 = 1.5;
/// The ceiling hangs this high until more is known, metres.
const USUAL_CEILING_M: f64 = 3.0;

/// No hall is larger, metres from the field's centre.
const LARGEST_M: f64 = 1000.0;
/// Room around a camera inside the proxy geometry, metres.
const ROOM_M: f64 = 0.3;
/// Nets and backs of goals stand this far behind the posts, metres.
const USUAL_GOAL_DEPTH_M: f64 = 0.5;

/// An upright rectangle on the ground, across the x axis and symmetric to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Billboard {
    /// Where it stands, metres.
    pub x_m: f64,
    /// Half its width, metres.
    pub half_width_m: f64,
    /// Metres.
    pub height_m: f64,
    /// Half the width of the opening in its middle, metres: 0 where there is none.
    pub opening_half_width_m: f64,
    /// Height of the opening, metres.
    pub opening_height_m: f64,
}

/// The measures of the hall around a field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hall {
    /// Where the walls stand towards −x and −y, metres.
    pub min_m: DVec2,
    /// Where the walls stand towards +x and +y, metres.
    pub max_m: DVec2,
    /// Height of the ceiling, metres.
    pub ceiling_m: f64,
    /// From the posts to the back of the goals, metres.
    pub goal_depth_m: f64,
}

impl Hall {
    /// A usual hall, until more is known.
    pub fn usual(field: &FieldDimensions) -> Self {
        let max_m = field.carpet_half_extent_m() + USUAL_WALLS_M;
        Self { min_m: -max_m, max_m, ceiling_m: USUAL_CEILING_M, goal_depth_m: USUAL_GOAL_DEPTH_M }
    }

    /// Whether the measures are finite numbers of a hall that holds the field.
    pub fn holds(&self, field: &FieldDimensions) -> bool {
        let half = DVec2::new(field.length_m, field.width_m) / 2.0;
        let sizes = [self.ceiling_m, self.goal_depth_m];
        let is_finite =
            self.min_m.is_finite() && self.max_m.is_finite() && sizes.iter().all(|size| size.is_finite());
        is_finite
            && self.min_m.cmplt(-half).all()
            && self.max_m.cmpgt(half).all()
            && self.max_m.max(-self.min_m).max_element() <= LARGEST_M
            && sizes.iter().all(|&size| size > 0.0 && size <= LARGEST_M)
    }
}

/// A box around the field with the goals in it, axes as the world's; its floor is the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProxyGeometry {
    /// Corner with the smallest coordinates, metres; z is 0.
    pub min_in_world: DVec3,
    /// Corner with the largest coordinates, metres.
    pub max_in_world: DVec3,
    /// Frame and back of both goals.
    pub billboards: [Billboard; 4],
}

impl ProxyGeometry {
    /// The shape of a hall with a field in it.
    pub fn new(hall: &Hall, field: &FieldDimensions) -> Self {
        Self {
            min_in_world: hall.min_m.extend(0.0),
            max_in_world: hall.max_m.extend(hall.ceiling_m),
            billboards: goal_billboards(field, hall.goal_depth_m),
        }
    }

    /// The same geometry, grown where it must be to hold a camera with some room around it.
    pub fn holding(mut self, pose: CameraPose) -> Self {
        let room = DVec3::splat(ROOM_M);
        self.min_in_world = self.min_in_world.min(pose.position_in_world() - room).with_z(0.0);
        self.max_in_world = self.max_in_world.max(pose.position_in_world() + room);
        self
    }
}

/// Frame and back of both goals.
fn goal_billboards(field: &FieldDimensions, depth_m: f64) -> [Billboard; 4] {
    let (inner_half_width, thickness) = (field.goal_width_m / 2.0, field.goal_post_diameter_m);
    let front = Billboard {
        x_m: field.length_m / 2.0,
        half_width_m: inner_half_width + thickness,
        height_m: field.goal_height_m + thickness,
        opening_half_width_m: inner_half_width,
        opening_height_m: field.goal_height_m,
    };
    let back = Billboard {
        x_m: front.x_m + depth_m,
        half_width_m: inner_half_width,
        height_m: field.goal_height_m,
        opening_half_width_m: 0.0,
        opening_height_m: 0.0,
    };
    let mirrored = |billboard: Billboard| Billboard { x_m: -billboard.x_m, ..billboard };
    [front, back, mirrored(front), mirrored(back)]
}
