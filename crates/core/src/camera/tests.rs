mod gradients;
mod ground;
mod largest_angle;
mod reasons;
mod round_trip;

use glam::{DVec2, DVec3};
use proptest::prelude::*;

use super::*;

fn fisheye(size: [u32; 2], intrinsics: [f64; 4], k: [f64; 4]) -> Camera {
    Camera::new(size, intrinsics, Distortion::OpencvFisheye(OpencvFisheye { k })).unwrap()
}

fn opencv(intrinsics: [f64; 4], [k1, k2, p1, p2, k3]: [f64; 5]) -> Camera {
    Camera::new([640, 480], intrinsics, Distortion::Opencv(Opencv { k1, k2, p1, p2, k3 })).unwrap()
}

/// Returns the camera of the paper's walk: nearly 180° across the picture.
fn walk() -> Camera {
    let k = [-0.058061286, 0.008174184, -0.000916262, 0.000047755];
    fisheye([640, 480], [214.906223, 214.906223, 319.5, 239.5], k)
}

/// Returns a camera that sees behind itself: its polynomial grows all the way round.
fn all_round() -> Camera {
    fisheye([960, 960], [150.0, 151.0, 480.2, 479.1], [0.02, -0.003, 0.0, 0.0])
}

/// Returns a Brown–Conrady camera whose polynomial stops growing at 42°, inside the picture.
fn turning_barrel() -> Camera {
    opencv([420.0, 420.0, 319.5, 239.5], [-0.4, 0.0, 0.0, 0.0, 0.0])
}

fn tangential() -> Camera {
    opencv([500.0, 505.0, 330.0, 250.0], [-0.28, 0.07, 0.0015, -0.0021, 0.002])
}

fn cameras() -> Vec<Camera> {
    vec![
        walk(),
        fisheye([608, 800], [330.2442, 328.9, 292.1307, 401.3261], [-0.03325321, 0.0010053, 0.0, 0.0]),
        fisheye([640, 480], [180.0, 180.0, 320.0, 240.0], [0.0; 4]),
        all_round(),
        Camera::new([640, 480], [600.0, 610.0, 320.0, 240.0], Distortion::Pinhole).unwrap(),
        opencv([618.5678, 620.1, 309.193, 264.7764], [0.0164092, 0.0, 0.0, 0.0, 0.0]),
        opencv([420.0, 420.0, 319.5, 239.5], [-0.32, 0.11, 0.0, 0.0, -0.015]),
        turning_barrel(),
        tangential(),
        opencv([500.0, 505.0, 330.0, 250.0], [-0.2, 0.03, 0.02, -0.03, 0.0]),
    ]
}

fn any_camera() -> impl Strategy<Value = Camera> {
    proptest::sample::select(cameras())
}

fn direction(angle_rad: f64, around_rad: f64) -> DVec3 {
    (angle_rad.sin() * DVec2::from_angle(around_rad)).extend(angle_rad.cos())
}
