//! Pixels of sixteen samples from those of four of them: along a straight line, the place in the picture is a smooth function of the place on
//! the ground, so that a cubic through four nodes serves for all samples in between. Projecting a sample costs a square root, a division
//! and the lens's polynomial; interpolating one costs eight multiplications.
//!
//! The error of a cubic is h⁴/24 times the fourth derivative at most (h: distance of the nodes). What a camera sees of a line
//! depends on directions alone, hence on h/d (d: distance from the camera): the error falls with its fourth power, and there is a largest h/d
//! at which it is below [`TOLERANCE_PX`] for all lines. It is measured for each camera ([`Limits`]). Arcs are never interpolated: their bends add
//! so much that only those far away could be.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use crate::camera::{KernelCamera, LANES, Lanes, Places, place_lanes};

/// Number of nodes of a block.
pub(super) const NODES: usize = 4;
/// Samples of a block that are its nodes: as many between two neighbours.
pub(super) const NODE_LANES: [usize; NODES] = [0, 5, 10, 15];

/// Largest error of a place in the picture, pixels: a twentieth of the blur through which the models see lines.
pub(super) const TOLERANCE_PX: f32 = 0.05;
/// Part of the tolerance that the measured error may take, since other lines may be worse than those measured.
const MARGIN: f32 = 0.5;
/// Largest relative error of the nearness. What reads it is a weight with a limit at 1.
const NEARNESS_TOLERANCE: f32 = 1e-3;
/// Smallest cosine of an angle from the optical axis: farther out lenses bend so much that all steps would have to be smaller, and a camera that looks
/// ahead sees only what is before its robot's feet there.
const MIN_COS: f32 = 0.0;
/// Largest distance of a sample from its place on an even line, metres: rounding in the field's dimensions.
const EVEN_M: f64 = 1e-6;

/// Smallest and largest h/d tried, and the factor from one to the next.
const STEPS: [f64; 2] = [0.02, 0.4];
const STEP_FACTOR: f64 = 1.06;
/// Number of lines that each h/d is tried on.
const TRIED_LINES: u32 = 400;

/// Values of a block's nodes → values of its samples: one row for each node. A cubic by Lagrange.
const fn basis() -> [Lanes; NODES] {
    let mut basis = [[1.0; LANES]; NODES];
    let mut node = 0;
    while node < NODES {
        let mut lane = 0;
        while lane < LANES {
            let mut other = 0;
            let mut value = 1.0_f64;
            while other < NODES {
                if other != node {
                    let (at, from) = (NODE_LANES[node] as f64, NODE_LANES[other] as f64);
                    value *= (lane as f64 - from) / (at - from);
                }
                other += 1;
            }
            basis[node][lane] = value as f32;
            lane += 1;
        }
        node += 1;
    }
    basis
}

/// See [`basis`].
pub(super) const BASIS: [Lanes; NODES] = basis();

/// Interpolates between the nodes of one of four blocks.
#[inline(always)]
pub(super) fn interpolate(nodes: &Lanes, block: usize) -> Lanes {
    let at = |node: usize| nodes[NODES * block + node];
    let mut values = [0.0; LANES];
    for (i, value) in values.iter_mut().enumerate() {
        *value = (BASIS[0][i] * at(0) + BASIS[1][i] * at(1)) + (BASIS[2][i] * at(2) + BASIS[3][i] * at(3));
    }
    values
}

/// Returns whether points lie evenly on a straight line.
pub(super) fn are_even(points: &[DVec2; LANES]) -> bool {
    let (first, last) = (points[0], points[LANES - 1]);
    let even = |lane: usize| first.lerp(last, lane as f64 / (LANES - 1) as f64);
    points.iter().enumerate().all(|(lane, point)| point.distance(even(lane)) <= EVEN_M)
}

/// Where samples may be interpolated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest ratio of the distance between nodes to their distance from the camera.
    pub largest_step: f32,
    /// Smallest cosine of a node's angle from the optical axis: all samples in between are within the lens's largest angle.
    pub min_cos: f32,
}

