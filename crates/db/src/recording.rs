//! Data that the images of a recording share, and images to be stored.

use std::path::Path;

use reality_sim_core::{
    field::FieldDimensions,
    sequence::{CameraSetup, Sequence, camera_with_model},
};

use crate::{
    error::{DbError, DbFault},
    record::{PoseEstimate, PoseSource},
};

/// Recording that images belong to: its name, its camera, its field, and the source of its poses.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    pub(crate) name: String,
    /// Text that distinguishes it from other recordings of the same name.
    pub(crate) first_frame: String,
    /// Width and height of its pictures, pixels.
    pub(crate) size: [u32; 2],
    /// Text of its camera's file.
    pub(crate) camera: String,
    /// Text of its field's file.
    pub(crate) field: String,
    pub(crate) source: PoseSource,
}

impl Recording {
    /// Makes a recording that is identified by its name alone, such as one that is being made now. Fails if camera or
    /// field cannot be written as text, for example because a number is not finite.
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

    /// Makes a recording of a folder, identified by its name and its first frame, wherever the folder is.
    pub fn of_sequence(sequence: &Sequence, source: PoseSource) -> Result<Self, DbError> {
        Ok(Self {
            first_frame: first_frame(sequence),
            camera: corrected_camera(sequence)?,
            field: sequence.field.to_toml(&sequence.folder)?,
            ..Self::new(&sequence.name, &sequence.setup, &sequence.field, source)?
        })
    }
}

/// Returns the text of a sequence's camera, with the model by which it was corrected, if there is one.
fn corrected_camera(sequence: &Sequence) -> Result<String, DbError> {
    let camera = sequence.setup.to_toml(&sequence.folder)?;
    Ok(match &sequence.corrected_by {
        Some(model) => camera_with_model(&camera, model),
        None => camera,
    })
}

/// Returns everything that is known of the first frame except the picture: it distinguishes a sequence from others of its
/// name.
fn first_frame(sequence: &Sequence) -> String {
    let Some(frame) = sequence.frames.first() else { return String::new() };
    let odometry =
        frame.odometry.map_or(String::new(), |pose| format!("{},{},{}", pose.x_m, pose.y_m, pose.yaw_rad));
    let image = frame.image.display();
    format!("{},{image},{odometry},{},{}", frame.timestamp_s, frame.pitch_rad, frame.roll_rad)
}

/// Image to be stored in the database.
#[derive(Debug, Clone, Copy)]
pub struct NewImage<'a> {
    /// Number of the frame in its recording, from 0, by which the image is recognised.
    pub frame_index: usize,
    /// Time at which it was taken, by its recording's clock, seconds.
    pub timestamp_s: f64,
    /// Name of the file, relative to the recording's folder; any name if there is no file.
    pub file_name: &'a str,
    /// Pose of the camera when it was taken.
    pub estimate: &'a PoseEstimate,
    /// Complete JPEG or PNG file in the camera's size.
    pub bytes: &'a [u8],
}

impl NewImage<'_> {
    /// Refuses a pose that no camera can have, and a time that is not a finite number.
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

/// Result of inserting an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Insertion {
    /// The image was added.
    Added,
    /// The database held the image with bytes that cannot be decoded, and now holds these.
    Replaced,
    /// The database already held the image.
    AlreadyThere,
}
