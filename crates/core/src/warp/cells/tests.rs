#![expect(clippy::needless_range_loop, reason = "sixteen lanes in step, as in the code under test")]

use std::f64::consts::PI;

use image::RgbImage;
use proptest::prelude::*;

use super::{
    super::{
        Hall, Picture, Placement, ProxyGeometry, RayTable, blend,
        kernel::{proxy_points, see, unhidden},
    },
    *,
};
use crate::{
    camera::{Camera, Distortion, KernelCamera, Opencv, OpencvFisheye},
    field::FieldDimensions,
    pose::{CameraPose, Motion2, Pose2},
};

/// Largest distance between a place and its interpolation, pixels.
const LARGEST_OFF_PX: f32 = 0.05;

/// Lenses from 180° across to a narrow one, in full-size pictures.
fn camera(number: usize) -> Camera {
    let fisheye = |k| Distortion::OpencvFisheye(OpencvFisheye { k });
    let opencv = Opencv { k1: -0.12, k2: 0.03, p1: 0.001, p2: -0.002, k3: 0.0 };
    let made = match number {
        0 => {
            Camera::new([640, 480], [215.0, 215.0, 319.5, 239.5], fisheye([-0.058, 0.0082, -0.0009, 0.00005]))
        }
        1 => Camera::new([320, 240], [90.0, 90.0, 160.2, 121.0], fisheye([-0.033, 0.001, 0.0, 0.0])),
        2 => Camera::new([640, 480], [400.0, 402.0, 322.0, 238.0], Distortion::Opencv(opencv)),
        _ => Camera::new([325, 244], [250.0, 250.0, 160.0, 120.0], Distortion::Pinhole),
    };
    made.unwrap()
}

fn any_pose() -> impl Strategy<Value = CameraPose> {
    (-2.8..2.8, -1.9..1.9, -PI..PI, 0.3..1.3, 0.1..0.8, -0.2..0.2).prop_map(
        |(x, y, yaw, height, pitch, roll)| CameraPose::new(Pose2::new(x, y, yaw), height, pitch, roll),
    )
}

/// What one pixel shows of a source.
#[derive(Clone, Copy, PartialEq)]
struct Seen {
    surface: f32,
    is_shown: bool,
    u: f32,
    v: f32,
}

/// What the cells say of a source; `None` where every pixel is computed.
fn by_cells(target: &Target, source: &Source) -> Vec<Option<Seen>> {
    let (width, height) = (target.rays.width as usize, target.rays.height as usize);
    let weights = BlendWeights::default();
    let mut found = vec![None; width * height];
    for top in (0..height).step_by(CELL) {
        for column in 0..width.div_ceil(CELL) {
            let sources = [*source];
            let cell = Cell::new(target, &sources, &weights, column, top, CELL.min(height - top));
            let Some(faces) = cell.faces else { continue };
            for row in 0..CELL.min(height - top) {
                let seen = cell.points(row).surface;
                if cell.is_uneven(0) || faces.all().len() > 1 && !faces.hold(&seen) {
                    continue;
                }
                for (views, &surface) in cell.views.iter().zip(faces.all()) {
                    let ([u, v, _], prior) = match &views[0] {
                        SourceView::Smooth(map) => (map.places(row), map.at(row, source, &weights)),
                        _ => ([[0.0; LANES]; 3], None),
                    };
                    for lane in 0..CELL.min(width - column * CELL) {
                        // The nodes' surface counts for the whole of a cell that shows only one.
                        if faces.all().len() == 1 || surface == seen[lane] {
                            let is_shown = prior.is_some_and(|(_, weights)| weights[lane] > 0.0);
                            let (u, v) = (u[lane], v[lane]);
                            found[(top + row) * width + column * CELL + lane] =
                                Some(Seen { surface, is_shown, u, v });
                        }
                    }
                }
            }
        }
    }
    found
}

/// What every pixel shows of a source, computed one by one.
fn one_by_one(target: &Target, source: &Source) -> Vec<Seen> {
    let width = target.rays.width as usize;
    let mut found = Vec::new();
    for row in 0..target.rays.height as usize {
        for (block, rays) in target.rays.row(row).iter().enumerate() {
            let points = proxy_points(target.proxy, &target.placement, rays);
            let pixels = see(source.camera, &source.placement, &points);
            let unhidden = unhidden(target.proxy, &source.placement, &points);
            for lane in 0..LANES.min(width - block * LANES) {
                let surface = points.surface[lane];
                found.push(match &pixels {
                    Some(pixels) => Seen {
                        surface,
                        is_shown: pixels.seen[lane] * unhidden[lane] > 0.0,
                        u: pixels.u[lane],
                        v: pixels.v[lane],
                    },
                    None => Seen { surface, is_shown: false, u: 0.0, v: 0.0 },
                });
            }
        }
    }
    found
}

