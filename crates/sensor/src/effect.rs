//! Effects: deviations of real cameras and robots from the nominal model.
//!
//! The simulated camera is a chain of stages. An effect changes one of them through the hooks of that stage; its parameters
//! set how much. At the neutral values every hook is the identity.

mod about;
mod estimates;
mod parameter;

use std::fmt::Debug;

use glam::{DVec2, DVec3};
use reality_sim_core::{
    camera::{Camera, InvalidCamera},
    field::FieldDimensions,
    pose::{CameraPose, Motion2},
};

pub use self::{
    about::{About, Changes, Covariate, Need, Opposite, Stage},
    estimates::Estimates,
    parameter::{Growth, Parameter, Role},
};
use crate::{
    noise::Noise,
    surface::Surface,
    tone::{InvalidTone, Tone},
};

/// One effect: its description, its wording, and its forward model.
///
/// The hooks take the values `p` in the order of [`About::parameters`]; values missing at the end are 0. Each hook is the
/// identity unless the effect overrides it. A [`Chain`](crate::Chain) only calls the hooks of the effect's stage.
pub trait Effect: Sync + Debug {
    /// Returns the effect's description.
    fn about(&self) -> &'static About;

    /// Returns the effect's size in words, with 95 % intervals: "at the corner 42 % of the light is lost (± 1 %)". Returns
    /// `None` where one of its estimates is missing.
    fn size(&self, estimates: &Estimates<'_>) -> Option<String>;

    /// World: returns the true field for the nominal one.
    fn field(&self, _p: &[f64], field: FieldDimensions) -> FieldDimensions {
        field
    }

    /// World: returns the factor of the light on the ground at a point, metres.
    fn light(&self, _p: &[f64], _point_in_world: DVec2, _field: &FieldDimensions) -> f64 {
        1.0
    }

    /// World: returns the factor of a surface's reflectance.
    fn reflectance(&self, _p: &[f64], _surface: Surface) -> f64 {
        1.0
    }

    /// Motion: returns the delay in seconds of the middle of a row's exposure after the frame's timestamp; rows run from 0
    /// at the top to 1 at the bottom.
    fn delay_s(&self, _p: &[f64], _row: f64) -> f64 {
        0.0
    }

    /// Motion: returns the exposure time of each row in seconds; the times of several effects add up.
    fn exposure_s(&self, _p: &[f64]) -> f64 {
        0.0
    }

    /// Motion: returns the delay in seconds of images and odometry after the time of the reference poses.
    fn clock_s(&self, _p: &[f64]) -> f64 {
        0.0
    }

    /// Motion: returns the delay in seconds of the picture with this timestamp after the time of the reference poses.
    fn picture_delay_s(&self, _p: &[f64], _time_s: f64) -> f64 {
        0.0
    }

    /// Motion: returns the true pose at a time for that of the reference.
    fn sway(&self, _p: &[f64], pose: CameraPose, _time_s: f64) -> CameraPose {
        pose
    }

    /// Mount: returns the true pose for the nominal one.
    fn mount(&self, _p: &[f64], pose: CameraPose) -> CameraPose {
        pose
    }

    /// Lens: returns the true camera for the nominal one. Fails where the values leave no valid camera.
    fn lens(&self, _p: &[f64], camera: Camera) -> Result<Camera, InvalidCamera> {
        Ok(camera)
    }

    /// Lens: returns the shift in pixels of a point's picture that no camera model of the core expresses; `camera` is the true
    /// one.
    fn shift_px(&self, _p: &[f64], _camera: &Camera, _point_in_camera: DVec3) -> DVec2 {
        DVec2::ZERO
    }

    /// Lens: returns the magnification of red, green and blue about the principal point; 1 leaves the channel unchanged.
    fn magnification(&self, _p: &[f64]) -> [f64; 3] {
        [1.0; 3]
    }

    /// Lens: returns the share of the light that reaches the sensor at a distance from the principal point, in units of half
    /// the picture's diagonal.
    fn falloff(&self, _p: &[f64], _radius: f64) -> f64 {
        1.0
    }

    /// Lens: returns the variance of the blur along each axis, pixels², at a distance as in [`Effect::falloff`].
    fn blur_variance_px2(&self, _p: &[f64], _radius: f64) -> f64 {
        0.0
    }

    /// Lens: returns the share of the picture's mean light that is added everywhere.
    fn glare(&self, _p: &[f64]) -> f64 {
        0.0
    }

    /// Exposure: returns the gain of red, green and blue in the frame with this timestamp.
    fn gain(&self, _p: &[f64], _time_s: f64) -> [f64; 3] {
        [1.0; 3]
    }

    /// Sensor: returns the linear output for a linear value, before noise.
    fn respond(&self, _p: &[f64], linear: f64) -> f64 {
        linear
    }

    /// Sensor: returns the true noise for the nominal one.
    fn noise(&self, _p: &[f64], noise: Noise) -> Noise {
        noise
    }

    /// Encoding: returns the true tone curve for the nominal one. Fails where the values leave no valid curve.
    fn tone(&self, _p: &[f64], tone: Tone) -> Result<Tone, InvalidTone> {
        Ok(tone)
    }

    /// Encoding: returns the amount of an unsharp mask of 1 pixel on encoded values; negative amounts smooth.
    fn sharpening(&self, _p: &[f64]) -> f64 {
        0.0
    }

    /// Odometry: returns the delay in seconds of the odometry after the pictures.
    fn odometry_delay_s(&self, _p: &[f64]) -> f64 {
        0.0
    }

    /// Odometry: returns the delay in seconds of the stated pitch and roll after the pictures.
    fn attitude_delay_s(&self, _p: &[f64]) -> f64 {
        0.0
    }

    /// Odometry: returns the motion that the odometry reports for a true motion of this duration.
    fn odometry(&self, _p: &[f64], motion: Motion2, _duration_s: f64) -> Motion2 {
        motion
    }
}

impl dyn Effect + '_ {
    /// Returns [`About::id`].
    pub fn id(&self) -> &'static str {
        self.about().id
    }

    /// Returns [`About::name`].
    pub fn name(&self) -> &'static str {
        self.about().name
    }

    /// Returns [`About::because`].
    pub fn because(&self) -> &'static str {
        self.about().because
    }

    /// Returns [`About::stage`].
    pub fn stage(&self) -> Stage {
        self.about().stage
    }

    /// Returns [`About::parameters`].
    pub fn parameters(&self) -> &'static [Parameter] {
        self.about().parameters
    }

    /// Returns [`About::covariates`].
    pub fn covariates(&self) -> &'static [Covariate] {
        self.about().covariates
    }

    /// Returns [`About::recording_that_would_decide`].
    pub fn recording_that_would_decide(&self) -> &'static str {
        self.about().recording_that_would_decide
    }

    /// Returns the effect's size in words; where an estimate is missing, lists "name = value ± sigma" for those present.
    pub fn size_in_words(&self, estimates: &Estimates<'_>) -> String {
        self.size(estimates).unwrap_or_else(|| estimates.listed())
    }

    /// Returns name and signature for the direction of these estimates: those of [`About::opposite`] where they are
    /// negative.
    pub fn name_and_signature(&self, estimates: &Estimates<'_>) -> (&'static str, &'static str) {
        match self.about().opposite {
            Some(opposite) if estimates.is_negative() => (opposite.name, opposite.because),
            _ => (self.name(), self.because()),
        }
    }

    /// Words a size of one of its parameters: "0.080°", "3.1 %", "k1 = 0.0031".
    pub fn limit_in_words(&self, parameter: &str, value: f64) -> String {
        self.about().unit.limit_in_words(parameter, value)
    }
}

/// Returns the values of an effect with `N` parameters; values missing at the end are 0.
pub(crate) fn values<const N: usize>(p: &[f64]) -> [f64; N] {
    std::array::from_fn(|index| p.get(index).copied().unwrap_or_default())
}
