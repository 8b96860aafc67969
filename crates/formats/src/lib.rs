//! Logs and models of others in and out: a robot's log becomes a recording, tags and databases become models that other
//! programs read.
//!
//! | what | where |
//! |---|---|
//! | pictures with poses, on their way out | [`posed::PosedPictures`], [`undistort::Undistortion`] |
//! | COLMAP's models, written and read | [`colmap`] |
//! | nerfstudio's `transforms.json`, written and read | [`nerfstudio`] |

pub mod colmap;
mod file;
pub mod line_points;
pub mod model_error;
pub mod model_import;
pub mod nerfstudio;
pub mod posed;
pub mod undistort;

pub use self::{
    model_error::{ModelError, ModelFault},
    model_import::{ModelImport, ModelImportReport},
    posed::{PictureFiles, PosedPicture, PosedPictures},
};