/// Whether a pixel at most one to the side is as `is_it` says.
fn is_beside(width: usize, all: &[Seen], index: usize, is_it: impl Fn(&Seen) -> bool) -> bool {
    let (u, v) = ((index % width) as isize, (index / width) as isize);
    (-1..=1).flat_map(|dv| (-1..=1).map(move |du| (u + du, v + dv))).any(|(u, v)| {
        let is_inside = (0..width as isize).contains(&u) && v >= 0;
        is_inside && all.get(v as usize * width + u as usize).is_some_and(&is_it)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn places_are_those_of_every_pixel_and_edges_at_most_a_pixel_off(
        pose in any_pose(), forward in -1.5..1.5, left in -1.5..1.5, turn in -1.5..1.5,
        lenses in (0_usize..4, 0_usize..4),
    ) {
        let (drawn, recorded) = (camera(lenses.0), camera(lenses.1));
        let from = pose.with_planar(pose.planar().moved(Motion2 { forward_m: forward, left_m: left, turn_rad: turn }));
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let proxy = ProxyGeometry::new(&Hall::usual(&field), &field).holding(pose).holding(from);
        let rays = RayTable::new(&drawn);
        let target = Target { rays: &rays, placement: Placement::new(pose), proxy: &proxy };
        let (camera, picture) = (KernelCamera::new(&recorded), picture(&recorded));
        let source =
            Source { camera: &camera, placement: Placement::new(from), picture: &picture, gain: [1.0; 3] };
        let (found, exact) = (by_cells(&target, &source), one_by_one(&target, &source));
        let width = drawn.width as usize;
        let mut compared = 0;
        for (index, (found, exact_one)) in found.iter().zip(&exact).enumerate() {
            let Some(found) = found else { continue };
            compared += 1;
            let has_surface = |other: &Seen| other.surface == found.surface;
            prop_assert!(is_beside(width, &exact, index, has_surface), "another surface at {index}");
            let is_as_shown = |other: &Seen| other.is_shown == found.is_shown;
            prop_assert!(is_beside(width, &exact, index, is_as_shown), "another edge at {index}: {} {} {}, {} {} {}", found.is_shown, found.u, found.v, exact_one.is_shown, exact_one.u, exact_one.v);
            if found.is_shown && exact_one.is_shown && has_surface(exact_one) {
                let off = (found.u - exact_one.u).abs().max((found.v - exact_one.v).abs());
                prop_assert!(off <= LARGEST_OFF_PX, "{off} px at {index}");
            }
        }
        // One scene in two thousand has no such cell; were there many, the test would fail for want of scenes.
        prop_assume!(compared >= 4 * CELL * CELL);
    }

    #[test]
    fn pictures_are_those_drawn_pixel_by_pixel(
        pose in any_pose(), steps in prop::collection::vec((-0.4..0.4, -0.4..0.4, -0.4..0.4), 1..=MAX_SOURCES),
    ) {
        let (drawn, recorded) = (camera(1), camera(0));
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let mut proxy = ProxyGeometry::new(&Hall::usual(&field), &field).holding(pose);
        let poses: Vec<CameraPose> = steps
            .iter()
            .map(|&(forward_m, left_m, turn_rad)| pose.with_planar(pose.planar().moved(Motion2 { forward_m, left_m, turn_rad })))
            .collect();
        proxy = poses.iter().fold(proxy, |proxy, pose| proxy.holding(*pose));
        let rays = RayTable::new(&drawn);
        let target = Target { rays: &rays, placement: Placement::new(pose), proxy: &proxy };
        let (camera, picture) = (KernelCamera::new(&recorded), picture(&recorded));
        let sources: Vec<Source> = poses
            .iter()
            .map(|pose| Source { camera: &camera, placement: Placement::new(*pose), picture: &picture, gain: [1.0; 3] })
            .collect();
        let weights = BlendWeights::default();
        let exact = blend(&target, &sources, &weights);
        let mut colors = vec![[0; 3]; rays.pixels()];
        let origins = blend_cells_into(&target, &sources, &weights, &mut colors);
        // In 1500 such scenes it was 0.18 % at most, and 0.06 % in all but one.
        let beyond = colors.iter().enumerate().filter(|(index, color)| !is_around(&exact.colors, rays.width as usize, *index, **color)).count();
        let other = origins.iter().zip(&exact.origins).filter(|(a, b)| a.source != b.source).count();
        prop_assert!(beyond <= colors.len() / 200, "{beyond} colours");
        prop_assert!(other <= colors.len() / 100, "{other} origins");
    }
}

/// Whether a colour is, to two levels, among those of the pixels at most one to the side: where edges are at most a pixel off.
fn is_around(colors: &[[u8; 3]], width: usize, index: usize, color: [u8; 3]) -> bool {
    let (u, v) = (index % width, index / width);
    let rows = v.saturating_sub(1)..=(v + 1).min(colors.len() / width - 1);
    let around = || {
        rows.clone().flat_map(|v| (u.saturating_sub(1)..=(u + 1).min(width - 1)).map(move |u| v * width + u))
    };
    (0..3).all(|channel| {
        let values = || around().map(|index| colors[index][channel]);
        let (least, most) = (values().min().unwrap_or(0), values().max().unwrap_or(255));
        (least.saturating_sub(2)..=most.saturating_add(2)).contains(&color[channel])
    })
}

/// Makes a picture with soft stripes.
fn picture(camera: &Camera) -> std::sync::Arc<Picture> {
    let picture = RgbImage::from_fn(camera.width, camera.height, |u, v| {
        let wave = |per_px: f64, at: u32| (128.0 + 90.0 * (per_px * f64::from(at)).sin()) as u8;
        image::Rgb([wave(0.11, u), wave(0.13, v), wave(0.07, u + v)])
    });
    std::sync::Arc::new(Picture::from(&picture))
}
