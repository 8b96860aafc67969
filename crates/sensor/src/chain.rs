//! The simulated camera: its stages in order, each with the effects that change it.

use glam::{DVec2, DVec3};
use reality_sim_core::{
    camera::Camera,
    field::FieldDimensions,
    pose::{CameraPose, Motion2},
    sequence::{CameraSetup, Photometry},
};

use crate::{
    effect::Stage,
    effects::{BLACK_LEVEL, library},
    model::{Model, ModelError, ModelFault, Used},
    noise::Noise,
    sharpening::{sharpened_amplitude, sharpened_variance_px2},
    surface::Surface,
    tone::Tone,
    trajectory::Trajectory,
};

/// Tolerance of an inverted tone curve, encoded.
const INVERSION_TOLERANCE: f64 = 1e-7;
/// Largest number of steps of an inversion; a few suffice.
const MOST_INVERSION_STEPS: usize = 60;

/// Gamma of a camera without photometric calibration.
const DEFAULT_GAMMA: f64 = 2.2;

/// Simulated camera with its effects: maps points in the world to pixels, light to pixel values, and motions to what the
/// odometry reports of them. Effects of one stage are applied in the order of [`library`].
#[derive(Debug, Clone)]
pub struct Chain {
    model: Model,
    /// Effects of the stage that are not neutral, as in the lists below.
    world: Vec<Used>,
    motion: Vec<Used>,
    mount: Vec<Used>,
    lens: Vec<Used>,
    exposure: Vec<Used>,
    /// The nominal black level comes first.
    sensor: Vec<Used>,
    odometry: Vec<Used>,
    field: FieldDimensions,
    camera: Camera,
    clock_s: f64,
    exposure_s: f64,
    glare: f64,
    sharpening: f64,
    /// Whether rows are exposed at different times.
    has_row_times: bool,
    magnification: [f64; 3],
    psf_variance_px2: f64,
    noise: Noise,
    tone: Tone,
}

/// Returns the variance of a Gaussian kernel sampled at the pixels' centres. Below half a pixel it is less than the square
/// of sigma, because the kernel hardly reaches the neighbouring pixels.
pub fn sampled_variance_px2(sigma_px: f64) -> f64 {
    if sigma_px <= 0.0 {
        return 0.0;
    }
    let reach = (8.0 * sigma_px).ceil() as i32 + 1;
    let weight = |place: i32| (-0.5 * (f64::from(place) / sigma_px).powi(2)).exp();
    let (sum, squares) = (-reach..=reach)
        .map(|place| (weight(place), f64::from(place).powi(2)))
        .fold((0.0, 0.0), |(sum, squares), (weight, square)| (sum + weight, squares + weight * square));
    squares / sum
}

impl Chain {
    /// Builds the chain from a nominal camera, a nominal field and the model's changes to them. A camera without photometry
    /// gets a gamma of 2.2 and no black level, noise or blur. Fails where a value is not finite or where the effects leave
    /// no valid camera or tone curve.
    pub fn new(setup: &CameraSetup, field: &FieldDimensions, model: &Model) -> Result<Self, ModelError> {
        check_finite(model)?;
        let mut chain = Self::nominal(setup, field);
        let [world, motion, mount, lens, exposure, sensor, encoding, odometry] =
            Stage::ALL.map(|stage| effects_of(model, stage));
        chain.field = changed_field(&world, field)?;
        chain.clock_s = motion.iter().map(|used| used.effect.clock_s(&used.values)).sum();
        chain.exposure_s = motion.iter().map(|used| used.effect.exposure_s(&used.values)).sum();
        chain.has_row_times = delay_s(&motion, 0.0) != delay_s(&motion, 1.0);
        chain.camera = changed_camera(&lens, &setup.camera)?;
        chain.glare = lens.iter().map(|used| used.effect.glare(&used.values)).sum();
        chain.sharpening = encoding.iter().map(|used| used.effect.sharpening(&used.values)).sum();
        chain.magnification = product(&lens, |used| used.effect.magnification(&used.values));
        chain.noise = sensor.iter().fold(chain.noise, |noise, used| used.effect.noise(&used.values, noise));
        chain.sensor.extend(sensor);
        chain.tone = changed_tone(&encoding, chain.tone)?;
        Ok(Self { model: model.clone(), world, motion, mount, lens, exposure, odometry, ..chain })
    }

