//! The library of effects, one file each, with forward model, description and wording. Other code only knows an effect
//! through this library.

mod adjustments;
mod black_level;
mod camera_height;
mod camera_offset;
mod camera_yaw;
mod carpet_reflectance;
mod chromatic_aberration;
mod clock_jump;
mod defocus;
mod exposure_drift;
mod field_dimensions;
mod focal_length;
mod gait_sway;
mod imu_delay;
mod line_reflectance;
mod motion_blur;
mod mount_pitch;
mod mount_roll;
mod odometry_delay;
mod odometry_lateral_slip;
mod odometry_scale;
mod odometry_yaw_drift;
mod phrases;
mod principal_point;
mod radial_distortion;
mod rolling_shutter;
mod sensor_noise;
mod sharpening;
mod tangential_distortion;
mod time_offset;
mod tone_curve;
mod uneven_illumination;
mod veiling_glare;
mod vignetting;
mod white_balance;

use crate::effect::Effect;

/// All effects; a chain applies the effects of one stage in this order.
const LIBRARY: &[&dyn Effect] = &[
    &field_dimensions::FieldSize,
    &uneven_illumination::UnevenIllumination,
    &carpet_reflectance::CarpetReflectance,
    &line_reflectance::LineReflectance,
    &time_offset::TimeOffset,
    &clock_jump::ClockJump,
    &gait_sway::GaitSway,
    &rolling_shutter::RollingShutter,
    &motion_blur::MotionBlur,
    &camera_yaw::CameraYaw,
    &camera_offset::CameraOffset,
    &mount_pitch::MountPitch,
    &mount_roll::MountRoll,
    &camera_height::CameraHeight,
    &radial_distortion::RadialDistortion,
    &tangential_distortion::TangentialDistortion,
    &focal_length::FocalLength,
    &principal_point::PrincipalPoint,
    &chromatic_aberration::ChromaticAberration,
    &vignetting::Vignetting,
    &veiling_glare::VeilingGlare,
    &defocus::Defocus,
    &white_balance::WhiteBalance,
    &exposure_drift::ExposureDrift,
    &black_level::BlackLevel,
    &sensor_noise::SensorNoise,
    &tone_curve::ToneCurve,
    &sharpening::Sharpening,
    &odometry_scale::OdometryScale,
    &odometry_yaw_drift::OdometryYawDrift,
    &odometry_lateral_slip::OdometryLateralSlip,
    &odometry_delay::OdometryDelay,
    &imu_delay::ImuDelay,
];

/// Effect by which the chain applies the nominal camera's own black level.
pub(crate) const BLACK_LEVEL: &dyn Effect = &black_level::BlackLevel;

/// Returns all known effects, in the order of the stages.
pub fn library() -> &'static [&'static dyn Effect] {
    LIBRARY
}

/// Finds the effect with this id; `None` for an unknown id.
pub fn effect(id: &str) -> Option<&'static dyn Effect> {
    LIBRARY.iter().copied().find(|effect| effect.id() == id)
}
