//! A look at a picture that is to be drawn: a few hundred of its pixels, evenly spread, at which sources are compared.

use super::{
    BlendWeights, Source, Target,
    blend::view_weight,
    kernel::{ProxyPoints, proxy_points, see, unhidden},
    lanes::{least, most},
    rays::RayBlock,
    sampling::sample,
};
use crate::camera::LANES;

/// Number of rows of pixels that are examined, with sixteen pixels each.
const ROWS: usize = 12;

/// Weight below which a source does not show a pixel.
const LEAST_WEIGHT: f32 = 1e-6;

/// Cost of a pixel that a source does not see, the largest of [`Look::costs`].
pub const UNSEEN_COST: f32 = 4.0;

/// Evenly spread pixels of a target, and the points that they see.
pub struct Look<'a> {
    target: Target<'a>,
    points: Vec<ProxyPoints>,
}

impl std::fmt::Debug for Look<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Look").field("target", &self.target).finish_non_exhaustive()
    }
}

impl<'a> Look<'a> {
    /// Follows the pixels' rays.
    pub fn new(target: &Target<'a>) -> Self {
        let rays = target.rays;
        let row = |row: usize| {
            let blocks = rays.row((2 * row + 1) * rays.height as usize / (2 * ROWS));
            proxy_points(target.proxy, &target.placement, &spread(blocks, rays.width as usize))
        };
        Self { target: *target, points: (0..ROWS).map(row).collect() }
    }

    /// Returns how badly a source shows each of the pixels: 0 for a perfect view.
    pub fn costs(&self, source: &Source, weights: &BlendWeights) -> Vec<f32> {
        let mut costs = vec![0.0; ROWS * LANES];
        fill_costs(&self.points, &self.target, source, weights, &mut costs);
        costs
    }

    /// Returns the colours that a source shows at the pixels; `None` where it does not see them, or its mask hides them.
    pub fn colors(&self, source: &Source) -> Vec<Option<[f32; 3]>> {
        let mut colors = Vec::with_capacity(ROWS * LANES);
        for points in &self.points {
            let unhidden = unhidden(self.target.proxy, &source.placement, points);
            let pixels = see(source.camera, &source.placement, points);
            let seen = pixels.map(|pixels| (pixels.seen, sample(source.picture, &pixels)));
            let seen = seen.as_ref();
            colors.extend((0..LANES).map(|i| {
                seen.filter(|(seen, samples)| seen[i] * unhidden[i] * samples.shown[i] > 0.0)
                    .map(|(_, samples)| samples.color.map(|channel| channel[i]))
            }));
        }
        colors
    }

    /// Returns the places, in pixels of a source's camera, at which it would show the pixels; `None` where it does not see them.
    pub fn places(&self, source: &Source) -> Vec<Option<[f32; 2]>> {
        let mut places = Vec::with_capacity(ROWS * LANES);
        for points in &self.points {
            let unhidden = unhidden(self.target.proxy, &source.placement, points);
            let pixels = see(source.camera, &source.placement, points);
            let pixels = pixels.as_ref();
            places.extend((0..LANES).map(|i| {
                pixels
                    .filter(|pixels| pixels.seen[i] * unhidden[i] > 0.0)
                    .map(|pixels| [pixels.u[i], pixels.v[i]])
            }));
        }
        places
    }
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
fn fill_costs(
    points: &[ProxyPoints],
    target: &Target,
    source: &Source,
    weights: &BlendWeights,
    costs: &mut [f32],
) {
    for (points, costs) in points.iter().zip(costs.as_chunks_mut::<LANES>().0) {
        let mut weight = [0.0_f32; LANES];
        if let Some(pixels) = see(source.camera, &source.placement, points) {
            weight = view_weight(target, source, weights, points, &pixels);
        }
        for i in 0..LANES {
            let cost = least(1.0 / most(weight[i], LEAST_WEIGHT).sqrt(), UNSEEN_COST);
            costs[i] = if points.distance[i].is_nan() { 0.0 } else { cost };
        }
    }
}

/// Returns sixteen rays spread over a row.
fn spread(blocks: &[RayBlock], width: usize) -> RayBlock {
    std::array::from_fn(|axis| {
        std::array::from_fn(|lane| {
            let pixel = (2 * lane + 1) * width / (2 * LANES);
            blocks[pixel / LANES][axis][pixel % LANES]
        })
    })
}
