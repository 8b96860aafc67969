//! Cameras by nerfstudio's names.

use reality_sim_core::camera::{Camera, Distortion, Opencv, OpencvFisheye};

use super::file::Intrinsics;
use crate::{
    model_error::{ModelFault, excerpt},
    pixels::HALF_PIXEL,
};

/// Name of the camera model where the file has none, as in nerfstudio's `nerfstudio_dataparser.py`.
const DEFAULT_MODEL: &str = "PERSPECTIVE";

impl Intrinsics {
    /// Returns a camera's intrinsics in nerfstudio's pixels.
    pub fn of_camera(camera: &Camera) -> Self {
        let intrinsics = Self {
            fl_x: Some(camera.fx),
            fl_y: Some(camera.fy),
            cx: Some(camera.cx + HALF_PIXEL),
            cy: Some(camera.cy + HALF_PIXEL),
            w: Some(camera.width.into()),
            h: Some(camera.height.into()),
            ..Self::default()
        };
        match camera.distortion {
            Distortion::Pinhole => intrinsics,
            Distortion::Opencv(Opencv { k1, k2, p1, p2, k3 }) => Self {
                k1: Some(k1),
                k2: Some(k2),
                k3: Some(k3).filter(|k3| *k3 != 0.0),
                p1: Some(p1),
                p2: Some(p2),
                ..intrinsics
            },
            Distortion::OpencvFisheye(OpencvFisheye { k: [k1, k2, k3, k4] }) => {
                Self { k1: Some(k1), k2: Some(k2), k3: Some(k3), k4: Some(k4), ..intrinsics }
            }
        }
    }

    /// Returns the camera of a model with our pixels. Fails if a value is missing or cannot be used.
    pub fn camera(&self, model: Option<&str>) -> Result<Camera, ModelFault> {
        let missing = |key: &str| ModelFault::MissingValue { key: key.to_owned() };
        let [width, height] = [("w", self.w), ("h", self.h)].map(|(key, value)| {
            let value = value.ok_or_else(|| missing(key))?;
            let is_whole = value >= 1.0 && value <= f64::from(u32::MAX) && value.fract() == 0.0;
            let bad = || ModelFault::BadValue {
                key: key.to_owned(),
                value: value.to_string(),
                rule: "a whole number of pixels",
            };
            if is_whole { Ok(value as u32) } else { Err(bad()) }
        });
        let [width, height] = [width?, height?];
        let from_angle = |angle_rad: f64| 0.5 * f64::from(width) / (0.5 * angle_rad).tan();
        let fx = self.fl_x.or(self.camera_angle_x.map(from_angle)).ok_or_else(|| missing("fl_x"))?;
        let fy = self.fl_y.unwrap_or(fx);
        let cx = self.cx.unwrap_or(0.5 * f64::from(width)) - HALF_PIXEL;
        let cy = self.cy.unwrap_or(0.5 * f64::from(height)) - HALF_PIXEL;
        Camera::new([width, height], [fx, fy, cx, cy], self.distortion(model.unwrap_or(DEFAULT_MODEL))?)
            .map_err(|error| ModelFault::Camera { id: 0, error })
    }

    fn distortion(&self, model: &str) -> Result<Distortion, ModelFault> {
        let [k1, k2, k3, k4, p1, p2] =
            [self.k1, self.k2, self.k3, self.k4, self.p1, self.p2].map(|term| term.unwrap_or(0.0));
        let is_plain = [k1, k2, k3, k4, p1, p2].iter().all(|term| *term == 0.0);
        match model {
            "PINHOLE" | "SIMPLE_PINHOLE" | "PERSPECTIVE" | "OPENCV" | "RADIAL" | "SIMPLE_RADIAL" => {
                if k4 != 0.0 {
                    return Err(ModelFault::UnsupportedTerms { model: "OPENCV", terms: "k4" });
                }
                let has_no_terms = is_plain && model != "OPENCV";
                Ok(match has_no_terms {
                    true => Distortion::Pinhole,
                    false => Distortion::Opencv(Opencv { k1, k2, p1, p2, k3 }),
                })
            }
            "OPENCV_FISHEYE" | "FISHEYE" | "SIMPLE_RADIAL_FISHEYE" | "RADIAL_FISHEYE" => {
                if p1 != 0.0 || p2 != 0.0 {
                    return Err(ModelFault::UnsupportedTerms { model: "OPENCV_FISHEYE", terms: "p1 or p2" });
                }
                Ok(Distortion::OpencvFisheye(OpencvFisheye { k: [k1, k2, k3, k4] }))
            }
            model => Err(ModelFault::UnknownCameraModel { model: excerpt(model) }),
        }
    }
}
