//! Recordings: a folder with the camera, the field, one record per picture and, if known, the reference poses.
//!
//! Unknown keys and columns are ignored: other programs may have added them. Anything missing, malformed or impossible
//! is a [`SequenceError`] that names file, line, fault and remedy in one line.

mod atomic;
mod calibration_file;
mod camera_file;
mod corrected_by;
mod error;
mod field_file;
mod format_error;
mod frames;
mod groundtruth;
mod jpeg;
mod limits;
mod mounting;
mod origin;
mod picture;
mod printable;
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
use rayon::prelude::*;

pub use self::{
    atomic::{hold_writing, write_atomically, write_atomically_with},
    calibration_file::{camera_with_uncertainty, read_calibration},
    camera_file::{CameraSetup, Photometry, Trust, read_camera, read_mounting},
    corrected_by::{camera_with_model, model_of_camera},
    error::{Fault, SequenceError},
    field_file::read_field,
    format_error::FormatError,
    frames::FrameRecord,
    groundtruth::match_poses,
    mounting::Mounting,
    origin::{Origin, read_origin},
    picture::{check_image, decode_image, save_image},
    printable::{Printable, counted, for_terminal, on_one_line, one_line},
    sequence_file::is_inside_folder,
    tum::{StampedPose, read_tum, write_tum},
};
use self::{
    frames::parse_frames,
    groundtruth::between_frames,
    limits::{MAX_TABLE_BYTES, MAX_TOML_BYTES},
    picture::{copy_picture, read_picture},
    sequence_file::{SEQUENCE_FILE, parse_sequence},
    text::read_and_parse,
};
use crate::{
    field::FieldDimensions,
    pose::{CameraPose, Pose2},
    refine::CalibrationUncertainty,
};

/// Recording, loaded into memory except for its pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct Sequence {
    /// Folder of the recording.
    pub folder: PathBuf,
    /// Text files from which the recording was read.
    pub files: Vec<PathBuf>,
    /// Name of the recording.
    pub name: String,
    /// Camera as mounted on the robot.
    pub setup: CameraSetup,
    /// Field on which it was recorded.
    pub field: FieldDimensions,
    /// Frames in order of time, at least one.
    pub frames: Vec<FrameRecord>,
    /// Reference poses at other times than the frames', in order of time: motion capture is faster than cameras.
    pub poses_between_frames: Vec<StampedPose>,
    /// Pose of the first frame in the world, if known.
    pub start: Option<Pose2>,
    /// How far lens and mount can be trusted, if the camera's file says it.
    pub calibration: Option<CalibrationUncertainty>,
    /// Text of the model by which camera, field, poses and odometry have been corrected, if one has been used.
    pub corrected_by: Option<String>,
}

impl Sequence {
    /// Reads and validates a sequence's text files, not its pictures. Fails if a file is missing or cannot be read, or
    /// with the first value that is missing or invalid.
    pub fn open(folder: &Path) -> Result<Self, SequenceError> {
        Self::open_with_camera(folder, None)
    }

    /// Works as [`Sequence::open`], with another camera file, if one is given, in place of the sequence's own.
    pub fn open_with_camera(folder: &Path, camera: Option<&Path>) -> Result<Self, SequenceError> {
        let camera = camera.map_or_else(|| Self::camera_file(folder), |camera| Ok(camera.to_path_buf()))?;
        let (setup, mounting) = (read_camera(&camera)?, read_mounting(&camera)?);
        let calibration = read_calibration(&camera, &setup.camera)?;
        Self::open_with(folder, CameraFile { setup, mounting, calibration })
    }

    /// Works as [`Sequence::open`], with a camera that is made here, not read: that of a recording which is not calibrated yet.
    pub fn open_with_setup(folder: &Path, setup: CameraSetup) -> Result<Self, SequenceError> {
        Self::open_with(folder, CameraFile { setup, mounting: Mounting::default(), calibration: None })
    }

    fn open_with(folder: &Path, camera: CameraFile) -> Result<Self, SequenceError> {
        check_folder(folder)?;
        let main_file = folder.join(SEQUENCE_FILE);
        let table = read_and_parse(&main_file, MAX_TOML_BYTES, parse_sequence)?;
        let parts = [&table.camera, &table.field, &table.frames];
        let parts = parts.into_iter().chain(&table.groundtruth).map(|name| folder.join(name));
        let files = std::iter::once(main_file).chain(parts).collect();
        let CameraFile { setup, mounting, calibration } = camera;
        let field = read_field(&folder.join(&table.field))?;
        let mut frames = read_and_parse(&folder.join(&table.frames), MAX_TABLE_BYTES, parse_frames)?;
        let mut poses_between_frames = Vec::new();
        if let Some(name) = &table.groundtruth {
            let path = folder.join(name);
            let poses = read_tum(&path)?;
            let matched = match_poses(&path, poses.clone(), &frames)?;
            frames.iter_mut().zip(matched).for_each(|(frame, pose)| frame.reference_pose = pose);
            poses_between_frames = between_frames(poses, &frames);
        }
        if !mounting.is_as_stated() {
            frames.iter_mut().for_each(|frame| mounting.correct(frame));
            poses_between_frames.iter_mut().for_each(|stamped| mounting.correct_pose(stamped));
        }
        Ok(Self {
            folder: folder.to_path_buf(),
            files,
            name: table.name,
            setup,
            field,
            frames,
            poses_between_frames,
            start: table.start.map(Pose2::from),
            calibration,
            corrected_by: None,
        })
    }

