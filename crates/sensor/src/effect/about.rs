//! What is known of an effect before any data.

use super::parameter::Parameter;
use crate::text::Unit;

/// Stages of the simulated camera, in the order in which light passes them; the odometry is beside them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// The field and the light on it.
    World,
    /// The camera's pose while each row is exposed.
    Motion,
    /// The camera's place on the robot.
    Mount,
    /// Projection of rays to pixels, the lens's falloff and its blur.
    Lens,
    /// The amount of light that is collected.
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
    /// Red, green or blue.
    Color,
    /// The frame as a whole.
    Frame,
}

/// Part of a recording's files without which an effect cannot be seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Need {
    /// The odometry of its frames.
    Odometry,
    /// The nominal reflectance of lines and carpet.
    NominalReflectance,
    /// The nominal noise of the sensor.
    NominalNoise,
    /// The nominal point spread function.
    NominalSharpness,
}

/// Part of a recording that an effect changes, for a fit: what it does to the rest is too little to count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Changes {
    /// The pictures: positions, brightness, sharpness and noise.
    Pictures,
    /// The pictures' noise alone. It moves the mean of dark places a little, too little to be told from anything else.
    Noise,
    /// The odometry.
    Odometry,
    /// Pictures and odometry.
    PicturesAndOdometry,
}

/// Name and signature of an effect whose value is negative.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Opposite {
    /// As [`About::name`].
    pub name: &'static str,
    /// As [`About::because`].
    pub because: &'static str,
}

/// What is known of an effect before any data: its numbers, what it needs and changes, and its words. No field has a
/// default.
#[derive(Debug, Clone, Copy)]
pub struct About {
    /// Name in files: `vignetting`.
    pub id: &'static str,
    /// What happens, in plain words: "the lens darkens towards the corners".
    pub name: &'static str,
    /// Its signature, as one clause: "lines and carpet darken towards the corners, with the distance from …".
    pub because: &'static str,
    /// Name and signature of negative values; `None` where those of positive ones fit both.
    pub opposite: Option<Opposite>,
    /// Its name in a list: "a loss of light at the corners".
    pub noun: &'static str,
    /// Its place in a list of effects that would have been found; lower ones come first, no two are equal.
    pub rank: u32,
    /// Unit in which a size of it is said.
    pub unit: Unit,
    /// The stage that it changes.
    pub stage: Stage,
    /// Its numbers.
    pub parameters: &'static [Parameter],
    /// Quantities that its signature depends on.
    pub covariates: &'static [Covariate],
    /// What the recording's files must provide for it to be seen, in the order in which it is asked for.
    pub needs: &'static [Need],
    /// What a fit of it compares.
    pub changes: Changes,
    /// Whether it differs from time to time along a course of its own, rather than at a constant rate.
    pub varies_over_time: bool,
    /// What to record so that it can be seen: "walk with quick turns of the head".
    pub recording_that_would_decide: &'static str,
}
