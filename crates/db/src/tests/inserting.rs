//! Adding one image at a time.

use super::*;

/// Inserts a frame of the walk as an image; its recording is identified by name and first frame, like one in a folder.
fn insert(database: &mut Database, sequence: &Sequence, index: usize) -> Result<Insertion, DbError> {
    let recording = Recording::of_sequence(sequence, PoseSource::GroundTruth)?;
    let estimate = estimates(sequence)[index].unwrap();
    let frame = &sequence.frames[index];
    let image = NewImage {
        frame_index: index,
        timestamp_s: frame.timestamp_s,
        file_name: frame.image.to_str().unwrap(),
        estimate: &estimate,
        bytes: &sequence.image_bytes(index)?,
    };
    database.insert(&recording, &image)
}

fn empty() -> (TempDir, Database) {
    let folder = tempfile::tempdir().unwrap();
    let database = Database::create_or_open(&folder.path().join("a.db")).unwrap();
    (folder, database)
}

#[test]
fn images_inserted_one_by_one_are_those_that_a_folder_s_ingest_adds() {
    let sequence = short_walk(5);
    let (_folder, path) = database_of(&sequence);
    let (_other, mut database) = empty();
    for index in 0..5 {
        assert_eq!(insert(&mut database, &sequence, index).unwrap(), Insertion::Added);
    }
    assert_eq!(database.images().unwrap(), Database::open(&path).unwrap().images().unwrap());
    let report = add(&mut database, &sequence).unwrap();
    assert_eq!(report, IngestReport { added: 0, replaced: 0, already_there: 5, without_pose: 0 });
}

#[test]
fn an_image_that_is_there_is_not_added_again_and_another_in_its_place_is_refused() {
    let mut sequence = short_walk(2);
    let (_folder, mut database) = empty();
    insert(&mut database, &sequence, 1).unwrap();
    assert_eq!(insert(&mut database, &sequence, 1).unwrap(), Insertion::AlreadyThere);
    sequence.frames[1].timestamp_s += 1.0;
    let error = insert(&mut database, &sequence, 1).unwrap_err();
    let DbError::Database { fault: DbFault::Changed { what, .. }, .. } = error else { panic!("{error}") };
    assert_eq!(what, "time");
    assert_eq!(database.images().unwrap().len(), 1);
}

#[test]
fn what_is_no_picture_of_the_camera_or_has_no_possible_pose_or_time_is_refused_and_leaves_nothing() {
    let sequence = short_walk(1);
    let (_folder, mut database) = empty();
    let recording =
        Recording::new("live", &sequence.setup, &sequence.field, PoseSource::GroundTruth).unwrap();
    let estimate = estimates(&sequence)[0].unwrap();
    let bytes = sequence.image_bytes(0).unwrap();
    let image =
        NewImage { frame_index: 0, timestamp_s: 0.0, file_name: "0.jpg", estimate: &estimate, bytes: &bytes };

    let torn = NewImage { bytes: &bytes[..bytes.len() / 2], ..image };
    assert!(matches!(database.insert(&recording, &torn), Err(DbError::Sequence(_))));
    let never = NewImage { timestamp_s: f64::NAN, ..image };
    let nowhere = PoseEstimate::from(CameraPose { x_m: f64::NAN, ..estimate.pose });
    let nowhere = NewImage { estimate: &nowhere, ..image };
    for image in [never, nowhere] {
        assert!(matches!(database.insert(&recording, &image), Err(DbError::Database { .. })));
    }
    assert!(database.images().unwrap().is_empty() && database.sequences().unwrap().is_empty());
    assert_eq!(database.insert(&recording, &image).unwrap(), Insertion::Added);
}

#[test]
fn nothing_is_inserted_into_a_database_that_was_opened_for_reading() {
    let sequence = short_walk(1);
    let (_folder, path) = database_of(&sequence);
    let error = insert(&mut Database::open(&path).unwrap(), &sequence, 0).unwrap_err();
    assert!(matches!(error, DbError::Database { fault: DbFault::OpenedForReading, .. }));
}
