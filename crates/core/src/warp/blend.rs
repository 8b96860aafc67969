//! Blending of several pictures into one: every pixel is taken from the neighbours that see its point of the scene
//! best.
//!
//! The weights follow unstructured lumigraph rendering (Buehler et al., 2001): a penalty for the angle between the two
//! lines of sight, for coarser resolution, and for lying near the neighbour's border. A neighbour that disagrees with
//! the others at a pixel (because an obstacle stood there at the time, say) loses its weight there.

#![expect(clippy::needless_range_loop, reason = "sixteen lanes in step: the form the compiler vectorises")]

use std::sync::Arc;

use rayon::prelude::*;

use super::{
    Picture, ProxyGeometry,
    fill::fill,
    kernel::{Placement, ProxyPoints, proxy_points, see, unhidden},
    lanes::{least, most},
    mix::{Opinion, Opinions},
    origin::Origin,
    rays::{RayBlock, RayTable},
    sampling::{Samples, sample},
    weights::{BlendWeights, MAX_SOURCES},
};
use crate::camera::{KernelCamera, LANES, Lanes, Pixels};

/// Rows of a picture that one task draws.
const BAND_ROWS: usize = 8;

/// A recorded picture with its camera and pose.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    /// Camera that took the picture.
    pub camera: &'a KernelCamera,
    /// Pose of the camera.
    pub placement: Placement,
    /// Recorded picture.
    pub picture: &'a Arc<Picture>,
    /// Factors for red, green and blue.
    pub gain: [f32; 3],
}

/// Camera and pose for which a picture is wanted, with the proxy geometry of the scene.
#[derive(Debug, Clone, Copy)]
pub struct Target<'a> {
    /// Rays of the camera's pixels.
    pub rays: &'a RayTable,
    /// Pose of the camera.
    pub placement: Placement,
    /// Proxy geometry of the scene.
    pub proxy: &'a ProxyGeometry,
}

/// A picture warped from others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Warped {
    /// Red, green and blue, row by row from the top.
    pub colors: Vec<[u8; 3]>,
    /// Origin of each pixel.
    pub origins: Vec<Origin>,
}

/// Blackens the pixels at which the camera sees nothing, and fills in those that no source saw from the pixels around them.
/// This is the last step of [`blend`], on all devices.
pub fn complete(rays: &RayTable, colors: &mut [[u8; 3]], origins: &mut [Origin]) {
    rays.mark_outside(origins);
    for run in rays.outside() {
        colors[run.clone()].fill([0; 3]);
    }
    fill(colors, origins, rays.width as usize);
}

/// Draws the picture at the target from the sources; uses at most [`MAX_SOURCES`] of them.
pub fn blend(target: &Target, sources: &[Source], weights: &BlendWeights) -> Warped {
    let mut colors = vec![[0; 3]; target.rays.pixels()];
    let origins = blend_into(target, sources, weights, &mut colors);
    Warped { colors, origins }
}

/// Works like [`blend`], but draws into `colors`, row by row from the top, and returns the origin of each pixel.
///
/// # Panics
///
/// If there is not one colour for every pixel of the target.
pub fn blend_into(
    target: &Target,
    sources: &[Source],
    weights: &BlendWeights,
    colors: &mut [[u8; 3]],
) -> Vec<Origin> {
    draw_bands(target, sources, colors, BAND_ROWS, |sources, top, colors, origins| {
        let width = target.rays.width as usize;
        let rows = colors.chunks_mut(width).zip(origins.chunks_mut(width)).enumerate();
        for (row, (colors, origins)) in rows {
            blend_row(target, sources, weights, target.rays.row(top + row), colors, origins);
        }
    })
}

