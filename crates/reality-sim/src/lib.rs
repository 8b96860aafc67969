//! Reality Sim: what does the camera see at this pose? A robot records pictures while it walks over a soccer field. A
//! particle filter finds the camera's pose of each picture, to about a centimetre, and the pictures are stored by pose;
//! where none was recorded, one is reconstructed from its neighbours.
//!
//! This crate is the front of the library: it re-exports the most used types under their own names, and everything else in
//! modules.
//!
//! | task | types and modules |
//! |---|---|
//! | read a recording, its camera, its field | [`Sequence`], [`Camera`], [`FieldDimensions`] |
//! | describe the pose of a camera | [`CameraPose`], [`Pose2`] |
//! | find the pose of every picture, live or from a recording | [`Localizer`], [`Observation`], [`LocalizedFrame`] |
//! | find a camera's lens and mount from the lines of the field | [`calibration`] |
//! | store pictures by pose, in one file | [`db::Database`] |
//! | make the picture at a pose from recorded ones | [`Archive`], [`Synthesizer`], [`synthesis`] |
//! | give a simulator a camera | [`simulator`] |
//! | make the picture at a pose from the field's model | [`sensor::Renderer`] |
//! | find what a model of the camera misses | [`gap`] |
//! | tag a recording as the program does, with one or many settings | [`tagging`] |
//! | make pictures at random poses with labels | [`dataset`] |
//! | compare a recording with its camera as the program does | [`comparison`] |
//! | all of this for thousands of recordings | [`study`] |
//! | compare poses with ground truth, and pictures with true ones | [`evaluation`], [`probing`] |
//! | draw poses in a picture, pictures side by side, coverage | [`overlay`], [`montage`], [`coverage_chart`] |
//! | use the parts of localization | [`preprocess`], [`observation`], [`filter`], [`search`], [`refine`] |
//! | compute on another device | [`backend`]; with the feature `gpu` the module `gpu` |
//!
//! By default the library depends on neither a window nor a graphics card. The crates of public signatures are
//! re-exported: [`glam`], [`image`], [`nalgebra`]; poses convert to nalgebra's isometries and back.
//!
//! All quantities are in metres, radians and seconds; names carry the unit. The frames are those of [`pose`]: the world
//! has its origin at the field's centre, x towards the opponent's goal and z up; a camera's x points right, y down, z into
//! the scene.
//!
//! A database is built from a recording, and a simulator asks it for pictures:
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
//! Database::create_or_open(file)?.ingest(&walk, &poses, &PoseSource::GroundTruth)?;
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
//! A recording without poses is localized; [`localization`] shows the same for a live camera:
//!
//! ```
//! use std::path::Path;
//!
//! use reality_sim::{Localizer, Sequence};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # std::env::set_current_dir("../..")?;
//! let mut walk = Sequence::open(Path::new("assets/walk"))?;
//! walk.frames.truncate(3);
//!
//! let mut localizer = Localizer::builder(&walk.setup.camera, &walk.field).start(walk.start).build()?;
//! let frames = localizer.run(&walk).collect::<Result<Vec<_>, _>>()?;
//!
//! let truth = walk.frames[2].reference_pose.ok_or("the walk has ground truth")?;
//! assert!((frames[2].pose.x_m - truth.x_m).abs() < 0.03);
//! # Ok(())
//! # }
//! ```

pub mod comparison;
pub mod coverage_chart;
pub mod dataset;
pub mod evaluation;
pub mod montage;
pub mod overlay;
pub mod probing;
pub mod study;
pub mod tagging;

#[cfg(feature = "gpu")]
pub use reality_sim_gpu as gpu;

// The crates whose types appear in public signatures.
pub use {glam, image, nalgebra};

pub use reality_sim_calibration as calibration;
pub use reality_sim_core::{
    backend, camera, field, filter, localization, mount, names, observation, pose, preprocess, quality,
    refine, search, sequence, warp,
};
pub use reality_sim_core::{
    camera::Camera,
    field::FieldDimensions,
    localization::{LocalizationError, LocalizedFrame, Localizer, LocalizerConfig, Observation},
    observation::ObservationKind,
    pose::{CameraPose, Pose2},
    sequence::{Sequence, SequenceError, StampedPose, write_tum},
};
pub use reality_sim_db as db;
pub use reality_sim_gap as gap;
pub use reality_sim_pipeline as pipeline;
pub use reality_sim_sensor as sensor;
pub use reality_sim_simulator as simulator;
pub use reality_sim_synthesis as synthesis;
pub use reality_sim_synthesis::{Archive, Reconstruction, SynthesisError, Synthesizer};

/// Compiles the examples of README.md.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct ReadmeExamples;