impl Limits {
    /// Measures the limits of a camera.
    pub fn new(camera: &KernelCamera) -> Self {
        let lines: Vec<Line> = (0..TRIED_LINES).map(|number| Line::new(camera, number)).collect();
        let steps = std::iter::successors(Some(STEPS[0]), |step| Some(step * STEP_FACTOR));
        // From the smallest: long lines may be right only because they reach out of the picture.
        let is_right =
            |step: &f64| *step <= STEPS[1] && lines.iter().all(|line| line.is_right(camera, *step));
        let largest_step = steps.take_while(is_right).last().unwrap_or(0.0) as f32;
        // Between two nodes the cosine falls by h²/8 times its second derivative along the line at most, which is no more than 2/d².
        let margin = 0.25 * largest_step * largest_step;
        Self { largest_step, min_cos: camera.min_cos.max(MIN_COS) + margin }
    }

    /// Returns for each of four blocks whether its samples may not be interpolated between these nodes, the largest distance of which is
    /// given: 0 if they may.
    #[inline(always)]
    pub fn wrong(&self, nodes: &Places, step_m: f32) -> [u32; NODES] {
        let largest_nearness = self.largest_step / step_m;
        let mut wrong = [0u8; LANES];
        for ((wrong, nearness), cos) in wrong.iter_mut().zip(&nodes.nearness).zip(&nodes.cos) {
            // A point that is NaN is wrong.
            *wrong = u8::from(!((*nearness <= largest_nearness) & (*cos >= self.min_cos)));
        }
        std::array::from_fn(|block| {
            u32::from_ne_bytes(std::array::from_fn(|node| wrong[NODES * block + node]))
        })
    }
}

/// Straight line before a camera whose nearest node is at a distance of 1.
struct Line {
    /// Lane of the nearest node.
    nearest: usize,
    /// Unit vectors to that node, and along the line.
    towards: DVec3,
    along: DVec3,
}

impl Line {
    /// Returns one of the lines tried: spread evenly over what the camera sees and over all directions.
    fn new(camera: &KernelCamera, number: u32) -> Self {
        // Multiples of the powers of 1/x, x⁵ = x + 1, fill four dimensions evenly.
        let part = |power: i32| (f64::from(number) + 0.5) * 1.167_303_978_261_418_7_f64.powi(-power) % 1.0;
        let direction = |angle_rad: f64, bearing_rad: f64| {
            let ((sin, cos), bearing) = (angle_rad.sin_cos(), DVec2::from_angle(bearing_rad));
            (sin * bearing).extend(cos)
        };
        let max_angle_rad = f64::from(camera.min_cos.max(MIN_COS)).acos();
        let towards = direction(max_angle_rad * part(1), TAU * part(2));
        let any = direction((1.0 - 2.0 * part(3)).acos(), TAU * part(4));
        // Either an end is nearest, or the line passes by.
        let (nearest, along) = if number.is_multiple_of(2) {
            (NODE_LANES[0], if any.dot(towards) < 0.0 { -any } else { any })
        } else {
            let aside = any.reject_from_normalized(towards);
            (NODE_LANES[1], aside.normalize_or(towards.any_orthonormal_vector()))
        };
        Self { nearest, towards, along }
    }

    /// Returns whether what the picture contains of the line is interpolated right, with nodes this far from each other.
    fn is_right(&self, camera: &KernelCamera, step: f64) -> bool {
        let point = |lane: usize| {
            let steps = (lane as f64 - self.nearest as f64) / (NODE_LANES[1] - NODE_LANES[0]) as f64;
            self.towards + steps * step * self.along
        };
        let exact = place_lanes(camera, &lanes(point));
        if NODE_LANES.iter().any(|lane| exact.cos[*lane] < camera.min_cos.max(MIN_COS)) {
            return true;
        }
        let nodes = place_lanes(camera, &lanes(|lane| point(NODE_LANES[lane % NODES])));
        let [u, v, nearness] = [&nodes.u, &nodes.v, &nodes.nearness].map(|nodes| interpolate(nodes, 0));
        let contains =
            |u: f32, v: f32| (0.0..=camera.max_u).contains(&u) && (0.0..=camera.max_v).contains(&v);
        (0..LANES).filter(|i| contains(u[*i], v[*i]) || contains(exact.u[*i], exact.v[*i])).all(|i| {
            (u[i] - exact.u[i]).hypot(v[i] - exact.v[i]) <= MARGIN * TOLERANCE_PX
                && (nearness[i] / exact.nearness[i] - 1.0).abs() <= NEARNESS_TOLERANCE
        })
    }
}

fn lanes(point: impl Fn(usize) -> DVec3) -> [Lanes; 3] {
    let points: [DVec3; LANES] = std::array::from_fn(point);
    [points.map(|p| p.x as f32), points.map(|p| p.y as f32), points.map(|p| p.z as f32)]
}
