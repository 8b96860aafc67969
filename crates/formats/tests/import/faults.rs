//! What is said of logs that are cut off, disturbed or incomplete.

use glam::DVec3;
use mcap::Compression;

use super::{
    Ros, add_imu, assert_like, import, import_bytes, import_file, options, pictures,
    robot::{self, COMPRESSED, MATRIX, walk},
    with_imu,
};
use reality_sim_formats::import::ImportOptions;

#[test]
fn a_log_that_is_cut_off_is_read_up_to_its_last_whole_message() {
    let walk = walk(30);
    let messages = with_imu(&walk);
    let whole = messages.mcap(None, None);
    let mut before = usize::MAX;
    for part in [0.999, 0.8, 0.4] {
        let cut = &whole[..(whole.len() as f64 * part) as usize];
        let imported = import_bytes(cut, &options());
        let imported = match imported {
            Ok(imported) => imported,
            // The IMU comes after all pictures.
            Err(error) => {
                assert!(part < 0.9 && error.to_string().contains("pitch and roll"), "{error}");
                continue;
            }
        };
        assert!(imported.report.salvaged);
        assert!(imported.report.frames <= before);
        before = imported.report.frames;
    }
    assert_ne!(before, usize::MAX);
}

/// Messages in the order of time, as a robot writes them.
fn in_order(count: usize) -> super::Messages {
    let mut messages = super::Messages::default();
    for (index, truth) in walk(count).iter().enumerate() {
        let one = std::slice::from_ref(truth);
        let info = robot::camera_info(truth, "plumb_bob", &[], MATRIX);
        messages.ros("/camera_info", "sensor_msgs/msg/CameraInfo", "", truth.time_ns, &info);
        add_imu(&mut messages, truth, &robot::imu(truth, "", Some(one[0].level_from_body(0.0)), DVec3::ZERO));
        messages.ros("/odom", "nav_msgs/msg/Odometry", "", truth.time_ns, &robot::odometry(truth, "base"));
        let picture = robot::compressed(truth, "camera", robot::jpeg(index));
        messages.ros(
            "/image/compressed",
            "sensor_msgs/msg/CompressedImage",
            COMPRESSED,
            truth.time_ns,
            &picture,
        );
    }
    messages
}

#[test]
fn every_cut_keeps_the_frames_before_it() {
    let walk = walk(40);
    let messages = in_order(40);
    for (compression, chunk) in [
        (None, None),
        (None, Some(8000)),
        (Some(Compression::Zstd), Some(8000)),
        (Some(Compression::Lz4), Some(8000)),
    ] {
        let whole = messages.mcap(compression, chunk);
        for step in 4..20 {
            let length = whole.len() * step / 20;
            let imported = import_bytes(&whole[..length], &options()).unwrap();
            let frames = imported.report.frames;
            assert_like(&imported, &walk[..frames]);
            assert!(imported.report.salvaged);
            // The file has the summary at its end; a chunk of 8 kB holds some six frames.
            let expected = 40.0 * length as f64 / whole.len() as f64;
            assert!(
                frames as f64 > expected - 9.0,
                "{frames} of {expected} at {length}: {:?}",
                imported.report
            );
        }
    }
}

#[test]
fn a_wrong_end_is_no_reason_to_lose_anything() {
    let walk = walk(20);
    let mut whole = in_order(20).mcap(Some(Compression::Lz4), Some(4000));
    let length = whole.len();
    whole[length - 8..].fill(0);
    let imported = import_bytes(&whole, &options()).unwrap();
    assert_like(&imported, &walk);
    assert!(imported.report.salvaged && imported.report.bytes_lost == 0);
}

#[test]
fn zeros_behind_the_last_message_are_counted_as_lost() {
    let whole = in_order(20).mcap(None, None);
    let mut cut = whole[..whole.len() / 2].to_vec();
    cut.extend([0; 5000]);
    let imported = import_bytes(&cut, &options()).unwrap();
    assert!(imported.report.salvaged && imported.report.bytes_lost >= 3000, "{:?}", imported.report);
}

