use std::f64::consts::{PI, TAU};

use proptest::prelude::*;

use reality_sim_core::{
    camera::{Camera, Distortion, OpencvFisheye},
    field::FieldDimensions,
    pose::{Pose2, wrap_angle},
};

use super::*;

fn camera() -> Camera {
    let lens = OpencvFisheye { k: [-0.058, 0.008, -0.0009, 0.00005] };
    Camera::new([640, 480], [215.0, 215.0, 319.5, 239.5], Distortion::OpencvFisheye(lens)).unwrap()
}

fn metric() -> PixelMetric {
    let usual = CameraPose { height_m: 0.52, pitch_rad: 0.42, ..Default::default() };
    let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
    PixelMetric::new(&camera(), usual, &field).unwrap()
}

fn any_pose() -> impl Strategy<Value = CameraPose> {
    (-3.7..3.7, -2.7..2.7, -10.0..10.0, 0.5..0.55, 0.35..0.5, -0.05..0.05).prop_map(
        |(x, y, yaw, height, pitch, roll)| CameraPose::new(Pose2::new(x, y, yaw), height, pitch, roll),
    )
}

/// Generates images at one spot with different headings, and images on a line, which are difficult for triangulations.
fn any_recording() -> impl Strategy<Value = Vec<CameraPose>> {
    let spot = prop::collection::vec(any_pose(), 1..60);
    (spot, 0..3).prop_map(|(mut poses, kind)| {
        for (index, pose) in poses.iter_mut().enumerate() {
            match kind {
                0 => {}
                1 => (pose.x_m, pose.y_m) = (0.5, -0.25),
                _ => (pose.x_m, pose.y_m) = (0.05 * index as f64, 0.0),
            }
        }
        poses
    })
}

