//! Hidden effects as parameters of the library's effects.

use reality_sim_hidden::{Falloff, Hidden};

/// Returns the number that stands for an effect's size.
pub fn main_size(hidden: &Hidden) -> f64 {
    match hidden {
        Hidden::SensorNoise { factor } => *factor,
        Hidden::ExposureDrift { amplitude_ev, .. } => *amplitude_ev,
        Hidden::UnevenIllumination { strength, .. } => *strength,
        Hidden::PrincipalPoint { dx_px, dy_px } => dx_px.hypot(*dy_px),
        Hidden::CameraOffset { forward_m, left_m, .. } => forward_m.hypot(*left_m),
        Hidden::TangentialDistortion { p1, p2 } => p1.hypot(*p2),
        Hidden::Sharpening { amount, .. } => *amount,
        Hidden::VeilingGlare { share } => *share,
        Hidden::CarpetReflectance { change } | Hidden::LineReflectance { change } => *change,
        Hidden::GaitSway { pitch_rad, .. } => *pitch_rad,
        Hidden::FieldDimensions { length_m, width_m } => length_m.hypot(*width_m),
        Hidden::ChromaticAberration { red_scale, blue_scale } => red_scale.abs().max(blue_scale.abs()),
        Hidden::WhiteBalance { red_gain, blue_gain } => red_gain.abs().max(blue_gain.abs()),
        _ => parameters(hidden).first().map_or(1.0, |(_, value)| *value),
    }
}

/// Returns the size of a hidden effect that corresponds to a value of the library's parameter, with a sensor whose noise has
/// this variance at a linear value of 1.
pub fn hidden_size(hidden: &Hidden, parameter: f64, noise_shot: f64) -> f64 {
    match hidden {
        // The library's parameter is added to the variance, whereas the hidden factor multiplies the standard deviation.
        Hidden::SensorNoise { .. } => (1.0 + parameter / noise_shot).sqrt() - 1.0,
        _ => parameter,
    }
}

/// Returns the parameters whose true value is known, by their names in the library.
pub fn parameters(hidden: &Hidden) -> Vec<(&'static str, f64)> {
    match *hidden {
        Hidden::RadialDistortion { k } => {
            // A coefficient that is not hidden has no true value to compare with.
            let all = ["k1", "k2", "k3", "k4"].into_iter().zip(k);
            all.filter(|(_, change)| *change != 0.0).collect()
        }
        Hidden::PrincipalPoint { dx_px, dy_px } => vec![("x_px", dx_px), ("y_px", dy_px)],
        Hidden::FocalLength { scale } => vec![("scale", scale)],
        Hidden::MountPitch { angle_rad } => vec![("pitch_rad", angle_rad)],
        Hidden::MountRoll { angle_rad } => vec![("roll_rad", angle_rad)],
        Hidden::CameraHeight { height_m } => vec![("height_m", height_m)],
        Hidden::RollingShutter { readout_s } => vec![("readout_s", readout_s)],
        Hidden::TimeOffset { offset_s } => vec![("offset_s", offset_s)],
        Hidden::MotionBlur { exposure_s } => vec![("exposure_s", exposure_s)],
        Hidden::Defocus { sigma_px } => vec![("sigma_px", sigma_px)],
        Hidden::ChromaticAberration { red_scale, blue_scale } => {
            vec![("red_scale", red_scale), ("blue_scale", blue_scale)]
        }
        Hidden::Vignetting { strength, .. } => vec![("strength", strength)],
        Hidden::ToneCurve { gamma_change } => vec![("gamma_change", gamma_change)],
        Hidden::BlackLevel { offset } => vec![("offset", offset)],
        Hidden::WhiteBalance { red_gain, blue_gain } => {
            vec![("red_gain", red_gain), ("blue_gain", blue_gain)]
        }
        Hidden::FieldDimensions { length_m, width_m } => {
            vec![("length_m", length_m), ("width_m", width_m)]
        }
        Hidden::OdometryScale { scale } => vec![("scale", scale)],
        Hidden::OdometryYawDrift { rate_rad_per_s } => vec![("rad_per_s", rate_rad_per_s)],
        Hidden::OdometryLateralSlip { slip_m_per_m } => vec![("m_per_m", slip_m_per_m)],
        Hidden::CameraYaw { angle_rad } => vec![("yaw_rad", angle_rad)],
        Hidden::CameraOffset { forward_m, left_m, .. } => {
            vec![("forward_m", forward_m), ("left_m", left_m)]
        }
        Hidden::TangentialDistortion { p1, p2 } => vec![("p1", p1), ("p2", p2)],
        Hidden::OdometryDelay { delay_s } | Hidden::ImuDelay { delay_s } => vec![("delay_s", delay_s)],
        Hidden::ClockJump { jump_s } => vec![("jump_s", jump_s)],
        Hidden::Sharpening { amount, .. } => vec![("amount", amount)],
        Hidden::VeilingGlare { share } => vec![("share", share)],
        Hidden::CarpetReflectance { change } | Hidden::LineReflectance { change } => vec![("change", change)],
        // The other effects have other parameters than those of the library.
        _ => Vec::new(),
    }
}

/// Whether the library's effect with the true parameters makes exactly the same pictures. It does not for blur by a disc,
/// for another radius of the sharpening, nor for a cos⁴ falloff, which the library does not have.
pub fn has_the_librarys_form(hidden: &Hidden) -> bool {
    let is_other = matches!(
        hidden,
        Hidden::Defocus { .. }
            | Hidden::Sharpening { .. }
            | Hidden::Vignetting { falloff: Falloff::Cos4, .. }
    );
    !is_other && !parameters(hidden).is_empty()
}

/// Returns the unit of [`main_size`].
pub fn unit(id: &str) -> &'static str {
    match id {
        "principal_point" | "defocus" => "px",
        "mount_pitch" | "mount_roll" | "camera_yaw" | "gait_sway" => "rad",
        "camera_height" | "field_dimensions" | "camera_offset" => "m",
        "rolling_shutter" | "time_offset" | "motion_blur" | "odometry_delay" | "imu_delay" | "clock_jump" => {
            "s"
        }
        "exposure_drift" => "EV",
        "odometry_yaw_drift" => "rad/s",
        "odometry_lateral_slip" => "m/m",
        _ => "1",
    }
}
