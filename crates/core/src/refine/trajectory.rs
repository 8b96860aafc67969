//! Smoothing of a whole recording. Every pose is the most probable one given all pictures, past and future, the
//! odometry between them, and the mount poses. The poses form a chain, which is solved by Gauss–Newton; its normal
//! equations are block-tridiagonal (Rauch, Tung and Striebel, 1965, in information form).

use nalgebra::{Matrix3, Matrix3x6, Matrix6, Vector3, Vector6};

use super::{
    config::SmoothingConfig,
    picture::{PoseFit, mount_error},
    pose_steps::moved,
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
    let prior = mount_sigma.information();
    let mut poses: Vec<CameraPose> =
        frames.iter().map(|frame| frame.fit.map_or(frame.guess, |fit| fit.pose)).collect();
    let mut used: Vec<bool> = frames.iter().map(|frame| frame.fit.is_some()).collect();
    let mut covariances = Vec::new();
    for round in 0..config.rounds {
        let chain = Chain::build(frames, &poses, &used, &odometry, prior);
        let (steps, marginals) = chain.solve()?;
        for (pose, step) in poses.iter_mut().zip(&steps) {
            *pose = moved(*pose, step);
        }
        covariances = marginals;
        // Fits are judged only after the chain has settled once; a rejected fit may come back.
        if round > 0 {
            for index in 0..frames.len() {
                let others = Contradiction { config, prior: &prior, is_used: used[index] };
                let chi2 = others.chi2(&frames[index], poses[index], &covariances[index]);
                used[index] = chi2.is_some_and(|chi2| chi2 < config.outlier_chi2);
            }
        }
    }
    let of_calibration = errors_of_calibration(frames, &used);
    let smoothed = poses.into_iter().zip(covariances).zip(used).zip(of_calibration);
    Some(
        smoothed
            .map(|(((pose, covariance), picture_used), of_calibration)| SmoothedPose {
                pose,
                covariance: covariance + of_calibration,
                picture_used,
            })
            .collect(),
    )
}

/// Returns the part of each pose's covariance that comes from the calibration: that of its own picture, or of the nearest one that
/// is used. All pictures share the calibration's error, so that smoothing does not reduce it.
fn errors_of_calibration(frames: &[TrajectoryFrame], used: &[bool]) -> Vec<Matrix6<f64>> {
    let known: Vec<(usize, Matrix6<f64>)> = (0..frames.len())
        .filter(|&index| used[index])
        .filter_map(|index| Some((index, frames[index].fit?.of_calibration)))
        .collect();
    let mut nearest = 0;
    let of_frame = |index: usize| {
        while nearest + 1 < known.len()
            && known[nearest + 1].0.abs_diff(index) <= known[nearest].0.abs_diff(index)
        {
            nearest += 1;
        }
        known.get(nearest).map_or_else(Matrix6::zeros, |(_, of_calibration)| *of_calibration)
    };
    (0..frames.len()).map(of_frame).collect()
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
        prior: Matrix6<f64>,
    ) -> Self {
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
                chain.right[index] += fit.pull_of_picture(poses[index], frames[index].mount, &prior);
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
    // Neighbours share the calibration's error, which their motion does not contain.
    let covariance = fit.covariance - fit.of_calibration;
    let place = 0.5 * (covariance[(0, 0)] + covariance[(1, 1)]);
    Vector3::new(place, place, covariance[(2, 2)])
}

/// Comparison of what a picture alone tells with what all the rest does: its mount pose, and the other pictures.
struct Contradiction<'a> {
    config: &'a SmoothingConfig,
    /// Inverse covariance of the mount pose.
    prior: &'a Matrix6<f64>,
    /// Whether the picture is part of the chain.
    is_used: bool,
}

impl Contradiction<'_> {
    /// Returns the squared Mahalanobis distance of a picture from all the rest, if it has a fit. For a picture that is part
    /// of the chain, its deviation from the chain is compared with the difference of the two covariances; this equals the
    /// innovation test against the chain without the picture. It is taken along the principal axes of the picture's
    /// information: those of which it tells next to nothing are left out.
    fn chi2(&self, frame: &TrajectoryFrame, pose: CameraPose, covariance: &Matrix6<f64>) -> Option<f64> {
        let fit = frame.fit?;
        let axes = fit.information.symmetric_eigen();
        let is_told = axes.eigenvalues.map(|information| information > self.config.min_information);
        let pull = axes.eigenvectors.transpose() * fit.pull_of_picture(pose, frame.mount, self.prior);
        let of_chain = axes.eigenvectors.transpose() * covariance * axes.eigenvectors;
        let difference = Vector6::from_fn(|axis, _| match is_told[axis] {
            true => pull[axis] / axes.eigenvalues[axis],
            false => 0.0,
        });
        // Inflating the picture's own covariance a little keeps the difference of two nearly equal ones positive definite.
        let (of_picture, sign) = if self.is_used { (1.05, -1.0) } else { (1.0, 1.0) };
        let spread = Matrix6::from_fn(|row, column| {
            let own = if row == column { of_picture / axes.eigenvalues[row] } else { 0.0 };
            match is_told[row] && is_told[column] {
                true => own + sign * of_chain[(row, column)],
                false => f64::from(u8::from(row == column)),
            }
        });
        spread.cholesky().map(|spread| difference.dot(&spread.solve(&difference)))
    }
}

#[cfg(test)]
mod tests;
