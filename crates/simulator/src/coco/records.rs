//! Records of a COCO file.

use serde::Serialize;

use super::rle::Rle;

/// Kind of things that annotations mark.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Category {
    /// Number of the category.
    pub id: u32,
    /// Name of the category.
    pub name: String,
    /// Name of the group that it belongs to: `field` or `object`.
    pub supercategory: String,
    /// Names of the keypoints, if annotations of the category have any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub keypoints: Option<Vec<String>>,
    /// Places of the keypoints in the world, x and y, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub keypoint_places_m: Option<Vec<[f64; 2]>>,
    /// Pairs of keypoints that drawings join: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skeleton: Option<Vec<[u32; 2]>>,
}

/// Thing in a picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Annotation {
    /// Number of the annotation in its file.
    pub id: u64,
    /// Number of the picture.
    pub image_id: u64,
    /// Number of the category.
    pub category_id: u32,
    /// Left and upper edge, width and height of the box around its visible pixels, pixels.
    pub bbox: [u32; 4],
    /// Number of its visible pixels.
    pub area: u32,
    /// Its visible pixels.
    pub segmentation: Rle,
    /// Whether it is a crowd: 0, never.
    pub iscrowd: u8,
    /// Share of its pixels in the picture before which nothing stands, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub visibility: Option<f64>,
    /// Share of it that lies outside the picture, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truncation: Option<f64>,
    /// Value of its pixels in a picture of instances.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub instance: Option<u16>,
    /// Name of the thing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Column, row and visibility of every keypoint: 0 outside the picture, 1 hidden, 2 visible.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub keypoints: Option<Vec<f64>>,
    /// Number of keypoints in the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub num_keypoints: Option<usize>,
}

/// Part of a white line in view.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SeenLineRecord {
    /// Kind of the line.
    pub kind: &'static str,
    /// Number of the line on the field.
    pub line: usize,
    /// Columns and rows of the points that straight lines join, pixels.
    pub pixels: Vec<[f64; 2]>,
}

/// Crossing or mark in the picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SeenCrossingRecord {
    /// Kind of the crossing.
    pub kind: &'static str,
    /// Place on the ground, world axes, metres.
    pub place_m: [f64; 2],
    /// Column and row, pixels.
    pub pixel: [f64; 2],
    /// Whether nothing stands before it.
    pub visible: bool,
}
