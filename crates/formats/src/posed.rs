//! Pictures with their cameras and poses, on their way to the formats of others.

use std::{
    error::Error,
    fs,
    path::{Path, PathBuf},
};

use reality_sim_core::{
    camera::Camera,
    field::FieldDimensions,
    pose::CameraPose,
    sequence::{decode_image, save_image, write_atomically},
};

use crate::{
    model_error::{ModelError, ModelFault},
    undistort::{Border, Undistorter, Undistortion},
};

/// Folder of the pictures inside an export.
pub const IMAGES: &str = "images";

/// Place of a camera in [`PosedPictures::cameras`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct CameraIndex(pub usize);

/// Pictures of one field with the poses at which they were taken.
#[derive(Debug, Clone, PartialEq)]
pub struct PosedPictures {
    /// Cameras that took them.
    pub cameras: Vec<Camera>,
    /// Field on which they were taken.
    pub field: FieldDimensions,
    /// Pictures, in order of time where they are of one recording.
    pub pictures: Vec<PosedPicture>,
}

/// Picture with the pose at which it was taken.
#[derive(Debug, Clone, PartialEq)]
pub struct PosedPicture {
    /// Number of the picture in its source, by which its file is named.
    pub number: usize,
    /// Time at which it was taken, seconds.
    pub timestamp_s: f64,
    /// Camera that took it.
    pub camera: CameraIndex,
    /// Pose of the camera.
    pub pose: CameraPose,
    /// File in the folder [`IMAGES`] of the export, relative to that folder; empty before it is written.
    pub file_name: String,
}

/// Source of the pictures' files.
pub trait PictureFiles {
    /// Returns the JPEG or PNG file of a picture, by its place in [`PosedPictures::pictures`].
    fn bytes(&self, index: usize) -> Result<Vec<u8>, Box<dyn Error + Send + Sync>>;
}

impl PosedPictures {
    /// Returns the camera of a picture.
    pub fn camera(&self, picture: &PosedPicture) -> &Camera {
        &self.cameras[picture.camera.0]
    }

    /// Writes the pictures into the folder [`IMAGES`] of an export, unchanged or undistorted, and calls `done` after each.
    /// Returns them as they were written: with their file names, and with the cameras that see what they show. Fails if a
    /// picture cannot be read, decoded or written.
    pub fn write_pictures(
        &self,
        files: &dyn PictureFiles,
        folder: &Path,
        undistortion: Option<&Undistortion>,
        done: &mut dyn FnMut(usize),
    ) -> Result<Self, ModelError> {
        let folder = folder.join(IMAGES);
        fs::create_dir_all(&folder)
            .map_err(|error| ModelError::of_file(&folder, ModelFault::Unwritable(error)))?;
        let undistorters =
            undistortion.map(|undistortion| self.undistorters(undistortion, &folder)).transpose()?;
        let mut written = self.clone();
        for (index, picture) in written.pictures.iter_mut().enumerate() {
            let origin = PathBuf::from(format!("picture {}", picture.number));
            let bytes = files
                .bytes(index)
                .map_err(|error| ModelError::of_file(&origin, ModelFault::Picture(error)))?;
            picture.file_name = match &undistorters {
                Some(undistorters) => {
                    write_undistorted(&folder, picture.number, &bytes, &undistorters[picture.camera.0])?
                }
                None => write_unchanged(&folder, picture.number, &bytes)?,
            };
            done(index + 1);
        }
        if let Some(undistorters) = undistorters {
            written.cameras = undistorters.iter().map(|undistorter| undistorter.pinhole.clone()).collect();
        }
        Ok(written)
    }

    fn undistorters(
        &self,
        undistortion: &Undistortion,
        folder: &Path,
    ) -> Result<Vec<Undistorter>, ModelError> {
        let of_camera = |(id, camera)| {
            let undistorter = undistortion.of_camera(camera);
            undistorter.map_err(|error| ModelError::of_file(folder, ModelFault::Camera { id, error }))
        };
        (1..).zip(&self.cameras).map(of_camera).collect()
    }
}

fn write_unchanged(folder: &Path, number: usize, bytes: &[u8]) -> Result<String, ModelError> {
    let ending = match image::guess_format(bytes) {
        Ok(image::ImageFormat::Png) => "png",
        _ => "jpg",
    };
    let name = format!("{number:06}.{ending}");
    write_atomically(&folder.join(&name), bytes)?;
    Ok(name)
}

fn write_undistorted(
    folder: &Path,
    number: usize,
    bytes: &[u8],
    undistorter: &Undistorter,
) -> Result<String, ModelError> {
    let origin = PathBuf::from(format!("picture {number}"));
    let picture = decode_image(&origin, bytes, undistorter.recorded_size())?;
    Ok(match undistorter.border {
        Border::Black => {
            let name = format!("{number:06}.jpg");
            save_image(&folder.join(&name), &undistorter.picture(&picture))?;
            name
        }
        Border::Transparent => {
            let name = format!("{number:06}.png");
            let path = folder.join(&name);
            write_atomically(&path, &undistorter.transparent_png(&path, &picture)?)?;
            name
        }
    })
}
