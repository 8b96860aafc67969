//! Where the camera is against the point of the body that the odometry follows. When the body turns on the spot, a camera that
//! is not above that point moves; when it walks straight, a camera that looks aside moves aside.

use nalgebra::{Matrix2x3, Matrix3, Vector2, Vector3};
use reality_sim_core::{
    pose::{Motion2, Pose2},
    statistics::{robust_sigma, tukey_weight},
};

/// Fewest pairs of neighbouring pictures from which an offset is estimated.
const LEAST_PAIRS: usize = 10;

/// Number of reweighted steps: the equations are nearly linear.
const STEPS: usize = 8;

/// Standard deviations of the offset before anything is seen: no camera of a robot is farther from its body's centre, or turned
/// farther without anybody knowing, metres and radians.
const PRIOR_SIGMA: [f64; 3] = [0.3, 0.3, 0.3];

/// Place and heading of the camera in the odometry's frame of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyOffset {
    /// Ahead, to the left (metres) and turned counter-clockwise (radians).
    pub value: Vector3<f64>,
    /// Covariance of these.
    pub covariance: Matrix3<f64>,
}

/// Motion between two pictures as the lines and as the odometry have it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pair {
    pub by_lines: Motion2,
    pub by_odometry: Motion2,
}

impl Pair {
    /// Makes the pair of two neighbouring pictures from the poses of the camera and those of the odometry.
    pub fn new([from, to]: [Pose2; 2], [odometry_from, odometry_to]: [Pose2; 2]) -> Self {
        Self { by_lines: from.motion_to(to), by_odometry: odometry_from.motion_to(odometry_to) }
    }

    /// Returns the motion of a camera with this offset when the body moves as the odometry has it.
    fn predicted(&self, offset: &Vector3<f64>) -> Vector2<f64> {
        let turn = nalgebra::Rotation2::new(self.by_odometry.turn_rad);
        let place = Vector2::new(offset[0], offset[1]);
        let moved = Vector2::new(self.by_odometry.forward_m, self.by_odometry.left_m) + turn * place - place;
        nalgebra::Rotation2::new(-offset[2]) * moved
    }

    fn residual(&self, offset: &Vector3<f64>) -> Vector2<f64> {
        Vector2::new(self.by_lines.forward_m, self.by_lines.left_m) - self.predicted(offset)
    }

    fn gradient(&self, offset: &Vector3<f64>) -> Matrix2x3<f64> {
        let step = 1e-6;
        Matrix2x3::from_columns(&[0, 1, 2].map(|axis| {
            let mut change = Vector3::zeros();
            change[axis] = step;
            (self.predicted(&(offset + change)) - self.predicted(&(offset - change))) / (2.0 * step)
        }))
    }
}

/// Estimates the offset. Returns `None` with too few pairs.
pub(crate) fn estimate(pairs: &[Pair]) -> Option<BodyOffset> {
    if pairs.len() < LEAST_PAIRS {
        return None;
    }
    let prior = Matrix3::from_diagonal(&Vector3::from(PRIOR_SIGMA).map(|sigma| 1.0 / (sigma * sigma)));
    let mut value = Vector3::zeros();
    let mut covariance = Matrix3::zeros();
    for _ in 0..STEPS {
        let residuals: Vec<Vector2<f64>> = pairs.iter().map(|pair| pair.residual(&value)).collect();
        let sigma = robust_sigma(residuals.iter().flat_map(|r| [r.x, r.y])).max(1e-4);
        let (mut information, mut right) = (prior, -prior * value);
        for (pair, residual) in pairs.iter().zip(&residuals) {
            let weight = tukey_weight(residual.norm() / sigma);
            let gradient = pair.gradient(&value);
            let scaled = weight / (sigma * sigma) * gradient.transpose();
            information += scaled * gradient;
            right += scaled * residual;
        }
        covariance = information.try_inverse()?;
        value += covariance * right;
    }
    Some(BodyOffset { value, covariance })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// The truth composes poses; the code under test has formulas for motions.
        #[test]
        fn the_offset_of_a_camera_is_found(forward_m in -0.2..0.2_f64, left_m in -0.1..0.1_f64, heading_rad in -0.2..0.2_f64, seed in 0..1000_u32) {
            let offset = Motion2 { forward_m, left_m, turn_rad: heading_rad };
            let body: Vec<Pose2> = (0..40).map(|i| {
                let phase = f64::from(i) * 0.7 + f64::from(seed);
                Pose2::new(phase.sin(), (1.3 * phase).cos(), 0.8 * (0.9 * phase).sin())
            }).collect();
            let camera: Vec<Pose2> = body.iter().map(|pose| pose.moved(offset)).collect();
            let pairs: Vec<Pair> = (1..40).map(|i| Pair::new([camera[i - 1], camera[i]], [body[i - 1], body[i]])).collect();
            let found = estimate(&pairs).unwrap();
            prop_assert!((found.value - Vector3::new(forward_m, left_m, heading_rad)).norm() < 1e-4, "{:?}", found);
        }
    }
}
