//! Description of an effect, independent of any data.

use super::parameter::Parameter;
use crate::text::Unit;

/// Stages of the simulated camera, in the order in which light passes them; the odometry stands apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// The field and the light on it.
    World,
    /// The camera's pose while each row is exposed.
    Motion,
    /// Pose of the camera on the robot.
    Mount,
    /// Projection of rays to pixels, the lens's falloff and its blur.
    Lens,
    /// Gain of the collected light.
    Exposure,
    /// Light to the sensor's linear output.
    Sensor,
    /// Linear output to pixel values.
    Encoding,
    /// What the robot believes of its motion: the odometry, and the pitch and roll of its camera.
    Odometry,
}

impl Stage {
    /// All stages, in order.
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

/// Quantity that an effect's signature depends on: a place in the picture or on the field, a time, a motion.
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
    /// Angular rate of the camera.
    AngularRate,
    /// Speed of the camera.
    Speed,
    /// Brightness.
    Intensity,
    /// Time since the recording's start.
    Time,
    /// Phase of the robot's steps.
    GaitPhase,
    /// Red, green or blue.
    Color,
    /// The frame as a whole.
    Frame,
}

/// Data that a recording must provide for an effect to be observable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Need {
    /// The odometry of its frames.
    Odometry,
    /// Reference poses that something other than the pictures measured.
    MeasuredPoses,
    /// The nominal reflectance of lines and carpet.
    NominalReflectance,
    /// The nominal noise of the sensor.
    NominalNoise,
    /// The nominal point spread function.
    NominalSharpness,
}

/// Part of a recording that an effect changes, as far as a fit is concerned: its influence on the rest is negligible.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Changes {
    /// The pictures: positions, brightness, sharpness and noise.
    Pictures,
    /// Only the noise of the pictures. Noise also shifts the mean of dark areas slightly, too little to be told from other
    /// causes.
    Noise,
    /// The odometry.
    Odometry,
    /// Pitch and roll as the robot states them.
    Attitude,
    /// Pictures and odometry.
    PicturesAndOdometry,
}

/// Name and signature of an effect whose value is negative.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Opposite {
    /// Name, as [`About::name`].
    pub name: &'static str,
    /// Signature, as [`About::because`].
    pub because: &'static str,
}

/// Description of an effect, independent of any data: its parameters, its requirements, what it changes, and its wording. No
/// field has a default.
#[derive(Debug, Clone, Copy)]
pub struct About {
    /// Name in files: `vignetting`.
    pub id: &'static str,
    /// Description in plain words: "the lens darkens towards the corners".
    pub name: &'static str,
    /// Its signature, as one clause: "lines and carpet darken towards the corners, with the distance from …".
    pub because: &'static str,
    /// Name and signature of negative values; `None` where those of positive values fit both.
    pub opposite: Option<Opposite>,
    /// Noun phrase in a list: "a loss of light at the corners".
    pub noun: &'static str,
    /// Position in a list of effects that would have been found; lower ranks come first, and no two are equal.
    pub rank: u32,
    /// Unit in which its size is stated.
    pub unit: Unit,
    /// Stage that it changes.
    pub stage: Stage,
    /// Parameters of the forward model.
    pub parameters: &'static [Parameter],
    /// Covariates that its signature depends on.
    pub covariates: &'static [Covariate],
    /// Data that the recording must provide for the effect to be observable, in the order in which they are checked.
    pub needs: &'static [Need],
    /// Data that a fit of the effect compares.
    pub changes: Changes,
    /// Whether the effect follows a course of its own over time, rather than changing at a constant rate.
    pub varies_over_time: bool,
    /// Recording that would make the effect observable: "walk with quick turns of the head".
    pub recording_that_would_decide: &'static str,
}
