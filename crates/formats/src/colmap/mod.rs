//! COLMAP's models: `cameras`, `images` and `points3D`, as text and as binary files.
//!
//! The formats are those of COLMAP's page "Output Format". A pixel's centre is (0.5, 0.5) there and (0, 0) here; a pose is the
//! camera's axes from the world's (`camera_from_world`), its quaternion begins with w.

mod binary;
mod bytes;
mod camera;
mod image;
mod import;
mod text;

use std::{
    fs,
    path::{Path, PathBuf},
};

use reality_sim_core::sequence::write_atomically;

pub use self::{
    camera::{ColmapCamera, ColmapLens},
    image::{ColmapImage, Keypoint},
    import::{read_colmap, read_colmap_as_sequence},
};
use crate::{
    line_points::{LINE_SRGB, line_points, seen_points},
    model_error::{ModelError, ModelFault},
    posed::PosedPictures,
};

/// Half a pixel: what is added to our pixel coordinates to get COLMAP's.
pub const HALF_PIXEL: f64 = 0.5;

/// Folder of the model inside an export, as COLMAP's own projects have it.
pub const MODEL_FOLDER: &str = "sparse/0";

/// Table of the pictures' times, which COLMAP has no place for: columns `image` and `timestamp_s`.
pub const TIMESTAMPS_FILE: &str = "timestamps.csv";

/// Model as COLMAP's files hold it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ColmapModel {
    /// Cameras.
    pub cameras: Vec<ColmapCamera>,
    /// Pictures with their poses.
    pub images: Vec<ColmapImage>,
    /// Points in the world.
    pub points: Vec<ColmapPoint>,
}

/// Point in the world, with the pictures that show it.
#[derive(Debug, Clone, PartialEq)]
pub struct ColmapPoint {
    /// Number in the model, from 1.
    pub id: u64,
    /// Place in the world, metres.
    pub point_in_world: [f64; 3],
    /// Colour, sRGB.
    pub srgb: [u8; 3],
    /// Pictures that show it: image id, and place among the keypoints of that image.
    pub track: Vec<(u32, u32)>,
}

/// Which of the two kinds of files are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Encodings {
    /// `.txt` files.
    pub text: bool,
    /// `.bin` files, which COLMAP prefers where both are there.
    pub binary: bool,
}

impl ColmapModel {
    /// Makes the model of pictures that have been written. Its points lie on the field's lines, and its keypoints are where
    /// the cameras see them.
    pub fn new(posed: &PosedPictures) -> Self {
        let cameras = (1..).zip(&posed.cameras).map(|(id, camera)| ColmapCamera::new(id, camera)).collect();
        let places = line_points(&posed.field);
        let mut points: Vec<ColmapPoint> = (1..)
            .zip(&places)
            .map(|(id, place)| ColmapPoint {
                id,
                point_in_world: place.to_array(),
                srgb: LINE_SRGB,
                track: Vec::new(),
            })
            .collect();
        let mut images = Vec::with_capacity(posed.pictures.len());
        for (id, picture) in (1..).zip(&posed.pictures) {
            let seen = seen_points(posed.camera(picture), picture.pose, &places);
            for (place, (point, _)) in (0..).zip(&seen) {
                points[*point].track.push((id, place));
            }
            images.push(ColmapImage::new(id, picture, &seen));
        }
        Self { cameras, images, points }
    }

    /// Writes the model into [`MODEL_FOLDER`] of an export. Fails if a file cannot be written.
    pub fn write(&self, folder: &Path, encodings: Encodings) -> Result<(), ModelError> {
        let folder = folder.join(MODEL_FOLDER);
        fs::create_dir_all(&folder)
            .map_err(|error| ModelError::of_file(&folder, ModelFault::Unwritable(error)))?;
        if encodings.text {
            for (name, text) in self.texts() {
                write_atomically(&folder.join(name), text.as_bytes())?;
            }
        }
        if encodings.binary {
            for (name, bytes) in self.binaries() {
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

/// Returns the folder that holds the model's files: the given one, or one of those that COLMAP makes in a project.
fn model_folder(folder: &Path) -> Option<PathBuf> {
    let candidates = ["", "0", "sparse", MODEL_FOLDER].map(|name| folder.join(name));
    candidates
        .into_iter()
        .find(|folder| ["images.bin", "images.txt"].iter().any(|name| folder.join(name).is_file()))
}

/// Returns whether a path is a folder that holds a COLMAP model, itself or in one of the folders that COLMAP makes.
pub fn is_colmap(path: &Path) -> bool {
    model_folder(path).is_some()
}
