//! Every fault has a message of one line that names file and line.

use super::*;

/// Opens a valid recording in which the text of one file is replaced, and checks the message.
fn refuses(file: &str, text: impl AsRef<[u8]>, line: Option<usize>, parts: &[&str]) {
    let folder = folder_with(file, text);
    let error = Sequence::open(folder.path()).expect_err(&format!("{file} was accepted: {parts:?}"));
    assert_message(&error, &folder.path().join(file), parts);
    assert_eq!(error.line, line, "{error}");
    if let Some(line) = line {
        assert_message(&error, &folder.path().join(file), &[&format!(", line {line}: ")]);
    }
}

/// Works as [`refuses`], with one part of the valid text replaced.
fn refuses_change(file: &str, valid: &str, [from, to]: [&str; 2], line: Option<usize>, parts: &[&str]) {
    assert!(valid.contains(from), "the test itself is wrong: {from:?}");
    refuses(file, valid.replacen(from, to, 1), line, parts);
}

#[test]
fn folder_missing_or_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("nothing");
    assert_message(&Sequence::open(&missing).unwrap_err(), &missing, &["no such folder"]);
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    assert_message(&Sequence::open(&file).unwrap_err(), &file, &["not a folder"]);
}

#[test]
fn file_missing_or_not_a_file() {
    for name in ["sequence.toml", "camera.toml", "field.toml", "frames.csv", "groundtruth.tum"] {
        let folder = valid_folder();
        let path = folder.path().join(name);
        fs::remove_file(&path).unwrap();
        assert_message(&Sequence::open(folder.path()).unwrap_err(), &path, &["no such file"]);
        fs::create_dir(&path).unwrap();
        assert_message(&Sequence::open(folder.path()).unwrap_err(), &path, &["not a regular file"]);
    }
}

#[cfg(unix)]
#[test]
fn file_that_cannot_be_read() {
    use std::os::unix::fs::symlink;
    let folder = valid_folder();
    let path = folder.path().join("camera.toml");
    fs::remove_file(&path).unwrap();
    symlink(&path, &path).unwrap();
    assert_message(&Sequence::open(folder.path()).unwrap_err(), &path, &["cannot be read"]);
}

#[cfg(unix)]
#[test]
fn line_breaks_in_a_path_stay_out_of_the_message() {
    let folder = tempfile::tempdir().unwrap();
    let message = Sequence::open(&folder.path().join("a\nb")).unwrap_err().to_string();
    assert!(!message.contains('\n') && message.contains("a\\nb"), "{message:?}");
}

#[test]
fn not_utf8() {
    for name in ["sequence.toml", "camera.toml", "field.toml", "frames.csv", "groundtruth.tum"] {
        refuses(name, b"# one\n# two\n\xff\xfe = 1\n", Some(3), &["UTF-8"]);
    }
}

#[test]
fn toml_syntax() {
    refuses_change("sequence.toml", SEQUENCE, ["field =", "field"], Some(3), &["correct the line"]);
    refuses_change("camera.toml", CAMERA, ["[mount]", "[mount"], Some(12), &["correct the line"]);
    refuses_change("camera.toml", CAMERA, ["fy =", "fx ="], Some(5), &["duplicate key"]);
    refuses_change("field.toml", FIELD, ["0.05", "0,05"], Some(4), &["correct the line"]);
}

