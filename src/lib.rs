//! Reality Sim: what does the camera see at this pose? Pictures that a robot records while it walks over a soccer field
//! are tagged with the pose of the camera, to about a centimetre, by a particle filter.
//!
//! This is the library's face. Camera models, fields, recordings and the filter are those of `reality_sim_core`, under
//! their own names; [`evaluation`] measures poses against a ground truth, [`overlay`] draws them into pictures.
//!
//! Metres, radians and seconds everywhere; the unit is part of the name. The frames are those of [`pose`].
//!
//! ```
//! use std::path::Path;
//!
//! use reality_sim::{ObservationKind, Sequence, TagConfig, Tagger, tag_sequence};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut walk = Sequence::open(Path::new("assets/walk"))?;
//! walk.frames.truncate(3);
//!
//! let config = TagConfig::new(ObservationKind::Contrast);
//! let mut tagger = Tagger::new(&walk.setup.camera, &walk.field, walk.start, config);
//! let tagged = tag_sequence(&walk, &mut tagger, |_, _, _, _| Ok(()))?;
//!
//! let truth = walk.groundtruth[2].ok_or("the walk has ground truth")?;
//! assert!((tagged[2].pose.x_m - truth.x_m).abs() < 0.03);
//! # Ok(())
//! # }
//! ```

pub mod evaluation;
pub mod overlay;

#[cfg(feature = "gpu")]
pub use reality_sim_gpu as gpu;

pub use reality_sim_core::{
    backend, camera, field, filter, observation, pose, preprocess, refine, search, sequence, tag, warp,
};
pub use reality_sim_core::{
    camera::Camera,
    field::FieldDimensions,
    observation::ObservationKind,
    pose::{CameraPose, Pose2},
    sequence::{Sequence, SequenceError, StampedPose, write_tum},
    tag::{TagConfig, TagError, TaggedFrame, Tagger, tag_sequence},
};
