//! Data sets: pictures at random poses with labels, in a folder, as the program's `dataset` makes them.
//!
//! A picture depends on the settings and its number alone, so that a folder can be completed later, and by any number of threads.
//!
//! ```
//! use std::{path::Path, sync::Arc};
//!
//! use reality_sim::{Archive, Sequence, Synthesizer, dataset::{DatasetSettings, DatasetSource, make}};
//! use reality_sim::db::{Database, PoseEstimate, PoseSource};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let (file, out) = (folder.path().join("walk.db"), folder.path().join("pictures"));
//! let walk = Sequence::open(Path::new("../../assets/walk"))?;
//! let poses: Vec<_> = walk.reference_poses().map(|pose| pose.map(PoseEstimate::from)).collect();
//! Database::create_or_open(&file)?.ingest(&walk, &poses, &PoseSource::GroundTruth)?;
//!
//! let archive = Arc::new(Archive::open(&file, 256 << 20)?);
//! let source = DatasetSource::new(&file, Synthesizer::new(archive));
//! let settings = DatasetSettings { count: 2, ..DatasetSettings::default() };
//! let dataset = make(&source, &settings, &out, |_| ())?;
//! assert_eq!(dataset.written, 2);
//! assert!(out.join("annotations.json").is_file());
//! # Ok(())
//! # }
//! ```

mod error;
mod folder;
mod make;
mod manifest;
mod poses;
mod records;
mod settings;
mod source;
mod things;
mod worker;

pub use self::{
    error::DatasetError,
    make::{Dataset, make},
    settings::{DatasetSettings, InvalidNumbers, Numbers, PictureFormat},
    source::DatasetSource,
};
