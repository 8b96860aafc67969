//! Recordings: a folder with the camera, the field, one line a picture and, where it is known, where the camera was.
//!
//! Keys and columns that are not known are left to the programs that added them; what is missing, malformed or
//! impossible is a [`SequenceError`] that names file, line, fault and remedy in one line.

mod atomic;
mod camera_file;
mod error;
mod field_file;
mod frames;
mod groundtruth;
mod picture;
mod sequence_file;
mod text;
mod toml_text;
mod tum;
mod write;

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use image::RgbImage;

pub use self::{
    atomic::write_atomically,
    camera_file::{CameraSetup, Photometry, read_camera},
    error::{Fault, Printable, SequenceError},
    field_file::read_field,
    frames::FrameRecord,
    groundtruth::match_poses,
    picture::{check_image, decode_image, save_image},
    tum::{StampedPose, read_tum, write_tum},
};
use self::{
    frames::parse_frames,
    picture::{copy_picture, load_picture, read_picture},
    sequence_file::{SEQUENCE_FILE, parse_sequence},
    text::read_and_parse,
};
use crate::{
    field::FieldDimensions,
    pose::{CameraPose, Pose2},
};

/// A recording, all but its pictures in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Sequence {
    /// Where it lies.
    pub folder: PathBuf,
    /// The text files it was read from.
    pub files: Vec<PathBuf>,
    /// What it is called.
    pub name: String,
    /// The camera on the robot.
    pub setup: CameraSetup,
    /// The field it was recorded on.
    pub field: FieldDimensions,
    /// The pictures in the order of time, at least one.
    pub frames: Vec<FrameRecord>,
    /// Pose of the first frame in the world, where it is known.
    pub start: Option<Pose2>,
}

impl Sequence {
    /// Reads and validates a sequence's text files, not its pictures.
    pub fn open(folder: &Path) -> Result<Self, SequenceError> {
        check_folder(folder)?;
        let main_file = folder.join(SEQUENCE_FILE);
        let table = read_and_parse(&main_file, parse_sequence)?;
        let parts = [&table.camera, &table.field, &table.frames];
        let parts = parts.into_iter().chain(&table.groundtruth).map(|name| folder.join(name));
        let files = std::iter::once(main_file).chain(parts).collect();
        let setup = read_camera(&folder.join(&table.camera))?;
        let field = read_field(&folder.join(&table.field))?;
        let mut frames = read_and_parse(&folder.join(&table.frames), parse_frames)?;
        if let Some(name) = &table.groundtruth {
            let path = folder.join(name);
            let poses = match_poses(&path, read_tum(&path)?, &frames)?;
            frames.iter_mut().zip(poses).for_each(|(frame, pose)| frame.reference_pose = pose);
        }
        Ok(Self {
            folder: folder.to_path_buf(),
            files,
            name: table.name,
            setup,
            field,
            frames,
            start: table.start.map(Pose2::from),
        })
    }

    /// The reference pose of each frame, where there is one.
    pub fn reference_poses(&self) -> impl ExactSizeIterator<Item = Option<CameraPose>> + Clone {
        self.frames.iter().map(|frame| frame.reference_pose)
    }

    /// Whether any frame has a reference pose.
    pub fn has_reference_poses(&self) -> bool {
        self.reference_poses().any(|pose| pose.is_some())
    }

    /// The picture of a frame (from 0), JPEG or PNG, in the camera's size. Grey pictures become RGB.
    pub fn load_image(&self, index: usize) -> Result<RgbImage, SequenceError> {
        let camera = &self.setup.camera;
        load_picture(&self.image_path(index)?, [camera.width, camera.height])
    }

    /// The bytes of a frame's picture file (frames count from 0) as they are: a whole JPEG or PNG in the camera's size, by
    /// its header and its end. The pixels are not decoded.
    pub fn image_bytes(&self, index: usize) -> Result<Vec<u8>, SequenceError> {
        let camera = &self.setup.camera;
        read_picture(&self.image_path(index)?, [camera.width, camera.height])
    }

    /// Copies the picture of a frame (from 0) as it is into another sequence's folder, under the same name.
    pub fn copy_image(&self, index: usize, folder: &Path) -> Result<(), SequenceError> {
        let from = self.image_path(index)?;
        copy_picture(&from, &folder.join(&self.frames[index].image))
    }

    /// Where the picture of a frame (from 0) lies.
    pub fn image_path(&self, index: usize) -> Result<PathBuf, SequenceError> {
        let frame = self.frames.get(index).ok_or_else(|| {
            let fault = Fault::NoSuchFrame { index, count: self.frames.len() };
            SequenceError::of_file(&self.folder, fault)
        })?;
        Ok(self.folder.join(&frame.image))
    }
}

fn check_folder(folder: &Path) -> Result<(), SequenceError> {
    let fault = match fs::metadata(folder) {
        Ok(metadata) if metadata.is_dir() => return Ok(()),
        Ok(_) => Fault::NotAFolder,
        Err(error) if error.kind() == io::ErrorKind::NotFound => Fault::FolderMissing,
        Err(error) => Fault::Unreadable(error),
    };
    Err(SequenceError::of_file(folder, fault))
}

#[cfg(test)]
mod tests;
