//! Pixels of sixteen samples from those of four of them: along a line, the place in the picture is a smooth function of the place on
//! the ground, so that a cubic through four nodes serves for all samples in between. Projecting a sample costs a square root, a division
//! and the lens's polynomial; interpolating one costs eight multiplications.
//!
//! The error of a cubic is h⁴/24 times the fourth derivative at most (h: distance of the nodes). What a camera sees of a straight line
//! depends on directions alone, hence on h/d (d: distance from the camera): the error falls with its fourth power, and there is a largest h/d
//! at which it is below [`TOLERANCE_PX`] for all lines. Of an arc it depends on h/r, too (r: radius), which is known. The largest h/d is measured
//! for each camera, and for each arc of a field ([`CameraLimits`]).

use std::f64::consts::{GOLDEN_RATIO, TAU};

use glam::{DQuat, DVec2, DVec3};

use crate::camera::{KernelCamera, LANES, Lanes, Places, place_lanes};

/// Number of nodes of a block.
pub const NODES: usize = 4;
/// Samples of a block that are its nodes: as many between two neighbours.
pub(super) const NODE_LANES: [usize; NODES] = [0, 5, 10, 15];

/// Largest error of a place in the picture, pixels: a twentieth of the blur through which the models see lines.
pub(super) const TOLERANCE_PX: f32 = 0.05;
/// Part of the tolerance that the measured error may take, since other lines may be worse than those measured.
const MARGIN: f32 = 0.5;
/// Largest relative error of the nearness. What reads it is a weight with a limit at 1.
const NEARNESS_TOLERANCE: f32 = 1e-3;

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

/// Cubic through the four nodes of a block.
#[derive(Debug)]
pub(super) struct Cubic([Lanes; NODES]);

impl Cubic {
    /// Returns the cubic, whose [`basis`] the compiler does not know: where it sees the ones and zeros at the nodes, it leaves out their
    /// multiplications, and puts the vectors of the other lanes together by shuffles. On a processor with AVX2, a frame of
    /// `tag --observation gauss` then takes a fifth longer.
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self(std::hint::black_box(const { basis() }))
    }

    /// Interpolates between the nodes of one of four blocks.
    #[inline(always)]
    pub(super) fn interpolate(&self, nodes: &Lanes, block: usize) -> Lanes {
        let at = |node: usize| nodes[NODES * block + node];
        let Self([a, b, c, d]) = self;
        let mut values = [0.0; LANES];
        for (i, value) in values.iter_mut().enumerate() {
            *value = (a[i] * at(0) + b[i] * at(1)) + (c[i] * at(2) + d[i] * at(3));
        }
        values
    }
}

/// Where the samples of a block may be interpolated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest nearness of a node: one over the distance from the camera, per metre.
    pub largest_nearness: f32,
    /// Smallest cosine of a node's angle from the optical axis: all samples in between are within the lens's largest angle.
    pub min_cos: f32,
}

impl Limits {
    /// Limits of a block that is never interpolated: no point has such a nearness or cosine.
    pub const NOWHERE: Self = Self { largest_nearness: -1.0, min_cos: 2.0 };

    /// Returns the limits where both hold.
    pub fn and(self, other: Self) -> Self {
        Self {
            largest_nearness: self.largest_nearness.min(other.largest_nearness),
            min_cos: self.min_cos.max(other.min_cos),
        }
    }

    /// Returns for each of four blocks whether its samples may not be interpolated between these nodes: 0 if they may.
    #[inline(always)]
    pub(super) fn wrong(&self, nodes: &Places) -> [u32; NODES] {
        let mut wrong = [0u8; LANES];
        for ((wrong, nearness), cos) in wrong.iter_mut().zip(&nodes.nearness).zip(&nodes.cos) {
            // A point that is NaN is wrong.
            *wrong = u8::from(!((*nearness <= self.largest_nearness) & (*cos >= self.min_cos)));
        }
        std::array::from_fn(|block| {
            u32::from_ne_bytes(std::array::from_fn(|node| wrong[NODES * block + node]))
        })
    }
}

/// Measures where the samples of lines may be interpolated in pictures of a camera.
#[derive(Debug)]
pub(super) struct CameraLimits<'a> {
    camera: &'a KernelCamera,
    lines: Vec<Line>,
    /// Largest step along straight lines.
    straight: f64,
}

impl<'a> CameraLimits<'a> {
    /// Measures the limits of straight lines.
    pub fn new(camera: &'a KernelCamera) -> Self {
        let lines = (0..TRIED_LINES).map(|number| Line::new(camera, number)).collect();
        let limits = Self { camera, lines, straight: 0.0 };
        Self { straight: limits.largest_step(0.0), ..limits }
    }

