//! What there is to see: layers of flat shapes, from the ground up.

mod goal;

use glam::{DVec2, DVec3, Vec3};
use reality_sim_core::field::{Curve, FieldDimensions};

use self::goal::GoalBars;
use crate::SceneColors;

/// Side of the penalty and centre marks, metres: squares along the lines.
const MARK_SIDE_M: f64 = 0.1;
/// From the carpet's edge to the hall's walls, metres.
const FLOOR_AROUND_CARPET_M: f64 = 3.0;
/// From the ground to the hall's ceiling, metres.
const HALL_HEIGHT_M: f64 = 4.0;

/// A flat shape in the world, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Shape {
    /// A convex quadrilateral by its corners, in order.
    Quad([DVec3; 4]),
    /// A horizontal circle.
    Disc {
        /// Its centre.
        center: DVec3,
        /// Metres.
        radius_m: f64,
    },
    /// What is between two horizontal circles.
    Ring {
        /// Their centre.
        center: DVec3,
        /// Radius of the smaller; 0 or less for none.
        inner_m: f64,
        /// Radius of the larger.
        outer_m: f64,
    },
}

/// Shapes of one colour (linear RGB).
#[derive(Debug, Clone)]
pub(crate) struct Layer {
    /// Linear RGB.
    pub(crate) color: Vec3,
    /// They may overlap.
    pub(crate) shapes: Vec<Shape>,
}

/// The scene.
#[derive(Debug, Clone)]
pub(crate) struct World {
    wall: Vec3,
    /// Floor, carpet and lines, each on the one before.
    ground: [Layer; 3],
    ceiling: Layer,
    /// The goals at −x and at +x.
    goals: [(Vec3, GoalBars); 2],
}

impl World {
    pub(crate) fn new(field: &FieldDimensions, colors: SceneColors) -> Self {
        let carpet = field.carpet_half_extent_m();
        let floor = carpet + FLOOR_AROUND_CARPET_M;
        let around_center = |half_m: DVec2, z_m| vec![rectangle(DVec2::ZERO, half_m.x * DVec2::X, half_m.y, z_m)];
        let [negative_x, positive_x] = field.goals().map(|goal| GoalBars::new(&goal));
        Self {
            wall: colors.wall_linear_rgb,
            ground: [
                Layer { color: colors.floor_linear_rgb, shapes: around_center(floor, 0.0) },
                Layer { color: colors.carpet_linear_rgb, shapes: around_center(carpet, 0.0) },
                Layer { color: colors.line_linear_rgb, shapes: line_shapes(field) },
            ],
            ceiling: Layer {
                color: colors.ceiling_linear_rgb,
                shapes: around_center(floor, HALL_HEIGHT_M),
            },
            goals: [
                (colors.goal_negative_x_linear_rgb, negative_x),
                (colors.goal_positive_x_linear_rgb, positive_x),
            ],
        }
    }

    /// What is seen where there is no layer: the walls.
    pub(crate) fn background(&self) -> Vec3 {
        self.wall
    }

    /// What is seen from a place above the ground, each layer in front of those before it. The hall has no outside:
    /// from beyond its walls or its ceiling they are not seen.
    pub(crate) fn layers_seen_from(&self, position: DVec3) -> Vec<Layer> {
        let ceiling = (position.z < HALL_HEIGHT_M).then_some(&self.ceiling);
        // The nearer goal hides the farther one: the plane x = 0 is between them.
        let [negative_x, positive_x] = &self.goals;
        let far_to_near = if position.x < 0.0 { [positive_x, negative_x] } else { [negative_x, positive_x] };
        let goals =
            far_to_near.map(|(color, bars)| Layer { color: *color, shapes: bars.outline_from(position) });
        self.ground.iter().chain(ceiling).cloned().chain(goals).collect()
    }
}

/// White lines and marks.
fn line_shapes(field: &FieldDimensions) -> Vec<Shape> {
    let half_m = field.line_width_m / 2.0;
    let line = |curve: &Curve| match *curve {
        // Lines meet at their centres: with half a width more at each end, corners are square.
        Curve::Segment { from, to } => {
            let half = (to - from) / 2.0;
            rectangle((from + to) / 2.0, half + half_m * half.normalize_or_zero(), half_m, 0.0)
        }
        Curve::Circle { center, radius_m } => Shape::Ring {
            center: center.extend(0.0),
            inner_m: radius_m - half_m,
            outer_m: radius_m + half_m,
        },
    };
    let mark = |center| rectangle(center, MARK_SIDE_M / 2.0 * DVec2::X, MARK_SIDE_M / 2.0, 0.0);
    field.curves().iter().map(line).chain(field.marks().into_iter().map(mark)).collect()
}

/// A horizontal rectangle: from its centre to the middle of one end, half its width, and its height above the ground.
fn rectangle(center: DVec2, half_along: DVec2, half_width_m: f64, z_m: f64) -> Shape {
    let half_across = half_width_m * half_along.perp().normalize_or_zero();
    let corner = |along: f64, across: f64| (center + along * half_along + across * half_across).extend(z_m);
    Shape::Quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)])
}
