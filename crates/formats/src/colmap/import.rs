//! A COLMAP model as a recording.

use std::{
    collections::{HashMap, HashSet},
    path::{Path, PathBuf},
};

use super::{
    binary,
    camera::ColmapCamera,
    folders::{TIMESTAMPS_FILE, model_folder},
    image::ColmapImage,
    text,
};
use crate::{
    file::{MAX_MODEL_BYTES, MAX_TABLE_BYTES, is_inside_folder, read_bytes, read_text},
    model_error::{ModelError, ModelFault, excerpt},
    model_import::{ForeignModel, ForeignPicture, ModelImport, ModelImportReport},
    posed::IMAGES,
};

/// Reads a COLMAP model, text or binary, from the folder that holds its files or from that of a project, which has them in
/// `sparse/0`. Fails with the first value that is missing or impossible.
pub fn read_colmap(folder: &Path) -> Result<(Vec<ColmapCamera>, Vec<ColmapImage>), ModelError> {
    let nothing = || {
        let what = "images.bin or images.txt of a COLMAP model";
        ModelError::of_file(folder, ModelFault::NothingThere { what })
    };
    let folder = model_folder(folder).ok_or_else(nothing)?;
    // Binary files come first, as in COLMAP.
    if folder.join("images.bin").is_file() {
        let (cameras, images) = (folder.join("cameras.bin"), folder.join("images.bin"));
        Ok((
            binary::parse_cameras(&cameras, &read_bytes(&cameras, MAX_MODEL_BYTES)?)?,
            binary::parse_images(&images, &read_bytes(&images, MAX_MODEL_BYTES)?)?,
        ))
    } else {
        let (cameras, images) = (folder.join("cameras.txt"), folder.join("images.txt"));
        Ok((
            text::parse_cameras(&cameras, &read_text(&cameras, MAX_MODEL_BYTES)?)?,
            text::parse_images(&images, &read_text(&images, MAX_MODEL_BYTES)?)?,
        ))
    }
}

/// Reads a COLMAP model and writes it as a recording with reference poses.
///
/// The pictures lie in the folder that the options give, or in `images` beside the model or up to three folders above it.
/// Times come from [`TIMESTAMPS_FILE`] in the project's folder, where it is; else the pictures, sorted by name, are a fixed
/// time apart. Fails as [`read_colmap`] does, if there are several cameras, if the poses are impossible over a field, or if a
/// picture cannot be copied.
pub fn read_colmap_as_sequence(
    input: &Path,
    out: &Path,
    options: &ModelImport,
) -> Result<ModelImportReport, ModelError> {
    foreign_model(input, options)?.write(out, options)
}

fn foreign_model(input: &Path, options: &ModelImport) -> Result<ForeignModel, ModelError> {
    let (cameras, images) = read_colmap(input)?;
    let fail = |fault| ModelError::of_file(input, fault);
    let pictures_in = options.images.clone().unwrap_or_else(|| images_folder(input));
    let times = timestamps(input)?;
    let numbers: HashMap<u32, &ColmapCamera> = cameras.iter().map(|camera| (camera.id, camera)).collect();
    let mut seen = HashSet::new();
    let mut model = ForeignModel::new(input);
    for image in &images {
        let id = image.camera_id;
        if seen.insert(id) {
            let camera = numbers
                .get(&id)
                .ok_or_else(|| fail(ModelFault::NoSuchCamera { picture: excerpt(&image.name), id }))?;
            model.add_camera(camera.camera().map_err(fail)?);
        }
        if !is_inside_folder(Path::new(&image.name)) {
            return Err(fail(ModelFault::PathLeavesFolder { name: excerpt(&image.name) }));
        }
        model.pictures.push(ForeignPicture {
            file: pictures_in.join(&image.name),
            name: image.name.clone(),
            timestamp_s: times.get(&image.name).copied(),
            pose: image.pose().map_err(fail)?,
        });
    }
    Ok(model)
}

/// Folders in which a project's own files may lie: that of the model, and those above it.
fn project_folders(input: &Path) -> impl Iterator<Item = PathBuf> {
    let model = model_folder(input).unwrap_or_else(|| input.to_path_buf());
    let model = std::path::absolute(&model).unwrap_or(model);
    model.ancestors().take(4).map(Path::to_path_buf).collect::<Vec<_>>().into_iter()
}

fn images_folder(input: &Path) -> PathBuf {
    let folders = project_folders(input).map(|folder| folder.join(IMAGES));
    folders.into_iter().find(|folder| folder.is_dir()).unwrap_or_else(|| input.join(IMAGES))
}

/// Reads the pictures' times, where there are any.
fn timestamps(input: &Path) -> Result<HashMap<String, f64>, ModelError> {
    // Two folders above the model at most: what lies farther up is of something else.
    let mut files = project_folders(input).take(3).map(|folder| folder.join(TIMESTAMPS_FILE));
    let Some(path) = files.find(|file| file.is_file()) else { return Ok(HashMap::new()) };
    let text = read_text(&path, MAX_TABLE_BYTES)?;
    let mut times = HashMap::new();
    for (index, line) in text.lines().enumerate().skip(1).filter(|(_, line)| !line.trim().is_empty()) {
        let time = line.rsplit_once(',').and_then(|(name, time)| Some((name, time.trim().parse().ok()?)));
        let time = time.filter(|(_, time): &(&str, f64)| time.is_finite()).ok_or_else(|| {
            let (key, value) = ("timestamp_s".to_owned(), excerpt(line));
            ModelError::at(&path, index + 1, ModelFault::BadValue { key, value, rule: "IMAGE,SECONDS" })
        })?;
        times.insert(time.0.to_owned(), time.1);
    }
    Ok(times)
}
