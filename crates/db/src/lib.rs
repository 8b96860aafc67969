//! Pictures with the poses at which they were taken, in one file: a simulator looks them up instead of rendering.
//!
//! | type | purpose |
//! |---|---|
//! | [`Database`] | the file: [`Database::ingest`] adds recordings, [`Database::insert`] an image, [`Database::copy_from`] those of another database, [`Database::remove`] removes some, other methods read |
//! | [`Recording`], [`NewImage`] | an image to be stored, and what it shares with others |
//! | [`ImageRecord`] | an image without its pixels: pose, time, camera, field |
//! | [`ImageDetails`] | what else is known of it: covariance, source of the pose, file |
//! | [`PoseEstimate`], [`PoseSource`] | a pose to be stored, and where poses come from |
//! | [`Ground`], [`ImageMask`] | the clean stage: the carpet without what stood on it, and where images show such things |
//! | [`metric::PixelMetric`] | distance between two poses: how far the picture moves between them, pixels |
//! | [`index::PoseIndex`] | images by pose: nearest and natural neighbours |
//! | [`coverage::Coverage`] | which parts of the field were recorded, in which directions |
//! | [`DbError`] | which file, what is wrong with it, and the remedy |
//!
//! The file is an SQLite database. It holds the picture files as they were recorded, and the cameras and fields as the
//! text of their files. An interrupted ingest continues where it stopped. Units and frames are those of
//! [`reality_sim_core::pose`].
//!
//! ```
//! use std::path::Path;
//!
//! use reality_sim_core::sequence::Sequence;
//! use reality_sim_db::{Database, PoseEstimate, PoseSource, index::PoseIndex, metric::PixelMetric};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # std::env::set_current_dir("../..")?;
//! # let folder = tempfile::tempdir()?;
//! # let file = folder.path().join("walk.db");
//! # let file = file.as_path();
//! let walk = Sequence::open(Path::new("assets/walk"))?;
//! let poses: Vec<_> = walk.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
//! let mut database = Database::create_or_open(file)?;
//! let report = database.ingest(&walk, &poses, &PoseSource::GroundTruth)?;
//! assert_eq!(report.added, 60);
//!
//! let poses: Vec<_> = database.images()?.iter().map(|image| image.pose).collect();
//! let metric = PixelMetric::new(&walk.setup.camera, poses[0], &walk.field).ok_or("the camera sees the field")?;
//! let nearest = PoseIndex::new(metric, poses.clone()).nearest(poses[7], 3)?;
//! assert_eq!((nearest[0].image, nearest[0].distance_px), (7, 0.0));
//! # Ok(())
//! # }
//! ```

mod clean_stage;
mod copying;
pub mod coverage;
mod database;
mod error;
mod ground;
mod image_mask;
pub mod index;
mod ingest;
mod insert;
mod leb128;
pub mod metric;
mod record;
mod recording;
mod removal;
mod schema;
mod work_limit;

pub use self::{
    database::Database,
    error::{DbError, DbFault},
    ground::Ground,
    image_mask::ImageMask,
    ingest::IngestReport,
    record::{ImageDetails, ImageRecord, PoseEstimate, PoseSource},
    recording::{Insertion, NewImage, Recording},
    schema::SCHEMA_VERSION,
};

#[cfg(test)]
mod tests;
