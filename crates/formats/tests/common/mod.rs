//! What the tests of exports share: pictures with poses that are made up, and points whose pixels the core knows.

#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "each test file uses a part; helpers of tests fail like tests"
)]

use std::error::Error;

use glam::{DVec2, DVec3};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use proptest::prelude::*;
use reality_sim_core::{
    camera::{Camera, Distortion, Opencv, OpencvFisheye},
    field::FieldDimensions,
    pose::{CameraPose, Pose2},
};
use reality_sim_formats::{PictureFiles, PosedPicture, PosedPictures, posed::CameraIndex};

/// Size of the made-up pictures: small, for they are decoded.
pub const SIZE: [u32; 2] = [64, 48];

/// Pictures of one colour.
pub struct Grey;

impl PictureFiles for Grey {
    fn bytes(&self, index: usize) -> Result<Vec<u8>, Box<dyn Error + Send + Sync>> {
        let [width, height] = SIZE;
        let pixels = vec![index as u8; (3 * width * height) as usize];
        let mut bytes = Vec::new();
        PngEncoder::new(&mut bytes).write_image(&pixels, width, height, ExtendedColorType::Rgb8)?;
        Ok(bytes)
    }
}

pub fn cameras() -> [Camera; 4] {
    let camera = |distortion| Camera::new(SIZE, [31.5, 30.25, 32.1, 23.7], distortion).unwrap();
    let brown = Opencv { k1: -0.11, k2: 0.013, p1: 0.0012, p2: -0.0023, k3: 0.0 };
    [
        camera(Distortion::Pinhole),
        camera(Distortion::Opencv(brown)),
        camera(Distortion::Opencv(Opencv { k3: 0.0017, ..brown })),
        camera(Distortion::OpencvFisheye(OpencvFisheye { k: [-0.058, 0.0082, -0.00092, 0.000048] })),
    ]
}

pub fn any_camera() -> impl Strategy<Value = Camera> {
    let parts = (25.0..60.0, 25.0..60.0, 25.0..38.0, 18.0..30.0);
    let terms = [-0.1..0.1, -0.02..0.02, -0.003..0.003, -0.003..0.003, -0.003..0.003_f64];
    (0..4_usize, parts, terms).prop_filter_map(
        "no such lens",
        |(lens, (fx, fy, cx, cy), [k1, k2, p1, p2, k3])| {
            let distortion = match lens {
                0 => Distortion::Pinhole,
                1 => Distortion::Opencv(Opencv { k1, k2, p1, p2, k3: 0.0 }),
                2 => Distortion::Opencv(Opencv { k1, k2, p1, p2, k3 }),
                _ => Distortion::OpencvFisheye(OpencvFisheye { k: [k1, k2, p1, p2] }),
            };
            Camera::new(SIZE, [fx, fy, cx, cy], distortion).ok()
        },
    )
}

pub fn any_pose() -> impl Strategy<Value = CameraPose> {
    (-4.5..4.5, -3.0..3.0, -3.1..3.1, 0.3..1.5, -0.2..1.2, -0.6..0.6)
        .prop_map(|(x, y, yaw, h, pitch, roll)| CameraPose::new(Pose2::new(x, y, yaw), h, pitch, roll))
}

/// A pose without any symmetry.
pub fn a_pose() -> CameraPose {
    CameraPose::new(Pose2::new(-1.3, 0.7, 0.4), 0.55, 0.35, 0.12)
}

pub fn field() -> FieldDimensions {
    FieldDimensions::preset("spl").unwrap()
}

/// Returns pictures of one camera, one a pose.
pub fn posed(camera: &Camera, poses: &[CameraPose]) -> PosedPictures {
    let picture = |(number, pose): (usize, &CameraPose)| PosedPicture {
        number,
        timestamp_s: 100.25 + 0.1 * number as f64,
        camera: CameraIndex(0),
        pose: *pose,
        file_name: String::new(),
    };
    PosedPictures {
        cameras: vec![camera.clone()],
        field: field(),
        pictures: poses.iter().enumerate().map(picture).collect(),
    }
}

/// Returns points of the field, and the pixels at which the core sees them from a pose.
pub fn known_points(camera: &Camera, pose: CameraPose) -> Vec<(DVec3, DVec2)> {
    let grid = (-20..=20)
        .flat_map(|x| (-20..=20).map(move |y| DVec3::new(0.25 * f64::from(x), 0.2 * f64::from(y), 0.0)));
    let points: Vec<_> =
        grid.filter_map(|point| Some((point, camera.project(pose.camera_from_world(point)).ok()?))).collect();
    assert!(points.len() > 20, "{} points are seen", points.len());
    points
}

/// Returns the largest difference of two poses' coordinates, metres and radians.
pub fn difference(a: CameraPose, b: CameraPose) -> f64 {
    let angle = |a: f64, b: f64| reality_sim_core::pose::wrap_angle(a - b).abs();
    [
        (a.x_m - b.x_m).abs(),
        (a.y_m - b.y_m).abs(),
        (a.height_m - b.height_m).abs(),
        angle(a.yaw_rad, b.yaw_rad),
        angle(a.pitch_rad, b.pitch_rad),
        angle(a.roll_rad, b.roll_rad),
    ]
    .into_iter()
    .fold(0.0, f64::max)
}
