//! True values: the nominal values with the hidden effects.

use glam::DVec2;
use reality_sim_core::field::FieldDimensions;

use crate::{
    effect::{Course, Falloff, Hidden, Light, Mistake},
    lens::Lens,
    nominal::Nominal,
    pattern::Pattern,
    rig::Rig,
};

/// Camera, hall and odometry as they are. Effects of one kind add up.
#[derive(Debug, Clone)]
pub struct Truth {
    /// The lens for green light.
    pub lens: Lens,
    /// Magnification of red, green, blue.
    pub magnification: [f64; 3],
    /// Displacements in parts of the picture.
    pub dents: Vec<Patch>,
    /// Place of the camera relative to the believed one, without the sway of the gait.
    pub mount: Rig,
    /// Sway of the gait that the believed poses lack: amplitudes of the pitch, radians, and of the height, metres.
    pub sway: [f64; 2],
    /// Readout time from the first row to the last, seconds.
    pub readout_s: f64,
    /// Offset of the robot's clock, seconds.
    pub offset_s: f64,
    /// Jump of the pictures' clock in the middle, seconds.
    pub jump_s: f64,
    /// Number of pictures lost in the middle.
    pub lost: usize,
    /// Number of pictures stored twice.
    pub doubled: usize,
    /// Delay of the odometry, seconds.
    pub odometry_delay_s: f64,
    /// Delay of IMU and joints, seconds.
    pub imu_delay_s: f64,
    /// Exposure time, seconds.
    pub exposure_s: f64,
    /// Standard deviation of the defocus disc, pixels; squares add up.
    pub defocus_px: f64,
    /// Losses of light towards the corners.
    pub vignettes: Vec<(f64, Falloff)>,
    /// Dark patches of dirt: the first number of the amplitude is the opacity.
    pub dirt: Vec<Patch>,
    /// Flicker: amplitude, bands over the height, shift from picture to picture in bands.
    pub flicker: Vec<[f64; 3]>,
    /// Gains of red, green, blue.
    pub gains: [f64; 3],
    /// Courses of the exposure: amplitude in stops, and shape.
    pub drifts: Vec<(f64, Course)>,
    /// Change of the nominal gamma.
    pub gamma_change: f64,
    /// Black level, linear.
    pub black_level: f64,
    /// Ratio of the noise's standard deviation to the nominal one.
    pub noise: f64,
    /// Unsharp masks: amount, and standard deviation in pixels.
    pub sharpening: Vec<[f64; 2]>,
    /// Share of the picture's mean light that is added everywhere.
    pub glare: f64,
    /// Factors on the reflectance of carpet and lines.
    pub reflectance: [f64; 2],
    /// Mistakes in the files.
    pub mistakes: Vec<Mistake>,
    /// Illumination of the hall: strength and shape.
    pub lights: Vec<(f64, Light)>,
    /// Extinction per metre.
    pub extinction_per_m: f64,
    /// Waves of the ground: amplitude, waves per metre in x and y, phase.
    pub waves: Vec<[f64; 4]>,
    /// Dimensions of the field.
    pub field: FieldDimensions,
    /// Paint on the ground.
    pub pattern: Pattern,
    /// Number of people on the field.
    pub people: u32,
    /// Factor on the odometry's distances.
    pub odometry_scale: f64,
    /// Drift of the odometry's heading, radians per second.
    pub odometry_drift_rad_per_s: f64,
    /// Slip of the odometry to the left, metres per metre forward.
    pub odometry_slip: f64,
}

/// Gaussian patch of the picture.
#[derive(Debug, Clone, Copy)]
pub struct Patch {
    /// Centre, pixels.
    pub center_px: DVec2,
    /// Standard deviation, pixels.
    pub sigma_px: f64,
    /// Value at the centre.
    pub amplitude: DVec2,
}

impl Patch {
    /// Returns the value at a pixel.
    pub fn at(&self, pixel: DVec2) -> DVec2 {
        let square = pixel.distance_squared(self.center_px) / (self.sigma_px * self.sigma_px);
        self.amplitude * (-0.5 * square).exp()
    }
}

