//! Pictures at poses at which none was recorded, made from those recorded around them.
//!
//! | type | purpose |
//! |---|---|
//! | [`Archive`] | a database opened for pictures: index by pose, pictures decoded last |
//! | [`Synthesizer`] | the picture at a pose; threads share one |
//! | [`Memory`] | what one picture of a moving camera tells of the next |
//! | [`SynthesisConfig`] | how many neighbours, their weights, and when a picture is refused |
//! | [`Reconstruction`], [`Provenance`] | a picture, the images it was made from, and how far each pixel can be trusted |
//! | [`SynthesisError`] | why there is no picture |
//! | [`measure_hall`] | where the walls around the field are |
//! | [`find_clean_stage`] | the carpet without what stood on it, and where pictures show such things |
//!
//! A picture is made by one of these methods:
//!
//! | [`Method`] | result |
//! |---|---|
//! | [`Nearest`] | the nearest picture as it is |
//! | [`Quadratic`] | the paper's Eq. 4: the nearest picture, moved by a polynomial of second order in its pixels |
//! | [`Plane`] | one picture, exactly, through the ground plane and both lenses; goals and hall as in [`reality_sim_core::warp`] |
//! | [`Blend`] | several pictures, each warped as by `Plane`, weighted pixel by pixel |
//! | [`Auto`] | the recorded picture if there is one at the pose, else `Blend` |
//!
//! [`MethodKind`] lists them by name.
//!
//! Pictures are RGB, 8 bits per channel, as a camera records them; units and frames are those of
//! [`reality_sim_core::pose`].
//!
//! ```
//! # use std::path::Path;
//! use std::sync::Arc;
//!
//! use reality_sim_core::pose::Pose2;
//! use reality_sim_synthesis::{Archive, Auto, Synthesizer};
//! # use reality_sim_core::sequence::Sequence;
//! # use reality_sim_db::{Database, PoseEstimate, PoseSource};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # std::env::set_current_dir("../..")?;
//! # let folder = tempfile::tempdir()?;
//! # let file = folder.path().join("walk.db");
//! # let file = file.as_path();
//! # let walk = Sequence::open(Path::new("assets/walk"))?;
//! # let poses: Vec<_> = walk.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
//! # Database::create_or_open(file)?.ingest(&walk, &poses, &PoseSource::GroundTruth)?;
//! // At most 256 MiB for decoded pictures.
//! let archive = Arc::new(Archive::open(file, 256 << 20)?);
//! let usual = archive.usual_pose();
//! let simulator = Synthesizer::new(archive);
//! let pose = usual.with_planar(Pose2::new(-2.3, 0.2, 1.6));
//! let seen = simulator.image_at(pose, &Auto)?;
//! assert!(seen.covered() > 0.9);
//!
//! // The same into a buffer of one's own.
//! let mut pixels = vec![0; 3 * 640 * 480];
//! simulator.image_into(pose, &Auto, &mut pixels)?;
//! assert_eq!(pixels, seen.picture.as_raw().as_slice());
//! # Ok(())
//! # }
//! ```

mod ahead;
mod archive;
mod auto;
mod cache;
mod clean_stage;
mod clean_view;
mod error;
mod gain;
mod hall;
mod kind;
mod memory;
mod method;
mod nearest;
mod plane;
mod quadratic;
pub mod quality;
mod reconstruction;
mod select;
mod shrunk;
mod synthesizer;

pub use self::{
    ahead::Ahead,
    archive::Archive,
    auto::Auto,
    clean_stage::{FoundCleanStage, find_clean_stage},
    error::SynthesisError,
    hall::measure_hall,
    kind::MethodKind,
    memory::Memory,
    method::Method,
    nearest::Nearest,
    plane::{Blend, Plane},
    quadratic::Quadratic,
    reconstruction::{ORIGIN_HUES, Provenance, Reconstruction, UsedImage},
    synthesizer::{SynthesisConfig, Synthesizer},
};

#[cfg(test)]
mod tests;
