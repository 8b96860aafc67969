//! Line samples on the ground, laid out for the scoring loops: up to sixteen neighbours of one line in a block, and four blocks together.

use glam::DVec2;

use super::{
    block::{LineBlock, SamplePoints},
    interpolation::{CameraLimits, Limits, NODE_LANES, NODES},
    path::Path,
};
use crate::camera::{LANES, Lanes};

/// Circle on the ground, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Circle {
    pub centre: [f32; 2],
    pub radius: f32,
}

impl Circle {
    /// Circle of no points: wherever a camera is, the circle is out of its view.
    const EMPTY: Self = Self { centre: [0.0; 2], radius: f32::NEG_INFINITY };

    fn around(points: &[DVec2]) -> Self {
        let centre = points.iter().sum::<DVec2>() / points.len() as f64;
        let radius = points.iter().map(|point| point.distance(centre)).fold(0.0, f64::max);
        // The radius is a little larger, to allow for rounding.
        Self { centre: [centre.x as f32, centre.y as f32], radius: 1.001 * radius as f32 + 1e-4 }
    }
}

/// x and y of sixteen points on the ground, metres.
pub(super) type Ground = [Lanes; 2];

/// Up to sixteen samples. Each has N points: its centre on the line, or that and a point to both sides of the line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Block<const N: usize> {
    /// A block with fewer samples is padded with NaN, which no camera sees.
    pub points: [Ground; N],
    /// 1 for each sample, 0 for the padding.
    pub is_sample: Lanes,
    /// Contains all points.
    pub circle: Circle,
}

impl<const N: usize> Block<N> {
    /// Block without samples.
    const EMPTY: Self =
        Self { points: [[[f32::NAN; LANES]; 2]; N], is_sample: [0.0; LANES], circle: Circle::EMPTY };

    fn new(samples: &[[DVec2; N]]) -> Self {
        let points = std::array::from_fn(|number| ground(samples.iter().map(|sample| sample[number])));
        let is_sample = std::array::from_fn(|lane| if lane < samples.len() { 1.0 } else { 0.0 });
        Self { points, is_sample, circle: Circle::around(samples.as_flattened()) }
    }
}

/// Four blocks.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Quad<const N: usize> {
    /// Nodes of all blocks, four of each: between them, places in the picture are interpolated.
    pub nodes: [Ground; N],
    /// Where that is right.
    pub limits: Limits,
    /// Contains all points.
    pub circle: Circle,
    pub blocks: [Block<N>; NODES],
}

impl<const N: usize> Quad<N> {
    /// Puts up to four chunks together.
    fn new(chunks: &[(Chunk<N>, Limits)]) -> Self {
        let node = |lane: usize, number: usize| {
            let paths = chunks.get(lane / NODES).and_then(|(chunk, _)| chunk.paths.as_ref());
            paths.map_or(DVec2::NAN, |paths| paths[number].at(NODE_LANES[lane % NODES] as f64))
        };
        let all = chunks.iter().flat_map(|(chunk, _)| chunk.samples.as_flattened()).copied();
        let limits = chunks.iter().map(|(_, limits)| *limits).reduce(Limits::and);
        Self {
            nodes: std::array::from_fn(|number| ground((0..LANES).map(|lane| node(lane, number)))),
            limits: limits.unwrap_or(Limits::NOWHERE),
            circle: Circle::around(&all.collect::<Vec<_>>()),
            blocks: std::array::from_fn(|block| {
                chunks.get(block).map_or(Block::EMPTY, |(chunk, _)| Block::new(chunk.samples))
            }),
        }
    }
}

/// Samples of one block, neighbours of each other on one line.
struct Chunk<'a, const N: usize> {
    samples: &'a [[DVec2; N]],
    /// On which the points are even; `None` if they are not.
    paths: Option<[Path; N]>,
}

impl<'a, const N: usize> Chunk<'a, N> {
    fn new(samples: &'a [[DVec2; N]]) -> Self {
        let path = |number: usize| {
            let points: Vec<DVec2> = samples.iter().map(|sample| sample[number]).collect();
            Path::through(&points)
        };
        let paths: Vec<Path> = (0..N).map_while(path).collect();
        Self { samples, paths: paths.try_into().ok() }
    }

    /// Largest distance of neighbouring nodes, metres, and largest angle between the directions there; `None` if the points are not even.
    fn step(&self) -> Option<[f64; 2]> {
        let steps = self.paths.as_ref()?.iter().map(|path| path.step((NODE_LANES[1] - NODE_LANES[0]) as f64));
        steps.reduce(|[a, b], [c, d]| [a.max(c), b.max(d)])
    }
}

/// All samples of a field's lines, each with N points.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Samples<const N: usize> {
    pub quads: Vec<Quad<N>>,
}

impl<const N: usize> Samples<N> {
    /// Takes the samples line by line, each in order.
    pub fn new<'a>(lines: impl Iterator<Item = &'a [[DVec2; N]]>, limits: &CameraLimits) -> Self {
        let (mut straight, mut bent, mut uneven) = (Vec::new(), Vec::new(), Vec::new());
        for line in lines {
            let chunks: Vec<Chunk<N>> = line.chunks(LANES).map(Chunk::new).collect();
            // Measured once for a line: its chunks are alike.
            let most = chunks.iter().filter_map(Chunk::step).reduce(|[a, b], [c, d]| [a.max(c), b.max(d)]);
            let [step_m, bend_rad] = most.unwrap_or_default();
            let limits = limits.of(step_m, bend_rad);
            for chunk in chunks {
                match chunk.paths {
                    None => uneven.push((chunk, Limits::NOWHERE)),
                    Some(_) if bend_rad > 0.0 => bent.push((chunk, limits)),
                    Some(_) => straight.push((chunk, limits)),
                }
            }
        }
        // Apart from each other, since the blocks of a quad have their limits in common.
        let quads = [straight, bent, uneven]
            .into_iter()
            .flat_map(|alike| alike.chunks(NODES).map(Quad::new).collect::<Vec<_>>());
        Self { quads: quads.collect() }
    }

    /// Returns every block that has samples, with these two of its points.
    pub fn blocks(&self, [first, second]: [usize; 2]) -> impl Iterator<Item = LineBlock> {
        let two = move |points: &[Ground; N], lane: usize| {
            [first, second].map(|number| points[number].map(|axis| axis[lane]))
        };
        let numbered = self.quads.iter().flat_map(|quad| (0..NODES).map(move |block| (quad, block)));
        let blocks = numbered.map(move |(quad, number)| {
            let block = &quad.blocks[number];
            let is_sample = |lane: &usize| block.is_sample[*lane] > 0.0;
            let samples: Vec<SamplePoints> =
                (0..LANES).filter(is_sample).map(|lane| two(&block.points, lane)).collect();
            let first_sample = samples.first().copied().unwrap_or_default();
            // Not every graphics device knows NaN.
            let node = |node: SamplePoints| {
                if node.as_flattened().iter().all(|number| number.is_finite()) { node } else { first_sample }
            };
            LineBlock {
                samples,
                nodes: std::array::from_fn(|lane| node(two(&quad.nodes, NODES * number + lane))),
                limits: quad.limits,
                centre: block.circle.centre,
                radius_m: block.circle.radius,
            }
        });
        blocks.filter(|block| !block.samples.is_empty())
    }
}

fn ground(points: impl Iterator<Item = DVec2>) -> Ground {
    let mut ground = [[f32::NAN; LANES]; 2];
    for (lane, point) in points.enumerate() {
        (ground[0][lane], ground[1][lane]) = (point.x as f32, point.y as f32);
    }
    ground
}
