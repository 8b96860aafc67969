//! Reality Sim: what does the camera see at this pose? Pictures that a robot records while it walks over a soccer field
//! are tagged with the pose of the camera, to about a centimetre, by a particle filter, and stored by pose; where none was
//! recorded, one is reconstructed from its neighbours.
//!
//! This is the library's face. Camera models, fields, recordings and the filter are those of `reality_sim_core`, under
//! their own names; [`db`] is the database, [`synthesis`] gives pictures from it, [`sensor`] draws them from the field's
//! model. [`evaluation`] measures poses against a ground truth, [`probing`] pictures; [`overlay`], [`montage`] and
//! [`coverage_chart`] draw.
//!
//! Metres, radians and seconds everywhere; the unit is part of the name. The frames are those of [`pose`].
//!
//! A recording becomes a database, and a simulator asks it for pictures:
//!
//! ```
//! use std::{path::Path, sync::Arc};
//!
//! use reality_sim::{Archive, Pose2, Sequence, Synthesizer, synthesis::Auto};
//! use reality_sim::db::{Database, PoseEstimate, PoseSource};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # std::env::set_current_dir("../..")?;
//! # let folder = tempfile::tempdir()?;
//! # let file = folder.path().join("walk.db");
//! # let file = file.as_path();
//! let walk = Sequence::open(Path::new("assets/walk"))?;
//! let poses: Vec<_> = walk.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
//! Database::create_or_open(file)?.ingest(&walk, &poses, &PoseSource::GroundTruth, |_| ())?;
//!
//! let archive = Arc::new(Archive::open(file, 256 << 20)?);
//! let usual = archive.usual_pose();
//! let simulator = Synthesizer::new(archive);
//! let seen = simulator.image_at(usual.with_planar(Pose2::new(-2.3, 0.2, 1.6)), &Auto)?;
//! assert_eq!(seen.picture.dimensions(), (640, 480));
//! assert!(seen.covered() > 0.9);
//! # Ok(())
//! # }
//! ```
//!
//! A recording without poses is tagged:
//!
//! ```
//! use std::path::Path;
//!
//! use reality_sim::{ObservationKind, Sequence, TagConfig, Tagger, tag_sequence};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # std::env::set_current_dir("../..")?;
//! let mut walk = Sequence::open(Path::new("assets/walk"))?;
//! walk.frames.truncate(3);
//!
//! let config = TagConfig::new(ObservationKind::Contrast);
//! let mut tagger = Tagger::new(&walk.setup.camera, &walk.field, walk.start, config);
//! let tagged = tag_sequence(&walk, &mut tagger, |_, _, _, _| Ok(()))?;
//!
//! let truth = walk.frames[2].reference_pose.ok_or("the walk has ground truth")?;
//! assert!((tagged[2].pose.x_m - truth.x_m).abs() < 0.03);
//! # Ok(())
//! # }
//! ```

pub mod coverage_chart;
pub mod evaluation;
pub mod montage;
pub mod overlay;
pub mod probing;

#[cfg(feature = "gpu")]
pub use reality_sim_gpu as gpu;

// The crates whose types appear in public signatures.
pub use {glam, image, nalgebra};

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
pub use reality_sim_db as db;
pub use reality_sim_gap as gap;
pub use reality_sim_sensor as sensor;
pub use reality_sim_synthesis as synthesis;
pub use reality_sim_synthesis::{Archive, Reconstruction, SynthesisError, Synthesizer};
