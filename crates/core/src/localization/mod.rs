//! Monte Carlo localization of a camera on a soccer field, picture by picture.
//!
//! | type | |
//! |---|---|
//! | [`Localizer`] | finds the pose of every picture as it arrives; [`Localizer::builder`] makes one |
//! | [`Observation`] | a picture with its time, odometry and mount pose |
//! | [`Picture`] | RGB or grey; owned, shared or copied from a buffer |
//! | [`LocalizedFrame`] | the pose of a picture, and how far to trust it |
//! | [`LiveLocalizer`] | does so on a thread of its own for a camera that does not wait; drops the oldest pictures |
//! | [`Run`] | iterates over the frames of a recording, by [`Localizer::run`] |
//! | [`Smoother`] | estimates all frames together, by [`Localizer::smoother`] |
//! | [`LocalizerConfig`] | every tunable parameter |
//!
//! An update follows the textbook (Thrun, Burgard and Fox, "Probabilistic Robotics", 2005, chapter 8): particles are
//! moved by the odometry, weighed by the picture and resampled. If the prediction is too uncertain, or the picture
//! contradicts it, the whole field is searched. The best pose is fitted with sub-pixel accuracy, and the colours of the
//! goals tell it from its mirror pose.
//!
//! Picture by picture; [`LiveLocalizer`] does the same on a thread of its own:
//!
//! ```
//! use std::path::Path;
//!
//! use reality_sim_core::{
//!     localization::{Localizer, LocalizerConfig, Observation, Picture, mount_of_frame},
//!     observation::ObservationKind,
//!     sequence::Sequence,
//! };
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let walk = Sequence::open(Path::new("../../assets/walk"))?;
//! let mut localizer = Localizer::builder(&walk.setup.camera, &walk.field)
//!     .config(LocalizerConfig::new(ObservationKind::Contrast).with_seed(7))
//!     .start(walk.start)
//!     .build()?;
//!
//! // What a driver hands over: a buffer, the time, what the joints say, the odometry.
//! let buffer = walk.load_image(0)?.into_raw();
//! let picture = Picture::from_rgb([640, 480], &buffer)?;
//! let observation = Observation::new(0.0, picture, mount_of_frame(&walk, 0));
//! let odometry = walk.frames[0].odometry.ok_or("the walk has odometry")?;
//!
//! let frame = localizer.update(&observation.with_odometry(odometry))?;
//! assert!(frame.sure && frame.pose.x_m.is_finite());
//! # Ok(())
//! # }
//! ```
//!
//! A recording, and then all of its frames together:
//!
//! ```
//! # use std::path::Path;
//! # use reality_sim_core::{localization::{Localizer, Picture}, sequence::Sequence};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let mut walk = Sequence::open(Path::new("../../assets/walk"))?;
//! # walk.frames.truncate(3);
//! let mut localizer = Localizer::builder(&walk.setup.camera, &walk.field).start(walk.start).build()?;
//! let frames = localizer.run(&walk).collect::<Result<Vec<_>, _>>()?;
//! let smoothed = localizer.smoother().smooth(&frames, |index| walk.load_image(index).map(Picture::from))?;
//! assert_eq!(smoothed.map(|poses| poses.len()), Some(3));
//! # Ok(())
//! # }
//! ```

mod agreement;
mod builder;
mod config;
mod error;
mod frame;
mod half_evidence;
mod live;
mod localizer;
mod observation;
mod picture;
mod playback;
mod relocalization;
mod rivals;
mod run;
mod smoothing;
mod track;

pub use self::{
    builder::LocalizerBuilder,
    config::{LocalizerConfig, RelocalizationConfig, TrackConfig},
    error::LocalizationError,
    frame::LocalizedFrame,
    live::{LiveError, LiveFeed, LiveFrame, LiveLocalizer, Pushed},
    localizer::Localizer,
    observation::{Observation, mount_of_frame},
    picture::{InvalidPicture, Picture},
    playback::Playback,
    run::Run,
    smoothing::{Smoother, Smoothing},
};
pub use crate::goal_colors::GoalColorConfig;

#[cfg(test)]
mod tests;
