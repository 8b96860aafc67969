//! Class, distance and thing of every pixel: sixteen neighbouring pixels at a time, in plain arrays that the compiler turns into
//! vector instructions.

use reality_sim_core::{
    camera::{LANES, Lanes},
    field::FieldDimensions,
    pose::CameraPose,
    warp::{Placement, ProxyGeometry},
};

use super::{extent::Extent, goal_view::GoalView, painted_ground::PaintedGround};
use crate::class::Class;

/// What stands around a camera.
pub(super) struct View<'a> {
    ground: &'a PaintedGround,
    placement: Placement,
    /// Corners of the hall, with the camera as the origin, metres.
    low: [f32; 3],
    high: [f32; 3],
    goals: [GoalView; 2],
}

impl<'a> View<'a> {
    /// Looks at a field from a pose.
    pub(super) fn new(
        ground: &'a PaintedGround,
        field: &FieldDimensions,
        proxy: &ProxyGeometry,
        pose: CameraPose,
    ) -> Self {
        let (proxy, position) = (proxy.holding(pose), pose.position_in_world());
        let [negative_x, positive_x] = field.goals();
        // The proxy geometry has frame and back of the goal at +x, then of that at −x.
        let [_, back_at_positive_x, _, back_at_negative_x] = &proxy.billboards;
        Self {
            ground,
            placement: Placement::new(pose),
            low: (proxy.min_in_world - position).as_vec3().to_array(),
            high: (proxy.max_in_world - position).as_vec3().to_array(),
            goals: [
                GoalView::new(&negative_x, back_at_negative_x, position),
                GoalView::new(&positive_x, back_at_positive_x, position),
            ],
        }
    }
}

/// Labels of a row of pixels.
pub(super) struct Row<'a> {
    /// Number of the row.
    pub(super) number: u32,
    pub(super) classes: &'a mut [Class],
    pub(super) distance_m: &'a mut [f32],
    pub(super) instances: &'a mut [u16],
}

/// Labels a row, and adds the pixels of both goals, whatever stands before them, to their extents.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
pub(super) fn label_row(view: &View, rays: &[[Lanes; 3]], row: &mut Row, goals: &mut [Extent]) {
    let blocks = row.classes.chunks_mut(LANES).zip(row.distance_m.chunks_mut(LANES));
    let blocks = blocks.zip(row.instances.chunks_mut(LANES)).zip(rays).enumerate();
    for (number, (((classes, distances), instances), rays)) in blocks {
        let Surroundings { direction, inverse_x, mut distance, on_ground } = surroundings(view, rays);
        let mut goal_of = [0_u16; LANES];
        for (goal_number, goal) in view.goals.iter().enumerate() {
            let candidates = goal.candidates(&direction, &inverse_x);
            if candidates.iter().all(|candidate| *candidate == 0) {
                continue;
            }
            for i in (0..classes.len()).filter(|i| candidates[*i] != 0) {
                let Some(to_goal) = goal.distance(direction.map(|axis| axis[i])) else { continue };
                goals[goal_number].add((number * LANES + i) as u32, row.number);
                if to_goal < distance[i] {
                    (distance[i], goal_of[i]) = (to_goal, goal_number as u16 + 1);
                }
            }
        }
        let mut class = [Class::Outside; LANES];
        // Above the horizon no pixel of a block shows the ground.
        if on_ground.iter().any(|on| *on != 0) {
            class = ground_classes(view, &direction, &distance, &on_ground);
        }
        for i in 0..LANES {
            class[i] = if goal_of[i] != 0 { Class::Goal } else { class[i] };
        }
        let count = classes.len();
        classes.copy_from_slice(&class[..count]);
        distances.copy_from_slice(&distance[..count]);
        instances.copy_from_slice(&goal_of[..count]);
    }
}

/// Returns what is painted where rays end on the ground.
#[inline(always)]
fn ground_classes(
    view: &View,
    direction: &[Lanes; 3],
    distance: &Lanes,
    on_ground: &[u32; LANES],
) -> [Class; LANES] {
    let mut ground = [[0.0_f32; LANES]; 2];
    for axis in 0..2 {
        for i in 0..LANES {
            ground[axis][i] = view.placement.position_in_world[axis] + distance[i] * direction[axis][i];
        }
    }
    let mut classes = view.ground.classes_at(&ground);
    for i in 0..LANES {
        classes[i] = if on_ground[i] != 0 { classes[i] } else { Class::Outside };
    }
    classes
}

/// Ground and hall along sixteen rays.
struct Surroundings {
    /// Unit directions, world axes.
    direction: [Lanes; 3],
    /// One over the directions' x: divisions are what takes most time here.
    inverse_x: Lanes,
    /// Distances, metres; infinite where there is no ray.
    distance: Lanes,
    /// 1 where the ray ends on the ground, else 0.
    on_ground: [u32; LANES],
}

#[inline(always)]
fn surroundings(view: &View, rays: &[Lanes; 3]) -> Surroundings {
    let axes = &view.placement.axes_in_world;
    let mut direction = [[0.0_f32; LANES]; 3];
    let mut inverse_x = [0.0_f32; LANES];
    let mut distance = [f32::INFINITY; LANES];
    let mut on_ground = [0_u32; LANES];
    for axis in 0..3 {
        let (low, high) = (view.low[axis], view.high[axis]);
        for i in 0..LANES {
            let d = axes[0][axis] * rays[0][i] + axes[1][axis] * rays[1][i] + axes[2][axis] * rays[2][i];
            direction[axis][i] = d;
            let inverse = 1.0 / d;
            let to_wall = if d < 0.0 { low } else { high } * inverse;
            if axis == 0 {
                inverse_x[i] = inverse;
            }
            // False for NaN, which a pixel without a ray has.
            let is_nearer = to_wall < distance[i];
            distance[i] = if is_nearer { to_wall } else { distance[i] };
            if axis == 2 {
                on_ground[i] = u32::from(is_nearer & (d < 0.0));
            }
        }
    }
    Surroundings { direction, inverse_x, distance, on_ground }
}
