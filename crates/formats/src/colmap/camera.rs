//! COLMAP's cameras, and their lens models.

use reality_sim_core::camera::{Camera, Distortion, InvalidCamera, Opencv, OpencvFisheye};

use crate::{model_error::ModelFault, pixels::HALF_PIXEL};

/// Lens models of COLMAP that can be represented here, with its numbers (`src/colmap/sensor/models.h`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColmapLens {
    /// f, cx, cy.
    SimplePinhole,
    /// fx, fy, cx, cy.
    Pinhole,
    /// f, cx, cy, k.
    SimpleRadial,
    /// f, cx, cy, k1, k2.
    Radial,
    /// fx, fy, cx, cy, k1, k2, p1, p2.
    Opencv,
    /// fx, fy, cx, cy, k1, k2, k3, k4.
    OpencvFisheye,
    /// fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6; k4 to k6 have to be 0.
    FullOpencv,
    /// f, cx, cy, k.
    SimpleRadialFisheye,
    /// f, cx, cy, k1, k2.
    RadialFisheye,
}

impl ColmapLens {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::SimplePinhole,
        Self::Pinhole,
        Self::SimpleRadial,
        Self::Radial,
        Self::Opencv,
        Self::OpencvFisheye,
        Self::FullOpencv,
        Self::SimpleRadialFisheye,
        Self::RadialFisheye,
    ];

    /// Returns the name in text files.
    pub fn name(self) -> &'static str {
        match self {
            Self::SimplePinhole => "SIMPLE_PINHOLE",
            Self::Pinhole => "PINHOLE",
            Self::SimpleRadial => "SIMPLE_RADIAL",
            Self::Radial => "RADIAL",
            Self::Opencv => "OPENCV",
            Self::OpencvFisheye => "OPENCV_FISHEYE",
            Self::FullOpencv => "FULL_OPENCV",
            Self::SimpleRadialFisheye => "SIMPLE_RADIAL_FISHEYE",
            Self::RadialFisheye => "RADIAL_FISHEYE",
        }
    }

    /// Returns the number in binary files.
    pub fn number(self) -> i32 {
        match self {
            Self::SimplePinhole => 0,
            Self::Pinhole => 1,
            Self::SimpleRadial => 2,
            Self::Radial => 3,
            Self::Opencv => 4,
            Self::OpencvFisheye => 5,
            Self::FullOpencv => 6,
            Self::SimpleRadialFisheye => 8,
            Self::RadialFisheye => 9,
        }
    }

    /// Returns the number of parameters.
    pub fn parameter_count(self) -> usize {
        match self {
            Self::SimplePinhole => 3,
            Self::Pinhole | Self::SimpleRadial | Self::SimpleRadialFisheye => 4,
            Self::Radial | Self::RadialFisheye => 5,
            Self::Opencv | Self::OpencvFisheye => 8,
            Self::FullOpencv => 12,
        }
    }

    /// Whether one focal length stands for both.
    fn has_one_focal_length(self) -> bool {
        matches!(
            self,
            Self::SimplePinhole
                | Self::SimpleRadial
                | Self::Radial
                | Self::SimpleRadialFisheye
                | Self::RadialFisheye
        )
    }

    fn distortion(self, terms: &[f64]) -> Result<Distortion, ModelFault> {
        let term = |index: usize| terms.get(index).copied().unwrap_or(0.0);
        Ok(match self {
            Self::SimplePinhole | Self::Pinhole => Distortion::Pinhole,
            Self::SimpleRadial | Self::Radial => {
                Distortion::Opencv(Opencv { k1: term(0), k2: term(1), ..Opencv::default() })
            }
            Self::Opencv | Self::FullOpencv => {
                if (5..8).any(|index| term(index) != 0.0) {
                    return Err(ModelFault::UnsupportedTerms { model: self.name(), terms: "k4, k5 or k6" });
                }
                Distortion::Opencv(Opencv { k1: term(0), k2: term(1), p1: term(2), p2: term(3), k3: term(4) })
            }
            Self::OpencvFisheye | Self::SimpleRadialFisheye | Self::RadialFisheye => {
                Distortion::OpencvFisheye(OpencvFisheye { k: [term(0), term(1), term(2), term(3)] })
            }
        })
    }
}

/// Camera as COLMAP's files hold it.
#[derive(Debug, Clone, PartialEq)]
pub struct ColmapCamera {
    /// Number in the model.
    pub id: u32,
    /// Lens model.
    pub lens: ColmapLens,
    /// Width of the picture, pixels.
    pub width: u64,
    /// Height of the picture, pixels.
    pub height: u64,
    /// Parameters in the lens model's order, the principal point in COLMAP's pixels.
    pub parameters: Vec<f64>,
}

impl ColmapCamera {
    /// Makes a camera of the lens model that has its terms: `OPENCV` without k3, `FULL_OPENCV` with it.
    pub fn new(id: u32, camera: &Camera) -> Self {
        let (lens, terms) = match camera.distortion {
            Distortion::Pinhole => (ColmapLens::Pinhole, Vec::new()),
            Distortion::Opencv(Opencv { k1, k2, p1, p2, k3: 0.0 }) => {
                (ColmapLens::Opencv, vec![k1, k2, p1, p2])
            }
            Distortion::Opencv(Opencv { k1, k2, p1, p2, k3 }) => {
                (ColmapLens::FullOpencv, vec![k1, k2, p1, p2, k3, 0.0, 0.0, 0.0])
            }
            Distortion::OpencvFisheye(OpencvFisheye { k }) => (ColmapLens::OpencvFisheye, k.to_vec()),
        };
        let mut parameters = vec![camera.fx, camera.fy, camera.cx + HALF_PIXEL, camera.cy + HALF_PIXEL];
        parameters.extend(terms);
        Self { id, lens, width: camera.width.into(), height: camera.height.into(), parameters }
    }

    /// Returns the camera with our pixels. Fails if its numbers cannot be used.
    pub fn camera(&self) -> Result<Camera, ModelFault> {
        let (intrinsics, terms) = match (self.lens.has_one_focal_length(), self.parameters.as_slice()) {
            (true, [f, cx, cy, terms @ ..]) => ([*f, *f, *cx, *cy], terms),
            (false, [fx, fy, cx, cy, terms @ ..]) => ([*fx, *fy, *cx, *cy], terms),
            _ => return Err(ModelFault::MissingValue { key: format!("parameters of camera {}", self.id) }),
        };
        let [fx, fy, cx, cy] = intrinsics;
        let [width, height] = [self.width, self.height].map(|side| u32::try_from(side).unwrap_or(u32::MAX));
        let invalid = |error: InvalidCamera| ModelFault::Camera { id: self.id, error };
        let distortion = self.lens.distortion(terms)?;
        let intrinsics = [fx, fy, cx - HALF_PIXEL, cy - HALF_PIXEL];
        Camera::new([width, height], intrinsics, distortion).map_err(invalid)
    }
}
