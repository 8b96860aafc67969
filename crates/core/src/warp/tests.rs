use std::{f64::consts::PI, sync::Arc};

use glam::{DVec2, DVec3};
use image::{Rgb, RgbImage};
use proptest::prelude::*;

use super::*;
use crate::{
    camera::{Camera, Distortion, KernelCamera, Opencv, OpencvFisheye},
    field::FieldDimensions,
    pose::{CameraPose, Pose2},
};

fn field() -> FieldDimensions {
    FieldDimensions::preset("humanoid-kidsize-2010").unwrap()
}

fn fisheye() -> Camera {
    let lens = OpencvFisheye { k: [-0.058, 0.0082, -0.0009, 0.00005] };
    Camera::new([160, 120], [54.0, 54.0, 79.5, 59.5], Distortion::OpencvFisheye(lens)).unwrap()
}

fn opencv() -> Camera {
    let lens = Opencv { k1: -0.12, k2: 0.03, p1: 0.001, p2: -0.002, k3: 0.0 };
    Camera::new([128, 96], [80.0, 82.0, 64.0, 47.0], Distortion::Opencv(lens)).unwrap()
}

fn any_pose() -> impl Strategy<Value = CameraPose> {
    (-2.5..2.5, -1.7..1.7, -PI..PI, 0.4..0.6, 0.3..0.6, -0.1..0.1).prop_map(
        |(x, y, yaw, height, pitch, roll)| CameraPose::new(Pose2::new(x, y, yaw), height, pitch, roll),
    )
}

/// Returns a pose a few steps away.
fn near(pose: CameraPose, forward_m: f64, turn_rad: f64) -> CameraPose {
    pose.with_planar(pose.planar().moved(crate::pose::Motion2 {
        forward_m,
        left_m: -0.2 * forward_m,
        turn_rad,
    }))
}

/// Returns the colour of a point in the world, which varies slowly enough for bilinear interpolation.
fn paint(point: DVec3) -> [f64; 3] {
    [
        128.0 + 60.0 * (1.1 * point.x).sin() + 40.0 * (0.9 * point.z).cos(),
        120.0 + 50.0 * (1.3 * point.y + 0.4).cos(),
        110.0 + 50.0 * (0.8 * (point.x + point.y)).sin(),
    ]
}

/// Returns where a ray from inside the proxy geometry ends, without using the code under test.
fn end_of_ray(proxy: &ProxyGeometry, from: DVec3, ray: DVec3) -> DVec3 {
    let mut nearest = f64::INFINITY;
    for axis in 0..3 {
        for wall in [proxy.min_in_world[axis], proxy.max_in_world[axis]] {
            let distance = (wall - from[axis]) / ray[axis];
            if distance > 0.0 && distance < nearest {
                nearest = distance;
            }
        }
    }
    for billboard in &proxy.billboards {
        let distance = (billboard.x_m - from.x) / ray.x;
        let point = from + distance * ray;
        let is_opening =
            point.y.abs() < billboard.opening_half_width_m && point.z < billboard.opening_height_m;
        let is_on = point.y.abs() <= billboard.half_width_m
            && (0.0..=billboard.height_m).contains(&point.z)
            && !is_opening;
        if distance > 0.0 && distance < nearest && is_on {
            nearest = distance;
        }
    }
    from + nearest * ray
}

/// Photographs the painted world through a lens.
fn photograph(camera: &Camera, pose: CameraPose, proxy: &ProxyGeometry) -> RgbImage {
    RgbImage::from_fn(camera.width, camera.height, |u, v| {
        match camera.unproject(DVec2::new(f64::from(u), f64::from(v))) {
            Ok(ray) => {
                let ray = pose.rotation_world_from_camera() * ray;
                Rgb(paint(end_of_ray(proxy, pose.position_in_world(), ray)).map(|value| value.round() as u8))
            }
            Err(_) => Rgb([0; 3]),
        }
    })
}

/// Returns a hall without goals, in which every point is visible from everywhere.
fn open_geometry() -> ProxyGeometry {
    let mut proxy = ProxyGeometry::new(&Hall::usual(&field()), &field());
    proxy.billboards.iter_mut().for_each(|billboard| billboard.half_width_m = -1.0);
    proxy
}

struct Taken {
    camera: KernelCamera,
    placement: Placement,
    picture: Arc<Picture>,
}

impl Taken {
    fn new(camera: &Camera, pose: CameraPose, picture: &RgbImage) -> Self {
        let (camera, placement) = (KernelCamera::new(camera), Placement::new(pose));
        Self { camera, placement, picture: Arc::new(Picture::from(picture)) }
    }

    fn source(&self) -> Source<'_> {
        Source { camera: &self.camera, placement: self.placement, picture: &self.picture, gain: [1.0; 3] }
    }
}

fn drawn(camera: &Camera, pose: CameraPose, proxy: &ProxyGeometry, taken: &[Taken]) -> Warped {
    let rays = RayTable::new(camera);
    let target = Target { rays: &rays, placement: Placement::new(pose), proxy };
    let sources: Vec<Source> = taken.iter().map(Taken::source).collect();
    blend(&target, &sources, &BlendWeights::default())
}

