//! The simulated picture to compare real ones with: the field, its lines and goals in a plain hall, seen through the
//! true lens from a camera's pose.
//!
//! Light runs one way: world → lens → encoding. Up to the encoding, light is linear RGB with 1
//! as full scale. Metres, radians and the frames of [`reality_sim_core::pose`] everywhere.
//!
//! ```no_run
//! use reality_sim_core::sequence::Sequence;
//! use reality_sim_sensor::{Renderer, SceneColors};
//!
//! let sequence = Sequence::open("assets/walk".as_ref())?;
//! let colors = SceneColors::new(&sequence.setup, &sequence.field);
//! let renderer = Renderer::new(&sequence.setup, &sequence.field, colors);
//! let picture = renderer.draw(sequence.groundtruth[0].expect("the walk has ground truth"))?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod colors;
mod encoding;
mod lens;
mod renderer;
mod view;
mod world;

pub use self::{
    colors::SceneColors,
    renderer::{PoseError, Renderer},
};
