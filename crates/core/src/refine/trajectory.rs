//! Smoothing of a whole recording. Every pose is the most probable one given all pictures, past and future, the
//! odometry between them, and the mount poses. The poses form a chain, which is solved by Gauss–Newton; its normal
//! equations are block-tridiagonal (Rauch, Tung and Striebel, 1965, in information form).

use nalgebra::{Matrix3, Matrix3x6, Matrix6, Vector3, Vector6};

use super::{
    config::SmoothingConfig,
    picture::{PoseFit, mount_error, moved, pose_difference},
};
use crate::{
    filter::MotionNoise,
    mount::{MountPose, MountPoseSigma},
    pose::{CameraPose, Motion2},
    statistics::{median, robust_sigma},
};

/// Everything known about one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrajectoryFrame {
    /// First guess of the pose.
    pub guess: CameraPose,
    /// Fit to the picture, if there is one.
    pub fit: Option<PoseFit>,
    /// Mount pose by joints and IMU.
    pub mount: MountPose,
    /// Motion since the previous frame, by odometry.
    pub motion: Option<Motion2>,
}

/// Pose of one frame in the solution for the whole recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothedPose {
    /// Smoothed pose.
    pub pose: CameraPose,
    /// Covariance of x, y, yaw, height, pitch, roll, metres and radians.
    pub covariance: Matrix6<f64>,
    /// Whether the picture's own fit was used; otherwise the pose comes from its neighbours.
    pub picture_used: bool,
}

/// Returns the most probable poses of all pictures together. Returns `None` if the equations cannot be solved, for
/// example without a single fit.
pub fn smooth_trajectory(
    frames: &[TrajectoryFrame],
    config: &SmoothingConfig,
    mount_sigma: MountPoseSigma,
    noise: MotionNoise,
) -> Option<Vec<SmoothedPose>> {
    if !frames.iter().any(|frame| frame.fit.is_some()) {
        return None;
    }
    let odometry = OdometryNoise::learn(frames, config, noise);
    let mut poses: Vec<CameraPose> =
        frames.iter().map(|frame| frame.fit.map_or(frame.guess, |fit| fit.pose)).collect();
    let mut used: Vec<bool> = frames.iter().map(|frame| frame.fit.is_some()).collect();
    let mut covariances = Vec::new();
    for round in 0..config.rounds {
        let chain = Chain::build(frames, &poses, &used, &odometry, mount_sigma);
        let (steps, marginals) = chain.solve()?;
        for (pose, step) in poses.iter_mut().zip(&steps) {
            *pose = moved(*pose, step);
        }
        covariances = marginals;
        // Fits are judged only after the chain has settled once; a rejected fit may come back.
        if round > 0 {
            for index in 0..frames.len() {
                let chi2 = chi2_from_chain(&frames[index], poses[index], covariances[index], used[index]);
                used[index] = chi2.is_some_and(|chi2| chi2 < config.outlier_chi2);
            }
        }
    }
    let smoothed = poses.into_iter().zip(covariances).zip(used);
    Some(
        smoothed
            .map(|((pose, covariance), picture_used)| SmoothedPose { pose, covariance, picture_used })
            .collect(),
    )
}

/// Steps of all poses, and their marginal covariances.
type Solution = (Vec<Vector6<f64>>, Vec<Matrix6<f64>>);

/// Normal equations of the chain: `diagonal[i]` of pose i, and `beside[i]` between poses i and i + 1.
struct Chain {
    diagonal: Vec<Matrix6<f64>>,
    beside: Vec<Matrix6<f64>>,
    right: Vec<Vector6<f64>>,
}

impl Chain {
    fn build(
        frames: &[TrajectoryFrame],
        poses: &[CameraPose],
        used: &[bool],
        odometry: &OdometryNoise,
        mount_sigma: MountPoseSigma,
    ) -> Self {
        let prior = mount_sigma.information();
        let count = frames.len();
        let mut chain = Self {
            diagonal: vec![Matrix6::zeros(); count],
            beside: vec![Matrix6::zeros(); count.saturating_sub(1)],
            right: vec![Vector6::zeros(); count],
        };
        for index in 0..count {
            chain.diagonal[index] += prior;
            chain.right[index] -= prior * mount_error(poses[index], frames[index].mount);
            // A very weak prior keeps poses that nothing else determines where they are.
            chain.diagonal[index] += Matrix6::identity() * 1e-6;
            if let (Some(fit), true) = (frames[index].fit, used[index]) {
                chain.diagonal[index] += fit.information;
                chain.right[index] += fit.information * pose_difference(poses[index], fit.pose);
            }
            if let (Some(motion), true) = (frames[index].motion, index > 0) {
                chain.add_motion(index, poses[index - 1], poses[index], motion, odometry.information(motion));
            }
        }
        chain
    }

