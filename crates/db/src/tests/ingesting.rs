//! Adding recordings: again, changed, broken, and from two programs at once.

use std::{thread, time::Duration};

use image::{Rgb, RgbImage};
use reality_sim_core::sequence::save_image;

use super::*;

#[test]
fn the_same_sequence_again_adds_nothing_from_whatever_folder() {
    let sequence = walk();
    let (folder, path) = database_of(&sequence);
    let elsewhere = folder.path().join("elsewhere");
    sequence.write(&elsewhere).unwrap();
    (0..60).for_each(|index| sequence.copy_image(index, &elsewhere).unwrap());
    let mut database = Database::create_or_open(&path).unwrap();
    let before = database.images().unwrap();
    let report = add(&mut database, &Sequence::open(&elsewhere).unwrap()).unwrap();
    assert_eq!(report, IngestReport { added: 0, replaced: 0, already_there: 60, without_pose: 0 });
    assert_eq!(database.images().unwrap(), before);
    assert_eq!(database.sequences().unwrap().len(), 1);
}

#[test]
fn a_recording_that_went_on_is_completed() {
    let (_folder, path) = database_of(&short_walk(20));
    let mut database = Database::create_or_open(&path).unwrap();
    let report = add(&mut database, &walk()).unwrap();
    assert_eq!(report, IngestReport { added: 40, replaced: 0, already_there: 20, without_pose: 0 });
    let frames: Vec<usize> = database.images().unwrap().iter().map(|image| image.frame_index).collect();
    assert_eq!(frames, (0..60).collect::<Vec<_>>());
}

#[test]
fn frames_without_a_pose_are_left_out_until_they_have_one() {
    let sequence = walk();
    let folder = tempfile::tempdir().unwrap();
    let mut database = Database::create_or_open(&folder.path().join("a.db")).unwrap();
    let mut poses = estimates(&sequence);
    poses[3] = None;
    poses[59] = None;
    let report = database.ingest(&sequence, &poses, &PoseSource::GroundTruth).unwrap();
    assert_eq!(report, IngestReport { added: 58, replaced: 0, already_there: 0, without_pose: 2 });
    assert!(database.images().unwrap().iter().all(|image| image.frame_index != 3));
    let report = add(&mut database, &sequence).unwrap();
    assert_eq!(report, IngestReport { added: 2, replaced: 0, already_there: 58, without_pose: 0 });
}

#[test]
fn adding_that_is_stopped_in_the_middle_of_a_batch_keeps_what_was_done_and_goes_on_from_there() {
    let sequence = long_walk(100);
    let folder = tempfile::tempdir().unwrap();
    let mut database = Database::create_or_open(&folder.path().join("a.db")).unwrap();
    let mut seen = Vec::new();
    let stop_at_70 = |done| {
        seen.push(done);
        done < 70
    };
    let poses = estimates(&sequence);
    let report = database.ingest_while(&sequence, &poses, &PoseSource::GroundTruth, stop_at_70).unwrap();
    assert_eq!(report.added, 70);
    assert_eq!(seen, (1..=70).collect::<Vec<_>>(), "every frame is told");
    assert_eq!(database.images().unwrap().len(), 70);
    let report = add(&mut database, &sequence).unwrap();
    assert_eq!((report.added, report.already_there), (30, 70));
}

#[test]
fn recordings_of_one_name_are_told_apart_and_share_camera_and_field() {
    let (_folder, path) = database_of(&short_walk(3));
    let mut other = short_walk(3);
    other.frames[0].pitch_rad += 0.01;
    let mut database = Database::create_or_open(&path).unwrap();
    assert_eq!(add(&mut database, &other).unwrap().added, 3);
    assert_eq!(database.sequences().unwrap().len(), 2);
    assert_eq!((database.cameras().unwrap().len(), database.fields().unwrap().len()), (1, 1));
    assert_eq!(database.pose_sources().unwrap().len(), 1);
}

