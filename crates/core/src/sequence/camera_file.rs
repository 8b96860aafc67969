//! `camera.toml`: the lens, the camera's mounting height, and how it turns light into pixel values.

use std::{ops::RangeInclusive, path::Path};

use serde::{Deserialize, Serialize};

use super::{
    error::{Fault, SequenceError, excerpt},
    limits::MAX_TOML_BYTES,
    mounting::Mounting,
    text::read_and_parse,
    toml_text::{NumberCheck, line_of_key, parse, print},
};
use crate::camera::{Camera, Distortion, ImageCircle, InvalidCamera, Opencv, OpencvFisheye};

/// Maximum mounting height, metres; anything higher is a mistake in the file.
const MAX_HEIGHT_M: f64 = 100.0;

/// Gammas that a camera may have: those of cameras and displays lie between 1 and 2.8.
const GAMMAS: RangeInclusive<f64> = 0.1..=10.0;

/// Camera as mounted on the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraSetup {
    /// Lens and picture size.
    pub camera: Camera,
    /// Nominal height of the projection centre above the carpet, metres.
    pub mount_height_m: f64,
    /// How light becomes pixel values, if known.
    pub photometry: Option<Photometry>,
}

/// How a camera turns light into pixel values. Linear values have 1 as full scale; the noise of a linear value `v`
/// has the standard deviation `sqrt(noise_shot · v + noise_read²)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Photometry {
    /// Gamma: a pixel value is full scale times the linear value to the power of 1 / gamma.
    pub gamma: f64,
    /// Linear values of a white line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line_linear_rgb: Option<[f64; 3]>,
    /// Linear values of the carpet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub carpet_linear_rgb: Option<[f64; 3]>,
    /// Linear value without light.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub black_level: Option<f64>,
    /// Variance of the noise for each unit of the linear value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise_shot: Option<f64>,
    /// Standard deviation of the noise without light, linear.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise_read: Option<f64>,
    /// Standard deviation of the blur by lens and sensor, pixels, as a Gaussian sampled at the pixels' centres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub psf_sigma_px: Option<f64>,
    /// How far the values above are trusted; `None` for what a person's measurement is worth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trust: Option<Trust>,
}

/// Trust in nominal values of [`Photometry`], `[photometry.trust]`: standard deviations of their errors, as fractions of the
/// values.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Trust {
    /// Brightness of white lines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<f64>,
    /// Brightness of the carpet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub carpet: Option<f64>,
    /// Standard deviation of the noise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<f64>,
    /// Standard deviation of the blur.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blur: Option<f64>,
}

impl Photometry {
    /// Returns the photometry of a camera of which nothing but the gamma is known.
    pub fn of_gamma(gamma: f64) -> Self {
        Self {
            gamma,
            line_linear_rgb: None,
            carpet_linear_rgb: None,
            black_level: None,
            noise_shot: None,
            noise_read: None,
            psf_sigma_px: None,
            trust: None,
        }
    }

    /// Returns the trust in its values, as far as it is stated.
    pub fn trust(&self) -> Trust {
        self.trust.unwrap_or_default()
    }
}

#[derive(Serialize, Deserialize)]
struct CameraTable {
    model: String,
    width: u32,
    height: u32,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    #[serde(default)]
    distortion: Vec<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    max_angle_rad: Option<f64>,
    mount: MountTable,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    image_circle: Option<CircleTable>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    photometry: Option<Photometry>,
}

#[derive(Serialize, Deserialize)]
struct MountTable {
    height_m: f64,
    #[serde(default, skip_serializing_if = "is_as_stated")]
    correction: Mounting,
}

fn is_as_stated(correction: &Mounting) -> bool {
    correction.is_as_stated()
}

/// Table for an [`ImageCircle`] to which other programs may add keys.
#[derive(Serialize, Deserialize)]
struct CircleTable {
    cx: f64,
    cy: f64,
    radius: f64,
}

/// Reads and validates a camera file. Fails if it cannot be read, or with the first value that is missing or invalid.
pub fn read_camera(path: &Path) -> Result<CameraSetup, SequenceError> {
    read_and_parse(path, MAX_TOML_BYTES, CameraSetup::from_toml)
}