#[test]
fn toml_missing_key() {
    refuses_change("sequence.toml", SEQUENCE, ["frames =", "pictures ="], None, &["`frames` is missing"]);
    refuses_change("sequence.toml", SEQUENCE, ["yaw_rad", "yaw"], Some(7), &["`yaw_rad` is missing"]);
    refuses_change("camera.toml", CAMERA, ["fx", "focal"], None, &["`fx` is missing"]);
    refuses_change("camera.toml", CAMERA, ["model", "modle"], None, &["`model` is missing"]);
    refuses_change("camera.toml", CAMERA, ["[mount]", "[mounted]"], None, &["`mount` is missing"]);
    refuses_change("camera.toml", CAMERA, ["height_m", "height"], Some(12), &["`height_m` is missing"]);
    refuses_change("camera.toml", CAMERA, ["gamma", "gama"], Some(15), &["`gamma` is missing"]);
    refuses_change("camera.toml", CAMERA, ["radius", "r"], Some(10), &["`radius` is missing"]);
    refuses_change("field.toml", FIELD, ["width_m", "breadth_m"], None, &["`width_m` is missing"]);
    refuses("sequence.toml", "", None, &["is missing"]);
}

#[test]
fn toml_wrong_type() {
    refuses_change("sequence.toml", SEQUENCE, ["\"test\"", "5"], Some(1), &["expected a string"]);
    refuses_change("camera.toml", CAMERA, ["fx = 5.5", "fx = \"5\\n5\""], Some(4), &["invalid type"]);
    refuses_change("camera.toml", CAMERA, ["width = 16", "width = -16"], Some(2), &["-16"]);
    refuses_change("camera.toml", CAMERA, ["width = 16", "width = 1.5"], Some(2), &["1.5"]);
    refuses_change("camera.toml", CAMERA, ["[0.6, 0.7, 0.6]", "[0.6, 0.7]"], Some(17), &["length 2"]);
    refuses_change("field.toml", FIELD, ["6.0", "true"], Some(2), &["invalid type"]);
}

#[test]
fn camera_model_and_coefficients() {
    refuses_change(
        "camera.toml",
        CAMERA,
        ["\"OPENCV_FISHEYE\"", "\"\"\"FISH\nEYE\"\"\""],
        Some(1),
        &["\"FISH\\nEYE\"", "OPENCV_FISHEYE, OPENCV or PINHOLE"],
    );
    let three = ["[-0.06, 0.008, -0.0009, 0.00005]", "[-0.06, 0.008, -0.0009]"];
    refuses_change("camera.toml", CAMERA, three, Some(8), &["OPENCV_FISHEYE takes 4", "not 3"]);
    refuses_change("camera.toml", CAMERA, ["distortion", "distort"], None, &["takes 4", "not 0"]);
    let opencv = CAMERA.replace("OPENCV_FISHEYE", "OPENCV");
    refuses_change("camera.toml", &opencv, three, Some(8), &["OPENCV takes 4 or 5", "not 3"]);
    let pinhole = CAMERA.replace("OPENCV_FISHEYE", "PINHOLE");
    refuses("camera.toml", pinhole, Some(8), &["PINHOLE takes no", "not 4"]);
}

#[test]
fn camera_numbers() {
    let cases: [([&str; 2], usize, &str); 24] = [
        (["fx = 5.5", "fx = nan"], 4, "fx"),
        (["fx = 5.5", "fx = -1"], 4, "fx"),
        (["fy = 5.25", "fy = 0.0"], 5, "fy"),
        (["cx = 7.5", "cx = inf"], 6, "cx"),
        (["cy = 5.5", "cy = -inf"], 7, "cy"),
        (["width = 16", "width = 0"], 2, "0 x 12"),
        (["height = 12", "height = 99999"], 3, "16 x 99999"),
        (["0.008", "nan"], 8, "distortion"),
        (["max_angle_rad = 1.5", "max_angle_rad = 0.0"], 9, "max_angle_rad"),
        (["max_angle_rad = 1.5", "max_angle_rad = nan"], 9, "max_angle_rad"),
        (["max_angle_rad = 1.5", "max_angle_rad = 9"], 9, "max_angle_rad"),
        (["radius = 8", "radius = 0"], 10, "radius"),
        (["cx = 7,", "cx = nan,"], 10, "cx"),
        (["height_m = 0.52", "height_m = 0"], 13, "height_m"),
        (["height_m = 0.52", "height_m = -0.52"], 13, "height_m"),
        (["height_m = 0.52", "height_m = nan"], 13, "height_m"),
        (["height_m = 0.52", "height_m = 520"], 13, "height_m"),
        (["gamma = 2.2", "gamma = 0.0"], 16, "gamma"),
        (["[0.6, 0.7, 0.6]", "[0.6, nan, 0.6]"], 17, "line_linear_rgb"),
        (["noise_read = 0.004", "noise_read = -0.004"], 21, "noise_read"),
        (["psf_sigma_px = 0.5", "psf_sigma_px = inf"], 22, "psf_sigma_px"),
        (["black_level = 0.0", "black_level = nan"], 19, "black_level"),
        (["psf_sigma_px = 0.5", "psf_sigma_px = 0.5\n[photometry.trust]\nline = 0"], 24, "line"),
        (["psf_sigma_px = 0.5", "psf_sigma_px = 0.5\n[photometry.trust]\nnoise = 1.5"], 24, "noise"),
    ];
    for (change, line, part) in cases {
        refuses_change("camera.toml", CAMERA, change, Some(line), &[part]);
    }
}