fn worst_difference(warped: &Warped, truth: &RgbImage, mut counts: impl FnMut(usize) -> bool) -> u8 {
    let pixels = warped.colors.iter().zip(truth.pixels()).enumerate().filter(|(index, _)| counts(*index));
    pixels.flat_map(|(_, (a, b))| [0, 1, 2].map(|i| a[i].abs_diff(b.0[i]))).max().unwrap_or(0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn what_a_source_saw_is_drawn_as_the_world_looks_from_the_target(pose in any_pose(), forward in -0.4..0.4, turn in -0.5..0.5) {
        let proxy = open_geometry();
        for (target, source) in [(fisheye(), fisheye()), (opencv(), fisheye()), (fisheye(), opencv())] {
            let from = near(pose, forward, turn);
            let taken = Taken::new(&source, from, &photograph(&source, from, &proxy));
            let warped = drawn(&target, pose, &proxy, &[taken]);
            let seen = |index: usize| warped.origins[index].source == 0;
            let count = (0..warped.colors.len()).filter(|index| seen(*index)).count();
            prop_assert!(count > warped.colors.len() / 16, "{count} pixels");
            // At grazing angles a pixel covers metres of ground: a few far pixels may differ by more.
            let truth = photograph(&target, pose, &proxy);
            let different = warped.colors.iter().zip(truth.pixels()).enumerate()
                .filter(|(index, (a, b))| seen(*index) && (0..3).any(|i| a[i].abs_diff(b.0[i]) > 5)).count();
            prop_assert!((different as f64) < 0.05 * count as f64, "{different} of {count}");
        }
    }

    #[test]
    fn from_its_own_pose_a_picture_is_drawn_as_it_is(pose in any_pose()) {
        let proxy = ProxyGeometry::new(&Hall::usual(&field()), &field());
        let camera = fisheye();
        let picture = photograph(&camera, pose, &proxy);
        let warped = drawn(&camera, pose, &proxy, &[Taken::new(&camera, pose, &picture)]);
        // A point right behind the edge of a goal counts as hidden, and at the picture's edge rounding decides.
        let seen = |index: usize| warped.origins[index].source == 0;
        prop_assert!(worst_difference(&warped, &picture, seen) <= 1);
        prop_assert!((0..warped.colors.len()).filter(|index| seen(*index)).count() as f64 > 0.8 * warped.colors.len() as f64);
    }

    /// A goal stands between the source and the wall: the wall must not be painted with it.
    #[test]
    fn goals_are_drawn_where_they_stand_and_not_on_the_wall_behind(y in -1.0..1.0, yaw in -0.3..0.3, left in -0.5..0.5) {
        let proxy = ProxyGeometry::new(&Hall::usual(&field()), &field());
        let camera = fisheye();
        let pose = CameraPose::new(Pose2::new(1.2, y, yaw), 0.5, 0.3, 0.0);
        let from = CameraPose { y_m: y + left, ..pose };
        let black_goals = |pose: CameraPose| {
            RgbImage::from_fn(camera.width, camera.height, |u, v| {
                let ray = camera.unproject(DVec2::new(f64::from(u), f64::from(v))).unwrap();
                let end = end_of_ray(&proxy, pose.position_in_world(), pose.rotation_world_from_camera() * ray);
                let is_goal = proxy.billboards.iter().any(|billboard| (end.x - billboard.x_m).abs() < 1e-6 && end.z > 1e-6);
                Rgb(if is_goal { [0; 3] } else { [200; 3] })
            })
        };
        let warped = drawn(&camera, pose, &proxy, &[Taken::new(&camera, from, &black_goals(from))]);
        let truth = black_goals(pose);
        let wrong = warped.colors.iter().zip(truth.pixels()).zip(&warped.origins)
            .filter(|((a, b), origin)| origin.source == 0 && a[0].abs_diff(b.0[0]) > 100).count();
        let goal = truth.pixels().filter(|pixel| pixel.0[0] == 0).count();
        // Along edges, half a pixel decides.
        prop_assert!(goal > 100);
        prop_assert!((wrong as f64) < 0.1 * goal as f64, "{wrong} of {goal}");
    }

    /// NaN, a camera under the ground or outside the hall, no space, no picture: nothing panics, and every pixel has a
    /// colour.
    #[test]
    fn nothing_panics_whatever_is_asked_for(
        numbers in prop::array::uniform12(prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(0.0), -1e9..1e9, -5.0..5.0]),
        size in (0_u32..3, 0_u32..3),
    ) {
        let [x, y, yaw, height, pitch, roll, a, b, c, d, e, f] = numbers;
        let pose = CameraPose::new(Pose2::new(x, y, yaw), height, pitch, roll);
        let from = CameraPose::new(Pose2::new(a, b, c), d, e, f);
        let camera = opencv();
        let picture = RgbImage::from_pixel(size.0, size.1, Rgb([9; 3]));
        let proxy = open_geometry();
        let taken = [Taken::new(&camera, from, &picture), Taken::new(&fisheye(), pose, &picture)];
        prop_assert_eq!(drawn(&camera, pose, &proxy, &taken).colors.len(), 128 * 96);
        prop_assert_eq!(drawn(&camera, pose, &proxy, &[]).colors.len(), 128 * 96);
    }
}

