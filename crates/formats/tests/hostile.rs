//! Damaged logs: whatever the bytes are, reading ends, without a panic, and takes no more memory than twice the file and what
//! reading any file takes. `PROPTEST_CASES` raises the number of cases.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

#[path = "import/cdr.rs"]
mod cdr;
#[path = "import/foxglove_logs.rs"]
mod foxglove_logs;
#[path = "import/log_writer.rs"]
mod log_writer;
#[allow(dead_code, reason = "other tests use the rest")]
#[path = "import/robot.rs"]
mod robot;

use std::{
    alloc::{GlobalAlloc, Layout, System},
    fs,
    path::Path,
    sync::atomic::{AtomicUsize, Ordering},
};

use mcap::Compression;
use proptest::prelude::*;
use reality_sim_core::field::FieldDimensions;
use reality_sim_formats::{
    import::{ImportOptions, import_log},
    log::Log,
};

use self::{
    cdr::{Value, encode},
    log_writer::{Kind, Messages},
    robot::walk,
};

/// Memory that is in use, and the most that was since it was reset, bytes.
static IN_USE: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

/// Allocator that counts.
struct Counting;

// SAFETY: every call is the system allocator's; counting changes nothing of it.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let now = IN_USE.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        MOST.fetch_max(now, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        IN_USE.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Memory that reading any log takes, bytes: buffers, SQLite's cache, decompressors, and a small picture for each thread.
const ALLOWANCE: usize = 24 << 20;

/// Largest part of a file that one change replaces.
const MAX_CHANGE: usize = 16;

fn ros(
    messages: &mut Messages,
    topic: &str,
    type_name: &'static str,
    definition: &str,
    time_ns: i64,
    value: &Value,
) {
    messages.add(topic, &Kind::cdr(type_name, definition), time_ns, encode(value, false));
}

/// A small log with every kind of message.
fn small_log() -> Messages {
    let mut messages = Messages::default();
    for (index, truth) in walk(4).iter().enumerate() {
        let time = truth.time_ns;
        let picture = robot::compressed(truth, "camera", robot::jpeg(index));
        ros(
            &mut messages,
            "/image/compressed",
            "sensor_msgs/msg/CompressedImage",
            robot::COMPRESSED,
            time,
            &picture,
        );
        let info = robot::camera_info(truth, "plumb_bob", &[0.1, 0.0, 0.0, 0.0, 0.0], robot::MATRIX);
        ros(&mut messages, "/image/camera_info", "sensor_msgs/msg/CameraInfo", "", time, &info);
        ros(&mut messages, "/odom", "nav_msgs/msg/Odometry", "", time, &robot::odometry(truth, "base"));
        let turn = truth.level_from_body(0.0);
        let imu = robot::imu(truth, "imu", Some(turn), glam::DVec3::ZERO);
        ros(&mut messages, "/imu", "sensor_msgs/msg/Imu", robot::IMU, time, &imu);
        let link = robot::transform(time, "base", "camera", glam::DVec3::Z * 0.5, turn);
        ros(&mut messages, "/tf", "tf2_msgs/msg/TFMessage", robot::TF, time, &Value::Sequence(vec![link]));
        let names = Value::Sequence(vec![cdr::text("neck"), cdr::text("knee")]);
        let positions = Value::Sequence(vec![Value::F64(0.1), Value::F64(0.2)]);
        let nothing = Value::Sequence(Vec::new());
        let joints = Value::All(vec![robot::header(time, ""), names, positions, nothing.clone(), nothing]);
        ros(&mut messages, "/joints", "sensor_msgs/msg/JointState", robot::JOINTS, time, &joints);
        let pose = robot::pose(time, glam::DVec3::Z * 0.5, turn);
        ros(&mut messages, "/mocap", "geometry_msgs/msg/PoseStamped", robot::POSE, time, &pose);
        let json = format!(
            r#"{{"timestamp":{{"sec":1,"nsec":{index}}},"frame_id":"c","width":64,"height":48,"distortion_model":"","D":[],"K":[1,0,2,0,1,2,0,0,1]}}"#
        );
        let kind = Kind::json(
            "foxglove.CameraCalibration",
            r#"{"properties":{"width":{},"height":{},"distortion_model":{},"K":{}}}"#,
        );
        messages.add("/fox/calibration", &kind, time, json.into_bytes());
    }
    messages
}