/// Reads where the camera is against what the recording's other files state, `[mount.correction]`, from a camera file. Fails
/// as [`read_camera`] does.
pub fn read_mounting(path: &Path) -> Result<Mounting, SequenceError> {
    read_and_parse(path, MAX_TOML_BYTES, |path, text| {
        let table: CameraTable = parse(path, text)?;
        table.mount.correction.check(path, text)?;
        Ok(table.mount.correction)
    })
}

impl CameraSetup {
    /// Parses the text of a `camera.toml`. Fails with the first value that is missing or invalid. Errors name `origin`:
    /// the file, or another source of the text.
    pub fn from_toml(origin: &Path, text: &str) -> Result<Self, SequenceError> {
        let table: CameraTable = parse(origin, text)?;
        let camera = build_camera(origin, text, &table)?;
        let image_circle =
            table.image_circle.map(|circle| checked_circle(origin, text, &circle)).transpose()?;
        let mount = NumberCheck { path: origin, text, table: "mount" };
        let in_range = |height_m| height_m > 0.0 && height_m <= MAX_HEIGHT_M;
        mount.check("height_m", table.mount.height_m, in_range, "above 0 and at most 100 metres")?;
        table.mount.correction.check(origin, text)?;
        if let Some(photometry) = &table.photometry {
            check_photometry(origin, text, photometry)?;
        }
        Ok(Self {
            camera: camera.with_image_circle(image_circle),
            mount_height_m: table.mount.height_m,
            photometry: table.photometry,
        })
    }

    /// Returns the text of a `camera.toml` with this camera. Fails if the camera cannot be written as TOML. Errors name
    /// `origin`: the file, or another destination of the text.
    pub fn to_toml(&self, origin: &Path) -> Result<String, SequenceError> {
        self.to_toml_with(origin, Mounting::default())
    }

    /// Works as [`CameraSetup::to_toml`], with the camera's placement against what the recording's other files state.
    pub fn to_toml_with(&self, origin: &Path, correction: Mounting) -> Result<String, SequenceError> {
        let camera = &self.camera;
        let table = CameraTable {
            model: camera.distortion.colmap_name().to_owned(),
            width: camera.width,
            height: camera.height,
            fx: camera.fx,
            fy: camera.fy,
            cx: camera.cx,
            cy: camera.cy,
            distortion: camera.distortion.parameters(),
            max_angle_rad: limited_angle_rad(camera),
            mount: MountTable { height_m: self.mount_height_m, correction },
            image_circle: camera.image_circle.map(|circle| CircleTable {
                cx: circle.cx,
                cy: circle.cy,
                radius: circle.radius,
            }),
            photometry: self.photometry,
        };
        print(origin, &table)
    }
}

/// Returns the largest angle, if it differs from the one that follows from the distortion.
fn limited_angle_rad(camera: &Camera) -> Option<f64> {
    let natural = Camera::new(
        [camera.width, camera.height],
        [camera.fx, camera.fy, camera.cx, camera.cy],
        camera.distortion,
    );
    let is_natural = natural.is_ok_and(|natural| natural.max_angle_rad() == camera.max_angle_rad());
    (!is_natural).then(|| camera.max_angle_rad())
}

fn build_camera(path: &Path, text: &str, table: &CameraTable) -> Result<Camera, SequenceError> {
    let distortion = build_distortion(table).map_err(|fault| {
        let key = if matches!(fault, Fault::UnknownModel { .. }) { "model" } else { "distortion" };
        SequenceError::at(path, line_of_key(text, &[key]), fault)
    })?;
    let intrinsics = [table.fx, table.fy, table.cx, table.cy];
    let camera = Camera::new([table.width, table.height], intrinsics, distortion);
    let limited = camera.and_then(|camera| match table.max_angle_rad {
        Some(max_angle_rad) => camera.with_max_angle_rad(max_angle_rad),
        None => Ok(camera),
    });
    limited.map_err(|error| {
        let line = line_of_key(text, &[faulty_key(table, &error)]);
        SequenceError::at(path, line, Fault::Camera(error))
    })
}