#[test]
fn a_bag_that_is_cut_off_is_read_as_far_as_its_pages_are_there() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("walk.db3");
    in_order(200).write_db3(&file);
    let whole = std::fs::read(&file).unwrap();
    std::fs::write(&file, &whole[..whole.len() / 2]).unwrap();
    let imported = import_file(folder, &file, &options()).unwrap();
    assert!(imported.report.salvaged);
    assert_eq!(imported.report.bytes_lost, (whole.len() - whole.len() / 2) as u64);
    assert!((80..120).contains(&imported.report.frames), "{:?}", imported.report);
}

#[test]
fn a_clock_that_is_set_back_loses_no_frame() {
    let mut messages = super::Messages::default();
    let walk = walk(30);
    for (index, truth) in walk.iter().enumerate() {
        let mut by_clock = *truth;
        by_clock.time_ns -= if index >= 15 { 20_000_000_000 } else { 0 };
        let log_ns = truth.time_ns + 3_000_000;
        let info = robot::camera_info(&by_clock, "plumb_bob", &[], MATRIX);
        messages.ros("/camera_info", "sensor_msgs/msg/CameraInfo", "", log_ns, &info);
        messages.ros(
            "/imu",
            "sensor_msgs/msg/Imu",
            robot::IMU,
            log_ns,
            &robot::imu(&by_clock, "", Some(truth.level_from_body(0.0)), DVec3::ZERO),
        );
        messages.ros("/odom", "nav_msgs/msg/Odometry", "", log_ns, &robot::odometry(&by_clock, "base"));
        let picture = robot::compressed(&by_clock, "camera", robot::jpeg(index));
        messages.ros("/image/compressed", "sensor_msgs/msg/CompressedImage", COMPRESSED, log_ns, &picture);
    }
    let imported = import(&messages, &options()).unwrap();
    assert_eq!(imported.report.clock_jumps, 1);
    assert_like(&imported, &walk);
}

#[test]
fn doubled_lost_and_unusable_pictures_are_counted() {
    let walk = walk(20);
    let mut messages = super::Messages::default();
    for (index, truth) in walk.iter().enumerate() {
        if index == 9 || index == 10 {
            continue;
        }
        let info = robot::camera_info(truth, "plumb_bob", &[], MATRIX);
        messages.ros("/camera_info", "sensor_msgs/msg/CameraInfo", "", truth.time_ns, &info);
        add_imu(&mut messages, truth, &robot::imu(truth, "", Some(truth.level_from_body(0.0)), DVec3::ZERO));
        let file = if index == 5 { b"not a picture".to_vec() } else { robot::jpeg(index) };
        let picture = robot::compressed(truth, "camera", file);
        for _ in 0..if index == 3 { 2 } else { 1 } {
            messages.ros(
                "/image/compressed",
                "sensor_msgs/msg/CompressedImage",
                COMPRESSED,
                truth.time_ns,
                &picture,
            );
        }
    }
    let report = import(&messages, &options()).unwrap().report;
    assert_eq!((report.frames, report.doubled, report.unusable, report.lost), (17, 1, 1, 3), "{report:?}");
    assert_eq!((report.unmatched, report.clock_jumps), (0, 0));
}

#[test]
fn pictures_without_odometry_near_them_are_left_out_and_counted() {
    let walk = walk(20);
    let mut messages = in_order(20);
    messages.ros("/wheels", "nav_msgs/msg/Odometry", "", 0, &robot::odometry(&walk[0], "base"));
    for truth in walk.iter().filter(|truth| !(8..11).contains(&(truth.time_ns / 100_000_000 - 10))) {
        messages.ros("/wheels", "nav_msgs/msg/Odometry", "", truth.time_ns, &robot::odometry(truth, "base"));
    }
    let options = ImportOptions { odometry: Some("/wheels".to_owned()), ..options() };
    let report = import(&messages, &options).unwrap().report;
    assert_eq!((report.frames, report.unmatched), (17, 3), "{report:?}");
}

