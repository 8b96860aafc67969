//! The scene: layers of shapes, from the ground up.

mod goal;
mod lines;
mod shape;

use glam::{DVec2, DVec3, Vec3};
use reality_sim_core::field::FieldDimensions;

pub(crate) use self::shape::Shape;
use self::{
    goal::GoalBars,
    lines::{Rectangle, circles, straight_lines},
};
use crate::SceneColors;

/// Distance from the carpet's edge to the hall's walls, metres.
const FLOOR_AROUND_CARPET_M: f64 = 3.0;
/// Height of the hall's ceiling above the ground, metres.
const HALL_HEIGHT_M: f64 = 4.0;

/// Overlap between the shapes of a layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Overlap {
    /// Shapes touch at most.
    None,
    /// Shapes intersect where they meet.
    Joined,
}

/// Shapes of one colour.
#[derive(Debug, Clone)]
pub(crate) struct Layer {
    /// Linear RGB.
    pub(crate) color: Vec3,
    pub(crate) shapes: Vec<Shape>,
    pub(crate) overlap: Overlap,
    /// Whether the shapes lie on the ground, where the light may be uneven.
    pub(crate) on_ground: bool,
}

/// Ground, goals and hall.
#[derive(Debug, Clone)]
pub(crate) struct Scene {
    wall: Vec3,
    /// Floor, carpet, straight lines and circles, each on top of the previous one.
    ground: [Layer; 4],
    ceiling: Layer,
    /// Goals at −x and at +x.
    goals: [(Vec3, GoalBars); 2],
}

impl Scene {
    pub(crate) fn new(field: &FieldDimensions, colors: SceneColors) -> Self {
        let carpet = Rectangle::around(DVec2::ZERO, field.carpet_half_extent_m());
        let floor = carpet.grown(FLOOR_AROUND_CARPET_M);
        let layer = |color, shapes| Layer { color, shapes, overlap: Overlap::None, on_ground: true };
        let [negative_x, positive_x] = field.goals().map(|goal| GoalBars::new(&goal));
        Self {
            wall: colors.wall_linear_rgb,
            ground: [
                layer(colors.floor_linear_rgb, vec![floor.at_height(0.0)]),
                layer(colors.carpet_linear_rgb, vec![carpet.at_height(0.0)]),
                layer(colors.line_linear_rgb, straight_lines(field)),
                layer(colors.line_linear_rgb, circles(field)),
            ],
            ceiling: Layer {
                on_ground: false,
                ..layer(colors.ceiling_linear_rgb, vec![floor.at_height(HALL_HEIGHT_M)])
            },
            goals: [
                (colors.goal_negative_x_linear_rgb, negative_x),
                (colors.goal_positive_x_linear_rgb, positive_x),
            ],
        }
    }

    /// Returns the colour where there is no layer: the walls.
    pub(crate) fn background(&self) -> Vec3 {
        self.wall
    }

    /// Returns the layers visible from a position above the ground, from back to front. The hall has no outside: from beyond
    /// its walls or above its ceiling, they do not hide the field.
    pub(crate) fn layers_seen_from(&self, position: DVec3) -> Vec<Layer> {
        let ceiling = (position.z < HALL_HEIGHT_M).then_some(&self.ceiling);
        // The nearer goal hides the farther one: the plane x = 0 separates them.
        let [negative_x, positive_x] = &self.goals;
        let far_to_near = if position.x < 0.0 { [positive_x, negative_x] } else { [negative_x, positive_x] };
        let goals = far_to_near.map(|(color, bars)| Layer {
            color: *color,
            shapes: bars.outlines_from(position),
            overlap: Overlap::Joined,
            on_ground: false,
        });
        self.ground.iter().chain(ceiling).cloned().chain(goals).collect()
    }
}
