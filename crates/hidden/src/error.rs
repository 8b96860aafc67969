//! Errors of making a recording.

use std::{io, path::PathBuf};

use reality_sim_core::sequence::SequenceError;

/// Error of making a recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No effect has this id.
    #[error("there is no effect {id:?}: use one of LIBRARY or FOREIGN")]
    UnknownEffect {
        /// Id as given.
        id: String,
    },
    /// A value of the recipe is not allowed.
    #[error("{name} is {value}: it must be {rule}")]
    Recipe {
        /// Name of the quantity.
        name: &'static str,
        /// Value as given.
        value: f64,
        /// Rule that it violates.
        rule: &'static str,
    },
    /// A picture's file cannot be written.
    #[error("{}: cannot be written ({source}): check the permissions and the space on the disk", .path.display())]
    Unwritable {
        /// File or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A picture cannot be encoded.
    #[error("{}: cannot be encoded as JPEG ({source}): use pictures of at most 65535 pixels a side", .path.display())]
    Unencodable {
        /// File of the picture.
        path: PathBuf,
        /// Error of the encoder.
        source: image::ImageError,
    },
    /// The text files cannot be written.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
}
