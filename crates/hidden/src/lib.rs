//! Synthetic recordings with effects of camera, hall or odometry that the files beside the pictures do not mention, for
//! testing the search for missing effects.
//!
//! | type | role |
//! |---|---|
//! | [`Recipe`] | a recording from a seed: frames, size, hidden effects, walk |
//! | [`Hidden`] | an effect with its size; [`LIBRARY`] and [`FOREIGN`] list all ids |
//! | [`Walk`] | the robot's motion |
//! | [`Random`] | random numbers from a seed |
//! | [`Error`] | error of making a recording |
//!
//! The pictures are made by ray casting with nine or more rays per pixel, and share no code with the models that are fitted:
//! lens, rotations, field pattern, blur and noise are implemented again here. Only plain numbers and the writer of sequence
//! folders come from the core. Units are metres, radians and seconds; the frames are those of the core's poses.
//!
//! ```
//! use reality_sim_hidden::{Hidden, Random, Recipe};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let folder = folder.path();
//! let effect = Hidden::of("mount_pitch", 3.0, &mut Random::new(7))?;
//! let recipe = Recipe { effects: vec![effect], frames: 2, size: [160, 120], ..Recipe::new(7) };
//! let sequence = recipe.record(folder)?;
//! assert_eq!(sequence.frames.len(), 2);
//! # Ok(())
//! # }
//! ```

mod blur;
mod effect;
mod error;
mod exposure;
mod film;
mod jpeg;
mod lens;
mod log;
mod nominal;
mod pattern;
mod random;
mod rays;
mod recipe;
mod rotation;
mod scene;
mod solid;
mod texture;
mod trajectory;
mod truth;

#[cfg(test)]
mod tests;

pub use self::{
    effect::{Course, FOREIGN, Falloff, Hidden, LIBRARY, Light},
    error::Error,
    random::Random,
    recipe::Recipe,
    trajectory::Walk,
};
