//! Tests of a small valid recording, and of what fails when one thing about it is wrong.

mod malformed;
mod never_panics;
mod pictures;
mod reading;
mod writing;

use std::path::Path;

use tempfile::TempDir;

use super::*;

pub(super) const SEQUENCE: &str = "name = \"test\"
camera = \"camera.toml\"
field = \"field.toml\"
frames = \"frames.csv\"
groundtruth = \"groundtruth.tum\"

[start]
x_m = -1.5
y_m = 0.25
yaw_rad = 0.5
";

pub(super) const CAMERA: &str = "model = \"OPENCV_FISHEYE\"
width = 16
height = 12
fx = 5.5
fy = 5.25
cx = 7.5
cy = 5.5
distortion = [-0.06, 0.008, -0.0009, 0.00005]
max_angle_rad = 1.5
image_circle = { cx = 7, cy = 5.5, radius = 8 }

[mount]
height_m = 0.52

[photometry]
gamma = 2.2
line_linear_rgb = [0.6, 0.7, 0.6]
carpet_linear_rgb = [0.04, 0.14, 0.05]
black_level = 0.0
noise_shot = 0.0015
noise_read = 0.004
psf_sigma_px = 0.5
";

pub(super) const FIELD: &str = "name = \"kidsize\"
length_m = 6.0
width_m = 4.0
line_width_m = 0.05
border_strip_m = 0.7
goal_area_length_m = 0.6
goal_area_width_m = 2.2
penalty_mark_distance_m = 1.8
center_circle_diameter_m = 1.2
goal_width_m = 1.5
goal_height_m = 0.8
goal_post_diameter_m = 0.1
";

pub(super) const FRAMES: &str =
    "timestamp_s,image,odometry_x_m,odometry_y_m,odometry_yaw_rad,pitch_rad,roll_rad
0.2,images/0.png,0.0,0.0,0.0,0.43,0.02
0.4,images/1.png,0.015,0.004,0.08,0.41,0.01
0.6,images/2.png,0.03,0.008,0.16,0.42,-0.01
";

pub(super) const GROUNDTRUTH: &str = "# timestamp x y z qx qy qz qw
0.2 -1.785 0.011 0.521 -0.7557698 0.3764071 -0.2244386 0.4865769
0.6 -1.752 0.026 0.527 -0.7875121 0.2804026 -0.1913086 0.5143929
";

/// Makes a valid recording without pictures in which the text of one file is replaced.
pub(super) fn folder_with(changed: &str, text: impl AsRef<[u8]>) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, valid) in [
        ("sequence.toml", SEQUENCE),
        ("camera.toml", CAMERA),
        ("field.toml", FIELD),
        ("frames.csv", FRAMES),
        ("groundtruth.tum", GROUNDTRUTH),
    ] {
        let bytes = if name == changed { text.as_ref() } else { valid.as_bytes() };
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    folder
}

pub(super) fn valid_folder() -> TempDir {
    folder_with("", "")
}

/// Asserts that the message names the file, contains these parts and is a single line.
pub(super) fn assert_message(error: &SequenceError, file: &Path, parts: &[&str]) {
    let message = error.to_string();
    assert!(message.starts_with(&file.display().to_string()), "{message:?} does not name {}", file.display());
    assert!(!message.contains(['\n', '\r']), "{message:?} is more than one line");
    for part in parts {
        assert!(message.contains(part), "{message:?} does not say {part:?}");
    }
}
