//! What can go wrong with a recording.

use std::{io, path::PathBuf};

use reality_sim_core::sequence::SequenceError;

/// A recording that cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No effect has this id.
    #[error("there is no effect {id:?}: use one of LIBRARY or FOREIGN")]
    UnknownEffect {
        /// As given.
        id: String,
    },
    /// A recipe that cannot be followed.
    #[error("{name} is {value}: it must be {rule}")]
    Recipe {
        /// The quantity.
        name: &'static str,
        /// As given.
        value: f64,
        /// What it has to be.
        rule: &'static str,
    },
    /// A picture's file cannot be written.
    #[error("{}: cannot be written ({source}): check the permissions and the space on the disk", .path.display())]
    Unwritable {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A picture cannot be encoded.
    #[error("{}: cannot be encoded as JPEG ({source}): use pictures of at most 65535 pixels a side", .path.display())]
    Unencodable {
        /// The file.
        path: PathBuf,
        /// What the encoder says.
        source: image::ImageError,
    },
    /// The text files cannot be written.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
}
