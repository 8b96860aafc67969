//! Effects that can be hidden in a recording, by physical size.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::{error::Error, random::Random};

/// Ids of the effects that a library of effects should contain.
pub const LIBRARY: [&str; 22] = [
    "radial_distortion",
    "principal_point",
    "focal_length",
    "mount_pitch",
    "mount_roll",
    "camera_height",
    "rolling_shutter",
    "time_offset",
    "motion_blur",
    "defocus",
    "chromatic_aberration",
    "vignetting",
    "tone_curve",
    "black_level",
    "white_balance",
    "exposure_drift",
    "uneven_illumination",
    "sensor_noise",
    "field_dimensions",
    "odometry_scale",
    "odometry_yaw_drift",
    "odometry_lateral_slip",
];

/// Ids of the effects that no library contains: they must be noticed and not be given another effect's name.
pub const FOREIGN: [&str; 8] = [
    "lens_dirt",
    "flicker_bands",
    "missing_line",
    "shifted_line",
    "moving_people",
    "fog",
    "wavy_ground",
    "lens_dent",
];

/// Falloff of the light towards the corners.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Falloff {
    /// Proportional to the square of the distance from the principal point.
    Quadratic,
    /// Falloff as cos⁴ of the angle in a camera whose corners are at 45°, scaled to the same loss in the corners.
    Cos4,
}

/// Exposure over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Course {
    /// Linear from minus to plus the amplitude, from the first picture to the last.
    Linear,
    /// Sine with this period and this phase at time 0.
    Sine {
        /// Period, seconds.
        period_s: f64,
        /// Phase, radians.
        phase_rad: f64,
    },
}

/// Illumination of the field; its mean over the field is 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// Linear in a direction of the world, rising by the strength every half length of the field.
    Gradient {
        /// Direction, counter-clockwise from +x, radians.
        direction_rad: f64,
    },
    /// Bright Gaussian spot whose peak is higher than its surroundings by the strength.
    Spot {
        /// Centre in the world, metres.
        center_m: DVec2,
        /// Standard deviation, metres.
        sigma_m: f64,
    },
}

/// Effect that the files beside the pictures do not mention.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hidden {
    /// The true lens has the nominal coefficients plus `k`.
    RadialDistortion {
        /// Changes of k₁ … k₄.
        k: [f64; 4],
    },
    /// The true principal point is offset from the nominal one.
    PrincipalPoint {
        /// Offset to the right, pixels.
        dx_px: f64,
        /// Offset down, pixels.
        dy_px: f64,
    },
    /// The true focal length is the nominal one times 1 + `scale`.
    FocalLength {
        /// Change as a fraction.
        scale: f64,
    },
    /// The true optical axis is turned down in the camera frame.
    MountPitch {
        /// Angle, radians.
        angle_rad: f64,
    },
    /// The true camera is turned about its optical axis, with its x axis towards its y axis, after any pitch.
    MountRoll {
        /// Angle, radians.
        angle_rad: f64,
    },
    /// The true camera is higher.
    CameraHeight {
        /// Additional height, metres.
        height_m: f64,
    },
    /// Row v is exposed at t + readout · (v / (rows − 1) − 0.5).
    RollingShutter {
        /// Time from the first row to the last, seconds.
        readout_s: f64,
    },
    /// The robot's pictures, odometry, IMU and joints are taken at t + offset; the reference poses at t.
    TimeOffset {
        /// Offset, seconds.
        offset_s: f64,
    },
    /// Light is collected while the camera moves, in an interval centred at the picture's time.
    MotionBlur {
        /// Exposure time, seconds.
        exposure_s: f64,
    },
    /// Each point becomes an evenly lit disc in addition to the nominal blur.
    Defocus {
        /// Standard deviation per axis, half the disc's radius, pixels.
        sigma_px: f64,
    },
    /// Red and blue are magnified about the principal point by 1 + scale.
    ChromaticAberration {
        /// Scale of red relative to green.
        red_scale: f64,
        /// Scale of blue relative to green.
        blue_scale: f64,
    },
    /// Light is lost towards the corners.
    Vignetting {
        /// Fraction lost at a distance from the principal point of half the picture's diagonal.
        strength: f64,
        /// Shape of the falloff.
        falloff: Falloff,
    },
    /// Pixel values are encoded with another gamma.
    ToneCurve {
        /// Change of the nominal gamma.
        gamma_change: f64,
    },
    /// A linear value v becomes v (1 − offset) + offset before encoding.
    BlackLevel {
        /// Offset as a fraction of full scale.
        offset: f64,
    },
    /// Red and blue are amplified by 1 + gain, in linear light.
    WhiteBalance {
        /// Gain of red.
        red_gain: f64,
        /// Gain of blue.
        blue_gain: f64,
    },
    /// Exposure changes over time: linear values are multiplied by 2 to the power of its course.
    ExposureDrift {
        /// Amplitude, stops.
        amplitude_ev: f64,
        /// Course over time.
        course: Course,
    },
    /// The hall is unevenly lit.
    UnevenIllumination {
        /// Strength as a fraction.
        strength: f64,
        /// Shape of the illumination.
        shape: Light,
    },
    /// The standard deviation of the noise is 1 + factor times the nominal one.
    SensorNoise {
        /// Factor as a fraction.
        factor: f64,
    },
    /// The true field is larger; goals and goal areas move with the goal lines.
    FieldDimensions {
        /// Additional length, metres.
        length_m: f64,
        /// Additional width, metres.
        width_m: f64,
    },
    /// The odometry measures distances times 1 + scale.
    OdometryScale {
        /// Scale as a fraction.
        scale: f64,
    },
    /// The odometry's heading drifts.
    OdometryYawDrift {
        /// Drift rate, radians per second.
        rate_rad_per_s: f64,
    },
    /// The odometry's step to the left grows by this slip for each metre forward.
    OdometryLateralSlip {
        /// Slip, metres per metre.
        slip_m_per_m: f64,
    },
    /// Dirt on the lens: a blurred dark patch at a fixed place in the picture, transmitting 1 − opacity at its centre.
    LensDirt {
        /// Opacity as a fraction.
        opacity: f64,
        /// Centre, as fractions of the picture's width and height.
        center: DVec2,
        /// Standard deviation, as a fraction of the picture's width.
        sigma: f64,
    },
    /// Brightness bands from mains-powered lamps, which roll from picture to picture.
    FlickerBands {
        /// Amplitude as a fraction.
        amplitude: f64,
        /// Number of bands over the picture's height.
        bands: f64,
        /// Shift from one picture to the next, in bands.
        roll: f64,
    },
    /// One goal area is not painted.
    MissingLine {
        /// Whether the missing area is the one at +x, else the one at −x.
        positive_x: bool,
    },
    /// The halfway line is off the middle.
    ShiftedLine {
        /// Shift towards +x, metres.
        shift_m: f64,
    },
    /// Dark upright figures walk across the field.
    MovingPeople {
        /// Number of people, at most 8.
        count: u32,
    },
    /// Scattered light: a grey veil that grows with distance.
    Fog {
        /// Extinction per metre.
        extinction_per_m: f64,
    },
    /// The ground is not flat.
    WavyGround {
        /// Amplitude of the waves, metres.
        amplitude_m: f64,
        /// Wavelength, crest to crest, metres.
        wavelength_m: f64,
        /// Direction and phase of the waves, radians.
        angles_rad: [f64; 2],
    },
    /// The lens has a dent: one part of the picture is displaced.
    LensDent {
        /// Displacement at the centre, as fractions of the picture's width.
        shift: DVec2,
        /// Centre, as fractions of the picture's width and height.
        center: DVec2,
        /// Standard deviation, as a fraction of the picture's width.
        sigma: f64,
    },
}

