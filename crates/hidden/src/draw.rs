//! Effects drawn by id and size.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::{
    effect::{Course, Falloff, Hidden, Light, Mistake},
    error::Error,
    random::Random,
};

impl Hidden {
    /// Returns the effect with this id at `multiple` times its unit size, with a random sign where both signs make sense,
    /// and a random shape where the effect has several. `missing_line` has no size.
    ///
    /// The unit sizes are: k₁ 0.002, principal point 0.5 px, focal length 0.15 %, mount 0.1°, height 4 mm, readout 8 ms,
    /// offset 4 ms, exposure 12 ms, defocus 0.3 px, red and blue ±0.0008, vignetting 0.03, gamma 0.04, black level 0.003,
    /// white balance 0.02, exposure 0.04 EV, illumination 0.04, noise 0.12, field 2.5 cm long, odometry 3 %, 0.6°/s and 0.04
    /// m/m; yaw 0.2°, offset 4 mm, decentring 0.0005, delays 8 ms, sharpening 0.1, glare 0.01, reflectances 3 %, sway 0.15° and
    /// 2 mm, jump 8 ms; dirt 0.1, flicker 0.02, shifted line 1.5 cm, wider line 3 mm, one person, fog 0.01 per metre, waves
    /// 3 mm, dent 0.1 % of the width, one picture. Mistakes have no size.
    pub fn of(id: &str, multiple: f64, random: &mut Random) -> Result<Self, Error> {
        let unknown = || Error::UnknownEffect { id: id.to_owned() };
        geometric(id, multiple, random)
            .or_else(|| photometric(id, multiple, random))
            .or_else(|| odometric(id, multiple, random))
            .or_else(|| relative(id, multiple, random))
            .or_else(|| foreign(id, multiple, random))
            .or_else(|| Mistake::ALL.into_iter().find(|mistake| mistake.id() == id).map(Self::Mistake))
            .ok_or_else(unknown)
    }
}

/// Draws effects of lens, mount, time and field.
fn geometric(id: &str, multiple: f64, random: &mut Random) -> Option<Hidden> {
    let signed = |size: f64, random: &mut Random| random.sign() * size * multiple;
    Some(match id {
        "radial_distortion" => Hidden::RadialDistortion { k: [signed(0.002, random), 0.0, 0.0, 0.0] },
        "principal_point" => {
            let shift = DVec2::from_angle(random.between(0.0, TAU)) * 0.5 * multiple;
            Hidden::PrincipalPoint { dx_px: shift.x, dy_px: shift.y }
        }
        "focal_length" => Hidden::FocalLength { scale: signed(0.0015, random) },
        "mount_pitch" => Hidden::MountPitch { angle_rad: signed(0.1, random).to_radians() },
        "mount_roll" => Hidden::MountRoll { angle_rad: signed(0.1, random).to_radians() },
        "camera_height" => Hidden::CameraHeight { height_m: signed(0.004, random) },
        "rolling_shutter" => Hidden::RollingShutter { readout_s: 0.008 * multiple },
        "time_offset" => Hidden::TimeOffset { offset_s: signed(0.004, random) },
        "field_dimensions" => {
            let length_m = signed(0.025, random);
            Hidden::FieldDimensions { length_m, width_m: length_m * random.between(-0.5, 0.5) }
        }
        _ => return None,
    })
}

/// Draws effects of light and sensor.
fn photometric(id: &str, multiple: f64, random: &mut Random) -> Option<Hidden> {
    let signed = |size: f64, random: &mut Random| random.sign() * size * multiple;
    Some(match id {
        "motion_blur" => Hidden::MotionBlur { exposure_s: 0.012 * multiple },
        "defocus" => Hidden::Defocus { sigma_px: 0.3 * multiple },
        "chromatic_aberration" => {
            let red_scale = signed(0.0008, random);
            Hidden::ChromaticAberration { red_scale, blue_scale: -red_scale * random.between(0.6, 1.2) }
        }
        "vignetting" => {
            let falloff = if random.sign() > 0.0 { Falloff::Quadratic } else { Falloff::Cos4 };
            Hidden::Vignetting { strength: (0.03 * multiple).min(0.95), falloff }
        }
        "tone_curve" => Hidden::ToneCurve { gamma_change: signed(0.04, random) },
        "black_level" => Hidden::BlackLevel { offset: (0.003 * multiple).min(0.5) },
        "white_balance" => {
            Hidden::WhiteBalance { red_gain: signed(0.02, random), blue_gain: signed(0.02, random) }
        }
        "exposure_drift" => {
            Hidden::ExposureDrift { amplitude_ev: signed(0.04, random), course: course(random) }
        }
        "uneven_illumination" => {
            Hidden::UnevenIllumination { strength: (0.04 * multiple).min(0.9), shape: light(random) }
        }
        "sensor_noise" => Hidden::SensorNoise { factor: 0.12 * multiple },
        _ => return None,
    })
}

fn course(random: &mut Random) -> Course {
    if random.sign() > 0.0 {
        return Course::Linear;
    }
    Course::Sine { period_s: random.between(7.0, 9.0), phase_rad: random.between(0.0, TAU) }
}

