//! The library of effects, one file each.

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
mod principal_point;
mod radial_distortion;
mod rolling_shutter;
mod sensor_noise;
mod time_offset;
mod tone_curve;
mod uneven_illumination;
mod vignetting;
mod white_balance;

use glam::DQuat;
use reality_sim_core::{
    camera::{Camera, Distortion, InvalidCamera},
    pose::CameraPose,
};

use crate::effect::Effect;

/// In the order in which a chain applies those of one stage.
const LIBRARY: [&dyn Effect; 22] = [
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
    &LIBRARY
}

/// The effect with this id; `None` for one that is not known.
pub fn effect(id: &str) -> Option<&'static dyn Effect> {
    LIBRARY.iter().copied().find(|effect| effect.id() == id)
}

/// A pose turned about the camera's own axes.
fn turned(pose: CameraPose, true_from_nominal: DQuat) -> CameraPose {
    let rotation = pose.quaternion_world_from_camera() * true_from_nominal;
    CameraPose::from_world_from_camera(pose.position_in_world(), rotation)
}

/// A camera with other intrinsics, as wide as before: up to where its distortion stops growing, or to the limit that
/// it was given.
fn with_intrinsics(
    camera: &Camera,
    intrinsics: [f64; 4],
    distortion: Distortion,
) -> Result<Camera, InvalidCamera> {
    let size = [camera.width, camera.height];
    let nominal = [camera.fx, camera.fy, camera.cx, camera.cy];
    let is_limited = camera.max_angle_rad() < Camera::new(size, nominal, camera.distortion)?.max_angle_rad();
    let changed = Camera::new(size, intrinsics, distortion)?.with_image_circle(camera.image_circle);
    if is_limited {
        let limit_rad = camera.max_angle_rad().min(changed.max_angle_rad());
        changed.with_max_angle_rad(limit_rad)
    } else {
        Ok(changed)
    }
}
