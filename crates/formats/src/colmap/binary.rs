//! COLMAP's binary files.

use std::path::Path;

use super::{
    bytes::Bytes,
    camera::{ColmapCamera, ColmapLens},
    image::ColmapImage,
    model::ColmapModel,
};
use crate::model_error::{ModelError, ModelFault};

/// Bytes of a camera without its parameters: id, model, width, height.
const CAMERA_BYTES: usize = 4 + 4 + 8 + 8;

/// Bytes of an image with an empty name and no keypoints: id, rotation, translation, camera, zero byte, count.
const IMAGE_BYTES: usize = 4 + 7 * 8 + 4 + 1 + 8;

/// Bytes of a keypoint: two coordinates, a point's id.
const KEYPOINT_BYTES: usize = 3 * 8;

/// Returns names and bytes of the binary files, that of the images last: it makes a folder a model.
pub(super) fn binaries(model: &ColmapModel) -> [(&'static str, Vec<u8>); 3] {
    [
        ("cameras.bin", model.cameras_binary()),
        ("points3D.bin", model.points_binary()),
        ("images.bin", model.images_binary()),
    ]
}

impl ColmapModel {
    fn cameras_binary(&self) -> Vec<u8> {
        let mut bytes = count(self.cameras.len());
        for camera in &self.cameras {
            bytes.extend(camera.id.to_le_bytes());
            bytes.extend(camera.lens.number().to_le_bytes());
            bytes.extend(camera.width.to_le_bytes());
            bytes.extend(camera.height.to_le_bytes());
            push_numbers(&mut bytes, &camera.parameters);
        }
        bytes
    }

    fn images_binary(&self) -> Vec<u8> {
        let mut bytes = count(self.images.len());
        for image in &self.images {
            bytes.extend(image.id.to_le_bytes());
            push_numbers(&mut bytes, &image.rotation_wxyz);
            push_numbers(&mut bytes, &image.translation);
            bytes.extend(image.camera_id.to_le_bytes());
            bytes.extend(image.name.as_bytes());
            bytes.push(0);
            bytes.extend(count(image.keypoints.len()));
            for keypoint in &image.keypoints {
                push_numbers(&mut bytes, &keypoint.pixel);
                bytes.extend(keypoint.point_id.to_le_bytes());
            }
        }
        bytes
    }

    fn points_binary(&self) -> Vec<u8> {
        let mut bytes = count(self.points.len());
        for point in &self.points {
            bytes.extend(point.id.to_le_bytes());
            push_numbers(&mut bytes, &point.point_in_world);
            bytes.extend(point.srgb);
            // The error of the point: it is where the field's model has it.
            push_numbers(&mut bytes, &[0.0]);
            bytes.extend(count(point.track.len()));
            for (image, place) in &point.track {
                bytes.extend(image.to_le_bytes());
                bytes.extend(place.to_le_bytes());
            }
        }
        bytes
    }
}

fn count(length: usize) -> Vec<u8> {
    (length as u64).to_le_bytes().to_vec()
}

fn push_numbers(bytes: &mut Vec<u8>, numbers: &[f64]) {
    bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
}

/// Decodes `cameras.bin`.
pub(super) fn parse_cameras(path: &Path, bytes: &[u8]) -> Result<Vec<ColmapCamera>, ModelError> {
    let mut bytes = Bytes::new(path, bytes);
    let count = bytes.count("cameras", CAMERA_BYTES)?;
    (0..count).map(|_| camera(&mut bytes)).collect()
}

fn camera(bytes: &mut Bytes<'_>) -> Result<ColmapCamera, ModelError> {
    let (id, number) = (bytes.u32("a camera")?, bytes.i32("a camera")?);
    let (width, height) = (bytes.u64("a camera")?, bytes.u64("a camera")?);
    let lens = ColmapLens::ALL.into_iter().find(|lens| lens.number() == number);
    let lens =
        lens.ok_or_else(|| bytes.fail(ModelFault::UnknownCameraModel { model: format!("number {number}") }))?;
    let parameters =
        (0..lens.parameter_count()).map(|_| bytes.f64("a camera's parameters")).collect::<Result<_, _>>()?;
    Ok(ColmapCamera { id, lens, width, height, parameters })
}

/// Decodes `images.bin`, without the keypoints.
pub(super) fn parse_images(path: &Path, bytes: &[u8]) -> Result<Vec<ColmapImage>, ModelError> {
    let mut bytes = Bytes::new(path, bytes);
    let count = bytes.count("images", IMAGE_BYTES)?;
    (0..count).map(|_| image(&mut bytes)).collect()
}

fn image(bytes: &mut Bytes<'_>) -> Result<ColmapImage, ModelError> {
    let id = bytes.u32("an image")?;
    let (rotation_wxyz, translation) = (bytes.f64s("an image's pose")?, bytes.f64s("an image's pose")?);
    let camera_id = bytes.u32("an image")?;
    let name = bytes.text("an image's name")?;
    let keypoints = bytes.count("points of an image", KEYPOINT_BYTES)?;
    bytes.skip(keypoints * KEYPOINT_BYTES);
    Ok(ColmapImage { id, rotation_wxyz, translation, camera_id, name, keypoints: Vec::new() })
}
