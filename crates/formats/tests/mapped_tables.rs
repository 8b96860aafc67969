//! Pictures and a table with any columns, as a recording.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use std::{fs, path::Path};

use common::{Grey, cameras};
use reality_sim_core::{
    pose::{CameraPose, Pose2},
    sequence::{CameraSetup, Sequence},
};
use reality_sim_formats::{PictureFiles, mapped_table::read_table_as_sequence};

const MAPPING: &str = r#"name = "walk"
table = "log.csv"
delimiter = ";"
images = "pictures"
camera = "camera.toml"
field = "spl"

[columns]
timestamp_s = { column = "stamp", unit = "ms" }
image = "file"
odometry_x_m = { column = "x", unit = "mm" }
odometry_y_m = { column = "y", unit = "cm", sign = -1 }
odometry_yaw_rad = { column = "heading", unit = "deg", offset = 90 }
pitch_rad = "pitch"
roll_rad = { value = 0 }
reference_x_m = { column = "x", unit = "mm" }
reference_y_m = { value = 0.25 }
reference_yaw_rad = "pitch"
"#;

const TABLE: &str = "stamp;file;x;y;heading;pitch\n100;a.png;1000;50;-90;0.3\n200;b.png;1500;-50;0;0.4\n";

fn prepare(folder: &Path, mapping: &str, table: &str) -> std::path::PathBuf {
    fs::create_dir_all(folder.join("pictures")).unwrap();
    for (index, name) in ["a.png", "b.png"].iter().enumerate() {
        fs::write(folder.join("pictures").join(name), Grey.bytes(index).unwrap()).unwrap();
    }
    let setup = CameraSetup { camera: cameras()[3].clone(), mount_height_m: 0.5, photometry: None };
    fs::write(folder.join("camera.toml"), setup.to_toml(Path::new("camera.toml")).unwrap()).unwrap();
    fs::write(folder.join("log.csv"), table).unwrap();
    fs::write(folder.join("mapping.toml"), mapping).unwrap();
    folder.join("mapping.toml")
}

#[test]
fn columns_come_in_with_their_units_signs_and_constants() {
    let folder = tempfile::tempdir().unwrap();
    let mapping = prepare(folder.path(), MAPPING, TABLE);
    let out = folder.path().join("out");
    assert_eq!(read_table_as_sequence(&mapping, &out).unwrap(), 2);
    let sequence = Sequence::open(&out).unwrap();
    sequence.check_every_picture().unwrap();
    let frame = &sequence.frames[0];
    let odometry = frame.odometry.unwrap();
    assert_eq!((frame.timestamp_s, frame.pitch_rad, frame.roll_rad), (0.1, 0.3, 0.0));
    assert_eq!((odometry.x_m, odometry.y_m, odometry.yaw_rad), (1.0, -0.5, 0.0));
    let reference = frame.reference_pose.unwrap();
    let expected = CameraPose::new(Pose2::new(1.0, 0.25, 0.3), 0.5, 0.3, 0.0);
    assert!(common::difference(reference, expected) < 1e-9, "{reference:?}");
}

#[test]
fn mistakes_name_file_line_and_column() {
    for (mapping, table, words) in [
        (MAPPING.to_owned(), TABLE.replace("1500", "fast"), vec!["log.csv, line 3", "`x` is \"fast\""]),
        (
            MAPPING.replace("\"stamp\"", "\"time\""),
            TABLE.to_owned(),
            vec!["log.csv, line 2", "`time` is missing"],
        ),
        (
            MAPPING.replace("unit = \"ms\"", "unit = \"deg\""),
            TABLE.to_owned(),
            vec!["mapping.toml", "columns.timestamp_s"],
        ),
        (
            MAPPING.replace("unit = \"ms\"", "unit = \"hours\""),
            TABLE.to_owned(),
            vec!["mapping.toml, line 9"],
        ),
        (MAPPING.replace("pitch_rad = \"pitch\"", ""), TABLE.to_owned(), vec!["columns.pitch_rad"]),
        (MAPPING.replace("sign = -1", "sign = -2"), TABLE.to_owned(), vec!["columns.odometry_y_m"]),
        (
            MAPPING.to_owned(),
            TABLE.replace("b.png", "../b.png"),
            vec!["log.csv, line 3", "not a path inside"],
        ),
        (MAPPING.to_owned(), TABLE.replace(";0.4", ""), vec!["log.csv, line 3"]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = prepare(folder.path(), &mapping, &table);
        let error = read_table_as_sequence(&path, &folder.path().join("out")).unwrap_err().to_string();
        for word in words {
            assert!(error.contains(word), "{word}: {error}");
        }
    }
}
