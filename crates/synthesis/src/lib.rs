//! A picture at a pose at which none was recorded, from those recorded around it.
//!
//! [`Archive`] opens a database, [`Synthesizer`] gives the picture at a pose by one of the methods:
//!
//! | method | what |
//! |---|---|
//! | [`Nearest`] | the nearest picture as it is |
//! | [`Quadratic`] | the paper's Eq. 4: a polynomial of second order from the nearest picture's pixels to the target's |
//! | [`Plane`] | one picture, exactly, through the ground plane and both lenses; goals and hall as in [`reality_sim_core::warp::Hull`] |
//! | [`Blend`] | several, each as by `Plane`, weighed pixel by pixel |
//! | [`Auto`] | the recorded picture where there is one at the pose, else `Blend` |

mod archive;
mod auto;
mod cache;
mod error;
mod gain;
mod hall;
mod method;
mod methods;
mod nearest;
mod plane;
mod quadratic;
pub mod quality;
mod reconstruction;
mod select;
mod synthesizer;

pub use self::{
    archive::Archive,
    auto::Auto,
    error::SynthesisError,
    hall::measure_hall,
    method::Method,
    methods::METHODS,
    nearest::Nearest,
    plane::{Blend, Plane},
    quadratic::Quadratic,
    reconstruction::{ORIGIN_HUES, Reconstruction, Used},
    synthesizer::{SynthesisConfig, Synthesizer},
};

#[cfg(test)]
mod tests;
