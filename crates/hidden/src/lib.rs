//! Synthetic recordings with effects of camera, hall or odometry that the files beside the pictures do not mention, for
//! testing the search for missing effects.
//!
//! | type | role |
//! |---|---|
//! | [`Recipe`] | a recording from a seed: frames, size, hidden effects, walk, world |
//! | [`World`] | what a seed draws: the standard world, or one in which field, hall, camera and robot are drawn anew |
//! | [`Given`] | what the files of a drawn world tell of brightness, noise and sharpness |
//! | [`Takes`] | the pictures of a world as light, for many recordings with other effects |
//! | [`Facts`] | lens, height, field of a world, for tables |
//! | [`Hidden`] | an effect with its size; [`LIBRARY`], [`FOREIGN`] and [`MISTAKES`] list all ids |
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
mod carpet;
mod clock;
mod draw;
mod drawn;
mod effect;
mod error;
mod exposure;
mod facts;
mod figures;
mod film;
mod furniture;
mod jpeg;
mod lamps;
mod lens;
mod log;
mod mistakes;
mod movers;
mod nominal;
mod pattern;
mod random;
mod rays;
mod recipe;
mod rig;
mod rotation;
mod scene;
mod setting;
mod sights;
mod solid;
mod takes;
mod texture;
mod trajectory;
mod truth;

#[cfg(test)]
mod tests;

pub use self::{
    drawn::Given,
    effect::{Course, FOREIGN, Falloff, Hidden, LIBRARY, Light, MISTAKES, Mistake},
    error::Error,
    facts::Facts,
    random::Random,
    recipe::{Recipe, World},
    takes::Takes,
    trajectory::Walk,
};