#[test]
fn an_obstacle_that_one_of_four_pictures_shows_leaves_no_ghost() {
    let (camera, proxy) = (fisheye(), open_geometry());
    let pose = CameraPose::new(Pose2::new(0.0, 0.0, 0.3), 0.5, 0.42, 0.0);
    let mut taken: Vec<Taken> = Vec::new();
    for (number, (forward, turn)) in
        [(0.1, 0.1), (-0.15, 0.0), (0.2, -0.1), (-0.1, 0.15)].into_iter().enumerate()
    {
        let from = near(pose, forward, turn);
        let mut picture = photograph(&camera, from, &proxy);
        if number == 1 {
            for (u, v) in (60..90).flat_map(|u| (50..80).map(move |v| (u, v))) {
                picture.put_pixel(u, v, Rgb([255, 0, 0]));
            }
        }
        taken.push(Taken::new(&camera, from, &picture));
    }
    let truth = photograph(&camera, pose, &proxy);
    let with_ghost = worst_difference(&drawn(&camera, pose, &proxy, &taken[1..2]), &truth, |_| true);
    assert!(with_ghost > 100, "the obstacle is there");
    let warped = drawn(&camera, pose, &proxy, &taken);
    let seen = |index: usize| warped.origins[index].source != Origin::NOWHERE;
    assert!(worst_difference(&warped, &truth, seen) < 20);
}

#[test]
fn what_nobody_saw_is_marked_and_takes_the_colour_of_its_surroundings() {
    let (camera, proxy) = (fisheye(), open_geometry());
    let pose = CameraPose::new(Pose2::new(0.0, 0.0, 0.0), 0.5, 0.42, 0.0);
    let from = CameraPose { yaw_rad: 0.9, ..pose };
    let grey = RgbImage::from_pixel(camera.width, camera.height, Rgb([70, 80, 90]));
    let warped = drawn(&camera, pose, &proxy, &[Taken::new(&camera, from, &grey)]);
    let unseen = warped.origins.iter().filter(|origin| origin.source == Origin::NOWHERE);
    assert!(unseen.clone().count() > 1000 && unseen.clone().all(|origin| origin.trust == 0));
    assert!(warped.colors.iter().all(|color| *color == [70, 80, 90]));
}

#[test]
fn a_nearer_picture_is_trusted_more_and_chosen_before_a_farther_one() {
    let (camera, proxy) = (fisheye(), open_geometry());
    let pose = CameraPose::new(Pose2::new(0.0, 0.0, 0.0), 0.5, 0.42, 0.0);
    let at = |forward: f64| {
        let from = near(pose, forward, 0.0);
        Taken::new(&camera, from, &photograph(&camera, from, &proxy))
    };
    let mean_trust =
        |warped: &Warped| warped.origins.iter().map(|origin| f64::from(origin.trust)).sum::<f64>();
    let (near_one, far_one) =
        (drawn(&camera, pose, &proxy, &[at(0.05)]), drawn(&camera, pose, &proxy, &[at(-1.5)]));
    assert!(mean_trust(&near_one) > 1.2 * mean_trust(&far_one));
    let both = drawn(&camera, pose, &proxy, &[at(-1.5), at(0.05)]);
    let from_near = both.origins.iter().filter(|origin| origin.source == 1).count();
    assert!(from_near as f64 > 0.8 * both.origins.len() as f64);
    let rays = RayTable::new(&camera);
    let target = Target { rays: &rays, placement: Placement::new(pose), proxy: &proxy };
    let look = Look::new(&target);
    let total = |taken: &Taken| look.costs(&taken.source(), &BlendWeights::default()).iter().sum::<f32>();
    assert!(total(&at(0.05)) < total(&at(-1.5)));
}

#[test]
fn a_look_tells_the_colours_of_the_places_seen() {
    let (camera, proxy) = (fisheye(), open_geometry());
    let pose = CameraPose::new(Pose2::new(0.0, 0.0, 0.0), 0.5, 0.42, 0.0);
    let (a, b) = (near(pose, 0.2, 0.1), near(pose, -0.2, -0.1));
    let taken = [a, b].map(|from| Taken::new(&camera, from, &photograph(&camera, from, &proxy)));
    let rays = RayTable::new(&camera);
    let target = Target { rays: &rays, placement: Placement::new(pose), proxy: &proxy };
    let [a, b] = taken.each_ref().map(|taken| Look::new(&target).colors(&taken.source()));
    let both: Vec<_> = a.iter().zip(&b).filter_map(|(a, b)| Some(((*a)?, (*b)?))).collect();
    assert!(both.len() > 100);
    assert!(both.iter().all(|(a, b)| (0..3).all(|i| (a[i] - b[i]).abs() < 6.0)), "both see the same place");
}
