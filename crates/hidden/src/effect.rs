//! Effects that can be hidden in a recording, by physical size.

use glam::DVec2;

/// Ids of the effects that a library of effects should contain.
pub const LIBRARY: [&str; 33] = [
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
    "camera_yaw",
    "camera_offset",
    "tangential_distortion",
    "odometry_delay",
    "imu_delay",
    "sharpening",
    "veiling_glare",
    "carpet_reflectance",
    "line_reflectance",
    "gait_sway",
    "clock_jump",
];

/// Ids of the effects that no library contains: they must be noticed and not be given another effect's name.
pub const FOREIGN: [&str; 11] = [
    "lens_dirt",
    "flicker_bands",
    "missing_line",
    "shifted_line",
    "moving_people",
    "fog",
    "wavy_ground",
    "lens_dent",
    "wide_line",
    "lost_frames",
    "doubled_frames",
];

/// Ids of the mistakes that people make in the files beside the pictures.
pub const MISTAKES: [&str; 7] = [
    "degrees_for_radians",
    "swapped_axes",
    "negated_axis",
    "millimetres_for_metres",
    "mirrored_pictures",
    "inverted_poses",
    "another_leagues_field",
];

/// Mistake in the files beside the pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mistake {
    /// Pitch and roll in `frames.csv` are in degrees.
    DegreesForRadians,
    /// x and y of the reference poses are swapped.
    SwappedAxes,
    /// y of the reference poses has the other sign.
    NegatedAxis,
    /// Positions of the reference poses are in millimetres.
    MillimetresForMetres,
    /// The pictures are mirrored, left for right.
    MirroredPictures,
    /// The reference poses are camera-from-world.
    InvertedPoses,
    /// `field.toml` is that of another league.
    AnotherLeaguesField,
}

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
    /// The true camera is turned about the vertical, counter-clockwise, against the frame of the reference poses and of the
    /// body.
    CameraYaw {
        /// Angle, radians.
        angle_rad: f64,
    },
    /// The true camera is beside the place that the reference poses give, in the body's frame.
    CameraOffset {
        /// Offset ahead, metres.
        forward_m: f64,
        /// Offset to the left, metres.
        left_m: f64,
        /// Offset upwards, metres.
        up_m: f64,
    },
    /// The true lens is decentred by these coefficients more than the nominal one.
    TangentialDistortion {
        /// Change of p₁.
        p1: f64,
        /// Change of p₂.
        p2: f64,
    },
    /// The odometry that is logged with a picture is older than the picture.
    OdometryDelay {
        /// Delay, seconds.
        delay_s: f64,
    },
    /// Pitch and roll that are logged with a picture are older than the picture.
    ImuDelay {
        /// Delay, seconds.
        delay_s: f64,
    },
    /// The camera sharpens its pictures by an unsharp mask on encoded values.
    Sharpening {
        /// Factor on the difference from the blurred picture.
        amount: f64,
        /// Standard deviation of the blur, pixels.
        radius_px: f64,
    },
    /// Light scattered in the lens: a share of the picture's mean light is added everywhere.
    VeilingGlare {
        /// Share as a fraction.
        share: f64,
    },
    /// The carpet reflects 1 + change times what the files say.
    CarpetReflectance {
        /// Change as a fraction.
        change: f64,
    },
    /// The lines reflect 1 + change times what the files say.
    LineReflectance {
        /// Change as a fraction.
        change: f64,
    },
    /// The true camera pitches and bobs twice in each period of the gait, which the reference poses lack.
    GaitSway {
        /// Amplitude of the pitch, radians.
        pitch_rad: f64,
        /// Amplitude of the height, metres.
        height_m: f64,
    },
    /// Timestamps of the pictures jump in the middle of the recording; all else is joined by timestamp.
    ClockJump {
        /// Jump, seconds.
        jump_s: f64,
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
    /// The halfway line is wider.
    WideLine {
        /// Additional width, metres.
        width_m: f64,
    },
    /// Pictures are lost in the middle of the recording: those after it stand at the lines of earlier ones.
    LostFrames {
        /// Number of pictures.
        count: u32,
    },
    /// Pictures are stored twice, in place of the next: every fifth, until there are enough.
    DoubledFrames {
        /// Number of pictures.
        count: u32,
    },
    /// A mistake in the files.
    Mistake(Mistake),
}

impl Hidden {
    /// Returns the effect's id, one of [`LIBRARY`], [`FOREIGN`] or [`MISTAKES`].
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
            Self::CameraYaw { .. } => "camera_yaw",
            Self::CameraOffset { .. } => "camera_offset",
            Self::TangentialDistortion { .. } => "tangential_distortion",
            Self::OdometryDelay { .. } => "odometry_delay",
            Self::ImuDelay { .. } => "imu_delay",
            Self::Sharpening { .. } => "sharpening",
            Self::VeilingGlare { .. } => "veiling_glare",
            Self::CarpetReflectance { .. } => "carpet_reflectance",
            Self::LineReflectance { .. } => "line_reflectance",
            Self::GaitSway { .. } => "gait_sway",
            Self::ClockJump { .. } => "clock_jump",
            Self::LensDirt { .. } => "lens_dirt",
            Self::FlickerBands { .. } => "flicker_bands",
            Self::MissingLine { .. } => "missing_line",
            Self::ShiftedLine { .. } => "shifted_line",
            Self::MovingPeople { .. } => "moving_people",
            Self::Fog { .. } => "fog",
            Self::WavyGround { .. } => "wavy_ground",
            Self::LensDent { .. } => "lens_dent",
            Self::WideLine { .. } => "wide_line",
            Self::LostFrames { .. } => "lost_frames",
            Self::DoubledFrames { .. } => "doubled_frames",
            Self::Mistake(mistake) => mistake.id(),
        }
    }
}

impl Mistake {
    /// All mistakes, in the order of [`MISTAKES`].
    pub const ALL: [Self; 7] = [
        Self::DegreesForRadians,
        Self::SwappedAxes,
        Self::NegatedAxis,
        Self::MillimetresForMetres,
        Self::MirroredPictures,
        Self::InvertedPoses,
        Self::AnotherLeaguesField,
    ];

    /// Returns the mistake's id.
    pub fn id(self) -> &'static str {
        MISTAKES[self as usize]
    }
}
