//! A whole recording at once: nothing forces tagging to be causal. Every pose is the most probable one given all
//! pictures, the odometry between them, and what joints and IMU say: a chain solved by Gauss–Newton, whose normal
//! equations are block-tridiagonal (Rauch, Tung and Striebel, 1965, in information form).

use nalgebra::{Matrix3, Matrix3x6, Matrix6, Vector3, Vector6};

use super::picture::{AttitudeTolerance, PoseFit, attitude_error, moved, pose_difference};
use crate::{
    pose::{CameraPose, Motion2},
    preprocess::Attitude,
};

/// Rounds of Gauss–Newton; the chain is nearly linear.
const ROUNDS: usize = 6;
/// Least standard deviation of the odometry between two pictures that is believed: sway of the body, metres and radians.
const MIN_ODOMETRY_SIGMA: [f64; 3] = [0.003, 0.003, 0.003];
/// Where no picture tells, the odometry is worth this much, metres and radians.
const DEFAULT_ODOMETRY_SIGMA: [f64; 3] = [0.02, 0.02, 0.02];
/// A picture's fit this many times farther from the chain than its covariance says is another line (χ² of six).
const OUTLIER_CHI2: f64 = 40.0;

/// What is known of one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrajectoryFrame {
    /// A first guess.
    pub guess: CameraPose,
    /// What the picture says, where it says anything.
    pub fit: Option<PoseFit>,
    /// What joints and IMU say.
    pub attitude: Attitude,
    /// Motion from the frame before, by odometry.
    pub motion: Option<Motion2>,
}

/// A pose of the whole recording's solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothedPose {
    /// The pose.
    pub pose: CameraPose,
    /// Covariance of x, y, yaw, height, pitch, roll, metres and radians.
    pub covariance: Matrix6<f64>,
    /// Whether the picture's own fit was used; else the pose comes from its neighbours.
    pub picture_used: bool,
}

/// The most probable poses of all pictures together. `None` where the equations cannot be solved, as without a single
/// fit.
pub fn smooth_trajectory(
    frames: &[TrajectoryFrame],
    tolerance: AttitudeTolerance,
) -> Option<Vec<SmoothedPose>> {
    if !frames.iter().any(|frame| frame.fit.is_some()) {
        return None;
    }
    let odometry = odometry_information(frames);
    let mut poses: Vec<CameraPose> =
        frames.iter().map(|frame| frame.fit.map_or(frame.guess, |fit| fit.pose)).collect();
    let mut used: Vec<bool> = frames.iter().map(|frame| frame.fit.is_some()).collect();
    let mut covariances = Vec::new();
    for round in 0..ROUNDS {
        let chain = Chain::build(frames, &poses, &used, odometry, tolerance);
        let (steps, marginals) = chain.solve()?;
        for (pose, step) in poses.iter_mut().zip(&steps) {
            *pose = moved(*pose, step);
        }
        covariances = marginals;
        // Judged only after the chain has settled once; a fit may come back.
        if round > 0 {
            for index in 0..frames.len() {
                used[index] = fits_chain(&frames[index], poses[index], covariances[index], used[index]);
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

/// Normal equations of the chain: `diagonal[i]`, and `beside[i]` between i and i + 1.
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
        odometry: Matrix3<f64>,
        tolerance: AttitudeTolerance,
    ) -> Self {
        let prior = tolerance.information();
        let count = frames.len();
        let mut chain = Self {
            diagonal: vec![Matrix6::zeros(); count],
            beside: vec![Matrix6::zeros(); count.saturating_sub(1)],
            right: vec![Vector6::zeros(); count],
        };
        for index in 0..count {
            chain.diagonal[index] += prior;
            chain.right[index] -= prior * attitude_error(poses[index], frames[index].attitude);
            // The weakest of ties keeps poses that nothing else determines where they are.
            chain.diagonal[index] += Matrix6::identity() * 1e-6;
            if let (Some(fit), true) = (frames[index].fit, used[index]) {
                chain.diagonal[index] += fit.information;
                chain.right[index] += fit.information * pose_difference(poses[index], fit.pose);
            }
            if let (Some(motion), true) = (frames[index].motion, index > 0) {
                chain.add_motion(index, poses[index - 1], poses[index], motion, odometry);
            }
        }
        chain
    }

    /// A motion measured between frame `index − 1` and frame `index`.
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

    /// Steps and marginal covariances, by elimination forwards and substitution backwards.
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

/// Motion between two poses minus the motion measured.
fn motion_error(from: CameraPose, to: CameraPose, motion: Motion2) -> Vector3<f64> {
    let between = from.planar().motion_to(to.planar());
    Vector3::new(
        between.forward_m - motion.forward_m,
        between.left_m - motion.left_m,
        crate::pose::wrap_angle(between.turn_rad - motion.turn_rad),
    )
}

/// Change of the motion between two poses with the six numbers of each.
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

/// What the odometry is worth, from how well it agrees with neighbouring fits: the median deviation of each axis.
fn odometry_information(frames: &[TrajectoryFrame]) -> Matrix3<f64> {
    let errors: Vec<Vector3<f64>> = frames
        .windows(2)
        .filter_map(|pair| Some(motion_error(pair[0].fit?.pose, pair[1].fit?.pose, pair[1].motion?)))
        .collect();
    Matrix3::from_diagonal(&Vector3::from_fn(|axis, _| {
        let sigma = if errors.len() < 10 {
            DEFAULT_ODOMETRY_SIGMA[axis]
        } else {
            super::picture::robust_sigma(errors.iter().map(|error| error[axis])).max(MIN_ODOMETRY_SIGMA[axis])
        };
        1.0 / (sigma * sigma)
    }))
}

/// Whether a picture's fit agrees with the chain within both covariances.
fn fits_chain(frame: &TrajectoryFrame, pose: CameraPose, covariance: Matrix6<f64>, used: bool) -> bool {
    let Some(fit) = frame.fit else { return false };
    let difference = pose_difference(pose, fit.pose);
    // A fit that is part of the chain pulls it towards itself: its own covariance alone must explain the rest.
    let spread = if used { fit.covariance } else { fit.covariance + covariance };
    spread
        .try_inverse()
        .is_some_and(|inverse| (difference.transpose() * inverse * difference)[0] < OUTLIER_CHI2)
}
