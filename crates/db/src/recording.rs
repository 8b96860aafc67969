//! What images of one recording share, and one image on its way into the database.

use std::path::Path;

use reality_sim_core::{
    field::FieldDimensions,
    sequence::{CameraSetup, Sequence},
};

use crate::{
    error::{DbError, DbFault},
    record::{PoseEstimate, PoseSource},
};

/// A recording that images belong to: its name, its camera, its field, and where its poses come from.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    pub(crate) name: String,
    /// What tells it from others of its name.
    pub(crate) first_frame: String,
    /// Width and height of its pictures, pixels.
    pub(crate) size: [u32; 2],
    /// The text of its camera's file.
    pub(crate) camera: String,
    /// The text of its field's file.
    pub(crate) field: String,
    pub(crate) source: PoseSource,
}

impl Recording {
    /// A recording that is known by its name alone, as one that is made now. Fails where camera or field cannot be written
    /// as text, as with numbers that are not finite.
    pub fn new(
        name: &str,
        setup: &CameraSetup,
        field: &FieldDimensions,
        source: PoseSource,
    ) -> Result<Self, DbError> {
        let origin = Path::new(name);
        Ok(Self {
            name: name.to_owned(),
            first_frame: String::new(),
            size: [setup.camera.width, setup.camera.height],
            camera: setup.to_toml(origin)?,
            field: field.to_toml(origin)?,
            source,
        })
    }

    /// A recording in a folder, known by its name and its first frame, wherever it lies.
    pub fn of_sequence(sequence: &Sequence, source: PoseSource) -> Result<Self, DbError> {
        Ok(Self {
            first_frame: first_frame(sequence),
            camera: sequence.setup.to_toml(&sequence.folder)?,
            field: sequence.field.to_toml(&sequence.folder)?,
            ..Self::new(&sequence.name, &sequence.setup, &sequence.field, source)?
        })
    }
}

/// What tells a sequence from others of its name: all that is known of its first frame but the picture.
fn first_frame(sequence: &Sequence) -> String {
    let Some(frame) = sequence.frames.first() else { return String::new() };
    let odometry =
        frame.odometry.map_or(String::new(), |pose| format!("{},{},{}", pose.x_m, pose.y_m, pose.yaw_rad));
    let image = frame.image.display();
    format!("{},{image},{odometry},{},{}", frame.timestamp_s, frame.pitch_rad, frame.roll_rad)
}

/// An image on its way into the database.
#[derive(Debug, Clone, Copy)]
pub struct NewImage<'a> {
    /// Number of the frame in its recording, from 0: what recognises it.
    pub frame_index: usize,
    /// When it was taken, by its recording's clock, seconds.
    pub timestamp_s: f64,
    /// The file's name, relative to the recording's folder; any name where there is no file.
    pub file_name: &'a str,
    /// Where it was taken.
    pub estimate: &'a PoseEstimate,
    /// A whole JPEG or PNG in the camera's size.
    pub bytes: &'a [u8],
}

impl NewImage<'_> {
    /// Refuses a pose that no camera can have, and a time that is no number.
    pub(crate) fn check(&self) -> Result<(), DbFault> {
        let frame_index = self.frame_index;
        if !self.estimate.is_possible() {
            return Err(DbFault::PoseImpossible { frame_index });
        }
        if !self.timestamp_s.is_finite() {
            return Err(DbFault::TimeImpossible { frame_index });
        }
        Ok(())
    }
}

/// What became of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Insertion {
    /// It was added.
    Added,
    /// The database held it already.
    AlreadyThere,
}
