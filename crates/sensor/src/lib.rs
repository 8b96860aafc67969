//! Simulated pictures to compare real ones with: the field, its lines and goals in a plain hall, projected through the true
//! lens from a camera's pose.
//!
//! | type | role |
//! |---|---|
//! | [`Renderer`] | whole pictures, at a pose or while the camera moves |
//! | [`Effect`], [`library()`] | a deviation of a real camera or robot from the nominal model; all known effects |
//! | [`Model`] | the effects present and their sizes, as in `model.toml` |
//! | [`Chain`] | a camera with its model, for points, light and motions one by one |
//! | [`Corrected`] | camera, field and recordings as a model corrects them |
//! | [`Development`], [`LightTile`] | light of things that were not there, added to a recorded picture |
//! | [`Shading`] | what lens and exposure do to the light of whole pictures, taken out and put in |
//! | [`Trajectory`] | the camera's pose at any time, interpolated between stamped poses |
//! | [`Frame`] | projection of points into one picture, row by row |
//! | [`SceneColors`] | the colours of carpet, lines, goals and hall |
//! | [`ModelError`], [`RenderError`], [`TrajectoryError`] | errors of models, drawing and interpolating |
//!
//! Light runs one way: world → motion → mount → lens → exposure → sensor → encoding, one [`Stage`] each; the odometry is
//! beside it. Up to the encoding, light is linear RGB with 1 as full scale. Metres, radians, seconds and the frames of
//! [`reality_sim_core::pose`] everywhere.
//!
//! ```
//! use reality_sim_core::sequence::Sequence;
//! use reality_sim_sensor::{Model, Renderer, SceneColors, Trajectory, effect};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # std::env::set_current_dir("../..")?;
//! let walk = Sequence::open("assets/walk".as_ref())?;
//! let colors = SceneColors::new(&walk.setup, &walk.field);
//! let nominal = Renderer::new(&walk.setup, &walk.field, colors);
//! let pose = walk.frames[7].reference_pose.ok_or("the walk has reference poses")?;
//! let picture = nominal.draw(pose)?;
//! assert_eq!(picture.dimensions(), (640, 480));
//!
//! // The same while the camera moves, through a lens that darkens towards the corners.
//! let vignetting = effect("vignetting").ok_or("the library has it")?;
//! let model = Model::default().with(vignetting, [0.5]);
//! let renderer = Renderer::with_model(&walk.setup, &walk.field, colors, &model)?;
//! let poses: Vec<_> =
//!     walk.frames.iter().filter_map(|frame| Some((frame.timestamp_s, frame.reference_pose?))).collect();
//! let darker = renderer.draw_at(&Trajectory::new(&poses)?, poses[7].0, None)?;
//! let green = |picture: &image::RgbImage| u32::from(picture.get_pixel(639, 479)[1]);
//! assert!(green(&darker) < green(&picture));
//! # Ok(())
//! # }
//! ```

mod blur;
mod chain;
mod colors;
mod corrected;
mod development;
mod effect;
mod effect_index;
mod effects;
mod encoding;
mod frame;
mod lens;
mod light;
mod light_tile;
mod model;
mod motion;
mod noise;
mod projected_scene;
mod reach;
mod redevelopment;
mod renderer;
mod scene;
mod sensor;
mod shading;
mod sharpening;
mod surface;
pub mod text;
mod tone;
mod trajectory;

pub use self::{
    chain::{Chain, sampled_variance_px2},
    colors::{SceneColors, linear_from_srgb},
    corrected::{Corrected, CorrectionError, sampled_sigma_px},
    development::{Development, Exposure},
    effect::{About, Changes, Covariate, Effect, Estimates, Growth, Need, Opposite, Parameter, Role, Stage},
    effect_index::EffectIndex,
    effects::{effect, library},
    frame::Frame,
    light_tile::LightTile,
    model::{Model, ModelError, ModelFault, Used},
    noise::Noise,
    reach::Reach,
    redevelopment::Redevelopment,
    renderer::{RenderError, Renderer},
    shading::Shading,
    surface::Surface,
    tone::{InvalidTone, Tone},
    trajectory::{Trajectory, TrajectoryError, Twist},
};
