//! Writing a sequence's text files.

use std::{fs, path::Path};

use super::{
    CameraSetup, Sequence,
    atomic::write_atomically,
    calibration_file::camera_with_uncertainty,
    error::{Fault, SequenceError},
    frames::{FrameRecord, parse_frames, print_frames},
    sequence_file::{SEQUENCE_FILE, SequenceTable, StartTable, parse_sequence},
    toml_text::print,
    tum::{StampedPose, parse_tum, print_tum},
};
use crate::field::FieldDimensions;

const CAMERA_FILE: &str = "camera.toml";
const FIELD_FILE: &str = "field.toml";
const FRAMES_FILE: &str = "frames.csv";
const GROUNDTRUTH_FILE: &str = "groundtruth.tum";

impl Sequence {
    /// Writes the text files into a folder, which is created if missing. The caller writes the pictures, see
    /// [`Sequence::copy_image`] and [`super::save_image`]. `sequence.toml`, which makes the folder a sequence, is
    /// written last. Fails without writing anything if [`Sequence::open`] would reject the files. Fails also if a file
    /// cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), SequenceError> {
        let files = self.texts(folder)?;
        fs::create_dir_all(folder)
            .map_err(|error| SequenceError::of_file(folder, Fault::Unwritable(error)))?;
        files.iter().try_for_each(|(name, text)| write_atomically(&folder.join(name), text.as_bytes()))
    }

    /// Returns names and texts of the files, in the order in which they are written.
    fn texts(&self, folder: &Path) -> Result<Vec<(&'static str, String)>, SequenceError> {
        let path = folder.join(CAMERA_FILE);
        let camera = self.setup.to_toml(&path)?;
        CameraSetup::from_toml(&path, &camera)?;
        let camera = match &self.calibration {
            Some(calibration) => camera_with_uncertainty(&camera, &self.setup.camera, calibration),
            None => camera,
        };
        let path = folder.join(FIELD_FILE);
        let field = self.field.to_toml(&path)?;
        FieldDimensions::from_toml(&path, &field)?;
        let path = folder.join(FRAMES_FILE);
        let frames = print_frames(&path, &self.frames)?;
        let lines = self.frames.iter().map(|frame| FrameRecord { reference_pose: None, ..frame.clone() });
        if !parse_frames(&path, &frames)?.into_iter().eq(lines) {
            let rule = "the pictures' names must not begin or end with blanks";
            return Err(SequenceError::of_file(&path, Fault::Inconsistent { rule }));
        }
        let mut files = vec![(CAMERA_FILE, camera), (FIELD_FILE, field), (FRAMES_FILE, frames)];

        let path = folder.join(GROUNDTRUTH_FILE);
        let poses = self.stamped_reference_poses();
        if !poses.is_empty() {
            let text = print_tum(&path, &poses)?;
            parse_tum(&path, &text)?;
            files.push((GROUNDTRUTH_FILE, text));
        }
        let path = folder.join(SEQUENCE_FILE);
        let sequence = print(&path, &self.table(!poses.is_empty()))?;
        parse_sequence(&path, &sequence)?;
        files.push((SEQUENCE_FILE, sequence));
        Ok(files)
    }

    fn table(&self, has_groundtruth: bool) -> SequenceTable {
        SequenceTable {
            name: self.name.clone(),
            camera: CAMERA_FILE.to_owned(),
            field: FIELD_FILE.to_owned(),
            frames: FRAMES_FILE.to_owned(),
            groundtruth: has_groundtruth.then(|| GROUNDTRUTH_FILE.to_owned()),
            start: self.start.map(StartTable::from),
        }
    }

    fn stamped_reference_poses(&self) -> Vec<StampedPose> {
        let stamped = |frame: &FrameRecord| {
            Some(StampedPose { timestamp_s: frame.timestamp_s, pose: frame.reference_pose? })
        };
        let of_frames = self.frames.iter().filter_map(stamped);
        let mut poses: Vec<StampedPose> =
            of_frames.chain(self.poses_between_frames.iter().copied()).collect();
        poses.sort_by(|a, b| a.timestamp_s.total_cmp(&b.timestamp_s));
        poses
    }
}