    /// Returns the path of a recording's camera file. Fails as [`Sequence::open`] does.
    pub fn camera_file(folder: &Path) -> Result<PathBuf, SequenceError> {
        check_folder(folder)?;
        Ok(folder.join(read_and_parse(&folder.join(SEQUENCE_FILE), MAX_TOML_BYTES, parse_sequence)?.camera))
    }

    /// Returns the reference pose of each frame, if there is one.
    pub fn reference_poses(&self) -> impl ExactSizeIterator<Item = Option<CameraPose>> + Clone {
        self.frames.iter().map(|frame| frame.reference_pose)
    }

    /// Returns whether any frame has a reference pose.
    pub fn has_reference_poses(&self) -> bool {
        self.reference_poses().any(|pose| pose.is_some())
    }

    /// Loads the picture of a frame (from 0), JPEG or PNG; grey pictures become RGB. Fails if there is no such frame,
    /// or if the picture cannot be read or does not have the camera's size.
    pub fn load_image(&self, index: usize) -> Result<RgbImage, SequenceError> {
        self.load_image_and_file(index).map(|(picture, _)| picture)
    }

    /// Loads the picture of a frame as [`Sequence::load_image`], and returns it with the bytes of its file.
    pub fn load_image_and_file(&self, index: usize) -> Result<(RgbImage, Vec<u8>), SequenceError> {
        let camera = &self.setup.camera;
        read_picture(&self.image_path(index)?, [camera.width, camera.height])
    }

    /// Returns the bytes of a frame's picture file (frames count from 0) unchanged. Fails as [`Sequence::load_image`]: the
    /// picture is decoded.
    pub fn image_bytes(&self, index: usize) -> Result<Vec<u8>, SequenceError> {
        self.load_image_and_file(index).map(|(_, bytes)| bytes)
    }

    /// Checks, before long work, that the file of every picture is there, and that the first one is a picture of the camera.
    /// Fails with the number of missing pictures, or as [`Sequence::load_image`].
    pub fn check_pictures(&self) -> Result<(), SequenceError> {
        let is_missing = |frame: &&FrameRecord| !self.folder.join(&frame.image).is_file();
        let mut missing = self.frames.iter().filter(is_missing);
        if let Some(first) = missing.next() {
            let (first, count) = (first.image.clone(), 1 + missing.count());
            let fault = Fault::PicturesMissing { first, count, frames: self.frames.len() };
            return Err(SequenceError::of_file(&self.folder, fault));
        }
        self.load_image(0).map(drop)
    }

    /// Decodes every picture, after one of them could not be used. Fails with all that cannot be: their number, their names, and
    /// what is wrong with the first.
    pub fn check_every_picture(&self) -> Result<(), SequenceError> {
        let frames = (0..self.frames.len()).into_par_iter();
        let unusable = frames.filter_map(|index| self.load_image(index).err()).collect();
        self.unusable_pictures(unusable).map_or(Ok(()), Err)
    }

    /// Returns the error of pictures that cannot be used: for a single one its own, for none nothing.
    pub fn unusable_pictures(&self, mut errors: Vec<SequenceError>) -> Option<SequenceError> {
        if errors.len() < 2 {
            return errors.pop();
        }
        let name = |error: &SequenceError| {
            error.path.strip_prefix(&self.folder).unwrap_or(&error.path).to_path_buf()
        };
        let names = errors.iter().map(name).collect();
        let first = Box::new(errors.swap_remove(0).fault);
        let fault = Fault::PicturesUnusable { names, first, frames: self.frames.len() };
        Some(SequenceError::of_file(&self.folder, fault))
    }

    /// Copies the picture file of a frame (from 0) unchanged into another sequence's folder, under the same name. Fails
    /// if there is no such frame, or if the file cannot be read or written.
    pub fn copy_image(&self, index: usize, folder: &Path) -> Result<(), SequenceError> {
        let from = self.image_path(index)?;
        copy_picture(&from, &folder.join(&self.frames[index].image))
    }

    /// Returns the path of a frame's picture (from 0). Fails if there is no such frame.
    pub fn image_path(&self, index: usize) -> Result<PathBuf, SequenceError> {
        let frame = self.frames.get(index).ok_or_else(|| {
            let fault = Fault::NoSuchFrame { index, count: self.frames.len() };
            SequenceError::of_file(&self.folder, fault)
        })?;
        Ok(self.folder.join(&frame.image))
    }
}

/// What a camera's file says.
struct CameraFile {
    setup: CameraSetup,
    mounting: Mounting,
    calibration: Option<CalibrationUncertainty>,
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
