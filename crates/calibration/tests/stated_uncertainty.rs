//! Covariances of poses hold with a calibration that is off by its stated uncertainty. The pictures are ray-traced, and their camera is
//! known exactly.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

use std::path::Path;

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use reality_sim_core::{
    camera::{Camera, Distortion, OpencvFisheye},
    filter::{Purpose, Stream},
    localization::mount_of_frame,
    mount::{MountPose, MountPoseSigma},
    pose::wrap_angle,
    preprocess::{Preprocessor, Texture},
    refine::{CalibrationUncertainty, Reach, RefineConfig, Refiner},
    sequence::Sequence,
};

/// Standard deviations of fx, fy (relative), k1, height (metres), pitch and roll (radians): what real calibrations err by.
const FOCAL: f64 = 0.005;
const K1: f64 = 0.004;
const HEIGHT_M: f64 = 0.01;
const ANGLE_RAD: f64 = 0.0087;

/// Numbers of calibrations that are drawn, and of pictures that each is tried with.
const DRAWS: u32 = 24;
const PICTURES: usize = 6;

/// Returns the covariance of fx, fy, cx, cy, k1 … k4, height, pitch and roll; both focal lengths err alike.
fn stated(camera: &Camera) -> DMatrix<f64> {
    let sigma = FOCAL * camera.fx;
    let mut covariance = DMatrix::zeros(11, 11);
    for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        covariance[(row, column)] = sigma * sigma;
    }
    for (place, sigma) in [(4, K1), (8, HEIGHT_M), (9, ANGLE_RAD), (10, ANGLE_RAD)] {
        covariance[(place, place)] = sigma * sigma;
    }
    covariance
}

/// Calibration that errs by a draw of five standard normal numbers, with the pitch and roll that it adds.
fn drawn(camera: &Camera, draw: &[f64; 5]) -> (Camera, Vector3<f64>) {
    let focal = 1.0 + FOCAL * draw[0];
    let mut k = [0.0; 4];
    k.copy_from_slice(&camera.distortion.parameters());
    k[0] += K1 * draw[1];
    let intrinsics = [camera.fx * focal, camera.fy * focal, camera.cx, camera.cy];
    let distortion = Distortion::OpencvFisheye(OpencvFisheye { k });
    let off = Camera::new([camera.width, camera.height], intrinsics, distortion).unwrap();
    (off, Vector3::new(HEIGHT_M * draw[2], ANGLE_RAD * draw[3], ANGLE_RAD * draw[4]))
}

#[test]
fn poses_are_off_by_as_much_as_their_covariances_say() {
    let walk = Sequence::open(Path::new("../../assets/walk")).unwrap();
    let truth = &walk.setup.camera;
    let frames: Vec<usize> = (0..PICTURES).map(|index| index * walk.frames.len() / PICTURES).collect();
    let pictures: Vec<(Texture, f64)> = frames
        .iter()
        .map(|&frame| {
            let preprocessor = Preprocessor::new(truth, walk.field.line_width_m);
            let prepared =
                preprocessor.prepare(walk.load_image(frame).unwrap(), mount_of_frame(&walk, frame));
            (Texture::pack(&prepared.whiteness), f64::from(prepared.levels.contrast()))
        })
        .collect();
    let (mut with, mut without) = (Vec::new(), Vec::new());
    for draw in 0..DRAWS {
        let normals = Stream::new(11, Purpose::Initialise, draw, 0);
        let numbers: Vec<f64> = (0..2).flat_map(|index| normals.normals(index)).collect();
        let (camera, mount_error) = drawn(truth, &std::array::from_fn(|index| numbers[index]));
        let calibration = CalibrationUncertainty::new(&camera, stated(&camera)).unwrap();
        let refiner = Refiner::new(&camera, &walk.field, RefineConfig::default(), MountPoseSigma::default());
        for (&frame, (texture, contrast)) in frames.iter().zip(&pictures) {
            let pose = walk.frames[frame].reference_pose.unwrap();
            let told = mount_of_frame(&walk, frame);
            let mount = MountPose {
                height_m: told.height_m + mount_error[0],
                pitch_rad: told.pitch_rad + mount_error[1],
                roll_rad: told.roll_rad + mount_error[2],
            };
            let fit = refiner.fit(texture, pose, mount, *contrast, Reach::Wide).unwrap();
            let error = Vector3::new(
                fit.pose.x_m - pose.x_m,
                fit.pose.y_m - pose.y_m,
                wrap_angle(fit.pose.yaw_rad - pose.yaw_rad),
            );
            let squared =
                |covariance: Matrix3<f64>| error.dot(&(covariance.try_inverse().unwrap() * error)) / 3.0;
            let planar =
                |fit: reality_sim_core::refine::PoseFit| fit.covariance.fixed_view::<3, 3>(0, 0).into_owned();
            without.push(squared(planar(fit)));
            with.push(squared(planar(fit.with_calibration(Some(&calibration)))));
        }
    }
    let mean = |values: &[f64]| DVector::from_column_slice(values).mean();
    // 24 draws of five numbers scatter by about √(2 / 5 / 24), an eighth; 0.64 and 1.56 are a sigma that is 0.8 and 1.25 of what is stated.
    let (with, without) = (mean(&with), mean(&without));
    assert!((0.64..1.56).contains(&with), "{with} with the calibration's part, {without} without");
    assert!(
        without > 2.0 * with,
        "{with} with the calibration's part, {without} without: it would not matter"
    );
}
