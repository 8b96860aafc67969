//! Calibrations of cameras, `sensor_msgs/CameraInfo` and Foxglove's `CameraCalibration`, as cameras.

use reality_sim_core::{
    camera::{Camera, Distortion, InvalidCamera, Opencv, OpencvFisheye},
    sequence::on_one_line,
};

use super::{
    Header,
    lens_fit::{LensFit, Rational, fit},
};
use crate::schema::View;

/// Largest error of a lens that stands for one that cannot be written, pixels.
const MAX_FIT_ERROR_PX: f64 = 0.1;

/// Calibration as a message holds it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Calibration {
    /// Time and frame of the camera.
    pub header: Header,
    /// Size of the sensor's picture, pixels.
    pub size: [u32; 2],
    /// Name of the lens model.
    pub model: String,
    /// Distortion coefficients.
    pub distortion: Vec<f64>,
    /// Camera matrix, row by row.
    pub matrix: Vec<f64>,
    /// Projection of rectified pictures, row by row, 3 × 4.
    pub projection: Vec<f64>,
    /// Pixels of the sensor that are one of the picture, each way.
    pub binning: [u32; 2],
    /// Part of the sensor that is sent, in its own pixels: left, top, width, height; all zero for the whole.
    pub region: [u32; 4],
}

/// Reason why a calibration cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CalibrationFault {
    /// The camera matrix is zero: nobody has calibrated the camera.
    #[error(
        "is all zeros: the camera was never calibrated, calibrate it (`reality-sim calibrate`) and give the result by --camera"
    )]
    AllZeros,
    /// The lens model is not known.
    #[error("the lens model `{}` is not read: calibrate with plumb_bob, rational_polynomial or equidistant", on_one_line(.0))]
    UnknownModel(String),
    /// The model takes another number of coefficients.
    #[error("{} has {found} distortion coefficients, which is no number that it takes", on_one_line(.model))]
    Coefficients {
        /// Name of the lens model.
        model: String,
        /// Number of coefficients.
        found: usize,
    },
    /// The lens cannot be written as one of the models of a sequence.
    #[error(
        "its {model} lens cannot be written as OPENCV or OPENCV_FISHEYE (the nearest such lens is {error_px:.2} px off): calibrate with plumb_bob or equidistant"
    )]
    NoSuchLens {
        /// Name of the lens model.
        model: &'static str,
        /// Error of the nearest lens, pixels.
        error_px: f64,
    },
    /// The lens has coefficients beyond those that a sequence's models have.
    #[error(
        "its thin prism or tilted sensor (coefficients 9 to 14) cannot be written: calibrate with plumb_bob"
    )]
    ThinPrism,
    /// The numbers make no camera.
    #[error("{0}")]
    Camera(#[from] InvalidCamera),
}

/// Camera of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvertedCamera {
    /// Camera.
    pub camera: Camera,
    /// Error against the calibration, pixels, where another lens model stands for it.
    pub fit_error_px: Option<f64>,
}

