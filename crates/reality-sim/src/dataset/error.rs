//! Reasons why there is no data set.

use std::{io, path::PathBuf};

use reality_sim_core::sequence::SequenceError;
use reality_sim_db::DbError;
use reality_sim_sensor::ModelError;
use reality_sim_simulator::LookError;

/// Reason why a data set could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DatasetError {
    /// The folder was made with other settings.
    #[error(
        "{}: holds a data set that was made with another {}: give the same settings, or another folder",
        folder.display(), keys.join(", ")
    )]
    OtherSettings {
        /// Folder of the data set.
        folder: PathBuf,
        /// Keys of `dataset.json` that differ.
        keys: Vec<String>,
    },
    /// The folder holds more pictures than are wanted.
    #[error("{}: holds more than {count} pictures already: give a larger count, or another folder", folder.display())]
    MorePictures {
        /// Folder of the data set.
        folder: PathBuf,
        /// Number of pictures that are wanted.
        count: u32,
    },
    /// The folder holds something else.
    #[error(
        "{}: holds other files and no dataset.json: give a new folder, or that of a data set to be completed",
        folder.display()
    )]
    OtherFiles {
        /// Folder that was given.
        folder: PathBuf,
    },
    /// The folder's manifest is none.
    #[error("{}: is not the manifest of a data set ({cause}): give another folder", file.display())]
    Manifest {
        /// Path of `dataset.json`.
        file: PathBuf,
        /// What is wrong in it.
        #[source]
        cause: serde_json::Error,
    },
    /// A folder cannot be created.
    #[error("{}: cannot be created ({cause}): check the path and its permissions", folder.display())]
    Folder {
        /// Folder that is wanted.
        folder: PathBuf,
        /// What the operating system says.
        #[source]
        cause: io::Error,
    },
    /// A file cannot be written.
    #[error(transparent)]
    File(#[from] SequenceError),
    /// The database cannot be read.
    #[error(transparent)]
    Database(#[from] DbError),
    /// A picture cannot be encoded as PNG.
    #[error("{}: cannot be encoded: {cause}", file.display())]
    Encoding {
        /// File that is wanted.
        file: PathBuf,
        /// What the encoder says.
        #[source]
        cause: image::ImageError,
    },
    /// Records cannot be written as JSON.
    #[error("the records of picture {picture} cannot be written: {cause}")]
    Records {
        /// Number of the picture.
        picture: u32,
        /// What is wrong in them.
        #[source]
        cause: serde_json::Error,
    },
    /// The model does not fit the camera.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The distance up to which poses are drawn is none.
    #[error("within: is {within}: give a number of pixels above 0")]
    Within {
        /// Distance that was given, pixels.
        within: f64,
    },
    /// No pose is near enough to a recorded picture.
    #[error(
        "{}: no random pose for picture {picture} is within {within_px} px of a recorded picture: record more of the field, or allow a larger distance",
        database.display()
    )]
    NothingNear {
        /// Database.
        database: PathBuf,
        /// Number of the picture.
        picture: u32,
        /// Distance that is allowed, root mean square pixels.
        within_px: f64,
    },
    /// Recorded pictures show too little at all poses.
    #[error(
        "{}: recorded pictures show too little at {poses} random poses for picture {picture}: record more of the field, or ask for the best effort",
        database.display()
    )]
    TooLittleSeen {
        /// Database.
        database: PathBuf,
        /// Number of the picture.
        picture: u32,
        /// Number of poses.
        poses: u32,
    },
    /// The camera failed.
    #[error(transparent)]
    Look(#[from] LookError),
}
