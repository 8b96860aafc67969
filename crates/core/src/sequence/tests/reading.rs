//! Tests of valid recordings, in all the ways in which they may be written.

use super::*;
use crate::camera::{Distortion, Opencv};

fn camera(text: &str) -> CameraSetup {
    CameraSetup::from_toml(Path::new("camera.toml"), text).unwrap()
}

#[test]
fn opens_a_valid_recording() {
    let folder = valid_folder();
    let sequence = Sequence::open(folder.path()).unwrap();
    assert_eq!(sequence.name, "test");
    assert_eq!(sequence.start, Some(Pose2::new(-1.5, 0.25, 0.5)));
    assert_eq!(sequence.setup.mount_height_m, 0.52);
    assert_eq!(sequence.setup.camera.max_angle_rad(), 1.5);
    assert_eq!(sequence.setup.camera.image_circle.unwrap().radius, 8.0);
    assert_eq!(sequence.setup.photometry.unwrap().line_linear_rgb, Some([0.6, 0.7, 0.6]));
    assert_eq!(sequence.field.length_m, 6.0);
    assert_eq!(sequence.frames.len(), 3);
    assert_eq!(sequence.frames[1].odometry, Some(Pose2::new(0.015, 0.004, 0.08)));
    assert_eq!(sequence.frames[2].roll_rad, -0.01);
    let known: Vec<_> = sequence.reference_poses().map(|pose| pose.is_some()).collect();
    assert_eq!(known, [true, false, true], "a frame without a row has no reference pose");
}

#[test]
fn takes_a_byte_order_mark_and_windows_line_ends_in_every_file() {
    let plain = Sequence::open(valid_folder().path()).unwrap();
    let folder = valid_folder();
    for entry in fs::read_dir(folder.path()).unwrap() {
        let path = entry.unwrap().path();
        let text = fs::read_to_string(&path).unwrap().replace('\n', "\r\n");
        fs::write(&path, format!("\u{feff}{text}")).unwrap();
    }
    let windows = Sequence::open(folder.path()).unwrap();
    assert_eq!(Sequence { folder: plain.folder.clone(), files: plain.files.clone(), ..windows }, plain);
}

#[test]
fn leaves_unknown_keys_and_columns_to_others() {
    for (name, text) in [
        ("sequence.toml", format!("weather = \"dry\"\n{SEQUENCE}floor = 2\n[robot]\nname = \"x\"\n")),
        ("camera.toml", format!("serial = 5\n{CAMERA}exposure_s = 0.01\n[lens]\nmaker = \"x\"\n")),
        ("field.toml", format!("{FIELD}country = \"SG\"\n")),
    ] {
        Sequence::open(folder_with(name, text).path()).unwrap();
    }
    let frames =
        "note,roll_rad,pitch_rad,image,timestamp_s\nx,0.1,0.2,images/0.png,0.2\n,0.1,0.2,a.png,0.3\n";
    let sequence = Sequence::open(folder_with("frames.csv", frames).path()).unwrap();
    assert_eq!(sequence.frames[0].pitch_rad, 0.2);
    assert_eq!(sequence.frames[0].odometry, None);
}

#[test]
fn start_and_ground_truth_are_optional() {
    let text = "name = \"\"\ncamera = \"camera.toml\"\nfield = \"field.toml\"\nframes = \"frames.csv\"\n";
    for text in [text.to_owned(), format!("{text}groundtruth = \"\"\n")] {
        let sequence = Sequence::open(folder_with("sequence.toml", text).path()).unwrap();
        assert_eq!((sequence.start, sequence.frames.len(), sequence.has_reference_poses()), (None, 3, false));
    }
    let sequence = Sequence::open(folder_with("groundtruth.tum", "# nothing yet\n\n").path()).unwrap();
    assert!(!sequence.has_reference_poses());
}

