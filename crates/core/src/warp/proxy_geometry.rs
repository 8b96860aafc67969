//! Proxy geometry: the shape that stands for the scene, on which the ray of a pixel ends.
//!
//! The ground is exactly the plane z = 0. Each goal is two upright *billboards*: its frame, from which posts and
//! crossbar stand out by no more than half their thickness, and its back. Everything else (walls, ceiling, whatever
//! stands in front of them) is taken to lie on a box around the field. The whole is closed, so the map from one picture
//! to another has no seam where the ground ends.

use glam::{DVec2, DVec3};

use crate::{field::FieldDimensions, pose::CameraPose};

/// Default distance of the walls from the carpet, metres.
const USUAL_WALLS_M: f64 = 1.5;
/// Default height of the ceiling, metres.
const USUAL_CEILING_M: f64 = 3.0;

/// Maximum distance of walls and ceiling from the field's centre, metres.
const LARGEST_M: f64 = 1000.0;
/// Free space around a camera inside the proxy geometry, metres.
const ROOM_M: f64 = 0.3;
/// Default distance of nets and backs of goals behind the posts, metres.
const USUAL_GOAL_DEPTH_M: f64 = 0.5;

/// Upright rectangle on the ground, perpendicular to the x axis and symmetric about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Billboard {
    /// Position along x, metres.
    pub x_m: f64,
    /// Half its width, metres.
    pub half_width_m: f64,
    /// Height, metres.
    pub height_m: f64,
    /// Half the width of the opening in its middle, metres: 0 without an opening.
    pub opening_half_width_m: f64,
    /// Height of the opening, metres.
    pub opening_height_m: f64,
}

/// Dimensions of the hall around a field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hall {
    /// Coordinates of the walls towards −x and −y, metres.
    pub min_m: DVec2,
    /// Coordinates of the walls towards +x and +y, metres.
    pub max_m: DVec2,
    /// Height of the ceiling, metres.
    pub ceiling_m: f64,
    /// Distance from the posts to the back of the goals, metres.
    pub goal_depth_m: f64,
}

impl Hall {
    /// Returns a typical hall, for use until more is known.
    pub fn usual(field: &FieldDimensions) -> Self {
        let max_m = field.carpet_half_extent_m() + USUAL_WALLS_M;
        Self { min_m: -max_m, max_m, ceiling_m: USUAL_CEILING_M, goal_depth_m: USUAL_GOAL_DEPTH_M }
    }

    /// Returns whether the dimensions are finite and the hall contains the field.
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

/// Box around the field with the goals in it, in world axes; its floor is the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProxyGeometry {
    /// Corner with the smallest coordinates, metres; z is 0.
    pub min_in_world: DVec3,
    /// Corner with the largest coordinates, metres.
    pub max_in_world: DVec3,
    /// Frames and backs of both goals.
    pub billboards: [Billboard; 4],
}

impl ProxyGeometry {
    /// Returns the proxy geometry of a hall with a field in it.
    pub fn new(hall: &Hall, field: &FieldDimensions) -> Self {
        Self {
            min_in_world: hall.min_m.extend(0.0),
            max_in_world: hall.max_m.extend(hall.ceiling_m),
            billboards: goal_billboards(field, hall.goal_depth_m),
        }
    }

    /// Returns the same geometry, enlarged if necessary to contain a camera with some space around it.
    pub fn holding(mut self, pose: CameraPose) -> Self {
        let room = DVec3::splat(ROOM_M);
        self.min_in_world = self.min_in_world.min(pose.position_in_world() - room).with_z(0.0);
        self.max_in_world = self.max_in_world.max(pose.position_in_world() + room);
        self
    }
}

/// Returns frame and back of both goals.
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