#[test]
fn a_changed_sequence_is_refused_and_nothing_is_changed() {
    let (folder, path) = database_of(&short_walk(5));
    let mut database = Database::create_or_open(&path).unwrap();
    let before = database.images().unwrap();
    let original = short_walk(7);
    let with = |change: &dyn Fn(&mut Sequence)| {
        let mut sequence = original.clone();
        change(&mut sequence);
        sequence
    };
    let far = |pose: &mut CameraPose| pose.x_m += 1e-3;
    for (changed, what) in [
        (
            with(&|sequence| sequence.frames[4].reference_pose.iter_mut().for_each(far)),
            "frame 4 of the sequence \"walk\" is in it with another pose",
        ),
        (
            with(&|sequence| sequence.frames[3].timestamp_s += 0.01),
            "frame 3 of the sequence \"walk\" is in it with another time",
        ),
        (
            with(&|sequence| sequence.frames[2].image = sequence.frames[3].image.clone()),
            "frame 2 of the sequence \"walk\" is in it with another file name",
        ),
        (with(&|sequence| sequence.setup.mount_height_m = 0.4), "another camera"),
        (with(&|sequence| sequence.field.length_m += 0.5), "another field"),
    ] {
        let error = add(&mut database, &changed).expect_err(what);
        assert_message(&error, &path, &[what, "the sequence was changed", "build it into a new file"]);
    }
    original.write(folder.path()).unwrap();
    (0..7).for_each(|index| original.copy_image(index, folder.path()).unwrap());
    fs::copy(original.image_path(0).unwrap(), folder.path().join(&original.frames[4].image)).unwrap();
    let error = add(&mut database, &Sequence::open(folder.path()).unwrap()).unwrap_err();
    assert_message(&error, &path, &["frame 4", "another picture"]);
    assert_eq!(database.images().unwrap(), before);
}

#[test]
fn poses_that_differ_by_rounding_or_a_turn_are_the_same() {
    let (_folder, path) = database_of(&short_walk(3));
    let mut again = short_walk(3);
    for pose in again.frames.iter_mut().flat_map(|frame| &mut frame.reference_pose) {
        pose.yaw_rad += std::f64::consts::TAU;
        pose.height_m += 1e-9;
    }
    assert_eq!(add(&mut Database::create_or_open(&path).unwrap(), &again).unwrap().already_there, 3);
}

#[test]
fn a_broken_picture_is_named_and_the_others_are_stored() {
    let sequence = long_walk(70);
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("copy");
    let mut broken = sequence.clone();
    broken.folder = copy.clone();
    for index in 0..70 {
        broken.frames[index].image = format!("{index}.jpg").into();
        sequence.copy_image(index, &copy).unwrap();
        fs::create_dir_all(&copy).unwrap();
        fs::copy(sequence.image_path(index).unwrap(), copy.join(&broken.frames[index].image)).unwrap();
    }
    let file = broken.image_path(68).unwrap();
    let bytes = fs::read(&file).unwrap();
    let path = folder.path().join("a.db");
    let mut database = Database::create_or_open(&path).unwrap();
    fs::write(&file, &bytes[..bytes.len() / 2]).unwrap();
    assert_message(
        &add(&mut database, &broken).unwrap_err(),
        &path,
        &["other 69 pictures", "68.jpg", "cut off"],
    );
    fs::write(&file, "hello").unwrap();
    assert_message(&add(&mut database, &broken).unwrap_err(), &path, &["68.jpg", "neither a JPEG nor a PNG"]);
    fs::remove_file(&file).unwrap();
    assert_message(&add(&mut database, &broken).unwrap_err(), &path, &["68.jpg", "there is no such file"]);
    assert_eq!(database.images().unwrap().len(), 69);
    fs::write(&file, &bytes).unwrap();
    let report = add(&mut database, &broken).unwrap();
    assert_eq!(report, IngestReport { added: 1, replaced: 0, already_there: 69, without_pose: 0 });
}

#[test]
fn large_pictures_are_committed_before_they_fill_the_memory() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = 1_u32;
    // Noise does not compress.
    let noise = RgbImage::from_fn(2000, 2000, |_, _| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        Rgb([(state >> 8) as u8, (state >> 16) as u8, (state >> 24) as u8])
    });
    save_image(&folder.path().join("noise.png"), &noise).unwrap();
    let mut sequence = short_walk(5);
    (sequence.setup.camera.width, sequence.setup.camera.height) = noise.dimensions();
    sequence.folder = folder.path().to_path_buf();
    sequence.frames.iter_mut().for_each(|frame| frame.image = "noise.png".into());
    let path = folder.path().join("a.db");
    let mut database = Database::create_or_open(&path).unwrap();
    let mut committed = Vec::new();
    let count_committed = |_| {
        committed.push(Database::open(&path).unwrap().images().unwrap().len());
        true
    };
    database
        .ingest_while(&sequence, &estimates(&sequence), &PoseSource::GroundTruth, count_committed)
        .unwrap();
    assert_eq!(committed, [0, 0, 2, 2, 4]);
    assert_eq!(database.picture(5).unwrap(), noise);
}