/// Draws a picture by bands of this many rows, each of them by `draw` from at most [`MAX_SOURCES`] sources, given its first row;
/// returns the origin of each pixel.
pub(crate) fn draw_bands(
    target: &Target,
    sources: &[Source],
    colors: &mut [[u8; 3]],
    rows: usize,
    draw: impl Fn(&[Source], usize, &mut [[u8; 3]], &mut [Origin]) + Sync,
) -> Vec<Origin> {
    assert_eq!(colors.len(), target.rays.pixels(), "one colour for every pixel");
    let sources = &sources[..sources.len().min(MAX_SOURCES)];
    let mut origins = vec![Origin { source: Origin::NOWHERE, trust: 0 }; colors.len()];
    let band = rows * target.rays.width as usize;
    let bands = colors.par_chunks_mut(band).zip(origins.par_chunks_mut(band)).enumerate();
    bands.for_each(|(number, (colors, origins))| draw(sources, number * rows, colors, origins));
    complete(target.rays, colors, &mut origins);
    origins
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2"))]
fn blend_row(
    target: &Target,
    sources: &[Source],
    weights: &BlendWeights,
    rays: &[RayBlock],
    colors: &mut [[u8; 3]],
    origins: &mut [Origin],
) {
    let mut opinions = Opinions::NONE;
    for ((rays, colors), origins) in rays.iter().zip(colors.chunks_mut(LANES)).zip(origins.chunks_mut(LANES))
    {
        let points = proxy_points(target.proxy, &target.placement, rays);
        opinions.clear();
        for (number, source) in sources.iter().enumerate() {
            // A closure would not be compiled for the processor's vectors.
            if form(opinions.next(number), target, source, weights, &points) {
                opinions.keep();
            }
        }
        opinions.mixed(sources.len(), weights, 0.0).write(colors, origins);
    }
}

/// Forms the opinion of a source on sixteen points; returns false if it sees none of them.
#[inline(always)]
pub(crate) fn form(
    opinion: &mut Opinion,
    target: &Target,
    source: &Source,
    weights: &BlendWeights,
    points: &ProxyPoints,
) -> bool {
    let Some(pixels) = see(source.camera, &source.placement, points) else { return false };
    let prior = view_weight(target, source, weights, points, &pixels);
    say(opinion, source, &sample(source.picture, &pixels), &prior);
    true
}

/// Writes down what a source shows, and its weight where the scene is shown.
#[inline(always)]
pub(crate) fn say(opinion: &mut Opinion, source: &Source, samples: &Samples, prior: &Lanes) {
    for channel in 0..3 {
        let gain = source.gain[channel];
        for i in 0..LANES {
            opinion.color[channel][i] = least(samples.color[channel][i] * gain, 255.0);
        }
    }
    for i in 0..LANES {
        opinion.prior[i] = if samples.shown[i] > 0.0 { prior[i] } else { 0.0 };
    }
}

/// Returns how badly a source shows points: a penalty for each.
#[inline(always)]
pub(crate) fn penalties(
    target: &Target,
    source: &Source,
    weights: &BlendWeights,
    points: &ProxyPoints,
    nearness: &Lanes,
) -> Lanes {
    let [x, y, z] = source.placement.position_in_world;
    let (height, target_height) = (z, target.placement.position_in_world[2]);
    let mut penalties = [0.0_f32; LANES];
    for i in 0..LANES {
        let nearness = nearness[i];
        let along = points.direction[0][i] * (points.place[0][i] - x)
            + points.direction[1][i] * (points.place[1][i] - y)
            + points.direction[2][i] * (points.place[2][i] - z);
        let cosine = along * nearness;
        let ground = points.on_ground[i];
        // Ratio of the pixel densities on the surface, target over source. The density falls with the squared distance,
        // and on the ground with one more power for the foreshortening.
        let nearer = 1.0 / (points.distance[i] * nearness);
        let flatter = nearer * target_height / height;
        let density = nearer * nearer * (1.0 + ground * (flatter - 1.0));
        let per_angle = weights.angle_above + ground * (weights.angle_on_ground - weights.angle_above);
        penalties[i] = weights.softness
            + per_angle * (1.0 - cosine)
            + weights.resolution * most(density - 1.0, 0.0) / 3.0;
    }
    penalties
}

/// Returns the weight of a source before it is compared with the others.
#[inline(always)]
pub(crate) fn weigh(source: &Source, weights: &BlendWeights, pixels: &Pixels, penalty: &Lanes) -> Lanes {
    let per_px = 1.0 / weights.border_px;
    let (max_u, max_v) = (source.camera.max_u, source.camera.max_v);
    let mut weight = [0.0_f32; LANES];
    for i in 0..LANES {
        let (u, v) = (pixels.u[i], pixels.v[i]);
        let inside_px = least(least(u, v), least(max_u - u, max_v - v));
        let fade = least((inside_px + 1.0) * per_px, 1.0);
        weight[i] = if pixels.seen[i] > 0.0 { fade / (penalty[i] * penalty[i]) } else { 0.0 };
    }
    weight
}

/// Returns the weight of a source at points, 0 where a goal hides them.
#[inline(always)]
pub(crate) fn view_weight(
    target: &Target,
    source: &Source,
    weights: &BlendWeights,
    points: &ProxyPoints,
    pixels: &Pixels,
) -> Lanes {
    let penalty = penalties(target, source, weights, points, &pixels.nearness);
    let mut weight = weigh(source, weights, pixels, &penalty);
    let unhidden = unhidden(target.proxy, &source.placement, points);
    for i in 0..LANES {
        weight[i] = if unhidden[i] > 0.0 { weight[i] } else { 0.0 };
    }
    weight
}
