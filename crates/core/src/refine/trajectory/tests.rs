use nalgebra::{DMatrix, DVector};

use super::{
    super::{calibration::ByCalibration, pose_steps::pose_difference},
    *,
};
use crate::filter::{Purpose, Stream};

/// Odometry noise of the simulated walk, which does not grow with the motion.
const STEADY: MotionNoise = MotionNoise {
    still_m: 0.0,
    still_rad: 0.0,
    m_per_m: 0.0,
    rad_per_rad: 0.0,
    rad_per_m: 0.0,
    unknown_m: 0.0,
    unknown_rad: 0.0,
};
const MOUNT_SIGMA: MountPoseSigma = MountPoseSigma { height_m: 0.03, angle_rad: 0.01 };

/// Standard deviations of simulated errors.
#[derive(Clone, Copy)]
struct Errors {
    /// Of a picture alone: height and pitch are known no better than from joints and IMU.
    picture: [f64; 6],
    /// Of a step of the odometry: forwards, to the left, in heading.
    odometry: [f64; 3],
}

/// Odometry better than pictures.
const SMOOTH: Errors =
    Errors { picture: [0.02, 0.02, 0.008, 0.03, 0.012, 0.006], odometry: [0.005, 0.005, 0.004] };
/// Pictures better than odometry, so that the odometry's own errors are learned well.
const SWAYING: Errors =
    Errors { picture: [0.006, 0.006, 0.003, 0.03, 0.012, 0.006], odometry: [0.012, 0.012, 0.008] };

/// Returns the covariance of a picture alone: errors of height, pitch and roll move the place.
fn of_a_picture(errors: Errors) -> Matrix6<f64> {
    let sigmas = Vector6::from(errors.picture);
    let mut correlations = Matrix6::identity();
    for (a, b, correlation) in [(0, 3, 0.6), (0, 4, -0.7), (1, 5, 0.8), (3, 4, -0.3)] {
        (correlations[(a, b)], correlations[(b, a)]) = (correlation, correlation);
    }
    Matrix6::from_diagonal(&sigmas) * correlations * Matrix6::from_diagonal(&sigmas)
}

/// Simulates the fit of a picture as [`super::super::Refiner`] makes it: of the picture, which errs by `error`, and of the
/// mount pose.
fn fitted(truth: CameraPose, picture: Matrix6<f64>, error: Vector6<f64>, mount: MountPose) -> PoseFit {
    let (information, prior) = (picture.try_inverse().unwrap(), MOUNT_SIGMA.information());
    let covariance = (information + prior).try_inverse().unwrap();
    let step = covariance * (information * error - prior * mount_error(truth, mount));
    PoseFit {
        pose: moved(truth, &step),
        covariance,
        of_calibration: Matrix6::zeros(),
        by_calibration: ByCalibration::default(),
        information,
        residual_px: 0.1,
        found: 1.0,
        offsets: 100,
    }
}

/// Simulates a walk whose pictures, odometry and mount poses err as their covariances say; every third picture shows
/// nothing.
fn walk(seed: u64, count: u32, errors: Errors) -> (Vec<CameraPose>, Vec<TrajectoryFrame>) {
    let truth: Vec<CameraPose> = (0..count)
        .map(|i| {
            let t = f64::from(i) * 0.1;
            CameraPose {
                x_m: 2.0 * t.sin(),
                y_m: t.cos(),
                yaw_rad: 0.7 * t,
                height_m: 0.5,
                pitch_rad: 0.4,
                roll_rad: 0.0,
            }
        })
        .collect();
    let picture = of_a_picture(errors);
    let spread = picture.cholesky().unwrap().l();
    let normals = |purpose, i: usize| Stream::new(seed, purpose, i as u32, 0).normals(0);
    let frames = (0..truth.len())
        .map(|i| {
            let a = normals(Purpose::Initialise, i);
            let mount = MountPose {
                height_m: 0.5 + 0.03 * a[0],
                pitch_rad: 0.4 + 0.01 * a[1],
                roll_rad: 0.01 * a[2],
            };
            let fit = fitted(truth[i], picture, spread * Vector6::from(normals(Purpose::Predict, i)), mount);
            let o = normals(Purpose::Diffuse, i);
            let motion = (i > 0).then(|| {
                let m = truth[i - 1].planar().motion_to(truth[i].planar());
                Motion2 {
                    forward_m: m.forward_m + errors.odometry[0] * o[0],
                    left_m: m.left_m + errors.odometry[1] * o[1],
                    turn_rad: m.turn_rad + errors.odometry[2] * o[2],
                }
            });
            TrajectoryFrame { guess: fit.pose, fit: (i % 3 != 2).then_some(fit), mount, motion }
        })
        .collect();
    (truth, frames)
}

/// Compares the block elimination with one dense solve of the same normal equations.
#[test]
fn the_chain_is_solved_as_a_dense_system_would_be() {
    let (truth, frames) = walk(3, 9, SMOOTH);
    let used = vec![true; 9];
    let chain = Chain::build(
        &frames,
        &truth,
        &used,
        &OdometryNoise::learn(&frames, &SmoothingConfig::default(), STEADY),
        MOUNT_SIGMA.information(),
    );
    let mut dense = DMatrix::zeros(54, 54);
    let mut right = DVector::zeros(54);
    for i in 0..9 {
        dense.view_mut((6 * i, 6 * i), (6, 6)).copy_from(&chain.diagonal[i]);
        right.rows_mut(6 * i, 6).copy_from(&chain.right[i]);
        if i < 8 {
            dense.view_mut((6 * i, 6 * i + 6), (6, 6)).copy_from(&chain.beside[i]);
            dense.view_mut((6 * i + 6, 6 * i), (6, 6)).copy_from(&chain.beside[i].transpose());
        }
    }
    let (steps, covariances) = chain.solve().unwrap();
    let inverse = dense.try_inverse().unwrap();
    let expected = &inverse * right;
    for i in 0..9 {
        assert!((expected.rows(6 * i, 6) - steps[i]).norm() < 1e-9);
        assert!((inverse.view((6 * i, 6 * i), (6, 6)) - covariances[i]).norm() < 1e-9 * inverse.norm());
    }
}

