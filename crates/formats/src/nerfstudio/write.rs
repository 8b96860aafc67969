//! Writing `transforms.json`.

use std::{fmt::Write, path::Path};

use reality_sim_core::sequence::write_atomically;

use super::{
    TRANSFORMS_FILE,
    file::{Frame, Intrinsics, Transforms},
    matrix::rows_of_pose,
};
use crate::{
    line_points::{LINE_SRGB, line_points},
    model_error::{ModelError, ModelFault},
    posed::{IMAGES, PosedPictures},
};

/// Name of the file with points on the field's lines, from which splats may start.
pub const POINTS_FILE: &str = "sparse_pc.ply";

/// Writes pictures that have been written before as a `transforms.json`, with points on the field's lines beside it. Intrinsics
/// are the file's where there is one camera, and each picture's where there are several. Fails if the cameras have different
/// models, or if a file cannot be written.
pub fn write_nerfstudio(posed: &PosedPictures, folder: &Path) -> Result<(), ModelError> {
    let path = folder.join(TRANSFORMS_FILE);
    let models: Vec<&str> = posed.cameras.iter().map(|camera| camera.distortion.colmap_name()).collect();
    if models.iter().any(|model| *model != models[0]) {
        return Err(ModelError::of_file(&path, ModelFault::MixedModels { format: "nerfstudio" }));
    }
    write_atomically(&folder.join(POINTS_FILE), points(posed).as_bytes())?;
    let text = serde_json::to_string_pretty(&transforms(posed, models.first().copied()))
        .map_err(|error| ModelError::of_file(&path, ModelFault::Unwritable(error.into())))?;
    Ok(write_atomically(&path, text.as_bytes())?)
}

fn transforms(posed: &PosedPictures, model: Option<&str>) -> Transforms {
    let common = match posed.cameras.as_slice() {
        [camera] => Some(Intrinsics::of_camera(camera)),
        _ => None,
    };
    let frames = posed.pictures.iter().map(|picture| Frame {
        file_path: format!("{IMAGES}/{}", picture.file_name),
        timestamp_s: Some(picture.timestamp_s),
        camera_model: None,
        intrinsics: match common {
            Some(_) => Intrinsics::default(),
            None => Intrinsics::of_camera(posed.camera(picture)),
        },
        transform_matrix: rows_of_pose(picture.pose),
    });
    Transforms {
        camera_model: model.map(str::to_owned),
        intrinsics: common.unwrap_or_default(),
        applied_transform: None,
        applied_scale: None,
        ply_file_path: Some(POINTS_FILE.to_owned()),
        frames: frames.collect(),
    }
}

/// Returns the text of a PLY file with points on the field's lines.
fn points(posed: &PosedPictures) -> String {
    let points = line_points(&posed.field);
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
        points.len()
    );
    let [red, green, blue] = LINE_SRGB;
    for point in points {
        // Writing into a string cannot fail.
        let _ = writeln!(text, "{} {} {} {red} {green} {blue}", point.x, point.y, point.z);
    }
    text
}