fn whole_logs() -> Vec<(&'static str, Vec<u8>)> {
    let messages = small_log();
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("bag.db3");
    messages.write_db3(&bag);
    vec![
        ("mcap", messages.mcap(None, None)),
        ("mcap", messages.mcap(None, Some(2000))),
        ("mcap", messages.mcap(Some(Compression::Lz4), Some(4000))),
        ("mcap", messages.mcap(Some(Compression::Zstd), Some(4000))),
        ("mcap", foxglove_logs::json_log(&walk(4), true).mcap(None, Some(4000))),
        ("mcap", foxglove_logs::protobuf_log(&walk(4)).mcap(None, Some(4000))),
        ("db3", fs::read(bag).unwrap()),
    ]
}

/// Change of a file: where, as a part of its length, and what to.
#[derive(Debug, Clone)]
enum Change {
    Replace(f64, Vec<u8>),
    Cut(f64),
    Remove(f64, usize),
    Insert(f64, Vec<u8>),
    /// A length that is far too large, of four or eight bytes.
    Length(f64, usize),
}

fn change() -> impl Strategy<Value = Change> {
    let bytes = || prop::collection::vec(any::<u8>(), 1..MAX_CHANGE);
    prop_oneof![
        4 => (0.0..1.0, bytes()).prop_map(|(at, bytes)| Change::Replace(at, bytes)),
        1 => (0.0..1.0).prop_map(Change::Cut),
        1 => (0.0..1.0, 1..200_usize).prop_map(|(at, count)| Change::Remove(at, count)),
        1 => (0.0..1.0, bytes()).prop_map(|(at, bytes)| Change::Insert(at, bytes)),
        2 => (0.0..1.0, prop::sample::select(vec![4_usize, 8])).prop_map(|(at, count)| Change::Length(at, count)),
    ]
}

fn apply(change: &Change, file: &mut Vec<u8>) {
    let place = |at: f64, file: &[u8]| (at * file.len() as f64) as usize;
    match change {
        Change::Replace(at, bytes) => {
            let start = place(*at, file);
            file.iter_mut().skip(start).zip(bytes).for_each(|(old, new)| *old = *new);
        }
        Change::Cut(at) => file.truncate(place(*at, file)),
        Change::Remove(at, count) => {
            let start = place(*at, file);
            file.drain(start..(start + count).min(file.len()));
        }
        Change::Insert(at, bytes) => {
            let start = place(*at, file);
            file.splice(start..start, bytes.iter().copied());
        }
        Change::Length(at, count) => {
            let start = place(*at, file);
            file.iter_mut().skip(start).take(*count).for_each(|byte| *byte = 0x7f);
        }
    }
}

/// Reads and imports a file; both may fail, with a message on one line.
fn read(folder: &Path, ending: &str, bytes: &[u8]) -> usize {
    let file = folder.join(format!("log.{ending}"));
    fs::write(&file, bytes).unwrap();
    let field = FieldDimensions::preset("spl").unwrap();
    let options = ImportOptions { height_m: Some(0.5), ..ImportOptions::new("hostile", field) };
    let before = IN_USE.load(Ordering::Relaxed);
    MOST.store(before, Ordering::Relaxed);
    let log = Log::open(&file).unwrap();
    let surveyed = log.survey().map(drop).map_err(|error| error.to_string());
    let imported = import_log(&log, &options, &folder.join("out"), &mut |_| {})
        .map(drop)
        .map_err(|error| error.to_string());
    for message in [surveyed, imported].into_iter().filter_map(Result::err) {
        assert!(!message.contains('\n') && message.len() < 3000, "{message}");
    }
    MOST.load(Ordering::Relaxed) - before
}

#[test]
fn no_change_of_a_log_makes_reading_fail_badly() {
    let logs = whole_logs();
    let folder = tempfile::tempdir().unwrap();
    let cases: u32 = std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(200);
    let mut runner =
        proptest::test_runner::TestRunner::new(ProptestConfig { cases, ..ProptestConfig::default() });
    let case = (0..logs.len(), prop::collection::vec(change(), 1..6));
    let result = runner.run(&case, |(index, changes)| {
        let (ending, mut file) = logs[index].clone();
        changes.iter().for_each(|change| apply(change, &mut file));
        let most = read(folder.path(), ending, &file);
        prop_assert!(most <= 2 * file.len() + ALLOWANCE, "{most} bytes for {}", file.len());
        Ok(())
    });
    result.unwrap();
}
