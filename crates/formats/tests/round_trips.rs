//! What is exported comes back the same; models of others come in with our conventions.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use std::fs;

use common::{Grey, a_pose, any_camera, any_pose, cameras, difference, field, posed};
use proptest::prelude::*;
use reality_sim_core::{camera::Camera, pose::CameraPose, sequence::Sequence};
use reality_sim_formats::{
    ModelImport, PosedPictures,
    colmap::{Encodings, read_colmap_as_sequence, write_colmap},
    nerfstudio::{read_nerfstudio_as_sequence, write_nerfstudio},
    undistort::Undistortion,
};

const TOLERANCE: f64 = 1e-6;

#[derive(Debug, Clone, Copy)]
enum Format {
    Text,
    Binary,
    Nerfstudio,
}

fn round_trip(pictures: &PosedPictures, format: Format) -> Sequence {
    let folder = tempfile::tempdir().unwrap();
    let (model, out) = (folder.path().join("model"), folder.path().join("sequence"));
    let written = pictures.write_pictures(&Grey, &model, None, &mut |_| {}).unwrap();
    let options = ModelImport::new("walk", field());
    let report = match format {
        Format::Text | Format::Binary => {
            let text = matches!(format, Format::Text);
            write_colmap(&written, &model, Encodings { text, binary: !text }).unwrap();
            read_colmap_as_sequence(&model, &out, &options).unwrap()
        }
        Format::Nerfstudio => {
            write_nerfstudio(&written, &model).unwrap();
            read_nerfstudio_as_sequence(&model, &out, &options).unwrap()
        }
    };
    assert_eq!((report.frames, report.has_times), (pictures.pictures.len(), true));
    let sequence = Sequence::open(&out).unwrap();
    sequence.check_every_picture().unwrap();
    sequence
}