#[test]
fn a_picture_of_another_size_is_refused() {
    let mut sequence = short_walk(2);
    sequence.setup.camera.width += 1;
    let folder = tempfile::tempdir().unwrap();
    let mut database = Database::create_or_open(&folder.path().join("a.db")).unwrap();
    let error = add(&mut database, &sequence).unwrap_err();
    assert_message(&error, &sequence.folder, &["2 of its 2 pictures", "000000.jpg", "pixels and the camera"]);
    assert!(database.images().unwrap().is_empty() && database.sequences().unwrap().is_empty());
}

#[test]
fn poses_that_are_no_numbers_or_too_few_are_refused() {
    let sequence = walk();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.db");
    let mut database = Database::create_or_open(&path).unwrap();
    let mut ingest = |poses: &[Option<PoseEstimate>], part: &str| {
        let error = database.ingest(&sequence, poses, &PoseSource::GroundTruth).unwrap_err();
        assert_message(&error, &path, &[part]);
    };
    let good = estimates(&sequence);
    ingest(&good[1..], "59 poses were given for the 60 frames");
    ingest(&[], "0 poses");
    let mut bad = good.clone();
    bad[7].as_mut().unwrap().pose.roll_rad = f64::NAN;
    ingest(&bad, "frame 7 is none that a camera can have");
    let mut bad = good;
    bad[8].as_mut().unwrap().covariance.as_mut().unwrap()[(5, 2)] = f64::INFINITY;
    ingest(&bad, "frame 8 is none that a camera can have");
    assert!(Database::open(&path).unwrap().images().unwrap().is_empty());
}

#[test]
fn a_reader_does_not_write() {
    let (_folder, path) = database_of(&short_walk(2));
    let mut reader = Database::open(&path).unwrap();
    assert_message(&add(&mut reader, &walk()).unwrap_err(), &path, &["was opened for reading"]);
    let connection = reader.connection.lock().unwrap();
    assert!(connection.execute("DELETE FROM images", []).is_err());
}

#[test]
fn a_full_disk_is_an_error_and_what_was_committed_stays() {
    let sequence = long_walk(200);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.db");
    let mut database = Database::create_or_open(&path).unwrap();
    let limit = |database: &Database, pages: i64| {
        // SQLite then behaves as on a disk of this size.
        let connection = database.connection.lock().unwrap();
        connection.pragma_update_and_check(None, "max_page_count", pages, |_| Ok(())).unwrap();
    };
    limit(&database, 2500);
    assert_message(&add(&mut database, &sequence).unwrap_err(), &path, &["the disk is full"]);
    let kept = database.images().unwrap().len();
    assert!(kept > 0 && kept.is_multiple_of(64), "{kept}");
    limit(&database, i64::from(u32::MAX));
    let report = add(&mut database, &sequence).unwrap();
    assert_eq!(report, IngestReport { added: 200 - kept, replaced: 0, already_there: kept, without_pose: 0 });
}

#[test]
fn a_second_writer_gets_a_clear_error_when_the_first_does_not_finish() {
    let (_folder, path) = database_of(&short_walk(2));
    let first = Database::create_or_open(&path).unwrap();
    let mut second = Database::create_or_open(&path).unwrap();
    second.connection.lock().unwrap().busy_timeout(Duration::from_millis(10)).unwrap();
    let connection = first.connection.lock().unwrap();
    connection.execute_batch("BEGIN IMMEDIATE").unwrap();
    assert_message(&add(&mut second, &walk()).unwrap_err(), &path, &["is locked by another program"]);
    connection.execute_batch("ROLLBACK").unwrap();
    assert_eq!(add(&mut second, &walk()).unwrap().added, 58);
}

#[test]
fn two_writers_of_one_sequence_take_turns_and_double_nothing() {
    let sequence = long_walk(256);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.db");
    let write = || add(&mut Database::create_or_open(&path).unwrap(), &sequence).unwrap();
    let reports =
        thread::scope(|scope| [scope.spawn(write), scope.spawn(write)].map(|writer| writer.join().unwrap()));
    assert_eq!(reports[0].added + reports[1].added, 256);
    assert_eq!(reports[0].already_there + reports[1].already_there, 256);
    assert_eq!(read_all(&path).unwrap(), 256);
}
