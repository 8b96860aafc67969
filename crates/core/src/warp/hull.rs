//! The shape that stands for the world: what the ray of a pixel ends on.
//!
//! The ground is the plane z = 0, exactly. Each goal is an upright *screen* between its posts, from which they
//! and the crossbar do not stand out by more than their thickness. All else (walls, ceiling, what stands in front of them) is
//! taken to lie on a box around the field, the *hull* of the hall. Ground and hull are closed: the map from one picture to
//! another has no seam where the ground ends.

use glam::{DVec2, DVec3};

use crate::{field::FieldDimensions, pose::CameraPose};

/// Walls stand this far from the carpet until more is known, metres.
const USUAL_WALLS_M: f64 = 1.5;
/// The ceiling hangs this high until more is known, metres.
const USUAL_CEILING_M: f64 = 3.0;

/// Nets and backs of goals stand this far behind the posts, metres.
const USUAL_GOAL_DEPTH_M: f64 = 0.5;

/// An upright rectangle on the ground, across the x axis and symmetric to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Screen {
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

/// A box around the field with the goals in it, axes as the world's; its floor is the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hull {
    /// Corner with the smallest coordinates, metres; z is 0.
    pub min_in_world: DVec3,
    /// Corner with the largest coordinates, metres.
    pub max_in_world: DVec3,
    /// The goals.
    pub screens: [Screen; 4],
}

impl Hull {
    /// A hall of the usual size around a field.
    pub fn around(field: &FieldDimensions) -> Self {
        let half = field.carpet_half_extent_m() + USUAL_WALLS_M;
        Self {
            min_in_world: (-half).extend(0.0),
            max_in_world: half.extend(USUAL_CEILING_M),
            screens: goal_screens(field),
        }
    }

    /// The same hull, grown where it must be to hold a camera with this much room around it, metres.
    pub fn holding(mut self, pose: CameraPose, room_m: f64) -> Self {
        let room = DVec2::splat(room_m).extend(room_m);
        self.min_in_world = self.min_in_world.min(pose.position_in_world() - room).with_z(0.0);
        self.max_in_world = self.max_in_world.max(pose.position_in_world() + room);
        self
    }
}

/// Frame and back of both goals.
fn goal_screens(field: &FieldDimensions) -> [Screen; 4] {
    let (inner_half_width, thickness) = (field.goal_width_m / 2.0, field.goal_post_diameter_m);
    let front = Screen {
        x_m: field.length_m / 2.0,
        half_width_m: inner_half_width + thickness,
        height_m: field.goal_height_m + thickness,
        opening_half_width_m: inner_half_width,
        opening_height_m: field.goal_height_m,
    };
    let back = Screen {
        x_m: front.x_m + USUAL_GOAL_DEPTH_M,
        half_width_m: inner_half_width,
        height_m: field.goal_height_m,
        opening_half_width_m: 0.0,
        opening_height_m: 0.0,
    };
    let mirrored = |screen: Screen| Screen { x_m: -screen.x_m, ..screen };
    [front, back, mirrored(front), mirrored(back)]
}