fn light(random: &mut Random) -> Light {
    if random.sign() > 0.0 {
        return Light::Gradient { direction_rad: random.between(0.0, TAU) };
    }
    let center_m = DVec2::new(random.between(-2.2, 2.2), random.between(-1.4, 1.4));
    Light::Spot { center_m, sigma_m: random.between(1.2, 1.8) }
}

/// Draws effects of the odometry.
fn odometric(id: &str, multiple: f64, random: &mut Random) -> Option<Hidden> {
    let signed = |size: f64, random: &mut Random| random.sign() * size * multiple;
    Some(match id {
        "odometry_scale" => Hidden::OdometryScale { scale: signed(0.03, random) },
        "odometry_yaw_drift" => Hidden::OdometryYawDrift { rate_rad_per_s: signed(0.6, random).to_radians() },
        "odometry_lateral_slip" => Hidden::OdometryLateralSlip { slip_m_per_m: signed(0.04, random) },
        _ => return None,
    })
}

/// Draws effects between the camera and what the files say of its place, times and surroundings.
fn relative(id: &str, multiple: f64, random: &mut Random) -> Option<Hidden> {
    let signed = |size: f64, random: &mut Random| random.sign() * size * multiple;
    Some(match id {
        "camera_yaw" => Hidden::CameraYaw { angle_rad: signed(0.2, random).to_radians() },
        "camera_offset" => {
            let offset_m = DVec2::from_angle(random.between(0.0, TAU)) * 0.004 * multiple;
            Hidden::CameraOffset { forward_m: offset_m.x, left_m: offset_m.y, up_m: 0.0 }
        }
        "tangential_distortion" => {
            let p = DVec2::from_angle(random.between(0.0, TAU)) * 0.0005 * multiple;
            Hidden::TangentialDistortion { p1: p.x, p2: p.y }
        }
        "odometry_delay" => Hidden::OdometryDelay { delay_s: 0.008 * multiple },
        "imu_delay" => Hidden::ImuDelay { delay_s: 0.008 * multiple },
        "sharpening" => Hidden::Sharpening { amount: 0.1 * multiple, radius_px: random.between(0.8, 1.6) },
        "veiling_glare" => Hidden::VeilingGlare { share: 0.01 * multiple },
        "carpet_reflectance" => Hidden::CarpetReflectance { change: signed(0.03, random).max(-0.9) },
        "line_reflectance" => Hidden::LineReflectance { change: signed(0.03, random).max(-0.9) },
        "gait_sway" => {
            Hidden::GaitSway { pitch_rad: signed(0.15, random).to_radians(), height_m: signed(0.002, random) }
        }
        "clock_jump" => Hidden::ClockJump { jump_s: signed(0.008, random) },
        _ => return None,
    })
}

/// Draws effects that no library contains.
fn foreign(id: &str, multiple: f64, random: &mut Random) -> Option<Hidden> {
    // The centre lies in the lower half, where the carpet is visible.
    let place = |random: &mut Random| DVec2::new(random.between(0.25, 0.75), random.between(0.55, 0.8));
    Some(match id {
        "lens_dirt" => Hidden::LensDirt {
            opacity: (0.1 * multiple).min(0.95),
            center: place(random),
            sigma: random.between(0.05, 0.09),
        },
        "flicker_bands" => Hidden::FlickerBands {
            amplitude: (0.02 * multiple).min(0.9),
            bands: random.between(1.5, 3.5),
            roll: random.between(0.15, 0.85),
        },
        "missing_line" => Hidden::MissingLine { positive_x: random.sign() > 0.0 },
        "shifted_line" => Hidden::ShiftedLine { shift_m: random.sign() * 0.015 * multiple },
        "moving_people" => Hidden::MovingPeople { count: multiple.round().clamp(1.0, 8.0) as u32 },
        "fog" => Hidden::Fog { extinction_per_m: 0.01 * multiple },
        "wavy_ground" => Hidden::WavyGround {
            amplitude_m: 0.003 * multiple,
            wavelength_m: random.between(1.5, 3.0),
            angles_rad: [random.between(0.0, TAU), random.between(0.0, TAU)],
        },
        "lens_dent" => Hidden::LensDent {
            shift: DVec2::from_angle(random.between(0.0, TAU)) * 0.001 * multiple,
            center: place(random),
            sigma: random.between(0.06, 0.11),
        },
        "wide_line" => Hidden::WideLine { width_m: 0.003 * multiple },
        "lost_frames" => Hidden::LostFrames { count: multiple.round().clamp(1.0, 20.0) as u32 },
        "doubled_frames" => Hidden::DoubledFrames { count: multiple.round().clamp(1.0, 20.0) as u32 },
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{FOREIGN, LIBRARY, MISTAKES};

    #[test]
    fn every_id_makes_an_effect_of_that_id() {
        let mut random = Random::new(1);
        for id in LIBRARY.iter().chain(&FOREIGN).chain(&MISTAKES) {
            assert_eq!(Hidden::of(id, 1.0, &mut random).unwrap().id(), *id);
        }
        let error = Hidden::of("gravity", 1.0, &mut random).unwrap_err();
        assert!(error.to_string().contains("gravity"));
    }
}
