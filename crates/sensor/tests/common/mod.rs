//! Cameras, poses and colours that the tests share.

use glam::Vec3;
use reality_sim_core::{
    camera::{Camera, Distortion, Opencv, OpencvFisheye},
    field::FieldDimensions,
    pose::CameraPose,
    sequence::{CameraSetup, Photometry},
};
use reality_sim_sensor::{SceneColors, Trajectory};

pub fn field() -> FieldDimensions {
    FieldDimensions::preset("humanoid-kidsize-2010").unwrap()
}

/// Returns [`field`] without goals.
pub fn field_without_goals() -> FieldDimensions {
    FieldDimensions { goal_height_m: 0.0, goal_post_diameter_m: 0.0, ..field() }
}

pub fn fisheye([width, height]: [u32; 2], focal_px: f64) -> Camera {
    let lens = OpencvFisheye { k: [-0.058, 0.0082, -0.0009, 0.00005] };
    camera([width, height], focal_px, Distortion::OpencvFisheye(lens))
}

pub fn pinhole(size: [u32; 2], focal_px: f64) -> Camera {
    camera(size, focal_px, Distortion::Pinhole)
}

pub fn barrel(size: [u32; 2], focal_px: f64) -> Camera {
    let lens = Opencv { k1: -0.25, k2: 0.05, p1: 0.001, p2: -0.002, k3: 0.0 };
    camera(size, focal_px, Distortion::Opencv(lens))
}

fn camera([width, height]: [u32; 2], focal_px: f64, distortion: Distortion) -> Camera {
    let center = [width, height].map(|pixels| (f64::from(pixels) - 1.0) / 2.0);
    let intrinsics = [focal_px, 1.01 * focal_px, center[0] + 0.3, center[1] - 0.7];
    Camera::new([width, height], intrinsics, distortion).unwrap()
}

/// Camera whose pixel values are 255 times the linear ones.
pub fn linear_setup(camera: Camera) -> CameraSetup {
    let photometry = Photometry::of_gamma(1.0);
    CameraSetup { camera, mount_height_m: 0.5, photometry: Some(photometry) }
}

/// Colours with whole pixel values that differ in one or two channels at least; lines differ most from carpet.
pub fn colors() -> SceneColors {
    SceneColors {
        line_linear_rgb: Vec3::new(0.8, 1.0, 1.0),
        carpet_linear_rgb: Vec3::new(0.0, 0.2, 0.0),
        goal_negative_x_linear_rgb: Vec3::new(0.2, 0.4, 1.0),
        goal_positive_x_linear_rgb: Vec3::new(1.0, 0.8, 0.2),
        floor_linear_rgb: Vec3::new(0.4, 0.2, 0.2),
        wall_linear_rgb: Vec3::new(0.4, 0.4, 0.6),
        ceiling_linear_rgb: Vec3::new(0.8, 0.6, 0.4),
    }
}

/// Returns the pixel value of a linear one, for a camera of [`linear_setup`].
pub fn pixel_of(linear_rgb: Vec3) -> [u8; 3] {
    linear_rgb.to_array().map(|value| (255.0 * value).round() as u8)
}

pub fn pose([x_m, y_m, yaw_rad]: [f64; 3], [height_m, pitch_rad, roll_rad]: [f64; 3]) -> CameraPose {
    CameraPose { x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad }
}

/// Trajectory of a robot's camera that sees the field while the robot walks and turns its head.
pub fn walk() -> Trajectory {
    let stamped = |time_s: f64| {
        let planar = [1.4 + 0.3 * time_s, -0.6 + 0.1 * time_s, 0.3 + 0.8 * time_s];
        (time_s, pose(planar, [0.5, 0.7 + 0.3 * time_s, 0.05]))
    };
    Trajectory::new(&[-0.4, -0.2, 0.0, 0.2, 0.4].map(stamped)).unwrap()
}

/// Camera with realistic shot and read noise, black level and blur.
pub fn measured_setup(camera: Camera) -> CameraSetup {
    let photometry = Photometry {
        black_level: Some(0.02),
        noise_shot: Some(0.002),
        noise_read: Some(0.005),
        psf_sigma_px: Some(0.7),
        ..Photometry::of_gamma(2.2)
    };
    CameraSetup { photometry: Some(photometry), ..linear_setup(camera) }
}