    /// Adds a motion measured between frame `index − 1` and frame `index`.
    fn add_motion(
        &mut self,
        index: usize,
        from: CameraPose,
        to: CameraPose,
        motion: Motion2,
        odometry: Matrix3<f64>,
    ) {
        let error = motion_error(from, to, motion);
        let (j_from, j_to) = motion_gradients(from, to);
        self.diagonal[index - 1] += j_from.transpose() * odometry * j_from;
        self.diagonal[index] += j_to.transpose() * odometry * j_to;
        self.beside[index - 1] += j_from.transpose() * odometry * j_to;
        self.right[index - 1] -= j_from.transpose() * odometry * error;
        self.right[index] -= j_to.transpose() * odometry * error;
    }

    /// Returns steps and marginal covariances, by forward elimination and back substitution.
    fn solve(self) -> Option<Solution> {
        let count = self.diagonal.len();
        let mut inverses: Vec<Matrix6<f64>> = Vec::with_capacity(count);
        let mut rights: Vec<Vector6<f64>> = Vec::with_capacity(count);
        for index in 0..count {
            let (mut diagonal, mut right) = (self.diagonal[index], self.right[index]);
            if index > 0 {
                let coupling = self.beside[index - 1].transpose() * inverses[index - 1];
                diagonal -= coupling * self.beside[index - 1];
                right -= coupling * rights[index - 1];
            }
            inverses.push(symmetric(diagonal).cholesky()?.inverse());
            rights.push(right);
        }
        let mut steps = vec![Vector6::zeros(); count];
        let mut covariances = inverses.clone();
        for index in (0..count).rev() {
            let mut right = rights[index];
            if index + 1 < count {
                let gain = inverses[index] * self.beside[index];
                right -= self.beside[index] * steps[index + 1];
                let from_next = gain * covariances[index + 1] * gain.transpose();
                covariances[index] += from_next;
            }
            steps[index] = inverses[index] * right;
        }
        Some((steps, covariances.into_iter().map(symmetric).collect()))
    }
}

fn symmetric(matrix: Matrix6<f64>) -> Matrix6<f64> {
    0.5 * (matrix + matrix.transpose())
}

/// Returns the motion between two poses minus the measured motion.
fn motion_error(from: CameraPose, to: CameraPose, motion: Motion2) -> Vector3<f64> {
    let between = from.planar().motion_to(to.planar());
    Vector3::new(
        between.forward_m - motion.forward_m,
        between.left_m - motion.left_m,
        crate::pose::wrap_angle(between.turn_rad - motion.turn_rad),
    )
}

/// Returns the derivatives of the motion between two poses by the six numbers of each.
fn motion_gradients(from: CameraPose, to: CameraPose) -> (Matrix3x6<f64>, Matrix3x6<f64>) {
    let (sin, cos) = from.yaw_rad.sin_cos();
    let (dx, dy) = (to.x_m - from.x_m, to.y_m - from.y_m);
    let mut j_from = Matrix3x6::zeros();
    let mut j_to = Matrix3x6::zeros();
    j_to.fixed_view_mut::<2, 2>(0, 0).copy_from(&nalgebra::Matrix2::new(cos, sin, -sin, cos));
    j_from.fixed_view_mut::<2, 2>(0, 0).copy_from(&nalgebra::Matrix2::new(-cos, -sin, sin, -cos));
    j_from[(0, 2)] = -sin * dx + cos * dy;
    j_from[(1, 2)] = -cos * dx - sin * dy;
    j_from[(2, 2)] = -1.0;
    j_to[(2, 2)] = 1.0;
    (j_from, j_to)
}

/// Noise of the odometry: a part that grows with the motion, and the sway of the body, which does not.
struct OdometryNoise {
    growing: MotionNoise,
    sway: Vector3<f64>,
}

impl OdometryNoise {
    /// Estimates the sway from how well the odometry agrees with neighbouring fits: the median deviation along each
    /// axis, minus what the fits themselves and the growing part contribute.
    fn learn(frames: &[TrajectoryFrame], config: &SmoothingConfig, noise: MotionNoise) -> Self {
        let growing = MotionNoise { still_m: 0.0, still_rad: 0.0, ..noise };
        let mut odometry = Self { growing, sway: Vector3::zeros() };
        let pairs: Vec<(Vector3<f64>, Vector3<f64>)> = frames
            .windows(2)
            .filter_map(|pair| {
                let (from, to, motion) = (pair[0].fit?, pair[1].fit?, pair[1].motion?);
                let known = planar_variances(&from) + planar_variances(&to) + odometry.variances(motion);
                Some((motion_error(from.pose, to.pose, motion), known))
            })
            .collect();
        odometry.sway = Vector3::from_fn(|axis, _| {
            if pairs.len() < config.min_sway_pairs {
                return config.default_sway[axis].powi(2);
            }
            let deviation = robust_sigma(pairs.iter().map(|(error, _)| error[axis]));
            let known = median(pairs.iter().map(|(_, known)| known[axis]));
            (deviation * deviation - known).max(config.min_sway[axis].powi(2))
        });
        odometry
    }

    /// Returns the variances forwards, to the left and in heading.
    fn variances(&self, motion: Motion2) -> Vector3<f64> {
        let sigma = self.growing.sigma(Some(motion));
        let place = sigma.position_m * sigma.position_m;
        self.sway + Vector3::new(place, place, sigma.yaw_rad * sigma.yaw_rad)
    }