impl Truth {
    /// Applies these effects to the nominal values.
    pub fn new(nominal: &Nominal, effects: &[Hidden]) -> Self {
        let mut truth = Self::nothing_hidden(nominal);
        let size = nominal.size.map(f64::from).into();
        for effect in effects {
            truth.hide_in_camera(effect, size);
            truth.hide_in_light(effect, size);
            truth.hide_in_hall(effect);
            truth.hide_in_files(effect);
            truth.hide_between(effect);
        }
        truth.pattern.resize(&truth.field);
        truth
    }

    fn nothing_hidden(nominal: &Nominal) -> Self {
        Self {
            lens: nominal.lens,
            magnification: [1.0; 3],
            dents: Vec::new(),
            mount: Rig::default(),
            sway: [0.0; 2],
            readout_s: 0.0,
            offset_s: 0.0,
            jump_s: 0.0,
            lost: 0,
            doubled: 0,
            odometry_delay_s: 0.0,
            imu_delay_s: 0.0,
            exposure_s: 0.0,
            defocus_px: 0.0,
            vignettes: Vec::new(),
            dirt: Vec::new(),
            flicker: Vec::new(),
            gains: [1.0; 3],
            drifts: Vec::new(),
            gamma_change: 0.0,
            black_level: 0.0,
            noise: 1.0,
            sharpening: Vec::new(),
            glare: 0.0,
            reflectance: [1.0; 2],
            mistakes: Vec::new(),
            lights: Vec::new(),
            extinction_per_m: 0.0,
            waves: Vec::new(),
            field: nominal.field.clone(),
            pattern: Pattern::new(&nominal.field),
            people: 0,
            odometry_scale: 1.0,
            odometry_drift_rad_per_s: 0.0,
            odometry_slip: 0.0,
        }
    }

    /// Returns the place of the camera relative to the believed one at a phase of the gait.
    pub fn rig(&self, gait_phase_rad: f64) -> Rig {
        let mut rig = self.mount;
        if self.sway != [0.0; 2] {
            let [pitch_rad, height_m] = self.sway;
            rig.pitch_rad += pitch_rad * (2.0 * gait_phase_rad + 0.7).sin();
            rig.raised_m += height_m * (2.0 * gait_phase_rad).cos();
        }
        rig
    }

    /// Applies effects of the lens and of the exposure.
    fn hide_in_camera(&mut self, effect: &Hidden, size_px: DVec2) {
        match *effect {
            Hidden::RadialDistortion { k } => self.lens.bend.add(k),
            Hidden::TangentialDistortion { p1, p2 } => {
                self.lens.p = [self.lens.p[0] + p1, self.lens.p[1] + p2];
            }
            Hidden::PrincipalPoint { dx_px, dy_px } => self.lens.center_px += DVec2::new(dx_px, dy_px),
            Hidden::FocalLength { scale } => self.lens.focal_px *= 1.0 + scale,
            Hidden::RollingShutter { readout_s } => self.readout_s += readout_s,
            Hidden::MotionBlur { exposure_s } => self.exposure_s += exposure_s,
            Hidden::Defocus { sigma_px } => self.defocus_px = self.defocus_px.hypot(sigma_px),
            Hidden::ChromaticAberration { red_scale, blue_scale } => {
                self.magnification[0] *= 1.0 + red_scale;
                self.magnification[2] *= 1.0 + blue_scale;
            }
            Hidden::LensDent { shift, center, sigma } => self.dents.push(Patch {
                center_px: center * size_px,
                sigma_px: sigma * size_px.x,
                amplitude: shift * size_px.x,
            }),
            _ => {}
        }
    }

