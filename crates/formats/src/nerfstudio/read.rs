//! A `transforms.json` as a recording.

use std::path::{Path, PathBuf};

use glam::DMat4;
use reality_sim_core::{pose::CameraPose, sequence::one_line};

use super::{
    TRANSFORMS_FILE,
    file::{Frame, Transforms},
    matrix::{matrix, pose_of_matrix},
};
use crate::{
    file::{MAX_TABLE_BYTES, is_inside_folder, read_text},
    model_error::{ModelError, ModelFault, excerpt},
    model_import::{ForeignModel, ForeignPicture, ModelImport, ModelImportReport},
};

/// Reads a `transforms.json`, or the folder that holds it, and writes it as a recording with reference poses.
///
/// `applied_transform` and `applied_scale` are undone. Times are those of the key `timestamp_s`, where every frame has it; else
/// the pictures, sorted by name, are a fixed time apart. Fails with the first value that is missing or impossible, if there are
/// several cameras, if the poses are impossible over a field, or if a picture cannot be copied.
pub fn read_nerfstudio_as_sequence(
    input: &Path,
    out: &Path,
    options: &ModelImport,
) -> Result<ModelImportReport, ModelError> {
    let path = if input.is_dir() { input.join(TRANSFORMS_FILE) } else { input.to_path_buf() };
    let text = read_text(&path, MAX_TABLE_BYTES)?;
    foreign_model(&path, &text, options)?.write(out, options)
}

fn foreign_model(path: &Path, text: &str, options: &ModelImport) -> Result<ForeignModel, ModelError> {
    let transforms: Transforms = serde_json::from_str(text).map_err(|error| {
        ModelError::at(path, error.line(), ModelFault::Syntax { message: one_line(&error) })
    })?;
    let fail = |fault| ModelError::of_file(path, fault);
    let undone = Undone::of(&transforms).map_err(fail)?;
    let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
    let mut model = ForeignModel::new(path);
    for frame in &transforms.frames {
        let name = frame.camera_model.as_deref().or(transforms.camera_model.as_deref());
        model.add_camera(frame.intrinsics.or(&transforms.intrinsics).camera(name).map_err(fail)?);
        model.pictures.push(ForeignPicture {
            file: picture_file(frame, &folder, options).map_err(fail)?,
            name: frame.file_path.clone(),
            timestamp_s: frame.timestamp_s,
            pose: undone.pose(frame).map_err(fail)?,
        });
    }
    Ok(model)
}

fn picture_file(frame: &Frame, folder: &Path, options: &ModelImport) -> Result<PathBuf, ModelFault> {
    let name = Path::new(&frame.file_path);
    if !is_inside_folder(name) {
        return Err(ModelFault::PathLeavesFolder { name: excerpt(&frame.file_path) });
    }
    Ok(match &options.images {
        Some(images) => images.join(name.file_name().unwrap_or_default()),
        None => folder.join(name),
    })
}

/// What undoes the transform that a tool has applied to the world.
struct Undone {
    original_from_file: DMat4,
    scale: f64,
}

impl Undone {
    fn of(transforms: &Transforms) -> Result<Self, ModelFault> {
        let bad = |key: &str, rule| ModelFault::BadValue {
            key: key.to_owned(),
            value: "something else".to_owned(),
            rule,
        };
        let file_from_original = match &transforms.applied_transform {
            Some(rows) => {
                let rule = "three rows of four finite numbers, a rotation and a shift";
                let is_rigid = |matrix: &DMat4| (matrix.determinant().abs() - 1.0).abs() < 1e-3;
                matrix(rows).filter(is_rigid).ok_or_else(|| bad("applied_transform", rule))?
            }
            None => DMat4::IDENTITY,
        };
        let scale = transforms.applied_scale.unwrap_or(1.0);
        if !(scale.is_finite() && scale > 0.0) {
            return Err(bad("applied_scale", "a finite number above 0"));
        }
        Ok(Self { original_from_file: file_from_original.inverse(), scale })
    }

    fn pose(&self, frame: &Frame) -> Result<CameraPose, ModelFault> {
        let no_rotation = || ModelFault::NoRotation { picture: excerpt(&frame.file_path) };
        let mut matrix = matrix(&frame.transform_matrix).ok_or_else(no_rotation)?;
        matrix.w_axis = (matrix.w_axis.truncate() / self.scale).extend(1.0);
        pose_of_matrix(&(self.original_from_file * matrix)).ok_or_else(no_rotation)
    }
}
