//! Effects: what real cameras and robots do and the nominal model leaves out.
//!
//! The simulated camera is a chain of stages. An effect changes one of them, by the hooks of that stage; its parameters
//! say how much. At the neutral values every hook is the identity.

mod about;
mod estimates;
mod parameter;

use std::fmt::Debug;

use glam::DVec2;
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
use crate::{noise::Noise, tone::Tone};

/// One effect: what is known of it, its words, and its forward model.
///
/// The hooks take the values `p` in the order of [`About::parameters`]; values missing at the end are 0. Each hook is
/// the identity unless the effect has its own. A [`Chain`](crate::Chain) calls the hooks of the effect's stage only.
pub trait Effect: Sync + Debug {
    /// What is known of it.
    fn about(&self) -> &'static About;

    /// Its size in words, with 95 % intervals: "at the corner 42 % of the light is lost (± 1 %)". `None` where one of its
    /// numbers is missing.
    fn size(&self, estimates: &Estimates<'_>) -> Option<String>;

    /// World: the field as it is, from what is written down of it.
    fn field(&self, _p: &[f64], field: FieldDimensions) -> FieldDimensions {
        field
    }

    /// World: factor of the light on the ground at a point of it, metres.
    fn light(&self, _p: &[f64], _point_in_world: DVec2, _field: &FieldDimensions) -> f64 {
        1.0
    }

    /// Motion: how long after the frame's time stamp the middle of a row's exposure is, seconds; rows run from 0, the
    /// top one, to 1.
    fn delay_s(&self, _p: &[f64], _row: f64) -> f64 {
        0.0
    }

    /// Motion: how long each row is exposed, seconds; several add up.
    fn exposure_s(&self, _p: &[f64]) -> f64 {
        0.0
    }

    /// Motion: how long after the time of the reference poses images and odometry are taken, seconds.
    fn clock_s(&self, _p: &[f64]) -> f64 {
        0.0
    }

    /// Mount: the true pose, from the nominal one.
    fn mount(&self, _p: &[f64], pose: CameraPose) -> CameraPose {
        pose
    }

    /// Lens: the true camera, from the nominal one. Fails where the values leave no camera.
    fn lens(&self, _p: &[f64], camera: Camera) -> Result<Camera, InvalidCamera> {
        Ok(camera)
    }

    /// Lens: by how much red, green and blue are magnified about the principal point; 1 is not at all.
    fn magnification(&self, _p: &[f64]) -> [f64; 3] {
        [1.0; 3]
    }

    /// Lens: the share of the light that reaches the sensor at a distance from the principal point; 1 is half the
    /// picture's diagonal.
    fn falloff(&self, _p: &[f64], _radius: f64) -> f64 {
        1.0
    }

    /// Lens: variance of the blur along each axis, pixels², at a distance as for [`Effect::falloff`].
    fn blur_variance_px2(&self, _p: &[f64], _radius: f64) -> f64 {
        0.0
    }

    /// Exposure: factor of red, green and blue in the frame with this time stamp.
    fn gain(&self, _p: &[f64], _time_s: f64) -> [f64; 3] {
        [1.0; 3]
    }

    /// Sensor: the linear output for a linear value, before noise.
    fn respond(&self, _p: &[f64], linear: f64) -> f64 {
        linear
    }

    /// Sensor: the true noise, from the nominal one.
    fn noise(&self, _p: &[f64], noise: Noise) -> Noise {
        noise
    }

    /// Encoding: the true tone curve, from the nominal one.
    fn tone(&self, _p: &[f64], tone: Tone) -> Tone {
        tone
    }

    /// Odometry: the motion that the odometry reports for a true one that took this long.
    fn odometry(&self, _p: &[f64], motion: Motion2, _duration_s: f64) -> Motion2 {
        motion
    }
}

impl dyn Effect + '_ {
    /// See [`About::id`].
    pub fn id(&self) -> &'static str {
        self.about().id
    }

    /// See [`About::name`].
    pub fn name(&self) -> &'static str {
        self.about().name
    }

    /// See [`About::because`].
    pub fn because(&self) -> &'static str {
        self.about().because
    }

    /// See [`About::stage`].
    pub fn stage(&self) -> Stage {
        self.about().stage
    }

    /// See [`About::parameters`].
    pub fn parameters(&self) -> &'static [Parameter] {
        self.about().parameters
    }

    /// See [`About::covariates`].
    pub fn covariates(&self) -> &'static [Covariate] {
        self.about().covariates
    }

    /// See [`About::recording_that_would_decide`].
    pub fn recording_that_would_decide(&self) -> &'static str {
        self.about().recording_that_would_decide
    }

    /// Its size in words; where one of its numbers is missing, "name = value ± sigma" of each that there is.
    pub fn size_in_words(&self, estimates: &Estimates<'_>) -> String {
        self.size(estimates).unwrap_or_else(|| estimates.listed())
    }

    /// Its name and signature in the direction of these estimates: those of [`About::opposite`] where they are negative.
    pub fn name_and_signature(&self, estimates: &Estimates<'_>) -> (&'static str, &'static str) {
        match self.about().opposite {
            Some(opposite) if estimates.is_negative() => (opposite.name, opposite.because),
            _ => (self.name(), self.because()),
        }
    }

    /// A size of a parameter of it: "0.080°", "3.1 %", "k1 = 0.0031".
    pub fn limit_in_words(&self, parameter: &str, value: f64) -> String {
        self.about().unit.limit_in_words(parameter, value)
    }
}

/// The values of an effect with `N` parameters; those missing at the end are 0.
pub(crate) fn values<const N: usize>(p: &[f64]) -> [f64; N] {
    std::array::from_fn(|index| p.get(index).copied().unwrap_or_default())
}
