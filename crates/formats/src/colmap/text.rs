//! COLMAP's text files.

use std::{
    fmt::{Display, Write},
    path::Path,
    str::FromStr,
};

use super::{
    camera::{ColmapCamera, ColmapLens},
    image::ColmapImage,
    model::ColmapModel,
};
use crate::model_error::{ModelError, ModelFault, excerpt};

/// Returns names and texts of the text files, that of the images last: it makes a folder a model.
pub(super) fn texts(model: &ColmapModel) -> [(&'static str, String); 3] {
    [
        ("cameras.txt", model.cameras_text()),
        ("points3D.txt", model.points_text()),
        ("images.txt", model.images_text()),
    ]
}

impl ColmapModel {
    fn cameras_text(&self) -> String {
        let mut text = String::from("# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n");
        for camera in &self.cameras {
            let ColmapCamera { id, lens, width, height, parameters } = camera;
            // Writing into a string cannot fail.
            let _ = writeln!(text, "{id} {} {width} {height} {}", lens.name(), spaced(parameters));
        }
        text
    }

    fn images_text(&self) -> String {
        let mut text =
            String::from("# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME\n# POINTS2D[] as X Y POINT3D_ID\n");
        for image in &self.images {
            let ColmapImage { id, rotation_wxyz, translation, camera_id, name, keypoints } = image;
            let pose = format!("{} {}", spaced(rotation_wxyz), spaced(translation));
            let keypoints =
                keypoints.iter().map(|point| format!("{} {}", spaced(&point.pixel), point.point_id));
            let keypoints: Vec<String> = keypoints.collect();
            let _ = writeln!(text, "{id} {pose} {camera_id} {name}\n{}", keypoints.join(" "));
        }
        text
    }

    fn points_text(&self) -> String {
        let mut text = String::from("# POINT3D_ID X Y Z R G B ERROR TRACK[] as IMAGE_ID POINT2D_IDX\n");
        for point in &self.points {
            let track = point.track.iter().map(|(image, place)| format!(" {image} {place}"));
            let track: String = track.collect();
            let (place, color) = (spaced(&point.point_in_world), spaced(&point.srgb));
            let _ = writeln!(text, "{} {place} {color} 0{track}", point.id);
        }
        text
    }
}

fn spaced(values: &[impl Display]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

/// Parses `cameras.txt`.
pub(super) fn parse_cameras(path: &Path, text: &str) -> Result<Vec<ColmapCamera>, ModelError> {
    let lines = text.lines().enumerate().filter(|(_, line)| is_content(line));
    lines.map(|(index, line)| camera(line).map_err(|fault| ModelError::at(path, index + 1, fault))).collect()
}

fn camera(line: &str) -> Result<ColmapCamera, ModelFault> {
    let mut fields = Fields::new(line);
    let id = fields.next("CAMERA_ID")?;
    let model = fields.text("MODEL")?;
    let lens = ColmapLens::ALL.into_iter().find(|lens| lens.name() == model);
    let lens = lens.ok_or_else(|| ModelFault::UnknownCameraModel { model: excerpt(model) })?;
    let (width, height) = (fields.next("WIDTH")?, fields.next("HEIGHT")?);
    let parameters = (0..lens.parameter_count()).map(|_| fields.next("PARAMS")).collect::<Result<_, _>>()?;
    if let Some(more) = fields.rest().split_whitespace().next() {
        let rule = "left out: the camera model has fewer parameters";
        return Err(ModelFault::BadValue { key: "PARAMS".to_owned(), value: excerpt(more), rule });
    }
    Ok(ColmapCamera { id, lens, width, height, parameters })
}

/// Parses `images.txt`, without the keypoints: every image has two lines, of which the second may be empty.
pub(super) fn parse_images(path: &Path, text: &str) -> Result<Vec<ColmapImage>, ModelError> {
    let mut images = Vec::new();
    let mut lines = text.lines().enumerate();
    while let Some((index, line)) = lines.next() {
        if is_content(line) {
            images.push(image(line).map_err(|fault| ModelError::at(path, index + 1, fault))?);
            lines.next();
        }
    }
    Ok(images)
}

fn image(line: &str) -> Result<ColmapImage, ModelFault> {
    let mut fields = Fields::new(line);
    let id = fields.next("IMAGE_ID")?;
    let rotation_wxyz = [fields.next("QW")?, fields.next("QX")?, fields.next("QY")?, fields.next("QZ")?];
    let translation = [fields.next("TX")?, fields.next("TY")?, fields.next("TZ")?];
    let camera_id = fields.next("CAMERA_ID")?;
    let name = fields.rest().trim().to_owned();
    if name.is_empty() {
        return Err(ModelFault::MissingValue { key: "NAME".to_owned() });
    }
    Ok(ColmapImage { id, rotation_wxyz, translation, camera_id, name, keypoints: Vec::new() })
}

fn is_content(line: &str) -> bool {
    let line = line.trim_start();
    !line.is_empty() && !line.starts_with('#')
}

/// Fields of a line, separated by blanks.
struct Fields<'a> {
    rest: &'a str,
}

impl<'a> Fields<'a> {
    fn new(line: &'a str) -> Self {
        Self { rest: line }
    }

    fn rest(&self) -> &'a str {
        self.rest
    }

    fn text(&mut self, key: &str) -> Result<&'a str, ModelFault> {
        let rest = self.rest.trim_start();
        let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
        let (field, rest) = rest.split_at(end);
        self.rest = rest;
        if field.is_empty() { Err(ModelFault::MissingValue { key: key.to_owned() }) } else { Ok(field) }
    }

    fn next<T: FromStr>(&mut self, key: &str) -> Result<T, ModelFault> {
        let field = self.text(key)?;
        field.parse().map_err(|_| ModelFault::BadValue {
            key: key.to_owned(),
            value: excerpt(field),
            rule: "a number",
        })
    }
}