fn check(camera: &Camera, poses: &[CameraPose], format: Format) {
    let pictures = posed(camera, poses);
    let sequence = round_trip(&pictures, format);
    assert_eq!(sequence.frames.len(), poses.len());
    let again = &sequence.setup.camera;
    // serde_json may be off by the last bit.
    assert_eq!(again.distortion.colmap_name(), camera.distortion.colmap_name());
    for (a, b) in again.distortion.parameters().iter().zip(camera.distortion.parameters()) {
        assert!((a - b).abs() < 1e-15, "{a} {b}");
    }
    for (a, b) in [(again.fx, camera.fx), (again.fy, camera.fy), (again.cx, camera.cx), (again.cy, camera.cy)]
    {
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
    for (frame, picture) in sequence.frames.iter().zip(&pictures.pictures) {
        let found = frame.reference_pose.unwrap();
        assert!(difference(found, picture.pose) < TOLERANCE, "{format:?}: {found:?} {:?}", picture.pose);
        assert!((frame.timestamp_s - picture.timestamp_s).abs() < 1e-9);
        assert!((frame.pitch_rad - picture.pose.pitch_rad).abs() < TOLERANCE);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn poses_and_cameras_survive_every_format(
        camera in any_camera(),
        poses in prop::collection::vec(any_pose(), 1..4),
        format in prop::sample::select(vec![Format::Text, Format::Binary, Format::Nerfstudio]),
    ) {
        check(&camera, &poses, format);
    }
}

#[test]
fn a_turned_and_scaled_world_is_turned_back() {
    let folder = tempfile::tempdir().unwrap();
    let pictures = posed(&cameras()[3], &[a_pose()]);
    let written = pictures.write_pictures(&Grey, folder.path(), None, &mut |_| {}).unwrap();
    write_nerfstudio(&written, folder.path()).unwrap();
    let path = folder.path().join("transforms.json");
    let mut file: serde_json::Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    // What nerfstudio's own `ns-process-data` applies to COLMAP's worlds: x, z, −y; here with a shift, and half the size.
    let applied = [[1.0, 0.0, 0.0, 0.5], [0.0, 0.0, 1.0, -0.25], [0.0, -1.0, 0.0, 2.0]];
    let matrix: Vec<Vec<f64>> =
        serde_json::from_value(file["frames"][0]["transform_matrix"].clone()).unwrap();
    let mut turned = matrix.clone();
    for row in 0..3 {
        for column in 0..4 {
            let sum: f64 = (0..3).map(|k| applied[row][k] * matrix[k][column]).sum();
            turned[row][column] = sum + if column == 3 { applied[row][3] } else { 0.0 };
        }
        turned[row][3] *= 0.5;
    }
    file["frames"][0]["transform_matrix"] = serde_json::to_value(&turned).unwrap();
    file["applied_transform"] = serde_json::to_value(applied).unwrap();
    file["applied_scale"] = 0.5.into();
    fs::write(&path, file.to_string()).unwrap();
    let out = folder.path().join("out");
    read_nerfstudio_as_sequence(&path, &out, &ModelImport::new("walk", field())).unwrap();
    let found = Sequence::open(&out).unwrap().frames[0].reference_pose.unwrap();
    assert!(difference(found, a_pose()) < TOLERANCE, "{found:?}");
}

#[test]
fn simpler_lenses_of_colmap_come_in_by_their_terms() {
    for (line, terms) in [
        ("SIMPLE_PINHOLE 64 48 31 32 24", vec![]),
        ("SIMPLE_RADIAL 64 48 31 32 24 -0.1", vec![-0.1, 0.0, 0.0, 0.0, 0.0]),
        ("RADIAL 64 48 31 32 24 -0.1 0.02", vec![-0.1, 0.02, 0.0, 0.0, 0.0]),
        ("SIMPLE_RADIAL_FISHEYE 64 48 31 32 24 -0.1", vec![-0.1, 0.0, 0.0, 0.0]),
        ("RADIAL_FISHEYE 64 48 31 32 24 -0.1 0.02", vec![-0.1, 0.02, 0.0, 0.0]),
    ] {
        let camera = import_with_camera(line).unwrap();
        assert_eq!(camera.distortion.parameters(), terms, "{line}");
        assert_eq!([camera.fx, camera.fy, camera.cx, camera.cy], [31.0, 31.0, 31.5, 23.5], "{line}");
    }
    for (line, word) in [
        ("FOV 64 48 31 31 32 24 0.1", "FOV"),
        ("FULL_OPENCV 64 48 31 31 32 24 0 0 0 0 0 0.1 0 0", "k4"),
        ("PINHOLE 64 48 31 31 32", "PARAMS"),
        ("PINHOLE 64 48 31 31 32 24 1", "PARAMS"),
        ("PINHOLE 64 x 31 31 32 24", "line 1"),
    ] {
        let error = import_with_camera(line).unwrap_err();
        assert!(error.contains(word), "{line}: {error}");
    }
}

fn import_with_camera(line: &str) -> Result<Camera, String> {
    let folder = tempfile::tempdir().unwrap();
    let pictures = posed(&cameras()[0], &[a_pose()]);
    let written = pictures.write_pictures(&Grey, folder.path(), None, &mut |_| {}).unwrap();
    write_colmap(&written, folder.path(), Encodings { text: true, binary: false }).unwrap();
    fs::write(folder.path().join("sparse/0/cameras.txt"), format!("1 {line}\n")).unwrap();
    let out = folder.path().join("out");
    read_colmap_as_sequence(folder.path(), &out, &ModelImport::new("walk", field()))
        .map_err(|error| error.to_string())?;
    Ok(Sequence::open(&out).unwrap().setup.camera)
}

#[test]
fn a_world_that_is_not_the_fields_is_refused_or_warned_of() {
    let import = |pose: CameraPose| {
        let folder = tempfile::tempdir().unwrap();
        let pictures = posed(&cameras()[0], &[pose]);
        let written = pictures.write_pictures(&Grey, folder.path(), None, &mut |_| {}).unwrap();
        write_colmap(&written, folder.path(), Encodings { text: false, binary: true }).unwrap();
        read_colmap_as_sequence(folder.path(), &folder.path().join("out"), &ModelImport::new("walk", field()))
    };
    let below = import(CameraPose { height_m: -0.5, ..a_pose() }).unwrap_err().to_string();
    assert!(below.contains("origin at the field's centre"), "{below}");
    let upside_down = import(CameraPose { roll_rad: 3.0, ..a_pose() }).unwrap_err().to_string();
    assert!(upside_down.contains("upside down"), "{upside_down}");
    assert!(import(a_pose()).unwrap().warnings.is_empty());
    assert_eq!(
        import(CameraPose { height_m: 6.0, x_m: 30.0, pitch_rad: -0.1, ..a_pose() }).unwrap().warnings.len(),
        3
    );
}

#[test]
fn an_undistorted_picture_shows_what_the_recorded_one_shows_where_its_camera_says() {
    let camera = &cameras()[3];
    let undistorter = Undistortion::default().of_camera(camera).unwrap();
    // Every pixel of this picture is as bright as its column, and as green as its row.
    let recorded = image::RgbImage::from_fn(64, 48, |u, v| image::Rgb([4 * u as u8, 5 * v as u8, 0]));
    let picture = undistorter.picture(&recorded);
    let pose = a_pose();
    let mut compared = 0;
    for (u, v, pixel) in picture.enumerate_pixels() {
        let Ok(ground) = undistorter.pinhole.unproject_to_ground(pose, glam::DVec2::new(u.into(), v.into()))
        else {
            continue;
        };
        let Ok(place) = camera.project(pose.camera_from_world(ground.extend(0.0))) else { continue };
        assert!((f64::from(pixel.0[0]) - 4.0 * place.x).abs() < 0.6, "{u} {v}");
        assert!((f64::from(pixel.0[1]) - 5.0 * place.y).abs() < 0.6, "{u} {v}");
        compared += 1;
    }
    assert!(compared > 500, "{compared}");
}
