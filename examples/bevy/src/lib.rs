//! Cameras in Bevy that see what a robot recorded. A [`RealityCamera`] looks from the place of its entity into a database of
//! recorded pictures, with the balls and robots of Bevy's world in them, and writes what it sees into an [`Image`].
//!
//! | type or module | purpose |
//! |---|---|
//! | [`RealityCameraPlugin`] | makes cameras look in every frame |
//! | [`RealityCamera`], [`LookStatus`] | a camera, and whether its image is what it sees now |
//! | [`RealityBall`], [`RealityRobot`] | things that cameras see, at the places of their entities |
//! | [`axes`] | Bevy's axes and those of the field |
//!
//! [`Image`]: bevy::image::Image

pub mod axes;
mod ball;
mod camera;
mod looking;
mod picture;
mod plugin;
mod robot;

pub use self::{
    ball::RealityBall,
    camera::{LookStatus, RealityCamera},
    plugin::{RealityCameraPlugin, RealityCameraSystems},
    robot::RealityRobot,
};

/// Compiles the example of README.md.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeExample;