proptest! {
    #[test]
    fn the_nearest_are_those_that_looking_at_all_of_them_finds(poses in any_recording(), pose in any_pose(), count in 1_usize..8) {
        let metric = metric();
        let mut all: Vec<f64> = poses.iter().map(|&other| metric.distance_px(other, pose)).collect();
        all.sort_by(f64::total_cmp);
        let found = PoseIndex::new(metric, poses).nearest(pose, count).unwrap();
        prop_assert_eq!(found.len(), count.min(all.len()));
        for (neighbour, expected) in found.iter().zip(all) {
            prop_assert!((neighbour.distance_px - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn natural_weights_add_up_to_one_and_hold_no_image_twice(poses in any_recording(), pose in any_pose()) {
        let found = PoseIndex::new(metric(), poses).natural(pose).unwrap();
        prop_assert!((found.iter().map(|neighbour| neighbour.weight).sum::<f64>() - 1.0).abs() < 1e-6);
        prop_assert!(found.iter().all(|neighbour| neighbour.weight > -1e-9));
        let mut images: Vec<_> = found.iter().map(|neighbour| neighbour.image).collect();
        images.sort_unstable();
        images.dedup();
        prop_assert_eq!(images.len(), found.len());
    }

    #[test]
    fn every_image_is_found_at_its_own_pose(poses in any_recording()) {
        let index = PoseIndex::new(metric(), poses.clone());
        for pose in poses {
            let turned = CameraPose { yaw_rad: pose.yaw_rad + 0.3, ..pose };
            prop_assert!(index.natural(pose).is_ok() && index.natural(turned).is_ok());
            prop_assert!(index.nearest(pose, 1).unwrap()[0].distance_px < 1e-6);
        }
    }

    /// Compares near and far poses with any motion in the other four dimensions.
    #[test]
    fn no_distance_is_less_than_its_bound(a in any_pose(), b in any_pose(), share in -6.0..0.0_f64) {
        let metric = metric();
        let toward = |from: f64, to: f64| from + 10.0_f64.powf(share) * (to - from);
        let near = CameraPose { x_m: toward(a.x_m, b.x_m), y_m: toward(a.y_m, b.y_m), yaw_rad: toward(a.yaw_rad, b.yaw_rad), ..b };
        let apart_m = (near.x_m - a.x_m).hypot(near.y_m - a.y_m);
        let turn_rad = wrap_angle(near.yaw_rad - a.yaw_rad).abs();
        let least_px = metric.least_px(apart_m, turn_rad);
        prop_assert!(metric.distance_px(a, near) >= least_px * (1.0 - 1e-9));
        prop_assert!(least_px >= metric.least_distance_px(apart_m).max(metric.least_turn_px(turn_rad)));
    }

    /// Compares to first order: the motion is small, and the lens itself gives the truth.
    #[test]
    fn the_distance_is_how_far_pixels_move(pose in any_pose(), motion in prop::array::uniform6(-1e-3..1e-3_f64)) {
        let camera = camera();
        let usual = CameraPose { height_m: pose.height_m, pitch_rad: pose.pitch_rad, roll_rad: pose.roll_rad, ..Default::default() };
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let metric = PixelMetric::new(&camera, usual, &field).unwrap();
        let other = CameraPose {
            x_m: pose.x_m + motion[0],
            y_m: pose.y_m + motion[1],
            yaw_rad: pose.yaw_rad + motion[2],
            height_m: pose.height_m + motion[3],
            pitch_rad: pose.pitch_rad + motion[4],
            roll_rad: pose.roll_rad + motion[5],
        };
        let background_m = field.carpet_half_extent_m().length();
        let (mut sum, mut count) = (0.0, 0);
        for v in (7..480).step_by(5) {
            for u in (3..640).step_by(5) {
                let pixel = DVec2::new(f64::from(u), f64::from(v));
                let ray = pose.rotation_world_from_camera() * camera.unproject(pixel).unwrap();
                let ground_m = if ray.z < 0.0 { -pose.height_m / ray.z } else { f64::INFINITY };
                let point = pose.position_in_world() + ground_m.min(background_m) * ray;
                let moved = camera.project_unbounded(other.camera_from_world(point)).unwrap();
                sum += (moved - pixel).length_squared();
                count += 1;
            }
        }
        let truth = (sum / f64::from(count)).sqrt();
        prop_assert!((metric.distance_px(pose, other) - truth).abs() < 0.02 * truth + 1e-6, "{} {}", metric.distance_px(pose, other), truth);
    }

    /// Sibson's weights reproduce linear functions, so they cannot jump.
    #[test]
    fn natural_weights_change_little_with_the_pose(x in -2.0..2.0, y in -1.5..1.5, yaw in -3.0..3.0) {
        let poses: Vec<CameraPose> = (0..4000).map(|i| {
            let [a, b, c] = [0.7548776662, 0.5698402910, 0.3819660113].map(|step| (f64::from(i) * step).fract());
            CameraPose::new(Pose2::new(6.0 * a - 3.0, 4.0 * b - 2.0, TAU * c), 0.52, 0.42, 0.0)
        }).collect();
        let index = PoseIndex::new(metric(), poses);
        let pose = CameraPose::new(Pose2::new(x, y, yaw), 0.52, 0.42, 0.0);
        let mean = |pose: CameraPose| {
            let found = index.natural(pose).unwrap();
            let place = |of: fn(&CameraPose) -> f64| found.iter().map(|n| n.weight * of(&index.poses()[n.image as usize])).sum::<f64>();
            DVec2::new(place(|pose| pose.x_m), place(|pose| pose.y_m))
        };
        let at = mean(pose);
        prop_assert!(at.distance(DVec2::new(x, y)) < 0.01, "{at}");
        let moved = CameraPose { yaw_rad: yaw + 1e-3, x_m: x + 1e-3, ..pose };
        prop_assert!(mean(moved).distance(at) < 0.01);
    }
}

/// Checks the geometry: spots without another spot in the circle over them are joined (Gabriel graph), no two edges cross,
/// and there are at most 3 n − 6 edges.
#[test]
fn the_triangulation_of_a_heading_is_that_of_the_places_of_its_sector() {
    let places: Vec<DVec2> = (0..60)
        .map(|i| [0.754877, 0.569840].map(|step| (f64::from(i) * step).fract()))
        .map(|[a, b]| DVec2::new(6.0 * a - 3.0, 4.0 * b - 2.0))
        .collect();
    let usual = CameraPose { height_m: 0.52, pitch_rad: 0.42, ..Default::default() };
    let looking = |yaw_rad: f64| {
        places.iter().map(move |place| usual.with_planar(Pose2::new(place.x, place.y, yaw_rad)))
    };
    let index = PoseIndex::new(metric(), looking(0.1).collect());
    let [only] = &index.triangulations(0.2)[..] else { panic!("the other sector is empty") };
    assert!((only.share - 1.0).abs() < 1e-12);
    let edges = &only.edges_in_world;
    let is_joined = |a: DVec2, b: DVec2| {
        edges.iter().any(|edge| {
            let is = |from: usize, to: usize| edge[from].distance(a) < 1e-9 && edge[to].distance(b) < 1e-9;
            is(0, 1) || is(1, 0)
        })
    };
    for (i, &a) in places.iter().enumerate() {
        for &b in &places[i + 1..] {
            let is_inside = |c: &&DVec2| **c != a && **c != b && (a - **c).dot(b - **c) < 0.0;
            let is_empty = !places.iter().any(|c| is_inside(&c));
            assert!(!is_empty || is_joined(a, b), "{a} and {b}");
        }
    }
    let side = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
    let cross = |[a, b]: [DVec2; 2], [c, d]: [DVec2; 2]| {
        side(a, b, c) * side(a, b, d) < -1e-12 && side(c, d, a) * side(c, d, b) < -1e-12
    };
    assert!(edges.iter().all(|&a| edges.iter().all(|&b| !cross(a, b))));
    assert!(edges.len() <= 3 * places.len() - 6);

    let both = PoseIndex::new(metric(), looking(0.1).chain(looking(0.8)).collect());
    let shares: Vec<f64> = both.triangulations(0.2).iter().map(|sector| sector.share).collect();
    assert_eq!(shares.len(), 2);
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12 && shares[0] > shares[1], "{shares:?}");
    assert!(both.triangulations(f64::NAN).is_empty());
}

/// Uses enough images for many levels of the tree, many at one place and heading, and headings on both sides of ±π.
#[test]
fn among_many_images_the_nearest_are_those_that_looking_at_all_of_them_finds() {
    let poses: Vec<CameraPose> = (0..5000)
        .map(|i| {
            let [x, y, yaw, height, pitch, roll] =
                [0.754877, 0.569840, 0.430159, 0.324718, 0.245122, 0.185037]
                    .map(|step| (f64::from(i) * step).fract() - 0.5);
            let pose = CameraPose::new(
                Pose2::new(7.4 * x, 5.4 * y, TAU * yaw),
                0.52 + 0.04 * height,
                0.42 + 0.08 * pitch,
                0.06 * roll,
            );
            if i % 5 == 0 { CameraPose { x_m: 0.5, y_m: 0.25, yaw_rad: 0.0, ..pose } } else { pose }
        })
        .collect();
    let metric = metric();
    let index = PoseIndex::new(metric.clone(), poses.clone());
    let corners = [[3.7, 2.7], [0.5, 0.25], [20.0, -3.0]];
    for (place, yaw_rad) in corners
        .into_iter()
        .flat_map(|place| [0.0, 1e-3, -1e-3, PI - 1e-4, 1e-4 - PI].map(|yaw_rad| (place, yaw_rad)))
    {
        let pose = CameraPose::new(Pose2::new(place[0], place[1], yaw_rad), 0.53, 0.4, 0.01);
        let mut all: Vec<f64> = poses.iter().map(|&other| metric.distance_px(other, pose)).collect();
        all.sort_by(f64::total_cmp);
        for count in [1, 6, 120] {
            let found = index.nearest(pose, count).unwrap();
            assert_eq!(found.len(), count);
            for (neighbour, expected) in found.iter().zip(&all) {
                assert!(
                    (neighbour.distance_px - expected).abs() < 1e-9,
                    "{pose:?}: {neighbour:?}, {expected}"
                );
            }
        }
    }
}

#[test]
fn images_at_absurd_distances_are_found_all_the_same() {
    let pose = CameraPose { height_m: 0.52, pitch_rad: 0.42, ..Default::default() };
    let far = CameraPose { x_m: 1e200, ..pose };
    let index = PoseIndex::new(metric(), vec![far; 3]);
    assert_eq!(index.nearest(pose, 2).unwrap().len(), 2);
    assert!(index.natural(pose).is_ok());
}

#[test]
fn what_cannot_be_answered_has_a_reason() {
    let empty = PoseIndex::new(metric(), vec![]);
    assert_eq!(empty.nearest(CameraPose::default(), 3), Err(NoNeighbours::NoImages));
    let pose = CameraPose { height_m: 0.52, pitch_rad: 0.42, ..Default::default() };
    let index = PoseIndex::new(metric(), vec![pose, CameraPose { x_m: f64::NAN, ..pose }]);
    let nowhere = CameraPose { y_m: f64::NAN, ..pose };
    assert_eq!(index.natural(nowhere), Err(NoNeighbours::NotFinite));
    assert_eq!(index.nearest(pose, 9).unwrap().len(), 1, "a pose that is NaN is never found");
    let far = CameraPose { x_m: 50.0, ..pose };
    assert!(matches!(index.check_reach(far, 300.0), Err(NoNeighbours::OutOfReach { .. })));
    assert!(index.check_reach(pose, 300.0).is_ok());
}
