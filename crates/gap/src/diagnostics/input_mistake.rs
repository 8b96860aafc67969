//! Mistakes that people make when they write a recording's files.

use serde::{Deserialize, Serialize};

/// Way in which a file was meant to be read and was not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum InputMistake {
    /// Places of the reference poses are in millimetres.
    PosesInMillimeters,
    /// Places of the reference poses are in centimetres.
    PosesInCentimeters,
    /// Reference poses are camera from world.
    PosesCameraFromWorld,
    /// Quaternions of the reference poses begin with w.
    PosesRealPartFirst,
    /// Rotations of the reference poses are those of axes ahead, left and up.
    PosesOfBodyAxes,
    /// x and y of the reference poses are swapped, with their headings.
    PosesSwappedAxes,
    /// x and y of the reference poses are swapped, their headings are not.
    PosesSwappedPlaces,
    /// y of the reference poses is positive to the right.
    PosesToTheRight,
    /// y of the reference poses has the wrong sign, their headings have not.
    PosesWrongSignOfY,
    /// z of the reference poses is positive down.
    PosesDown,
    /// Pitch of the reference poses is positive up.
    PosesPitchUp,
    /// Roll of the reference poses is positive counter-clockwise.
    PosesRollCounterClockwise,
    /// Pictures are mirrored.
    PicturesMirrored,
    /// Pictures are upside down.
    PicturesUpsideDown,
    /// Length and width of the field are swapped.
    FieldSwapped,
    /// The field is the one of another league: the preset with this number.
    FieldOfAnotherLeague(usize),
    /// The focal length of the camera file is not that of the pictures.
    FocalLength {
        /// Focal length of the file, percent of that of the pictures.
        percent: u32,
    },
    /// The camera file was made for pictures of another size.
    CameraOfOtherSize {
        /// Width of those pictures, percent of the width of these.
        percent: u32,
    },
    /// Pitch and roll by joints and IMU are in degrees.
    AnglesInDegrees,
    /// Pitch by joints and IMU is positive up.
    PitchUp,
    /// Roll by joints and IMU is positive counter-clockwise.
    RollCounterClockwise,
    /// Pitch and roll by joints and IMU are swapped.
    AnglesSwapped,
    /// Places of the odometry are in millimetres.
    OdometryInMillimeters,
    /// Headings of the odometry are in degrees.
    OdometryInDegrees,
    /// x and y of the odometry are swapped.
    OdometrySwapped,
    /// y and heading of the odometry are positive to the right.
    OdometryToTheRight,
}
