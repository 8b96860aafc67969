//! Writing a model.

use std::{fs, path::Path};

use reality_sim_core::sequence::write_atomically;

use super::{
    binary::binaries,
    folders::{MODEL_FOLDER, TIMESTAMPS_FILE},
    model::ColmapModel,
    text::texts,
};
use crate::{
    model_error::{ModelError, ModelFault},
    posed::PosedPictures,
};

/// Which of the two kinds of files are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Encodings {
    /// `.txt` files.
    pub text: bool,
    /// `.bin` files, which COLMAP prefers where both are there.
    pub binary: bool,
}

impl ColmapModel {
    /// Writes the model into [`MODEL_FOLDER`] of an export. Fails if a file cannot be written.
    pub fn write(&self, folder: &Path, encodings: Encodings) -> Result<(), ModelError> {
        let folder = folder.join(MODEL_FOLDER);
        fs::create_dir_all(&folder)
            .map_err(|error| ModelError::of_file(&folder, ModelFault::Unwritable(error)))?;
        if encodings.text {
            for (name, text) in texts(self) {
                write_atomically(&folder.join(name), text.as_bytes())?;
            }
        }
        if encodings.binary {
            for (name, bytes) in binaries(self) {
                write_atomically(&folder.join(name), &bytes)?;
            }
        }
        Ok(())
    }
}

/// Writes pictures that have been written before as a COLMAP model, with the table of their times. Fails if a file cannot be
/// written.
pub fn write_colmap(posed: &PosedPictures, folder: &Path, encodings: Encodings) -> Result<(), ModelError> {
    let mut times = String::from("image,timestamp_s\n");
    for picture in &posed.pictures {
        times.push_str(&format!("{},{}\n", picture.file_name, picture.timestamp_s));
    }
    write_atomically(&folder.join(TIMESTAMPS_FILE), times.as_bytes())?;
    ColmapModel::new(posed).write(folder, encodings)
}
