//! Things on the carpet that the model does not have, as numbers.

use serde::{Deserialize, Serialize};

/// Thing on the carpet that the model does not have, such as a robot, a ball or a person, with its shadow. Such things are
/// ordinary: they say nothing about the camera.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Object {
    /// Whether it stays in its place.
    pub motion: ObjectMotion,
    /// Share of the carpet in view that it hides, 0 to 1, the mean over all pictures.
    pub share: f64,
    /// Share of the pictures that show it, 0 to 1.
    pub pictures: f64,
    /// Place at which it touches the carpet, world axes, metres; none for what moves.
    pub place_m: Option<[f64; 2]>,
}

/// Whether a thing stays in its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ObjectMotion {
    /// It is in its place in all pictures.
    Standing,
    /// It is elsewhere in other pictures. All things that move are taken together.
    Moving,
}