#[test]
fn knows_every_camera_model() {
    let rest = "width = 4\nheight = 3\nfx = 2\nfy = 2\ncx = 1.5\ncy = 1\n[mount]\nheight_m = 1\n";
    let pinhole = camera(&format!("model = \"PINHOLE\"\n{rest}"));
    assert_eq!(pinhole.camera.distortion, Distortion::Pinhole);
    assert_eq!(camera(&format!("model = \"PINHOLE\"\ndistortion = []\n{rest}")), pinhole);
    let four = camera(&format!("model = \"OPENCV\"\ndistortion = [0.1, 0.2, 0.3, 0.4]\n{rest}"));
    let five = camera(&format!("model = \"OPENCV\"\ndistortion = [0.1, 0.2, 0.3, 0.4, 0]\n{rest}"));
    assert_eq!(four, five);
    let expected = Opencv { k1: 0.1, k2: 0.2, p1: 0.3, p2: 0.4, k3: 0.0 };
    assert_eq!(four.camera.distortion, Distortion::Opencv(expected));
}

#[test]
fn poses_are_matched_to_the_nearest_frame_in_any_order() {
    let text = "0.6004 3 0 1 0 0 0 1\n0.2006 9 0 1 0 0 0 1\n0.1996 1 0 1 0 0 0 1\n0.4003 2 0 1 0 0 0 1\n";
    let sequence = Sequence::open(folder_with("groundtruth.tum", text).path()).unwrap();
    let x: Vec<_> = sequence.reference_poses().map(|pose| pose.unwrap().x_m).collect();
    assert_eq!(x, [1.0, 2.0, 3.0]);
}

#[test]
fn a_frame_between_two_near_poses_has_the_pose_interpolated_there() {
    // Frames at 0.2, 0.4 and 0.6 s; half a turn about the optical axis goes on for 0.04 s at an even rate.
    let text = "0.19 1 0 1 0 0 0 1\n0.23 2 0 3 0 0 1 1\n0.375 0 0 1 0 0 0 1\n0.43 9 0 1 0 0 0 1\n0.6 3 0 1 0 0 0 1\n";
    let sequence = Sequence::open(folder_with("groundtruth.tum", text).path()).unwrap();
    let poses: Vec<_> = sequence.reference_poses().collect();
    let first = poses[0].unwrap();
    assert!((first.x_m - 1.25).abs() < 1e-9 && (first.height_m - 1.5).abs() < 1e-9);
    let turned = first.quaternion_world_from_camera().angle_between(glam::DQuat::IDENTITY);
    assert!((turned - std::f64::consts::FRAC_PI_8).abs() < 1e-6, "{turned}");
    assert_eq!(poses[1], None, "poses 0.055 s apart are too far apart");
    assert_eq!(poses[2].unwrap().x_m, 3.0);
}

#[test]
fn poses_of_no_frame_are_kept_in_order_of_time() {
    let text = "0.7 5 0 1 0 0 0 1\n0.6004 3 0 1 0 0 0 1\n0.3 2 0 1 0 0 0 1\n0.2006 1 0 1 0 0 0 1\n0.1 0 0 1 0 0 0 1\n";
    let folder = folder_with("groundtruth.tum", text);
    let sequence = Sequence::open(folder.path()).unwrap();
    let times = |sequence: &Sequence| -> Vec<f64> {
        sequence.poses_between_frames.iter().map(|stamped| stamped.timestamp_s).collect()
    };
    assert_eq!(times(&sequence), [0.1, 0.2006, 0.3, 0.7]);
    let again = tempfile::tempdir().unwrap();
    sequence.write(again.path()).unwrap();
    let read = Sequence::open(again.path()).unwrap();
    assert_eq!(times(&read), times(&sequence), "a sequence is written with all its poses");
}

#[test]
fn tum_takes_comments_blank_lines_and_any_scale_of_the_quaternion() {
    let text = "# one\n\n  1e0\t1  2 3 0 0 0 1  \n   # two\n2 1 2 3 0 0 0 7\r\n3 1 2 3 0 0 0 1e200";
    let poses = tum::parse_tum(Path::new("a.tum"), text).unwrap();
    let times: Vec<_> = poses.iter().map(|stamped| stamped.timestamp_s).collect();
    assert_eq!(times, [1.0, 2.0, 3.0]);
    assert!(poses.iter().all(|stamped| stamped.pose == poses[0].pose && stamped.pose.is_finite()));
}