#[test]
fn field_numbers() {
    refuses_change("field.toml", FIELD, ["6.0", "nan"], Some(2), &["length_m is NaN"]);
    refuses_change("field.toml", FIELD, ["6.0", "6000"], Some(2), &["length_m"]);
    refuses_change("field.toml", FIELD, ["0.1", "-0.1"], Some(12), &["goal_post_diameter_m"]);
    let text = format!("{FIELD}penalty_area_length_m = 1.0\n");
    refuses("field.toml", text, Some(13), &["needs penalty_area_width_m"]);
}

#[test]
fn start_that_is_no_number() {
    refuses_change("sequence.toml", SEQUENCE, ["-1.5", "nan"], Some(8), &["`x_m`", "finite"]);
    refuses_change("sequence.toml", SEQUENCE, ["yaw_rad = 0.5", "yaw_rad = inf"], Some(10), &["`yaw_rad`"]);
}

#[test]
fn file_names_that_leave_the_folder() {
    for name in ["/etc/passwd", "../camera.toml", "a/../../b", "", ".", "./"] {
        let change = ["\"camera.toml\"", &format!("\"{name}\"")];
        refuses_change("sequence.toml", SEQUENCE, change, Some(2), &["inside the sequence's folder"]);
        let change = ["images/1.png", name];
        refuses_change("frames.csv", FRAMES, change, Some(3), &["inside the sequence's folder"]);
    }
    let change = ["\"groundtruth.tum\"", "\"../groundtruth.tum\""];
    refuses_change("sequence.toml", SEQUENCE, change, Some(5), &["inside the sequence's folder"]);
}

#[test]
fn columns() {
    for column in ["timestamp_s", "image", "pitch_rad", "roll_rad"] {
        refuses_change("frames.csv", FRAMES, [column, "x"], Some(1), &[&format!("`{column}` is missing")]);
    }
    for column in ["odometry_x_m", "odometry_y_m", "odometry_yaw_rad"] {
        let parts = [&*format!("`{column}` is missing"), "all three or none"];
        refuses_change("frames.csv", FRAMES, [column, "x"], Some(1), &parts);
    }
    refuses_change("frames.csv", FRAMES, ["odometry_x_m", "image"], Some(1), &["`image` is there twice"]);
}