    /// Builds the chain of a camera and a field at their nominal values, without effects.
    pub fn nominal(setup: &CameraSetup, field: &FieldDimensions) -> Self {
        let photometry = setup.photometry.as_ref();
        let value = |of: fn(&Photometry) -> Option<f64>| photometry.and_then(of).unwrap_or(0.0);
        let black_level = Used { effect: BLACK_LEVEL, values: vec![value(|p| p.black_level)] };
        Self {
            model: Model::default(),
            world: Vec::new(),
            motion: Vec::new(),
            mount: Vec::new(),
            lens: Vec::new(),
            exposure: Vec::new(),
            sensor: vec![black_level],
            odometry: Vec::new(),
            field: field.clone(),
            camera: setup.camera.clone(),
            clock_s: 0.0,
            exposure_s: 0.0,
            glare: 0.0,
            sharpening: 0.0,
            has_row_times: false,
            magnification: [1.0; 3],
            psf_variance_px2: sampled_variance_px2(value(|p| p.psf_sigma_px)),
            noise: Noise { shot: value(|p| p.noise_shot), read_variance: value(|p| p.noise_read).powi(2) },
            tone: Tone { gamma: photometry.map_or(DEFAULT_GAMMA, |p| p.gamma), contrast: 0.0 },
        }
    }

    /// Returns the effects.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Returns the field with the effects' changes.
    pub fn field(&self) -> &FieldDimensions {
        &self.field
    }

    /// Returns the camera with the effects' changes to its lens.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Projects a point in the camera's axes to its pixel through [`Chain::camera`], with the shifts that this camera's model
    /// cannot express. The pixel may lie outside the picture; `None` beyond the largest valid angle.
    pub fn project_from_camera(&self, point_in_camera: DVec3) -> Option<DVec2> {
        Some(self.camera.project_unbounded(point_in_camera).ok()? + self.shift_px(point_in_camera))
    }

    /// Returns the shift of a point's picture that [`Chain::camera`] does not contain, pixels.
    pub(crate) fn shift_px(&self, point_in_camera: DVec3) -> DVec2 {
        let shift = |used: &Used| used.effect.shift_px(&used.values, &self.camera, point_in_camera);
        self.lens.iter().map(shift).sum()
    }

    /// Returns the delay in seconds of images and odometry after the time of the reference poses.
    pub fn clock_s(&self) -> f64 {
        self.clock_s
    }

    /// Returns the exposure time of each row in seconds.
    pub fn exposure_s(&self) -> f64 {
        self.exposure_s
    }

    /// Whether the rows of one picture are exposed at different times.
    pub fn has_row_times(&self) -> bool {
        self.has_row_times
    }

    /// Returns the magnification of red, green and blue about the principal point; 1 leaves the channel unchanged.
    pub fn magnification(&self) -> [f64; 3] {
        self.magnification
    }

    /// Whether red, green and blue are magnified differently.
    pub fn splits_colors(&self) -> bool {
        self.magnification.iter().any(|magnification| *magnification != self.magnification[1])
    }

    /// Returns the camera's true pose in the middle of a row's exposure, for the frame with this timestamp. `trajectory`
    /// holds the reference poses; rows run from 0 at the top to 1 at the bottom.
    pub fn pose(&self, trajectory: &Trajectory, time_s: f64, row: f64) -> CameraPose {
        self.camera_at(trajectory, self.exposure_middle_s(time_s, row))
    }

    /// Returns the camera's true pose at a time on the clock of the reference poses, seconds. A camera that stands still does
    /// not sway.
    pub(crate) fn camera_at(&self, trajectory: &Trajectory, time_s: f64) -> CameraPose {
        let reference = trajectory.at(time_s);
        if trajectory.is_still() {
            return self.mounted(reference);
        }
        let swayed = |pose, used: &Used| used.effect.sway(&used.values, pose, time_s);
        self.mounted(self.motion.iter().fold(reference, swayed))
    }

    /// Returns the middle of a row's exposure in seconds, on the clock of the reference poses.
    pub fn exposure_middle_s(&self, time_s: f64, row: f64) -> f64 {
        let of_picture = |used: &Used| used.effect.picture_delay_s(&used.values, time_s);
        let of_picture_s: f64 = self.motion.iter().map(of_picture).sum();
        time_s + self.clock_s + of_picture_s + delay_s(&self.motion, row)
    }

    /// Whether the camera's pose in a picture depends on those at other times than the picture's.
    pub fn is_timed(&self) -> bool {
        self.clock_s != 0.0 || !self.motion.is_empty()
    }

    /// Returns the camera's true pose for a reference pose.
    pub fn mounted(&self, pose: CameraPose) -> CameraPose {
        self.mount.iter().fold(pose, |pose, used| used.effect.mount(&used.values, pose))
    }

