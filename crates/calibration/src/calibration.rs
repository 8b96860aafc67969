//! Result of a calibration.

use nalgebra::DMatrix;
use reality_sim_core::{
    camera::Camera,
    mount::MountPoseSigma,
    pose::CameraPose,
    refine::{CalibrationUncertainty, InvalidCovariance},
    sequence::Mounting,
};

use crate::{
    advice::Advice, body_offset::BodyOffset, noise::Noise, parameter::Parameter, selection::Choice,
    uncertainty::UncertaintyMap,
};

/// Lens, mount and poses, as the lines of the field show them.
#[derive(Debug, Clone)]
pub struct Calibration {
    /// Lens and size of the pictures.
    pub camera: Camera,
    /// Nominal height of the projection centre above the carpet, metres.
    pub height_m: f64,
    /// Turn of the camera against the pitch and roll that the recording states.
    pub mounting: Mounting,
    /// Parameters that were fitted, in the order of the covariance.
    pub parameters: Vec<Parameter>,
    /// Values of the parameters: pixels, metres, radians.
    pub values: Vec<f64>,
    /// Covariance of the parameters.
    pub covariance: DMatrix<f64>,
    /// Camera on the body, if there is odometry and it turns.
    pub body_offset: Option<BodyOffset>,
    /// Poses of the pictures that were used, by frame (from 0).
    pub poses: Vec<(usize, CameraPose)>,
    /// Number of pictures that were tried.
    pub pictures: usize,
    /// Noise of lines, joints and IMU in this recording.
    pub noise: Noise,
    /// Robust standard deviation of the distances between projected and measured lines, pixels.
    pub reprojection_px: f64,
    /// Root mean square of these distances in pictures that the lens was not fitted to, pixels. Those beyond
    /// five standard deviations of the noise count as five.
    pub held_out_px: f64,
    /// What was compared to choose the number of terms.
    pub choices: Vec<Choice>,
    /// Place of the chosen one among them.
    pub chosen: usize,
    /// Uncertainty of the projection over the picture.
    pub uncertainty: UncertaintyMap,
    /// Pictures that would help most.
    pub advice: Vec<Advice>,
}

/// Standard deviation of a parameter above which it counts as undetermined.
///
/// Height: 1 cm, the error above which poses are off by as much as a line's width in a few metres. Angles: 0.2°, the play of a
/// good joint. Focal length: 1 %; principal point: 1 % of the picture's width, both about what copying another robot's
/// calibration costs. Distortion: a third of what is possible at all.
fn largest_sigma(parameter: Parameter, camera: &Camera, height_m: f64) -> f64 {
    match parameter {
        Parameter::Height => 0.01,
        Parameter::MountPitch | Parameter::MountRoll => 0.2_f64.to_radians(),
        Parameter::FocalLength => 0.01 * camera.fx,
        Parameter::PrincipalX | Parameter::PrincipalY => 0.01 * f64::from(camera.width),
        Parameter::AspectRatio | Parameter::Distortion(_) => parameter.prior_sigma(camera, height_m) / 3.0,
    }
}

/// Two parameters of which the pictures tell a combination better than each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Confusable {
    /// The two.
    pub parameters: [Parameter; 2],
    /// Correlation of their errors.
    pub correlation: f64,
}

/// Correlation from which two parameters are called confusable: the error of each is then ten times smaller when the other is
/// known, √(1 − 0.995²).
const CONFUSABLE: f64 = 0.995;

impl Calibration {
    /// Returns the standard deviation of each parameter.
    pub fn sigmas(&self) -> Vec<f64> {
        self.covariance.diagonal().iter().map(|variance| variance.max(0.0).sqrt()).collect()
    }

    /// Returns the parameters that the pictures do not determine.
    pub fn undetermined(&self) -> Vec<Parameter> {
        let sigmas = self.sigmas();
        let pairs = self.parameters.iter().zip(sigmas);
        pairs
            .filter(|(parameter, sigma)| *sigma > largest_sigma(**parameter, &self.camera, self.height_m))
            .map(|(parameter, _)| *parameter)
            .collect()
    }

    /// Returns the pairs that the pictures hardly tell apart.
    pub fn confusable(&self) -> Vec<Confusable> {
        let sigmas = self.sigmas();
        let mut found = Vec::new();
        for first in 0..self.parameters.len() {
            for second in first + 1..self.parameters.len() {
                let correlation = self.covariance[(first, second)] / (sigmas[first] * sigmas[second]);
                if correlation.abs() > CONFUSABLE {
                    let parameters = [self.parameters[first], self.parameters[second]];
                    found.push(Confusable { parameters, correlation });
                }
            }
        }
        found
    }
}

impl Calibration {
    /// Returns the covariance of all parameters of lens and mount, those that were not fitted taken as exact, for a camera's file.
    /// Fails if rounding has spoiled it.
    pub fn uncertainty_for_file(&self) -> Result<CalibrationUncertainty, InvalidCovariance> {
        let covariance = of_all_parameters(&self.camera, &self.parameters, &self.covariance);
        Ok(CalibrationUncertainty::new(&self.camera, covariance)?
            .with_mount_sigma(noise_of_mount(&self.noise)))
    }
}

/// Returns the covariance of all parameters of lens and mount from that of some of them; the others are exact.
pub(crate) fn of_all_parameters(
    camera: &Camera,
    parameters: &[Parameter],
    covariance: &DMatrix<f64>,
) -> DMatrix<f64> {
    let lens = 4 + camera.distortion.parameters().len();
    let mut of_all = DMatrix::zeros(lens + 3, parameters.len());
    for (column, parameter) in parameters.iter().enumerate() {
        match parameter {
            Parameter::FocalLength => {
                of_all[(0, column)] = 1.0;
                of_all[(1, column)] = camera.fy / camera.fx;
            }
            Parameter::AspectRatio => of_all[(1, column)] = camera.fx,
            Parameter::PrincipalX => of_all[(2, column)] = 1.0,
            Parameter::PrincipalY => of_all[(3, column)] = 1.0,
            Parameter::Distortion(index) => of_all[(4 + index, column)] = 1.0,
            Parameter::Height => of_all[(lens, column)] = 1.0,
            Parameter::MountPitch => of_all[(lens + 1, column)] = 1.0,
            Parameter::MountRoll => of_all[(lens + 2, column)] = 1.0,
        }
    }
    let covariance = &of_all * covariance * of_all.transpose();
    0.5 * (&covariance + covariance.transpose())
}

/// Returns how far height, pitch and roll are from the mount's from picture to picture.
pub(crate) fn noise_of_mount(noise: &Noise) -> MountPoseSigma {
    MountPoseSigma { height_m: noise.height_m, angle_rad: noise.pitch_rad.max(noise.roll_rad) }
}
