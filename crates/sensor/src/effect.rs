//! What an effect is: something that real cameras and robots do and the nominal model leaves out.
//!
//! The simulated camera is a chain of stages. An effect changes one of them, by the hooks of that stage; its parameters
//! say how much. At the neutral values every hook is the identity.

use std::fmt::Debug;

use glam::DVec2;
use reality_sim_core::{
    camera::{Camera, InvalidCamera},
    field::FieldDimensions,
    pose::{CameraPose, Motion2},
};

/// The stages of the simulated camera, in the order in which light passes them; the odometry is beside them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// The field and the light on it.
    World,
    /// Where the camera is while each row is exposed.
    Motion,
    /// How the camera sits on the robot.
    Mount,
    /// Which ray reaches which pixel, how much of it and how sharp.
    Lens,
    /// How much light is collected.
    Exposure,
    /// Light to the sensor's linear output.
    Sensor,
    /// Linear output to pixel values.
    Encoding,
    /// The motion that the robot believes it made.
    Odometry,
}

impl Stage {
    /// All, in their order.
    pub const ALL: [Self; 8] = [
        Self::World,
        Self::Motion,
        Self::Mount,
        Self::Lens,
        Self::Exposure,
        Self::Sensor,
        Self::Encoding,
        Self::Odometry,
    ];
}

/// What a parameter is for when it is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Role {
    /// The size of the effect: decides whether it is there.
    Size,
    /// Changes the effect's form, and alone decides nothing.
    Shape,
    /// Given by the recording, never fitted.
    Fixed,
}

/// How the effect grows with the parameter near its neutral value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Growth {
    /// In proportion.
    Linear,
    /// With the square, as a blur does: fitted as its square, never negative.
    Square,
}

/// What an effect shows itself against: where in the picture, where on the field, when, in which motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Covariate {
    /// Distance from the principal point.
    Radius,
    /// Row of the picture.
    Row,
    /// Place in the picture.
    Pixel,
    /// Direction from the camera.
    Bearing,
    /// Distance from the camera.
    Range,
    /// Place on the field.
    FieldPosition,
    /// How fast the camera turns.
    AngularRate,
    /// How fast the camera moves.
    Speed,
    /// How bright a place is.
    Intensity,
    /// Time since the recording's start.
    Time,
    /// Red, green or blue.
    Color,
    /// The frame as a whole.
    Frame,
}

/// One number of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// With its unit as suffix, where it has one: `pitch_rad`. The key in `model.toml`.
    pub name: &'static str,
    /// `rad`, `m`, `s`, `px`, `EV`; `1` for a plain number.
    pub unit: &'static str,
    /// Where the effect vanishes.
    pub neutral: f64,
    /// What is plausible, ends included.
    pub range: [f64; 2],
    /// A small change, for derivatives.
    pub step: f64,
    /// The least size worth caring about; 0 where it is no size.
    pub material: f64,
    /// What it is for when it is fitted.
    pub role: Role,
    /// How the effect grows with it.
    pub growth: Growth,
}

impl Parameter {
    /// The size of an effect that grows in proportion and vanishes at 0.
    pub const fn size(name: &'static str, unit: &'static str, range: [f64; 2], material: f64) -> Self {
        let (neutral, step) = (0.0, 0.5 * material);
        Self { name, unit, neutral, range, step, material, role: Role::Size, growth: Growth::Linear }
    }

    /// The size of an effect that grows with the square from 0.
    pub const fn square(name: &'static str, unit: &'static str, largest: f64, material: f64) -> Self {
        let size = Self::size(name, unit, [0.0, largest], material);
        Self { step: material, growth: Growth::Square, ..size }
    }

    /// What changes an effect's form, 0 for the plain one.
    pub const fn shape(name: &'static str, unit: &'static str, range: [f64; 2], step: f64) -> Self {
        let size = Self::size(name, unit, range, 0.0);
        Self { step, role: Role::Shape, ..size }
    }

    /// What the recording gives.
    pub const fn fixed(name: &'static str, unit: &'static str) -> Self {
        let range = [f64::NEG_INFINITY, f64::INFINITY];
        Self { role: Role::Fixed, ..Self::shape(name, unit, range, 1e-3) }
    }
}

/// Noise of a linear value `v` that the sensor puts out: its variance is `shot · v + read_variance`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Noise {
    /// Variance for each unit of the linear value.
    pub shot: f64,
    /// Variance without light.
    pub read_variance: f64,
}

impl Noise {
    /// Variance of a linear value's noise; none below 0.
    pub fn variance(self, linear: f64) -> f64 {
        self.shot * linear.max(0.0) + self.read_variance
    }
}

/// From a linear value `v` to the encoded `e`, both 0 to 1: `e = v^(1/gamma)`, then
/// `e + contrast · e (1 − e) (2e − 1)`, cut off at 0 and 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tone {
    /// Above 0.
    pub gamma: f64,
    /// 0 for a plain power; above it the curve is steeper in the middle.
    pub contrast: f64,
}

impl Tone {
    /// The encoded value, 0 to 1; linear values outside 0 to 1 are cut off.
    pub fn encode(self, linear: f64) -> f64 {
        let encoded = linear.clamp(0.0, 1.0).powf(1.0 / self.gamma);
        let bend = self.contrast * encoded * (1.0 - encoded) * (2.0 * encoded - 1.0);
        (encoded + bend).clamp(0.0, 1.0)
    }
}

/// What is known of an effect before any data.
#[derive(Debug, Clone, Copy)]
pub struct About {
    /// See [`Effect::id`].
    pub id: &'static str,
    /// See [`Effect::name`].
    pub name: &'static str,
    /// See [`Effect::stage`].
    pub stage: Stage,
    /// See [`Effect::parameters`].
    pub parameters: &'static [Parameter],
    /// See [`Effect::covariates`].
    pub covariates: &'static [Covariate],
    /// See [`Effect::because`].
    pub because: &'static str,
    /// See [`Effect::recording_that_would_decide`].
    pub recording_that_would_decide: &'static str,
}

/// One effect: what it is called, what it can be, and its forward model.
///
/// The hooks take the values `p` in the order of [`Effect::parameters`]; values missing at the end are 0. Each hook is
/// the identity unless the effect has its own. A [`Chain`](crate::Chain) calls the hooks of the effect's stage only.
pub trait Effect: Sync + Debug {
    /// What is known of it.
    fn about(&self) -> &'static About;

    /// Name in files: `vignetting`.
    fn id(&self) -> &'static str {
        self.about().id
    }

    /// What happens, in plain words: "the lens darkens towards the corners".
    fn name(&self) -> &'static str {
        self.about().name
    }

    /// The stage that it changes.
    fn stage(&self) -> Stage {
        self.about().stage
    }

    /// Its numbers.
    fn parameters(&self) -> &'static [Parameter] {
        self.about().parameters
    }

    /// In what its signature shows.
    fn covariates(&self) -> &'static [Covariate] {
        self.about().covariates
    }

    /// Its signature, as one clause: "lines and carpet darken towards the corners, with the distance from …".
    fn because(&self) -> &'static str {
        self.about().because
    }

    /// What to record so that it can be seen: "walk with quick turns of the head".
    fn recording_that_would_decide(&self) -> &'static str {
        self.about().recording_that_would_decide
    }

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

/// The values of an effect with `N` parameters; those missing at the end are 0.
pub(crate) fn values<const N: usize>(p: &[f64]) -> [f64; N] {
    std::array::from_fn(|index| p.get(index).copied().unwrap_or_default())
}