#[test]
fn smoothing_is_better_than_single_pictures_and_knows_how_good_it_is() {
    let planar = |error: Vector6<f64>| error.fixed_rows::<3>(0).into_owned();
    let (mut single, mut smooth, mut nees, mut gaps) = (0.0, 0.0, Vec::new(), 0.0_f64);
    for seed in 0..12 {
        let (truth, frames) = walk(seed, 60, SMOOTH);
        let smoothed = smooth_trajectory(&frames, &SmoothingConfig::default(), MOUNT_SIGMA, STEADY).unwrap();
        for ((truth, frame), pose) in truth.iter().zip(&frames).zip(&smoothed) {
            let error = pose_difference(*truth, pose.pose);
            match frame.fit {
                Some(fit) => {
                    single += planar(pose_difference(*truth, fit.pose)).norm_squared();
                    smooth += planar(error).norm_squared();
                }
                None => gaps = gaps.max(error.fixed_rows::<2>(0).norm()),
            }
            nees.push((error.transpose() * pose.covariance.try_inverse().unwrap() * error)[0]);
        }
    }
    assert!(smooth < 0.7 * single, "{smooth} against {single}");
    assert!(gaps < 0.05, "pictures without lines are up to {gaps} m off");
    // Quantiles of χ² with six degrees of freedom. The 720 poses are correlated: allow a few per cent of deviation.
    for (quantile, level) in [(5.348, 0.5), (10.645, 0.9), (12.592, 0.95)] {
        let inside = nees.iter().filter(|value| **value < quantile).count() as f64 / nees.len() as f64;
        assert!((inside - level).abs() < 0.06, "{inside} of the poses in the {level} region");
    }
}

/// Compares the errors of simulated walks with what the smoothed covariances say of them, number by number.
#[test]
fn smoothed_covariances_are_those_of_the_errors_where_fits_contain_the_mount_pose() {
    let mut inside = [0_u32; 6];
    let (mut nees, mut count) = (0.0, 0.0);
    for seed in 100..112 {
        let (truth, frames) = walk(seed, 300, SWAYING);
        let smoothed = smooth_trajectory(&frames, &SmoothingConfig::default(), MOUNT_SIGMA, STEADY).unwrap();
        for (truth, pose) in truth.iter().zip(&smoothed) {
            let error = pose_difference(*truth, pose.pose);
            for (axis, inside) in inside.iter_mut().enumerate() {
                *inside += u32::from(error[axis].abs() < 1.96 * pose.covariance[(axis, axis)].sqrt());
            }
            nees += error.dot(&(pose.covariance.try_inverse().unwrap() * error)) / 6.0;
            count += 1.0;
        }
    }
    // Of 3600 poses, a third are independent at least: standard deviations of 0.6 % and 0.017.
    let coverage = inside.map(|inside| f64::from(inside) / count);
    assert!(coverage.iter().all(|inside| (0.93..0.97).contains(inside)), "{coverage:?} in 95 % intervals");
    assert!((nees / count - 1.0).abs() < 0.06, "mean NEES of one number: {}", nees / count);
}

/// A fit that slipped in height is far from its mount pose; one that agrees with its picture and disagrees with a mount pose
/// by two standard deviations is none.
#[test]
fn a_fit_that_slipped_in_height_contradicts_its_mount_pose() {
    let (truth, mut frames) = walk(7, 40, SMOOTH);
    let mount = MountPose { height_m: truth[12].height_m - 0.3, ..frames[12].mount };
    let (true_mount, error) = (frames[12].mount, Vector6::zeros());
    frames[12].fit = Some(fitted(truth[12], of_a_picture(SMOOTH), error, true_mount));
    let smoothed = smooth_trajectory(&frames, &SmoothingConfig::default(), MOUNT_SIGMA, STEADY).unwrap();
    assert!(smoothed[12].picture_used);
    frames[12].mount = mount;
    frames[12].fit = Some(fitted(truth[12], of_a_picture(SMOOTH), error, mount));
    let smoothed = smooth_trajectory(&frames, &SmoothingConfig::default(), MOUNT_SIGMA, STEADY).unwrap();
    assert!(!smoothed[12].picture_used);
}

#[test]
fn a_fit_of_the_wrong_line_is_outvoted() {
    let (truth, mut frames) = walk(5, 40, SMOOTH);
    let wrong = frames[21].fit.as_mut().unwrap();
    wrong.pose.x_m += 0.6;
    let smoothed = smooth_trajectory(&frames, &SmoothingConfig::default(), MOUNT_SIGMA, STEADY).unwrap();
    assert!(!smoothed[21].picture_used);
    assert!((smoothed[21].pose.x_m - truth[21].x_m).abs() < 0.04);
    let none: Vec<TrajectoryFrame> =
        frames.iter().map(|frame| TrajectoryFrame { fit: None, ..*frame }).collect();
    assert!(smooth_trajectory(&none, &SmoothingConfig::default(), MOUNT_SIGMA, STEADY).is_none());
}