    /// Returns the limits of a line with nodes this far from each other, which is bent by this angle between two of them, 0 if it is straight:
    /// metres and radians.
    pub fn of(&self, step_m: f64, bend_rad: f64) -> Limits {
        let step = if bend_rad == 0.0 { self.straight } else { self.largest_step(bend_rad) };
        // Between two nodes the cosine falls by h²/8 times its second derivative along the line at most, which is no more than 2/d² + 1/(d r).
        let margin = 0.25 * step * step + 0.125 * step * bend_rad;
        Limits { largest_nearness: (step / step_m) as f32, min_cos: self.camera.min_cos + margin as f32 }
    }

    /// Returns the largest ratio of the distance between nodes to their distance from the camera; 0 if there is none.
    fn largest_step(&self, bend_rad: f64) -> f64 {
        let steps = std::iter::successors(Some(STEPS[0]), |step| Some(step * STEP_FACTOR));
        // From the smallest: long lines may be right only because they reach out of the picture.
        let is_right = |step: &f64| {
            *step <= STEPS[1] && self.lines.iter().all(|line| line.is_right(self.camera, *step, bend_rad))
        };
        steps.take_while(is_right).last().unwrap_or(0.0)
    }
}

/// Line before a camera whose nearest node is at a distance of 1.
#[derive(Debug)]
struct Line {
    /// Lane of the nearest node.
    nearest: usize,
    /// Unit vectors to that node, along the line there, and, at a right angle to it, to the side to which the line is bent.
    towards: DVec3,
    along: DVec3,
    inwards: DVec3,
}

impl Line {
    /// Returns one of the lines tried: spread evenly over what the camera sees and over all directions.
    fn new(camera: &KernelCamera, number: u32) -> Self {
        // Multiples of the powers of 1/x, x⁵ = x + 1, fill four dimensions evenly; those of the golden ratio a fifth.
        let part = |power: i32| (f64::from(number) + 0.5) * 1.167_303_978_261_418_7_f64.powi(-power) % 1.0;
        let side = (f64::from(number) + 0.5) * GOLDEN_RATIO % 1.0;
        let direction = |angle_rad: f64, bearing_rad: f64| {
            let ((sin, cos), bearing) = (angle_rad.sin_cos(), DVec2::from_angle(bearing_rad));
            (sin * bearing).extend(cos)
        };
        let max_angle_rad = f64::from(camera.min_cos).acos();
        let towards = direction(max_angle_rad * part(1), TAU * part(2));
        let any = direction((1.0 - 2.0 * part(3)).acos(), TAU * part(4));
        // Either an end is nearest, or the line passes by.
        let (nearest, along) = if number.is_multiple_of(2) {
            (NODE_LANES[0], if any.dot(towards) < 0.0 { -any } else { any })
        } else {
            let aside = any.reject_from_normalized(towards);
            (NODE_LANES[1], aside.normalize_or(towards.any_orthonormal_vector()))
        };
        let inwards = DQuat::from_axis_angle(along, TAU * side) * along.any_orthonormal_vector();
        Self { nearest, towards, along, inwards }
    }

    /// Returns a point that is so many steps from the nearest node.
    fn at(&self, steps: f64, step: f64, bend_rad: f64) -> DVec3 {
        let (length, turn_rad) = (steps * step, steps * bend_rad);
        // Chord of an arc: its length is sin(x)/x that of the arc, x half of the angle.
        let half_rad = 0.5 * turn_rad;
        let chord = if half_rad == 0.0 { length } else { length * half_rad.sin() / half_rad };
        self.towards + chord * (half_rad.cos() * self.along + half_rad.sin() * self.inwards)
    }

    /// Returns whether what the picture contains of the line is interpolated right, with nodes this far from each other.
    fn is_right(&self, camera: &KernelCamera, step: f64, bend_rad: f64) -> bool {
        let point = |lane: usize| {
            let steps = (lane as f64 - self.nearest as f64) / (NODE_LANES[1] - NODE_LANES[0]) as f64;
            self.at(steps, step, bend_rad)
        };
        let exact = place_lanes(camera, &lanes(point));
        if NODE_LANES.iter().any(|lane| exact.cos[*lane] < camera.min_cos) {
            return true;
        }
        let nodes = place_lanes(camera, &lanes(|lane| point(NODE_LANES[lane % NODES])));
        let cubic = Cubic::new();
        let [u, v, nearness] = [&nodes.u, &nodes.v, &nodes.nearness].map(|nodes| cubic.interpolate(nodes, 0));
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