    fn information(&self, motion: Motion2) -> Matrix3<f64> {
        Matrix3::from_diagonal(&self.variances(motion).map(|variance| 1.0 / variance))
    }
}

/// Returns the variances of a fit forwards, sideways and in heading. The first two are both the mean variance of the
/// position, which does not depend on the heading.
fn planar_variances(fit: &PoseFit) -> Vector3<f64> {
    let place = 0.5 * (fit.covariance[(0, 0)] + fit.covariance[(1, 1)]);
    Vector3::new(place, place, fit.covariance[(2, 2)])
}

/// Returns the squared Mahalanobis distance of a picture's fit from all the others, if it has a fit. For a fit that is part
/// of the chain, its deviation from the chain is compared with the difference of the two covariances; this equals the
/// innovation test against the chain without the fit.
fn chi2_from_chain(
    frame: &TrajectoryFrame,
    pose: CameraPose,
    covariance: Matrix6<f64>,
    used: bool,
) -> Option<f64> {
    let fit = frame.fit?;
    let difference = pose_difference(pose, fit.pose);
    let alone = fit.information.try_inverse().unwrap_or(fit.covariance);
    // Inflating the fit's own covariance a little keeps the difference of two nearly equal ones positive definite.
    let spread = if used { 1.05 * alone - covariance } else { alone + covariance };
    spread.cholesky().map(|spread| difference.dot(&spread.solve(&difference)))
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
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

    /// Simulates a walk whose pictures and odometry err as their covariances say; every third picture shows nothing.
    fn walk(seed: u64, count: u32) -> (Vec<CameraPose>, Vec<TrajectoryFrame>) {
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
        let sigmas = Vector6::new(0.01, 0.02, 0.008, 0.005, 0.004, 0.003);
        let covariance = Matrix6::from_diagonal(&sigmas.component_mul(&sigmas));
        let normals = |purpose, i: usize| Stream::new(seed, purpose, i as u32, 0).normals(0);
        let frames = (0..truth.len())
            .map(|i| {
                let n = Vector6::from(normals(Purpose::Predict, i));
                let pose = moved(truth[i], &sigmas.component_mul(&n));
                let fit = PoseFit {
                    pose,
                    covariance,
                    information: covariance.try_inverse().unwrap(),
                    residual_px: 0.1,
                    found: 1.0,
                    offsets: 100,
                };
                let o = normals(Purpose::Diffuse, i);
                let motion = (i > 0).then(|| {
                    let m = truth[i - 1].planar().motion_to(truth[i].planar());
                    Motion2 {
                        forward_m: m.forward_m + 0.005 * o[0],
                        left_m: m.left_m + 0.005 * o[1],
                        turn_rad: m.turn_rad + 0.004 * o[2],
                    }
                });
                let a = normals(Purpose::Initialise, i);
                let mount = MountPose {
                    height_m: 0.5 + 0.03 * a[0],
                    pitch_rad: 0.4 + 0.01 * a[1],
                    roll_rad: 0.01 * a[2],
                };
                TrajectoryFrame { guess: pose, fit: (i % 3 != 2).then_some(fit), mount, motion }
            })
            .collect();
        (truth, frames)
    }

    /// Compares the block elimination with one dense solve of the same normal equations.
    #[test]
    fn the_chain_is_solved_as_a_dense_system_would_be() {
        let (truth, frames) = walk(3, 9);
        let used = vec![true; 9];
        let chain = Chain::build(
            &frames,
            &truth,
            &used,
            &OdometryNoise::learn(&frames, &SmoothingConfig::default(), STEADY),
            MOUNT_SIGMA,
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
        let (mut single, mut smooth, mut nees, mut gaps) = (0.0, 0.0, Vec::new(), 0.0_f64);
        for seed in 0..12 {
            let (truth, frames) = walk(seed, 60);
            let smoothed =
                smooth_trajectory(&frames, &SmoothingConfig::default(), MOUNT_SIGMA, STEADY).unwrap();
            for ((truth, frame), pose) in truth.iter().zip(&frames).zip(&smoothed) {
                let error = pose_difference(*truth, pose.pose);
                match frame.fit {
                    Some(fit) => {
                        single += pose_difference(*truth, fit.pose).norm_squared();
                        smooth += error.norm_squared();
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

    #[test]
    fn a_fit_of_the_wrong_line_is_outvoted() {
        let (truth, mut frames) = walk(5, 40);
        let wrong = frames[21].fit.as_mut().unwrap();
        wrong.pose.x_m += 0.6;
        let smoothed = smooth_trajectory(&frames, &SmoothingConfig::default(), MOUNT_SIGMA, STEADY).unwrap();
        assert!(!smoothed[21].picture_used);
        assert!((smoothed[21].pose.x_m - truth[21].x_m).abs() < 0.04);
        let none: Vec<TrajectoryFrame> =
            frames.iter().map(|frame| TrajectoryFrame { fit: None, ..*frame }).collect();
        assert!(smooth_trajectory(&none, &SmoothingConfig::default(), MOUNT_SIGMA, STEADY).is_none());
    }
}