    /// Applies effects between the light behind the lens and the pixel values.
    fn hide_in_light(&mut self, effect: &Hidden, size_px: DVec2) {
        match *effect {
            Hidden::Vignetting { strength, falloff } => self.vignettes.push((strength, falloff)),
            Hidden::ToneCurve { gamma_change } => self.gamma_change += gamma_change,
            Hidden::BlackLevel { offset } => self.black_level += offset,
            Hidden::WhiteBalance { red_gain, blue_gain } => {
                self.gains[0] *= 1.0 + red_gain;
                self.gains[2] *= 1.0 + blue_gain;
            }
            Hidden::ExposureDrift { amplitude_ev, course } => self.drifts.push((amplitude_ev, course)),
            Hidden::SensorNoise { factor } => self.noise *= 1.0 + factor,
            Hidden::Sharpening { amount, radius_px } => self.sharpening.push([amount, radius_px]),
            Hidden::VeilingGlare { share } => self.glare += share,
            Hidden::FlickerBands { amplitude, bands, roll } => self.flicker.push([amplitude, bands, roll]),
            Hidden::LensDirt { opacity, center, sigma } => self.dirt.push(Patch {
                center_px: center * size_px,
                sigma_px: sigma * size_px.x,
                amplitude: DVec2::new(opacity, 0.0),
            }),
            _ => {}
        }
    }

    /// Applies effects of field, light and air.
    fn hide_in_hall(&mut self, effect: &Hidden) {
        match *effect {
            Hidden::UnevenIllumination { strength, shape } => self.lights.push((strength, shape)),
            Hidden::FieldDimensions { length_m, width_m } => {
                self.field.length_m += length_m;
                self.field.width_m += width_m;
            }
            Hidden::MissingLine { positive_x } => self.pattern.goal_areas[usize::from(positive_x)] = false,
            Hidden::ShiftedLine { shift_m } => self.pattern.halfway_shift_m += shift_m as f32,
            Hidden::WideLine { width_m } => self.pattern.halfway_extra_m += width_m as f32,
            Hidden::CarpetReflectance { change } => self.reflectance[0] *= 1.0 + change,
            Hidden::LineReflectance { change } => self.reflectance[1] *= 1.0 + change,
            Hidden::MovingPeople { count } => self.people = (self.people + count).min(8),
            Hidden::Fog { extinction_per_m } => self.extinction_per_m += extinction_per_m,
            Hidden::WavyGround { amplitude_m, wavelength_m, angles_rad: [direction_rad, phase_rad] } => {
                let waves = DVec2::from_angle(direction_rad) * std::f64::consts::TAU / wavelength_m;
                self.waves.push([amplitude_m, waves.x, waves.y, phase_rad]);
            }
            _ => {}
        }
    }

    /// Applies effects of odometry and clocks, and mistakes.
    fn hide_in_files(&mut self, effect: &Hidden) {
        match *effect {
            Hidden::OdometryScale { scale } => self.odometry_scale *= 1.0 + scale,
            Hidden::OdometryYawDrift { rate_rad_per_s } => self.odometry_drift_rad_per_s += rate_rad_per_s,
            Hidden::OdometryLateralSlip { slip_m_per_m } => self.odometry_slip += slip_m_per_m,
            Hidden::TimeOffset { offset_s } => self.offset_s += offset_s,
            Hidden::ClockJump { jump_s } => self.jump_s += jump_s,
            Hidden::OdometryDelay { delay_s } => self.odometry_delay_s += delay_s,
            Hidden::ImuDelay { delay_s } => self.imu_delay_s += delay_s,
            Hidden::LostFrames { count } => self.lost += count as usize,
            Hidden::DoubledFrames { count } => self.doubled += count as usize,
            Hidden::Mistake(mistake) => self.mistakes.push(mistake),
            _ => {}
        }
    }

    /// Applies effects between the believed camera and the true one.
    fn hide_between(&mut self, effect: &Hidden) {
        let mount = &mut self.mount;
        match *effect {
            Hidden::MountPitch { angle_rad } => mount.pitch_rad += angle_rad,
            Hidden::MountRoll { angle_rad } => mount.roll_rad += angle_rad,
            Hidden::CameraHeight { height_m } => mount.raised_m += height_m,
            Hidden::CameraYaw { angle_rad } => mount.yaw_rad += angle_rad,
            Hidden::CameraOffset { forward_m, left_m, up_m } => {
                mount.offset_m += DVec2::new(forward_m, left_m);
                mount.raised_m += up_m;
            }
            Hidden::GaitSway { pitch_rad, height_m } => {
                self.sway = [self.sway[0] + pitch_rad, self.sway[1] + height_m];
            }
            _ => {}
        }
    }
}
