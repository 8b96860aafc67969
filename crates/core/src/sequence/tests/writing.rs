//! Whatever is written reads back as the same.

use proptest::prelude::*;

use super::*;
use crate::pose::wrap_angle;

fn open(folder: &TempDir) -> Sequence {
    Sequence::open(folder.path()).unwrap()
}

/// Returns the largest difference of two poses in any coordinate, metres or radians.
fn difference(a: CameraPose, b: CameraPose) -> f64 {
    let lengths = [a.x_m - b.x_m, a.y_m - b.y_m, a.height_m - b.height_m];
    let angles = [a.yaw_rad - b.yaw_rad, a.pitch_rad - b.pitch_rad, a.roll_rad - b.roll_rad];
    lengths.into_iter().chain(angles.map(wrap_angle)).fold(0.0, |largest, value| value.abs().max(largest))
}

fn assert_round_trip(sequence: &Sequence) {
    let folder = tempfile::tempdir().unwrap();
    sequence.write(&folder.path().join("new/folder")).unwrap();
    let again = Sequence::open(&folder.path().join("new/folder")).unwrap();
    let mut read = Sequence { folder: sequence.folder.clone(), files: sequence.files.clone(), ..again };
    for (written, read) in sequence.frames.iter().zip(&mut read.frames) {
        assert_eq!(written.reference_pose.is_some(), read.reference_pose.is_some());
        let poses = written.reference_pose.zip(read.reference_pose);
        assert!(poses.is_none_or(|(written, read)| difference(written, read) < 1e-9));
        read.reference_pose = written.reference_pose;
    }
    assert_eq!(&read, sequence);
}

#[test]
fn sequence_round_trip() {
    assert_round_trip(&open(&valid_folder()));
}

#[test]
fn round_trip_without_anything_optional() {
    let mut sequence = open(&valid_folder());
    sequence.start = None;
    sequence.setup.photometry = None;
    for frame in &mut sequence.frames {
        frame.reference_pose = None;
        frame.odometry = None;
    }
    let text = "model = \"PINHOLE\"\nwidth = 4\nheight = 3\nfx = 2\nfy = 2\ncx = 1.5\ncy = 1\n[mount]\nheight_m = 1\n";
    sequence.setup = CameraSetup::from_toml(Path::new("camera.toml"), text).unwrap();
    assert_round_trip(&sequence);
}

#[test]
fn round_trip_with_odd_names() {
    let mut sequence = open(&valid_folder());
    sequence.name = "a \"b\" = 'c' # ü".to_owned();
    sequence.frames[0].image = PathBuf::from("images/a, \"b\".png");
    sequence.frames[1].image = PathBuf::from("bilder/ü\nv.png");
    sequence.frames[2].timestamp_s = 1.7e9 + 0.123_456;
    sequence.frames[2].reference_pose = None;
    assert_round_trip(&sequence);
}

#[test]
fn what_cannot_be_read_is_not_written() {
    let valid = open(&valid_folder());
    let folder = tempfile::tempdir().unwrap();
    let refuses = |change: &dyn Fn(&mut Sequence), part: &str| {
        let mut sequence = valid.clone();
        change(&mut sequence);
        let error = sequence.write(folder.path()).unwrap_err();
        assert_message(&error, folder.path(), &[part]);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is written");
    };
    refuses(&|s| s.frames.clear(), "no frames");
    refuses(&|s| s.name = "two\nlines".to_owned(), "control characters");
    refuses(&|s| s.frames[1].odometry = None, "either all frames have odometry or none");
    refuses(&|s| s.frames[1].image = "../a.png".into(), "inside the sequence's folder");
    refuses(&|s| s.frames[1].image = " a.png".into(), "blanks");
    refuses(&|s| s.frames[1].pitch_rad = f64::NAN, "`pitch_rad`");
    refuses(&|s| s.frames[1].timestamp_s = 0.0, "does not follow");
    refuses(&|s| s.setup.mount_height_m = 0.0, "`height_m`");
    refuses(&|s| s.setup.camera.fx = f64::NAN, "fx");
    refuses(&|s| s.field.length_m = -1.0, "length_m");
    refuses(&|s| s.start = Some(Pose2::new(f64::NAN, 0.0, 0.0)), "`x_m`");
    let impossible = CameraPose { x_m: f64::NAN, ..Default::default() };
    refuses(&|s| s.frames[0].reference_pose = Some(impossible), "finite");
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = valid_folder();
    let sequence = open(&folder);
    let inside_a_file = folder.path().join("camera.toml").join("x");
    assert_message(&sequence.write(&inside_a_file).unwrap_err(), &inside_a_file, &["cannot be written"]);
    let missing = folder.path().join("missing/poses.tum");
    assert_message(&write_tum(&missing, &[]).unwrap_err(), &missing, &["cannot be written"]);
}

#[test]
fn a_failed_write_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("poses.tum");
    write_tum(&path, &[]).unwrap();
    let before = fs::read(&path).unwrap();
    let broken = StampedPose { timestamp_s: f64::NAN, pose: CameraPose::default() };
    assert_message(&write_tum(&path, &[broken]).unwrap_err(), &path, &["finite"]);
    assert_eq!(fs::read(&path).unwrap(), before);
    let in_the_way = folder.path().join("folder.tum");
    fs::create_dir(&in_the_way).unwrap();
    assert_message(&write_tum(&in_the_way, &[]).unwrap_err(), &in_the_way, &["cannot be written"]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "no temporary file is left");
}

#[cfg(unix)]
#[test]
fn written_files_are_no_more_private_than_others() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let mode = |name: &str| fs::metadata(folder.path().join(name)).unwrap().permissions().mode();
    write_tum(&folder.path().join("poses.tum"), &[]).unwrap();
    fs::write(folder.path().join("other"), "").unwrap();
    assert_eq!(mode("poses.tum"), mode("other"));
}

proptest! {
    #[test]
    fn tum_round_trip(
        values in prop::array::uniform6(-3.0..3.0),
        pitch_rad in -1.57..1.57,
        timestamp_s in -1e10..1e10,
    ) {
        let [x_m, y_m, height_m, yaw_rad, roll_rad, _]: [f64; 6] = values;
        let pose = CameraPose { x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad };
        let path = Path::new("poses.tum");
        let text = tum::print_tum(path, &[StampedPose { timestamp_s, pose }]).unwrap();
        let again = tum::parse_tum(path, &text).unwrap();
        prop_assert_eq!(again.len(), 1);
        prop_assert_eq!(again[0].timestamp_s, timestamp_s);
        prop_assert!(difference(again[0].pose, pose) < 1e-9);
    }
}
