//! What the errors of a calibration do to a pose.

use glam::DVec3;
use nalgebra::{DMatrix, Matrix6, SMatrix, Vector6};

use super::measure::LineOffset;
use crate::{camera::Camera, mount::MountPoseSigma, pose::CameraPose};

/// Number of parameters of the mount: height, pitch, roll.
const OF_MOUNT: usize = 3;

/// Uncertainty of the calibration of a camera: the covariance of lens and mount.
///
/// The parameters are fx, fy, cx, cy (pixels), those of the distortion in the order of
/// [`crate::camera::Distortion::parameters`], then the height of the mount (metres), its turn against the stated pitch and against
/// the stated roll (radians).
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationUncertainty {
    covariance: DMatrix<f64>,
    mount_sigma: Option<MountPoseSigma>,
}

/// Reason why a matrix is no covariance of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum InvalidCovariance {
    /// The matrix does not have one row and one column for each parameter.
    #[error(
        "needs {expected} rows of {expected} numbers: fx, fy, cx, cy, the distortion's, height, pitch and roll of the mount"
    )]
    Size {
        /// Number of parameters of lens and mount.
        expected: usize,
    },
    /// The matrix has a number that is not finite, is not symmetric, or gives a combination of parameters a negative variance.
    #[error(
        "is not the covariance of anything: it must be finite, symmetric, and without negative variances"
    )]
    NotACovariance,
}

impl CalibrationUncertainty {
    /// Takes a covariance for the parameters of a camera. Fails if it has another size, or is none.
    pub fn new(camera: &Camera, covariance: DMatrix<f64>) -> Result<Self, InvalidCovariance> {
        let expected = 4 + camera.distortion.parameters().len() + OF_MOUNT;
        if covariance.shape() != (expected, expected) {
            return Err(InvalidCovariance::Size { expected });
        }
        let scale = covariance.amax();
        let asymmetry = (&covariance - covariance.transpose()).amax();
        if !covariance.iter().all(|value| value.is_finite()) || asymmetry > 1e-9 * scale {
            return Err(InvalidCovariance::NotACovariance);
        }
        // Scaled to unit variances: metres and pixels differ by orders of magnitude.
        let scales = covariance.diagonal().map(|variance| if variance > 0.0 { variance.sqrt() } else { 1.0 });
        let correlation =
            DMatrix::from_fn(expected, expected, |i, j| covariance[(i, j)] / (scales[i] * scales[j]));
        if correlation.symmetric_eigenvalues().min() < -1e-6 {
            return Err(InvalidCovariance::NotACovariance);
        }
        Ok(Self { covariance, mount_sigma: None })
    }

    /// Sets how far height, pitch and roll are from the mount's from picture to picture.
    pub fn with_mount_sigma(self, mount_sigma: MountPoseSigma) -> Self {
        Self { mount_sigma: Some(mount_sigma), ..self }
    }

    /// Returns how far height, pitch and roll are from the mount's from picture to picture, if that was measured.
    pub fn mount_sigma(&self) -> Option<MountPoseSigma> {
        self.mount_sigma
    }

    /// Returns the covariance.
    pub fn covariance(&self) -> &DMatrix<f64> {
        &self.covariance
    }
}

/// What the lines of one picture and its mount pose tell of the calibration, beside the pose: the mixed second derivatives.
#[derive(Debug, Clone)]
pub(super) struct Coupling(SMatrix<f64, 6, MOST>);

/// Largest number of parameters of lens and mount: Brown–Conrady with three radial terms.
pub const MOST: usize = 4 + 5 + OF_MOUNT;

impl Coupling {
    /// Starts with the mount pose, which holds the height, pitch and roll of the pose to those of the mount.
    pub fn of_mount(lens: usize, mount_information: &Matrix6<f64>) -> Self {
        let mut coupling = SMatrix::zeros();
        for axis in 0..OF_MOUNT {
            coupling[(3 + axis, lens + axis)] = -mount_information[(3 + axis, 3 + axis)];
        }
        Self(coupling)
    }

    /// Adds a line with its derivatives by the pose and its weight; one that the camera does not see adds nothing.
    pub fn add(
        &mut self,
        camera: &Camera,
        pose: CameraPose,
        offset: &LineOffset,
        by_pose: &Vector6<f64>,
        weight: f64,
    ) {
        let point = DVec3::from((offset.visible.sample.point_in_world, 0.0));
        let Ok(by_lens) = camera.intrinsic_gradients(pose.camera_from_world(point)) else { return };
        for (column, gradient) in by_lens.iter().enumerate() {
            let along_normal = offset.visible.normal_in_image.dot(*gradient);
            let mut column = self.0.column_mut(column);
            column += weight * along_normal * by_pose;
        }
    }

    /// Returns how the pose moves with the parameters, from its covariance C: to first order by −C B δ when they are off by δ, with
    /// B this coupling.
    pub fn by_calibration(&self, pose: &Matrix6<f64>) -> ByCalibration {
        ByCalibration(-pose * self.0)
    }
}

/// Derivatives of a fitted pose by the parameters of the calibration, metres and radians for each of their units. There are as many
/// columns as any lens has parameters; those beyond this lens's are zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ByCalibration(SMatrix<f64, 6, MOST>);

impl Default for ByCalibration {
    fn default() -> Self {
        Self(SMatrix::zeros())
    }
}

impl ByCalibration {
    /// Returns the derivatives by each parameter, one column each.
    pub fn derivatives(&self) -> &SMatrix<f64, 6, MOST> {
        &self.0
    }

    /// Returns the covariance of the pose that comes from the calibration.
    pub(super) fn covariance(&self, calibration: &CalibrationUncertainty) -> Matrix6<f64> {
        let by_parameters = self.0.columns(0, calibration.covariance.nrows());
        let covariance = by_parameters * &calibration.covariance * by_parameters.transpose();
        Matrix6::from_fn(|row, column| 0.5 * (covariance[(row, column)] + covariance[(column, row)]))
    }

    /// Returns the derivatives of the pose in other axes.
    pub(super) fn turned(&self, turn: &Matrix6<f64>) -> Self {
        Self(turn * self.0)
    }
}

/// Returns the number of the lens's parameters.
pub(super) fn lens_parameters(camera: &Camera) -> usize {
    4 + camera.distortion.parameters().len()
}
