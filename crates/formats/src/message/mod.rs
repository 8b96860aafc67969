//! Messages of robots' logs as typed values: what a message is, is told by the fields that it has.

mod bayer;
mod calibration;
mod header;
mod kind;
mod lens_fit;
mod picture;
mod pixels;
mod rigid;
mod sensors;
mod transforms;

pub use self::{
    calibration::{Calibration, CalibrationFault, ConvertedCamera},
    header::{Header, seconds},
    kind::{MessageKind, Role},
    picture::{Picture, PictureContent},
    pixels::{PixelFault, RawPicture},
    rigid::Rigid,
    sensors::{Attitude, ImuSample, Joint, imu, joints},
    transforms::{NamedTransform, OdometrySample, odometry, poses, transforms},
};
