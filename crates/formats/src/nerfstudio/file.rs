//! The file's keys.

use serde::{Deserialize, Serialize};

/// Intrinsics, of all pictures or of one.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Intrinsics {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fl_x: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fl_y: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cx: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cy: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub w: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub h: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera_angle_x: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub k1: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub k2: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub k3: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub k4: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p1: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p2: Option<f64>,
}

impl Intrinsics {
    /// Returns the values, with those of `common` where there are none.
    pub fn or(self, common: &Self) -> Self {
        Self {
            fl_x: self.fl_x.or(common.fl_x),
            fl_y: self.fl_y.or(common.fl_y),
            cx: self.cx.or(common.cx),
            cy: self.cy.or(common.cy),
            w: self.w.or(common.w),
            h: self.h.or(common.h),
            camera_angle_x: self.camera_angle_x.or(common.camera_angle_x),
            k1: self.k1.or(common.k1),
            k2: self.k2.or(common.k2),
            k3: self.k3.or(common.k3),
            k4: self.k4.or(common.k4),
            p1: self.p1.or(common.p1),
            p2: self.p2.or(common.p2),
        }
    }
}

/// One picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Frame {
    pub file_path: String,
    /// Time, seconds: a key that nerfstudio ignores.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timestamp_s: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera_model: Option<String>,
    #[serde(flatten)]
    pub intrinsics: Intrinsics,
    pub transform_matrix: Vec<Vec<f64>>,
}

/// The whole file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Transforms {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera_model: Option<String>,
    #[serde(flatten)]
    pub intrinsics: Intrinsics,
    /// Rotation and shift that were applied to the world, three rows of four numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub applied_transform: Option<Vec<Vec<f64>>>,
    /// Factor by which the places were multiplied.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub applied_scale: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ply_file_path: Option<String>,
    pub frames: Vec<Frame>,
}
