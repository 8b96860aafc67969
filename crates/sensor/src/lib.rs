//! The simulated picture to compare real ones with: the field, its lines and goals in a plain hall, seen through the
//! true lens from a camera's pose.
//!
//! Light runs one way: world → motion → mount → lens → exposure → sensor → encoding; the odometry is beside it. Up to
//! the encoding, light is linear RGB with 1 as full scale. Metres, radians and the frames of
//! [`reality_sim_core::pose`] everywhere.
//!
//! Real cameras differ from what is written down of them. Each way in which they do is an [`Effect`] of one stage, a file
//! in `effects/`; a [`Model`] (`model.toml`) says which of them are there and how large they are, and a [`Chain`] applies
//! them: to points, to light and to motions one by one, and through a [`Renderer`] to whole pictures.
//!
//! ```no_run
//! use reality_sim_core::sequence::Sequence;
//! use reality_sim_sensor::{Renderer, SceneColors};
//!
//! let sequence = Sequence::open("assets/walk".as_ref())?;
//! let colors = SceneColors::new(&sequence.setup, &sequence.field);
//! let renderer = Renderer::new(&sequence.setup, &sequence.field, colors);
//! let picture = renderer.draw(sequence.frames[0].reference_pose.expect("the walk has ground truth"))?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! With effects, while the camera moves:
//!
//! ```no_run
//! # use reality_sim_core::sequence::Sequence;
//! # let sequence = Sequence::open("assets/walk".as_ref())?;
//! use reality_sim_sensor::{Model, Renderer, SceneColors, Trajectory};
//!
//! let poses: Vec<_> = sequence
//!     .frames
//!     .iter()
//!     .filter_map(|frame| Some((frame.timestamp_s, frame.reference_pose?)))
//!     .collect();
//! let colors = SceneColors::new(&sequence.setup, &sequence.field);
//! let model = Model::read("model.toml".as_ref())?;
//! let renderer = Renderer::with_model(&sequence.setup, &sequence.field, colors, &model)?;
//! let picture = renderer.draw_at(&Trajectory::new(&poses)?, poses[7].0, Some(1))?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod blur;
mod chain;
mod colors;
mod effect;
mod effect_index;
mod effects;
mod encoding;
mod frame;
mod lens;
mod light;
mod model;
mod motion;
mod renderer;
mod sensor;
mod trajectory;
mod view;
mod world;

pub use self::{
    chain::Chain,
    colors::SceneColors,
    effect::{About, Covariate, Effect, Growth, Noise, Parameter, Role, Stage, Tone},
    effect_index::EffectIndex,
    effects::{effect, library},
    frame::Frame,
    model::{Model, ModelError, ModelFault, Used},
    renderer::{RenderError, Renderer},
    trajectory::{Trajectory, TrajectoryError, Twist},
};