#[test]
fn lines_of_frames() {
    refuses_change("frames.csv", FRAMES, ["0.41,0.01", "0.41"], Some(3), &["6 fields, not 7"]);
    refuses_change("frames.csv", FRAMES, ["0.41,0.01", "0.41,0.01,0"], Some(3), &["8 fields, not 7"]);
    refuses_change("frames.csv", FRAMES, ["0.015", "0;015"], Some(3), &["`odometry_x_m`", "\"0;015\""]);
    refuses_change("frames.csv", FRAMES, ["0.42,", ","], Some(4), &["`pitch_rad`", "not a number"]);
    refuses_change("frames.csv", FRAMES, ["-0.01", "NaN"], Some(4), &["`roll_rad`", "not a finite"]);
    refuses_change("frames.csv", FRAMES, ["0.2,", "inf,"], Some(2), &["`timestamp_s`", "not a finite"]);
    refuses_change("frames.csv", FRAMES, ["0.015", "1e999"], Some(3), &["`odometry_x_m`", "not a finite"]);
    refuses_change("frames.csv", FRAMES, ["0.4,", "0.2,"], Some(3), &["0.2 s does not follow 0.2 s"]);
    refuses_change("frames.csv", FRAMES, ["0.6,", "0.3,"], Some(4), &["0.3 s does not follow 0.4 s"]);
    let long = "x".repeat(10_000);
    let folder = folder_with("frames.csv", FRAMES.replacen("0.015", &long, 1));
    assert!(Sequence::open(folder.path()).unwrap_err().to_string().len() < 500);
}

#[test]
fn the_line_is_right_after_blank_lines_windows_line_ends_and_quoted_line_breaks() {
    let faulty = FRAMES.replacen("0.42", "x", 1);
    refuses("frames.csv", faulty.replace('\n', "\r\n"), Some(4), &["\"x\""]);
    refuses("frames.csv", faulty.replace('\n', "\n\n"), Some(7), &["\"x\""]);
    refuses("frames.csv", faulty.replace('\n', "\r\n\r\n"), Some(7), &["\"x\""]);
    refuses("frames.csv", faulty.replace('\n', "\n  \n"), Some(7), &["\"x\""]);
    refuses("frames.csv", format!("\u{feff}{faulty}"), Some(4), &["\"x\""]);
    refuses("frames.csv", faulty.replacen("images/0.png", "\"a\nb\"", 1), Some(5), &["\"x\""]);
    let camera = CAMERA.replacen("0.52", "-1", 1).replace('\n', "\r\n");
    refuses("camera.toml", format!("\u{feff}{camera}"), Some(13), &["height_m"]);
    let tum = GROUNDTRUTH.replacen("0.026", "x", 1).replace('\n', "\r\n\r\n");
    refuses("groundtruth.tum", tum, Some(5), &["\"x\""]);
}

#[test]
fn no_frames() {
    let header = FRAMES.lines().next().unwrap();
    refuses("frames.csv", header, None, &["no frames"]);
    refuses("frames.csv", "", None, &["no frames"]);
}

#[test]
fn tum_lines() {
    let seven = "0.2 1 2 3 0 0 1\n";
    refuses("groundtruth.tum", seven, Some(1), &["7 fields, not 8"]);
    refuses("groundtruth.tum", format!("#\n\n{}", "1 ".repeat(100)), Some(3), &["100 fields, not 8"]);
    refuses_change("groundtruth.tum", GROUNDTRUTH, ["0.026", "nan"], Some(3), &["`y`", "not a finite"]);
    refuses_change("groundtruth.tum", GROUNDTRUTH, ["0.4865769", "inf"], Some(2), &["`qw`", "not a finite"]);
    refuses_change("groundtruth.tum", GROUNDTRUTH, ["0.521", "high"], Some(2), &["`z`", "\"high\""]);
    refuses("groundtruth.tum", "# x\n0.2 1 2 3 0 0 0 0\n", Some(2), &["quaternion"]);
    refuses("groundtruth.tum", "# x\n0.2 1 2 3 0 -1e-300 0 0\n", Some(2), &["quaternion"]);
}

#[test]
fn timestamps_that_do_not_match() {
    let text = "100.2 1 2 3 0 0 0 1\n100.9 1 2 3 0 0 0 1\n";
    refuses("groundtruth.tum", text, None, &["do not match", "0.2 s to 0.6 s", "100.2 s to 100.9 s"]);
}
