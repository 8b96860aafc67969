//! A model, as COLMAP's files hold it.

use super::{camera::ColmapCamera, image::ColmapImage};
use crate::{
    line_points::{LINE_SRGB, line_points, seen_points},
    posed::PosedPictures,
};

/// Model as COLMAP's files hold it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ColmapModel {
    /// Cameras.
    pub cameras: Vec<ColmapCamera>,
    /// Pictures with their poses.
    pub images: Vec<ColmapImage>,
    /// Points in the world.
    pub points: Vec<ColmapPoint>,
}

/// Point in the world, with the pictures that show it.
#[derive(Debug, Clone, PartialEq)]
pub struct ColmapPoint {
    /// Number in the model, from 1.
    pub id: u64,
    /// Place in the world, metres.
    pub point_in_world: [f64; 3],
    /// Colour, sRGB.
    pub srgb: [u8; 3],
    /// Pictures that show it: image id, and place among the keypoints of that image.
    pub track: Vec<(u32, u32)>,
}

impl ColmapModel {
    /// Makes the model of pictures that have been written. Its points lie on the field's lines, and its keypoints are where
    /// the cameras see them.
    pub fn new(posed: &PosedPictures) -> Self {
        let cameras = (1..).zip(&posed.cameras).map(|(id, camera)| ColmapCamera::new(id, camera)).collect();
        let places = line_points(&posed.field);
        let mut points: Vec<ColmapPoint> = (1..)
            .zip(&places)
            .map(|(id, place)| ColmapPoint {
                id,
                point_in_world: place.to_array(),
                srgb: LINE_SRGB,
                track: Vec::new(),
            })
            .collect();
        let mut images = Vec::with_capacity(posed.pictures.len());
        for (id, picture) in (1..).zip(&posed.pictures) {
            let seen = seen_points(posed.camera(picture), picture.pose, &places);
            for (place, (point, _)) in (0..).zip(&seen) {
                points[*point].track.push((id, place));
            }
            images.push(ColmapImage::new(id, picture, &seen));
        }
        Self { cameras, images, points }
    }
}
