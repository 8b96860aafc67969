//! Line samples on the ground, laid out for the scoring loops: sixteen together, in blocks, and where a block's samples lie evenly on a
//! straight line, four blocks together.

use glam::DVec2;

use super::interpolation::{NODE_LANES, NODES, are_even};
use crate::camera::{LANES, Lanes};

/// Circle on the ground, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Circle {
    pub centre: [f32; 2],
    pub radius: f32,
}

impl Circle {
    fn around(points: &[DVec2]) -> Self {
        let centre = points.iter().sum::<DVec2>() / points.len() as f64;
        let radius = points.iter().map(|point| point.distance(centre)).fold(0.0, f64::max);
        // The radius is a little larger, to allow for rounding.
        Self { centre: [centre.x as f32, centre.y as f32], radius: 1.001 * radius as f32 + 1e-4 }
    }
}

/// x and y of sixteen points on the ground, metres.
pub(super) type Ground = [Lanes; 2];

/// Sixteen samples. Each has N points: its centre on the line, or that and a point to both sides of the line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Block<const N: usize> {
    /// A block with fewer samples is padded with NaN, which no camera sees.
    pub points: [Ground; N],
    /// Contains all points.
    pub circle: Circle,
}

impl<const N: usize> Block<N> {
    fn new(samples: &[[DVec2; N]]) -> Self {
        let points = std::array::from_fn(|number| ground(samples.iter().map(|sample| sample[number])));
        Self { points, circle: Circle::around(samples.as_flattened()) }
    }
}

/// Four blocks, each of samples that lie evenly on a straight line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Quad<const N: usize> {
    /// Nodes of all blocks, four of each: between them, places in the picture are interpolated.
    pub nodes: [Ground; N],
    /// Largest distance of neighbouring nodes, metres.
    pub step_m: f32,
    /// Contains all points.
    pub circle: Circle,
    pub blocks: [Block<N>; NODES],
}

impl<const N: usize> Quad<N> {
    fn new(blocks: [&[[DVec2; N]]; NODES]) -> Self {
        let node = |lane: usize| blocks[lane / NODES][NODE_LANES[lane % NODES]];
        let steps = (0..LANES).filter(|lane| lane % NODES > 0).flat_map(|lane| {
            let (from, to) = (node(lane - 1), node(lane));
            (0..N).map(move |number| from[number].distance(to[number]))
        });
        Self {
            nodes: std::array::from_fn(|number| ground((0..LANES).map(|lane| node(lane)[number]))),
            step_m: steps.fold(0.0, f64::max) as f32,
            circle: Circle::around(blocks.concat().as_flattened()),
            blocks: blocks.map(Block::new),
        }
    }
}

/// All samples of a field's lines, each with N points.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Samples<const N: usize> {
    pub quads: Vec<Quad<N>>,
    /// Samples that are in no quad.
    pub others: Vec<Block<N>>,
}

impl<const N: usize> Samples<N> {
    /// Takes the samples line by line, each in order.
    pub fn new<'a>(lines: impl Iterator<Item = &'a [[DVec2; N]]>) -> Self {
        let (mut even, mut others) = (Vec::new(), Vec::new());
        for line in lines {
            let chunks = line.chunks_exact(LANES);
            others.extend(chunks.remainder());
            for chunk in chunks {
                let is_even = (0..N).all(|number| are_even(&std::array::from_fn(|lane| chunk[lane][number])));
                if is_even { even.push(chunk) } else { others.extend(chunk) }
            }
        }
        let fours = even.chunks_exact(NODES);
        others.extend(fours.remainder().concat());
        Self {
            quads: fours.map(|four| Quad::new(std::array::from_fn(|block| four[block]))).collect(),
            others: others.chunks(LANES).map(Block::new).collect(),
        }
    }

    /// Returns the points of every sample.
    pub fn points(&self) -> impl Iterator<Item = [[f32; 2]; N]> {
        let blocks = self.quads.iter().flat_map(|quad| &quad.blocks).chain(&self.others);
        let sample = |block: &Block<N>, lane: usize| block.points.map(|[x, y]| [x[lane], y[lane]]);
        let samples = blocks.flat_map(move |block| (0..LANES).map(move |lane| sample(block, lane)));
        samples.filter(|points| !points[0][0].is_nan())
    }
}

fn ground(points: impl Iterator<Item = DVec2>) -> Ground {
    let mut ground = [[f32::NAN; LANES]; 2];
    for (lane, point) in points.enumerate() {
        (ground[0][lane], ground[1][lane]) = (point.x as f32, point.y as f32);
    }
    ground
}