impl Hidden {
    /// Returns the effect's id, one of [`LIBRARY`] or [`FOREIGN`].
    pub fn id(&self) -> &'static str {
        match self {
            Self::RadialDistortion { .. } => "radial_distortion",
            Self::PrincipalPoint { .. } => "principal_point",
            Self::FocalLength { .. } => "focal_length",
            Self::MountPitch { .. } => "mount_pitch",
            Self::MountRoll { .. } => "mount_roll",
            Self::CameraHeight { .. } => "camera_height",
            Self::RollingShutter { .. } => "rolling_shutter",
            Self::TimeOffset { .. } => "time_offset",
            Self::MotionBlur { .. } => "motion_blur",
            Self::Defocus { .. } => "defocus",
            Self::ChromaticAberration { .. } => "chromatic_aberration",
            Self::Vignetting { .. } => "vignetting",
            Self::ToneCurve { .. } => "tone_curve",
            Self::BlackLevel { .. } => "black_level",
            Self::WhiteBalance { .. } => "white_balance",
            Self::ExposureDrift { .. } => "exposure_drift",
            Self::UnevenIllumination { .. } => "uneven_illumination",
            Self::SensorNoise { .. } => "sensor_noise",
            Self::FieldDimensions { .. } => "field_dimensions",
            Self::OdometryScale { .. } => "odometry_scale",
            Self::OdometryYawDrift { .. } => "odometry_yaw_drift",
            Self::OdometryLateralSlip { .. } => "odometry_lateral_slip",
            Self::LensDirt { .. } => "lens_dirt",
            Self::FlickerBands { .. } => "flicker_bands",
            Self::MissingLine { .. } => "missing_line",
            Self::ShiftedLine { .. } => "shifted_line",
            Self::MovingPeople { .. } => "moving_people",
            Self::Fog { .. } => "fog",
            Self::WavyGround { .. } => "wavy_ground",
            Self::LensDent { .. } => "lens_dent",
        }
    }

    /// Returns the effect with this id at `multiple` times its unit size, with a random sign where both signs make sense,
    /// and a random shape where the effect has several. `missing_line` has no size.
    ///
    /// The unit sizes are: k₁ 0.002, principal point 0.5 px, focal length 0.15 %, mount 0.1°, height 4 mm, readout 8 ms,
    /// offset 4 ms, exposure 12 ms, defocus 0.3 px, red and blue ±0.0008, vignetting 0.03, gamma 0.04, black level 0.003,
    /// white balance 0.02, exposure 0.04 EV, illumination 0.04, noise 0.12, field 2.5 cm long, odometry 3 %, 0.6°/s and 0.04
    /// m/m; dirt 0.1, flicker 0.02, shifted line 1.5 cm, one person, fog 0.01 per metre, waves 3 mm, dent 0.1 % of the
    /// width.
    pub fn of(id: &str, multiple: f64, random: &mut Random) -> Result<Self, Error> {
        let unknown = || Error::UnknownEffect { id: id.to_owned() };
        geometric(id, multiple, random)
            .or_else(|| photometric(id, multiple, random))
            .or_else(|| odometric(id, multiple, random))
            .or_else(|| foreign(id, multiple, random))
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
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_id_makes_an_effect_of_that_id() {
        let mut random = Random::new(1);
        for id in LIBRARY.iter().chain(&FOREIGN) {
            assert_eq!(Hidden::of(id, 1.0, &mut random).unwrap().id(), *id);
        }
        let error = Hidden::of("gravity", 1.0, &mut random).unwrap_err();
        assert!(error.to_string().contains("gravity"));
    }
}