impl Calibration {
    /// Reads a message with a calibration; `None` if it is damaged.
    pub fn read(message: &View<'_>) -> Option<Self> {
        let size = |view: &View<'_>, name: &str| {
            view.field(name)?.integer().and_then(|size| u32::try_from(size).ok())
        };
        let numbers = |names: &[&str]| message.any_field(names).and_then(|view| view.numbers());
        let region = message
            .field("roi")
            .map(|roi| ["x_offset", "y_offset", "width", "height"].map(|name| size(&roi, name).unwrap_or(0)));
        Some(Self {
            header: Header::of(message),
            size: [size(message, "width")?, size(message, "height")?],
            model: message.field("distortion_model")?.text()?.into_owned(),
            distortion: numbers(&["d", "D"]).unwrap_or_default(),
            matrix: numbers(&["k", "K"])?,
            projection: numbers(&["p", "P"]).unwrap_or_default(),
            binning: ["binning_x", "binning_y"].map(|name| size(message, name).unwrap_or(1).max(1)),
            region: region.unwrap_or_default(),
        })
    }

    /// Returns whether nobody has filled in the camera matrix.
    pub fn is_all_zeros(&self) -> bool {
        self.matrix.iter().all(|value| *value == 0.0)
    }

    /// Converts the calibration of pictures as they leave the lens; `picture_size`, pixels, is taken where the calibration says
    /// nothing. Fails if it is all zeros, or if no camera of a sequence is like it.
    pub fn camera(&self, picture_size: [u32; 2]) -> Result<ConvertedCamera, CalibrationFault> {
        let &[fx, _, cx, _, fy, cy, ..] = self.matrix.as_slice() else {
            return Err(CalibrationFault::AllZeros);
        };
        if self.is_all_zeros() {
            return Err(CalibrationFault::AllZeros);
        }
        let size = if self.size.contains(&0) { picture_size } else { self.size };
        let (distortion, fit_error_px) = self.lens([fx, fy, cx, cy], size)?;
        let camera = self.as_sent([fx, fy, cx, cy], size, distortion)?;
        Ok(ConvertedCamera { camera, fit_error_px })
    }

    /// Converts the calibration of pictures that have been rectified: a camera without distortion. Fails if it is all zeros.
    pub fn rectified_camera(&self, picture_size: [u32; 2]) -> Result<ConvertedCamera, CalibrationFault> {
        let numbers = match *self.projection.as_slice() {
            [fx, _, cx, _, _, fy, cy, ..] if fx != 0.0 => [fx, fy, cx, cy],
            _ => match *self.matrix.as_slice() {
                [fx, _, cx, _, fy, cy, ..] if fx != 0.0 => [fx, fy, cx, cy],
                _ => return Err(CalibrationFault::AllZeros),
            },
        };
        let size = if self.size.contains(&0) { picture_size } else { self.size };
        Ok(ConvertedCamera { camera: self.as_sent(numbers, size, Distortion::Pinhole)?, fit_error_px: None })
    }

    /// Returns the camera of the part of the sensor that is sent, with pixels joined. A pixel's centre has integer coordinates.
    fn as_sent(
        &self,
        [fx, fy, cx, cy]: [f64; 4],
        size: [u32; 2],
        distortion: Distortion,
    ) -> Result<Camera, InvalidCamera> {
        let [left, top, width, height] = self.region;
        let [across, down] = self.binning.map(f64::from);
        let part = if width == 0 || height == 0 { size } else { [width, height] };
        let joined = [part[0] / self.binning[0], part[1] / self.binning[1]];
        let center = |center: f64, start: u32, joined: f64| {
            if joined == 1.0 {
                center - f64::from(start)
            } else {
                (center - f64::from(start) + 0.5) / joined - 0.5
            }
        };
        let numbers = [fx / across, fy / down, center(cx, left, across), center(cy, top, down)];
        Camera::new(joined, numbers, distortion)
    }

    /// Returns the lens, and its error in pixels where it stands for one that cannot be written.
    fn lens(&self, numbers: [f64; 4], size: [u32; 2]) -> Result<(Distortion, Option<f64>), CalibrationFault> {
        let wrong =
            || CalibrationFault::Coefficients { model: self.model.clone(), found: self.distortion.len() };
        let fisheye = |k| Ok((Distortion::OpencvFisheye(OpencvFisheye { k }), None));
        let opencv = |k1, k2, p1, p2, k3| Ok((Distortion::Opencv(Opencv { k1, k2, p1, p2, k3 }), None));
        let name = self.model.to_ascii_lowercase();
        match (name.as_str(), self.distortion.as_slice()) {
            ("equidistant" | "fisheye" | "kannala_brandt" | "kannala_brandt4" | "fisheye_equidistant", d) => {
                match *d {
                    [] => fisheye([0.0; 4]),
                    [k1, k2, k3, k4] => fisheye([k1, k2, k3, k4]),
                    _ => Err(wrong()),
                }
            }
            ("plumb_bob" | "" | "none" | "pinhole" | "rational_polynomial", []) => {
                Ok((Distortion::Pinhole, None))
            }
            ("plumb_bob" | "rational_polynomial" | "", &[k1, k2, p1, p2]) => opencv(k1, k2, p1, p2, 0.0),
            ("plumb_bob" | "rational_polynomial" | "", &[k1, k2, p1, p2, k3]) => opencv(k1, k2, p1, p2, k3),
            ("plumb_bob" | "none" | "pinhole", d) if d.iter().all(|value| *value == 0.0) => {
                Ok((Distortion::Pinhole, None))
            }
            ("rational_polynomial", &[k1, k2, p1, p2, k3, k4, k5, k6, ref prism @ ..]) => {
                if prism.iter().any(|value| *value != 0.0) {
                    return Err(CalibrationFault::ThinPrism);
                }
                if [k4, k5, k6] == [0.0; 3] {
                    return opencv(k1, k2, p1, p2, k3);
                }
                represented(Rational { k: [k1, k2, k3, k4, k5, k6], p: [p1, p2] }, numbers, size)
            }
            ("plumb_bob" | "rational_polynomial" | "none" | "pinhole" | "", _) => Err(wrong()),
            _ => Err(CalibrationFault::UnknownModel(self.model.clone())),
        }
    }
}

/// Finds the lens that stands for a rational one.
fn represented(
    rational: Rational,
    numbers: [f64; 4],
    size: [u32; 2],
) -> Result<(Distortion, Option<f64>), CalibrationFault> {
    let LensFit { distortion, error_px } = fit(rational, numbers, size);
    if error_px <= MAX_FIT_ERROR_PX {
        return Ok((distortion, Some(error_px)));
    }
    Err(CalibrationFault::NoSuchLens { model: "rational_polynomial", error_px })
}