    /// Returns the factors of red, green and blue on the light of a point in the scene: the product of the light on the
    /// ground at `ground` (metres, for a point on the ground), the lens's falloff at `pixel`, and the gain of the frame with
    /// this timestamp.
    pub fn light(&self, time_s: f64, pixel: DVec2, ground: Option<DVec2>) -> [f64; 3] {
        let light = ground.map_or(1.0, |point| self.light_on_ground(point)) * self.falloff(pixel);
        self.gain(time_s).map(|gain| light * gain)
    }

    /// Returns the factor of the light on the ground at a point, metres.
    pub fn light_on_ground(&self, point_in_world: DVec2) -> f64 {
        let light = |used: &Used| used.effect.light(&used.values, point_in_world, &self.field);
        self.world.iter().map(light).product()
    }

    /// Returns the factor of a surface's reflectance.
    pub fn reflectance(&self, surface: Surface) -> f64 {
        self.world.iter().map(|used| used.effect.reflectance(&used.values, surface)).product()
    }

    /// Returns the share of the picture's mean light that the lens adds everywhere.
    pub fn glare(&self) -> f64 {
        self.glare
    }

    /// Whether effects change the light on the ground from place to place.
    pub(crate) fn has_uneven_light(&self) -> bool {
        !self.world.is_empty()
    }

    /// Returns the share of the light that reaches the sensor at a pixel.
    pub fn falloff(&self, pixel: DVec2) -> f64 {
        let radius = self.radius(pixel);
        self.lens.iter().map(|used| used.effect.falloff(&used.values, radius)).product()
    }

    /// Returns the gain of red, green and blue in the frame with this timestamp.
    pub fn gain(&self, time_s: f64) -> [f64; 3] {
        product(&self.exposure, |used| used.effect.gain(&used.values, time_s))
    }

    /// Whether an effect of the exposure is present.
    pub(crate) fn changes_gain(&self) -> bool {
        !self.exposure.is_empty()
    }

    /// Returns the variance along each axis, in pixels², of the blur by lens and sensor at a pixel: the nominal variance
    /// plus the effects'. It excludes the pixel's own extent (1/12) and motion blur.
    pub fn psf_variance_px2(&self, pixel: DVec2) -> f64 {
        self.psf_variance_at_radius_px2(self.radius(pixel))
    }

    /// Returns [`Chain::psf_variance_px2`] at a distance from the principal point, in halves of the picture's diagonal.
    pub(crate) fn psf_variance_at_radius_px2(&self, radius: f64) -> f64 {
        let added = |used: &Used| used.effect.blur_variance_px2(&used.values, radius);
        self.psf_variance_px2 + self.lens.iter().map(added).sum::<f64>()
    }

    /// Returns the variance along an axis, in pixels², of the Gaussian blur that looks like one of this variance in the encoded
    /// picture, which may be sharpened: its edges are as steep.
    pub fn encoded_variance_px2(&self, variance_px2: f64) -> f64 {
        sharpened_variance_px2(variance_px2, self.sharpening)
    }

    /// Returns the factor of the encoding on the amplitude of waves with these angular frequencies along rows and columns, radians
    /// per pixel.
    pub fn encoded_amplitude(&self, frequency_rad_px: [f64; 2]) -> f64 {
        sharpened_amplitude(frequency_rad_px, self.sharpening)
    }

    /// Whether encoded values depend on those of other pixels.
    pub fn mixes_encoded_pixels(&self) -> bool {
        self.sharpening != 0.0
    }

    /// Returns the amount by which encoded pictures are sharpened.
    pub(crate) fn sharpening(&self) -> f64 {
        self.sharpening
    }

    /// Returns the sensor's linear output for a linear value that includes noise.
    pub fn respond(&self, linear: f64) -> f64 {
        self.sensor.iter().fold(linear, |value, used| used.effect.respond(&used.values, value))
    }

    /// Returns the noise of linear values before the sensor's response.
    pub fn noise(&self) -> Noise {
        self.noise
    }

    /// Returns the tone curve from linear output to pixel values.
    pub(crate) fn tone(&self) -> Tone {
        self.tone
    }

    /// Returns the pixel value, 0 to 1, for the sensor's linear output.
    pub fn encode(&self, linear: f64) -> f64 {
        self.tone.encode(linear)
    }

