//! The library of effects, one file each: its forward model, what it needs and changes, and its words. Nothing else knows it
//! but its place here.

mod adjustments;
mod black_level;
mod camera_height;
mod chromatic_aberration;
mod defocus;
mod exposure_drift;
mod field_dimensions;
mod focal_length;
mod motion_blur;
mod mount_pitch;
mod mount_roll;
mod odometry_lateral_slip;
mod odometry_scale;
mod odometry_yaw_drift;
mod phrases;
mod principal_point;
mod radial_distortion;
mod rolling_shutter;
mod sensor_noise;
mod time_offset;
mod tone_curve;
mod uneven_illumination;
mod vignetting;
mod white_balance;

use crate::effect::Effect;

/// In the order in which a chain applies those of one stage.
const LIBRARY: &[&dyn Effect] = &[
    &field_dimensions::FieldSize,
    &uneven_illumination::UnevenIllumination,
    &time_offset::TimeOffset,
    &rolling_shutter::RollingShutter,
    &motion_blur::MotionBlur,
    &mount_pitch::MountPitch,
    &mount_roll::MountRoll,
    &camera_height::CameraHeight,
    &radial_distortion::RadialDistortion,
    &focal_length::FocalLength,
    &principal_point::PrincipalPoint,
    &chromatic_aberration::ChromaticAberration,
    &vignetting::Vignetting,
    &defocus::Defocus,
    &white_balance::WhiteBalance,
    &exposure_drift::ExposureDrift,
    &black_level::BlackLevel,
    &sensor_noise::SensorNoise,
    &tone_curve::ToneCurve,
    &odometry_scale::OdometryScale,
    &odometry_yaw_drift::OdometryYawDrift,
    &odometry_lateral_slip::OdometryLateralSlip,
];

/// What the chain applies the nominal camera's own black level by.
pub(crate) const BLACK_LEVEL: &dyn Effect = &black_level::BlackLevel;

/// Every effect that is known, in the order of the stages.
pub fn library() -> &'static [&'static dyn Effect] {
    LIBRARY
}

/// The effect with this id; `None` for one that is not known.
pub fn effect(id: &str) -> Option<&'static dyn Effect> {
    LIBRARY.iter().copied().find(|effect| effect.id() == id)
}
