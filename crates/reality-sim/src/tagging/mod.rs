//! Tagging: the camera pose of every picture of a recording, by particle filter, and how good the poses are.
//!
//! ```
//! use std::path::Path;
//!
//! use reality_sim::{Sequence, tagging::{TagSettings, tag}};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut walk = Sequence::open(Path::new("../../assets/walk"))?;
//! walk.frames.truncate(5);
//! let few = TagSettings { particles: 200, ..TagSettings::default() };
//! // Pictures are decoded once for all settings.
//! for tagged in tag(&walk, &[TagSettings::default(), few])? {
//!     let error = tagged.error.ok_or("the walk has ground truth")?;
//!     assert!(error.max_m < 0.1);
//! }
//! # Ok(())
//! # }
//! ```

mod error;
mod lines;
mod pose;
mod settings;
mod tagged;

pub use self::{
    error::TagError,
    lines::LinesOfPictures,
    pose::{TaggedPose, covariance_rows},
    settings::TagSettings,
    tagged::{Tagged, tag},
};
