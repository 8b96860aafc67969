//! `[calibration]` in `camera.toml`: how far the camera's numbers can be trusted, a table of its own behind the camera's text.

use std::{fmt::Write, path::Path};

use nalgebra::DMatrix;
use serde::Deserialize;

use super::{
    error::{Fault, SequenceError},
    limits::MAX_TOML_BYTES,
    text::read_and_parse,
    toml_text::{NumberCheck, line_of_key, parse},
};
use crate::{camera::Camera, mount::MountPoseSigma, refine::CalibrationUncertainty};

/// Names of the mount's parameters, behind those of the lens.
const OF_MOUNT: [&str; 3] = ["height_m", "mount_pitch_rad", "mount_roll_rad"];

#[derive(Deserialize)]
struct File {
    calibration: Option<CalibrationTable>,
}

#[derive(Deserialize)]
struct CalibrationTable {
    covariance: Vec<Vec<f64>>,
    #[serde(default)]
    mount_sigma: Option<SigmaTable>,
}

/// Table for a [`MountPoseSigma`] to which other programs may add keys.
#[derive(Deserialize)]
struct SigmaTable {
    height_m: f64,
    angle_rad: f64,
}

/// Reads how far the numbers of a camera file can be trusted; `None` if the file does not say it. Fails if the file cannot be
/// read, or if what it says is no covariance of this camera's parameters.
pub fn read_calibration(
    path: &Path,
    camera: &Camera,
) -> Result<Option<CalibrationUncertainty>, SequenceError> {
    read_and_parse(path, MAX_TOML_BYTES, |path, text| parsed(path, text, camera))
}

fn parsed(path: &Path, text: &str, camera: &Camera) -> Result<Option<CalibrationUncertainty>, SequenceError> {
    let Some(table) = parse::<File>(path, text)?.calibration else { return Ok(None) };
    let rows = table.covariance.len();
    // Rows of different lengths are no matrix: they get a size that no camera has.
    let columns = if table.covariance.iter().all(|row| row.len() == rows) { rows } else { 0 };
    let values = table.covariance.iter().flatten().copied().take(rows * columns);
    let covariance = DMatrix::from_row_iterator(rows.min(columns), columns, values);
    let uncertainty = CalibrationUncertainty::new(camera, covariance).map_err(|reason| {
        let line = line_of_key(text, &["calibration", "covariance"]);
        SequenceError::at(path, line, Fault::Covariance(reason))
    })?;
    let Some(sigma) = table.mount_sigma else { return Ok(Some(uncertainty)) };
    let numbers = NumberCheck { path, text, table: "calibration.mount_sigma" };
    numbers.check(
        "height_m",
        sigma.height_m,
        |value| value > 0.0 && value <= 1.0,
        "above 0 and at most 1 metre",
    )?;
    numbers.check(
        "angle_rad",
        sigma.angle_rad,
        |value| value > 0.0 && value <= 1.0,
        "above 0 and at most 1 radian",
    )?;
    let sigma = MountPoseSigma { height_m: sigma.height_m, angle_rad: sigma.angle_rad };
    Ok(Some(uncertainty.with_mount_sigma(sigma)))
}

/// Returns the text of a camera's file with how far its numbers can be trusted.
pub fn camera_with_uncertainty(text: &str, camera: &Camera, uncertainty: &CalibrationUncertainty) -> String {
    let covariance = uncertainty.covariance();
    let names = ["fx", "fy", "cx", "cy"].into_iter().chain(camera.distortion.names().iter().copied());
    let names: Vec<String> = names.chain(OF_MOUNT).map(|name| format!("\"{name}\"")).collect();
    let mut text = format!("{text}\n[calibration]\nparameters = [{}]\ncovariance = [\n", names.join(", "));
    for row in covariance.row_iter() {
        let values: Vec<String> = row.iter().map(|value| format!("{value:e}")).collect();
        // Writing into a string cannot fail.
        let _ = writeln!(text, "    [{}],", values.join(", "));
    }
    text.push_str("]\n");
    if let Some(sigma) = uncertainty.mount_sigma() {
        let (height_m, angle_rad) = (sigma.height_m, sigma.angle_rad);
        let _ = writeln!(text, "mount_sigma = {{ height_m = {height_m}, angle_rad = {angle_rad} }}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{sequence::CameraSetup, test_scene};

    fn camera_text(camera: &Camera) -> String {
        let setup = CameraSetup { camera: camera.clone(), mount_height_m: 0.5, photometry: None };
        setup.to_toml(Path::new("camera.toml")).unwrap()
    }

    #[test]
    fn what_is_written_is_read_back() {
        let camera = test_scene::fisheye();
        let size = 4 + camera.distortion.parameters().len() + 3;
        let half =
            DMatrix::from_fn(size, size, |i, j| ((3 * i + 5 * j) as f64).sin() / 10.0_f64.powi(i as i32));
        let covariance = &half * half.transpose();
        let uncertainty = CalibrationUncertainty::new(&camera, covariance).unwrap();
        let sigma = MountPoseSigma { height_m: 0.012, angle_rad: 0.004 };
        let uncertainty = uncertainty.with_mount_sigma(sigma);
        let text = camera_with_uncertainty(&camera_text(&camera), &camera, &uncertainty);
        let path = Path::new("camera.toml");
        assert_eq!(parsed(path, &text, &camera).unwrap(), Some(uncertainty));
        // The camera itself is read as before.
        assert_eq!(CameraSetup::from_toml(path, &text).unwrap().camera, camera);
        assert_eq!(parsed(path, &camera_text(&camera), &camera).unwrap(), None);
    }

    #[test]
    fn what_is_no_covariance_is_refused_with_its_line() {
        let camera = test_scene::fisheye();
        let size = 4 + camera.distortion.parameters().len() + 3;
        let row = |value: &str| format!("[{}]", vec![value; size].join(","));
        let matrix = |rows: Vec<String>| format!("\n[calibration]\ncovariance = [{}]\n", rows.join(","));
        let mut negative = vec![row("0.0"); size];
        negative[0] = row("0.0").replacen("0.0", "-1.0", 1);
        for wrong in [vec![row("1.0")], vec!["[1.0]".to_owned(); size], vec![row("nan"); size], negative] {
            let text = camera_text(&camera) + &matrix(wrong);
            let error = parsed(Path::new("camera.toml"), &text, &camera).unwrap_err();
            assert!(error.line.is_some() && matches!(error.fault, Fault::Covariance(_)), "{error}");
        }
    }
}