fn build_distortion(table: &CameraTable) -> Result<Distortion, Fault> {
    let count = |model, expected| Fault::DistortionCount { model, expected, found: table.distortion.len() };
    match (table.model.as_str(), table.distortion.as_slice()) {
        ("PINHOLE", []) => Ok(Distortion::Pinhole),
        ("PINHOLE", _) => Err(count("PINHOLE", "no")),
        ("OPENCV", &[k1, k2, p1, p2]) => Ok(Distortion::Opencv(Opencv { k1, k2, p1, p2, k3: 0.0 })),
        ("OPENCV", &[k1, k2, p1, p2, k3]) => Ok(Distortion::Opencv(Opencv { k1, k2, p1, p2, k3 })),
        ("OPENCV", _) => Err(count("OPENCV", "4 or 5")),
        ("OPENCV_FISHEYE", &[k1, k2, k3, k4]) => {
            Ok(Distortion::OpencvFisheye(OpencvFisheye { k: [k1, k2, k3, k4] }))
        }
        ("OPENCV_FISHEYE", _) => Err(count("OPENCV_FISHEYE", "4")),
        (model, _) => Err(Fault::UnknownModel { model: excerpt(model) }),
    }
}

/// Returns the key in whose line the fault is shown.
fn faulty_key(table: &CameraTable, error: &InvalidCamera) -> &'static str {
    match error {
        InvalidCamera::Size { width, height } if *width != 0 && (*height == 0 || width < height) => "height",
        InvalidCamera::Size { .. } => "width",
        InvalidCamera::FocalLength { fx, .. } if *fx > 0.0 => "fy",
        InvalidCamera::FocalLength { .. } => "fx",
        InvalidCamera::NotFinite { name } => name,
        InvalidCamera::MaxAngle { .. } if table.max_angle_rad.is_some() => "max_angle_rad",
        InvalidCamera::MaxAngle { .. } => "distortion",
    }
}

fn checked_circle(path: &Path, text: &str, circle: &CircleTable) -> Result<ImageCircle, SequenceError> {
    let numbers = NumberCheck { path, text, table: "image_circle" };
    numbers.check("cx", circle.cx, |_| true, "a finite number of pixels")?;
    numbers.check("cy", circle.cy, |_| true, "a finite number of pixels")?;
    numbers.check("radius", circle.radius, |radius| radius > 0.0, "a positive number of pixels")?;
    Ok(ImageCircle { cx: circle.cx, cy: circle.cy, radius: circle.radius })
}

fn check_photometry(path: &Path, text: &str, photometry: &Photometry) -> Result<(), SequenceError> {
    let numbers = NumberCheck { path, text, table: "photometry" };
    numbers.check("gamma", photometry.gamma, |gamma| GAMMAS.contains(&gamma), "from 0.1 to 10")?;
    for (key, colour) in
        [("line_linear_rgb", photometry.line_linear_rgb), ("carpet_linear_rgb", photometry.carpet_linear_rgb)]
    {
        for value in colour.iter().flatten() {
            numbers.check(key, *value, |value| value >= 0.0, "three numbers of 0 or more")?;
        }
    }
    for (key, value) in [
        ("black_level", photometry.black_level),
        ("noise_shot", photometry.noise_shot),
        ("noise_read", photometry.noise_read),
        ("psf_sigma_px", photometry.psf_sigma_px),
    ] {
        numbers.check(key, value.unwrap_or(0.0), |value| value >= 0.0, "0 or more")?;
    }
    let trust = NumberCheck { table: "photometry.trust", ..numbers };
    let Trust { line, carpet, noise, blur } = photometry.trust();
    for (key, value) in [("line", line), ("carpet", carpet), ("noise", noise), ("blur", blur)] {
        let in_range = |value| value > 0.0 && value <= 1.0;
        trust.check(
            key,
            value.unwrap_or(1.0),
            in_range,
            "a fraction above 0 and at most 1, the standard deviation of the value's error",
        )?;
    }
    Ok(())
}