fn message_of(messages: &super::Messages, options: &ImportOptions) -> String {
    match import(messages, options) {
        Ok(imported) => panic!("{:?}", imported.report),
        Err(error) => error.to_string(),
    }
}

#[test]
fn what_is_missing_is_named_with_the_remedy() {
    let walk = walk(5);
    let says = |messages: &super::Messages, options: &ImportOptions, words: &[&str]| {
        let message = message_of(messages, options);
        assert!(words.iter().all(|word| message.contains(word)) && !message.contains('\n'), "{message}");
    };
    says(&with_imu(&walk), &ImportOptions { height_m: None, ..options() }, &["height", "--height-m"]);
    says(&pictures(&walk, "eye", "base"), &options(), &["pitch and roll", "--imu", "eye"]);
    says(&super::Messages::default(), &options(), &["no topic holds pictures", "info"]);

    let mut messages = with_imu(&walk);
    messages.ros("/odom2", "nav_msgs/msg/Odometry", "", walk[0].time_ns, &robot::odometry(&walk[0], "base"));
    says(&messages, &options(), &["2 topics", "--odometry", "/odom, /odom2"]);
    says(
        &with_imu(&walk),
        &ImportOptions { imu: Some("/im".to_owned()), ..options() },
        &["--imu", "/im", "/imu"],
    );

    let mut messages = super::Messages::default();
    let (truth, picture) = (&walk[0], robot::compressed(&walk[0], "camera", robot::jpeg(0)));
    messages.ros(
        "/c/image/compressed",
        "sensor_msgs/msg/CompressedImage",
        COMPRESSED,
        truth.time_ns,
        &picture,
    );
    says(&messages, &options(), &["no topic holds the camera's calibration", "--camera", "calibrate"]);
    let zeros = robot::camera_info(truth, "plumb_bob", &[0.0; 5], [0.0; 9]);
    messages.ros("/c/camera_info", "sensor_msgs/msg/CameraInfo", "", truth.time_ns, &zeros);
    says(&messages, &options(), &["the calibration on topic /c/camera_info is all zeros", "calibrate"]);
}

#[test]
fn a_file_that_is_no_log_is_called_that() {
    let error = import_bytes(b"something else entirely", &options()).err().unwrap().to_string();
    assert!(error.contains("is not an MCAP file"), "{error}");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bag.db3");
    std::fs::write(&file, [b'x'; 200]).unwrap();
    let error = import_file(folder, &file, &options()).err().unwrap().to_string();
    assert!(error.contains("SQLite"), "{error}");
}

/// A robot that nobody has calibrated: what is known is kept, the rest is left to `calibrate`.
#[test]
fn logs_without_calibration_or_height_become_sequences_if_that_is_wanted() {
    let walk = walk(5);
    let imported = |messages: &super::Messages| {
        let folder = tempfile::tempdir().unwrap();
        let (file, out) = (folder.path().join("log.mcap"), folder.path().join("sequence"));
        std::fs::write(&file, messages.mcap(None, None)).unwrap();
        let options = ImportOptions { height_m: None, allows_uncalibrated: true, ..options() };
        let log = reality_sim_formats::log::Log::open(&file).unwrap();
        let report = reality_sim_formats::import::import_log(&log, &options, &out, &mut |_| {}).unwrap();
        (report, std::fs::read_to_string(out.join("camera.toml")), folder)
    };
    let (report, camera, _folder) = imported(&with_imu(&walk));
    let camera = camera.unwrap();
    assert!(report.height_m.is_none() && report.camera_model == Some("OPENCV"));
    assert!(camera.contains("fx = ") && !camera.contains("[mount]"), "{camera}");
    assert!(report.notes.iter().any(|note| note.contains("calibrate")), "{:?}", report.notes);

    let mut messages = with_imu(&walk);
    messages.retain(|topic| !topic.ends_with("camera_info"));
    let (report, camera, folder) = imported(&messages);
    assert!(camera.is_err() && report.camera_model.is_none() && report.frames == 5);
    assert!(folder.path().join("sequence/frames.csv").is_file());
}