    /// Returns the linear value of light, before the sensor's response, that is encoded as this pixel value, 0 to 1. Values
    /// that no light has are clipped to those of the darkest and the brightest.
    pub fn linear_of(&self, encoded: f64) -> f64 {
        let excess = |linear: f64| self.encode(self.respond(linear)) - encoded;
        let (mut low, mut high) = ((0.0, excess(0.0)), (1.0, excess(1.0)));
        if low.1 >= 0.0 || high.1 <= 0.0 {
            return if low.1 >= 0.0 { 0.0 } else { 1.0 };
        }
        // Nearly right where the chain is a power law; bounds close in from both sides (Illinois algorithm, Dowell and
        // Jarratt 1971).
        let mut next = encoded.powf(self.tone.gamma);
        for _ in 0..MOST_INVERSION_STEPS {
            let found = (next, excess(next));
            if found.1.abs() < INVERSION_TOLERANCE {
                break;
            }
            if found.1 > 0.0 {
                (high, low.1) = (found, 0.5 * low.1);
            } else {
                (low, high.1) = (found, 0.5 * high.1);
            }
            next = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        }
        next
    }

    /// Returns [`Chain::linear_of`] for the 256 values of a picture's bytes.
    pub fn linear_values(&self) -> Vec<f32> {
        (0..=u8::MAX).map(|value| self.linear_of(f64::from(value) / 255.0) as f32).collect()
    }

    /// Returns the delay in seconds of the odometry after the pictures.
    pub fn odometry_delay_s(&self) -> f64 {
        self.odometry.iter().map(|used| used.effect.odometry_delay_s(&used.values)).sum()
    }

    /// Returns the delay in seconds of the stated pitch and roll after the pictures.
    pub fn attitude_delay_s(&self) -> f64 {
        self.odometry.iter().map(|used| used.effect.attitude_delay_s(&used.values)).sum()
    }

    /// Returns the motion that the odometry reports for a true motion of the camera that took `duration_s` seconds. The
    /// robot's clock is late: between two timestamps, `true_motion` connects the poses [`Chain::clock_s`] after them,
    /// less [`Chain::odometry_delay_s`].
    pub fn odometry(&self, true_motion: Motion2, duration_s: f64) -> Motion2 {
        let reported = |motion, used: &Used| used.effect.odometry(&used.values, motion, duration_s);
        self.odometry.iter().fold(true_motion, reported)
    }

    /// Returns the distance from the principal point in units of half the picture's diagonal.
    pub(crate) fn radius(&self, pixel: DVec2) -> f64 {
        let diagonal_px = f64::from(self.camera.width - 1).hypot(f64::from(self.camera.height - 1));
        2.0 * pixel.distance(DVec2::new(self.camera.cx, self.camera.cy)) / diagonal_px.max(1.0)
    }
}

fn check_finite(model: &Model) -> Result<(), ModelError> {
    for Used { effect, values } in &model.effects {
        for (parameter, value) in effect.parameters().iter().zip(values) {
            if !value.is_finite() {
                return Err(ModelFault::NotFinite { id: effect.id(), key: parameter.name }.into());
            }
        }
    }
    Ok(())
}

/// Returns the effects of a stage that are not neutral, in the library's order.
fn effects_of(model: &Model, stage: Stage) -> Vec<Used> {
    let of_stage = library().iter().filter(|effect| effect.stage() == stage);
    of_stage
        .filter_map(|effect| model.effects.iter().find(|used| used.effect.id() == effect.id()))
        .filter(|used| !used.is_neutral())
        .cloned()
        .collect()
}

fn changed_field(world: &[Used], field: &FieldDimensions) -> Result<FieldDimensions, ModelFault> {
    let field = world.iter().fold(field.clone(), |field, used| used.effect.field(&used.values, field));
    field.validate().map_err(ModelFault::Field)?;
    Ok(field)
}

fn changed_camera(lens: &[Used], camera: &Camera) -> Result<Camera, ModelFault> {
    lens.iter().try_fold(camera.clone(), |camera, used| {
        let fault = |error| ModelFault::Camera { id: used.effect.id(), error };
        used.effect.lens(&used.values, camera).map_err(fault)
    })
}

fn changed_tone(encoding: &[Used], nominal: Tone) -> Result<Tone, ModelFault> {
    encoding.iter().try_fold(nominal, |tone, used| {
        let fault = |error| ModelFault::Tone { id: used.effect.id(), error };
        used.effect.tone(&used.values, tone).map_err(fault)
    })
}

fn delay_s(motion: &[Used], row: f64) -> f64 {
    motion.iter().map(|used| used.effect.delay_s(&used.values, row)).sum()
}

/// Multiplies the colour factors of several effects.
fn product(effects: &[Used], factors: impl Fn(&Used) -> [f64; 3]) -> [f64; 3] {
    effects.iter().map(factors).fold([1.0; 3], |[r, g, b], [red, green, blue]| [r * red, g * green, b * blue])
}
