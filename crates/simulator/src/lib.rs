//! The camera of a simulator: a recorded picture at any pose, with the ball and the robots that the simulator moves, and with
//! labels.
//!
//! | type | purpose |
//! |---|---|
//! | [`Camera`] | a picture at a pose, drawn into a frame |
//! | [`Frame`] | the picture, and what is known of its pixels |
//! | [`Class`] | what a pixel shows |
//! | [`labels`] | what all pixels show, lines and crossings in pixels, boxes |
//! | [`coco`] | labels in the form of COCO |
//!
//! Pictures are RGB, 8 bits per channel; units and frames are those of [`reality_sim_core::pose`].

mod camera;
mod class;
pub mod coco;
mod error;
mod frame;
pub mod labels;

pub use self::{camera::Camera, class::Class, error::LookError, frame::Frame};
