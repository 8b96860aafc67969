//! Reading back what was stored.

use std::{sync::Arc, thread};

use super::*;

#[test]
fn images_come_out_as_they_went_in() {
    let sequence = walk();
    let (_folder, path) = database_of(&sequence);
    let database = Database::open(&path).unwrap();
    let images = database.images().unwrap();
    assert_eq!(images.len(), sequence.frames.len());
    assert!(images.is_sorted_by(|a, b| a.id < b.id));
    let details = details_of(&database).unwrap();
    for (index, image) in images.iter().enumerate() {
        let (file, details) = (fs::read(sequence.image_path(index).unwrap()).unwrap(), &details[&image.id]);
        assert_eq!(database.image_bytes(image.id).unwrap(), file);
        assert_eq!(details.byte_length, file.len() as u64);
        assert_eq!(image.frame_index, index);
        assert_eq!(image.timestamp_s, sequence.frames[index].timestamp_s);
        assert_eq!(Path::new(&details.file_name), sequence.frames[index].image);
        let estimate = PoseEstimate { pose: image.pose, covariance: details.covariance };
        assert_eq!(Some(estimate), estimates(&sequence)[index]);
    }
    let image = &images[17];
    assert_eq!(database.picture(image.id).unwrap(), sequence.load_image(17).unwrap());
    assert_eq!(database.sequences().unwrap()[&image.sequence_id], sequence.name);
    assert_eq!(database.cameras().unwrap()[&image.camera_id], sequence.setup);
    assert_eq!(database.fields().unwrap()[&image.field_id], sequence.field);
    assert_eq!(database.pose_sources().unwrap()[&details[&image.id].pose_source_id], PoseSource::GroundTruth);
}

#[test]
fn every_kind_of_pose_source_and_no_covariance_come_out_as_they_went_in() {
    let sequence = walk();
    let folder = tempfile::tempdir().unwrap();
    let mut database = Database::create_or_open(&folder.path().join("walk.db")).unwrap();
    let sources = [
        PoseSource::GroundTruth,
        PoseSource::Filter { settings: "{\"seed\": 3}".to_owned() },
        PoseSource::File { name: "poses ü.tum".to_owned() },
    ];
    for (index, source) in sources.iter().enumerate() {
        let pose = sequence.frames[index].reference_pose.unwrap();
        let mut poses = vec![None; sequence.frames.len()];
        poses[index] = Some(PoseEstimate { pose, covariance: None });
        database.ingest(&sequence, &poses, source).unwrap();
    }
    let details = details_of(&database).unwrap();
    let stored = database.pose_sources().unwrap();
    let found: Vec<&PoseSource> = details.values().map(|details| &stored[&details.pose_source_id]).collect();
    assert_eq!(found, sources.iter().collect::<Vec<_>>());
    assert!(details.values().all(|details| details.covariance.is_none()));
}

#[test]
fn an_image_that_is_not_there_is_an_error() {
    let (_folder, path) = database_of(&short_walk(2));
    let database = Database::open(&path).unwrap();
    for id in [0, 3, -1, i64::MAX] {
        assert_message(&database.picture(id).unwrap_err(), &path, &[&format!("no image {id}")]);
        assert_message(&database.image_bytes(id).unwrap_err(), &path, &[&format!("no image {id}")]);
    }
}

#[test]
fn threads_share_a_database_and_open_it_again() {
    let sequence = short_walk(8);
    let (_folder, path) = database_of(&sequence);
    let database = Arc::new(Database::open(&path).unwrap());
    let pictures: Vec<_> = (0..8).map(|index| sequence.load_image(index).unwrap()).collect();
    thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| {
                let own = Database::open(&path).unwrap();
                for (image, picture) in database.images().unwrap().iter().zip(&pictures) {
                    assert_eq!(&database.picture(image.id).unwrap(), picture);
                    assert_eq!(&own.picture(image.id).unwrap(), picture);
                }
            });
        }
    });
}

#[test]
fn nonsense_in_a_row_is_an_error_that_names_the_row() {
    let (folder, path) = database_of(&short_walk(3));
    let fresh = folder.path().join("fresh.db");
    for (sql, part) in [
        ("UPDATE images SET yaw_rad = 9e999 WHERE id = 2", "image 2: no camera can have its pose"),
        ("UPDATE images SET timestamp_s = -9e999 WHERE id = 2", "image 2: its time is not"),
        ("UPDATE images SET covariance = x'000000' WHERE id = 2", "covariance"),
        ("UPDATE images SET frame_index = -1 WHERE id = 2", "-1"),
        ("UPDATE images SET byte_length = -1 WHERE id = 2", "-1"),
        ("DELETE FROM cameras", "its camera is missing"),
        ("DELETE FROM fields", "its field is missing"),
        ("DELETE FROM sequences", "its sequence is missing"),
        ("DELETE FROM pose_sources", "its pose source is missing"),
    ] {
        fs::copy(&path, &fresh).unwrap();
        tamper(&fresh, sql);
        let database = Database::open(&fresh).unwrap();
        let error = database.images().and_then(|_| details_of(&database)).expect_err(sql);
        assert_message(&error, &fresh, &["is damaged", part, "build it again"]);
    }
    fs::copy(&path, &fresh).unwrap();
    tamper(
        &fresh,
        "UPDATE images SET covariance = CAST(zeroblob(280) || x'000000000000f07f' AS BLOB) WHERE id = 2",
    );
    let database = Database::open(&fresh).unwrap();
    assert_message(
        &details_of(&database).unwrap_err(),
        &fresh,
        &["image 2: its covariance is not of finite"],
    );
}

#[test]
fn other_tables_views_and_triggers_than_this_program_s_are_refused() {
    let (folder, path) = database_of(&short_walk(1));
    let fresh = folder.path().join("fresh.db");
    for (sql, part) in [
        ("DROP TABLE image_bytes", "table \"image_bytes\""),
        (
            "DROP TABLE sequences; CREATE VIEW sequences AS WITH RECURSIVE endless(id, name) AS
                (SELECT 1, 'a' UNION ALL SELECT id + 1, name FROM endless) SELECT * FROM endless",
            "table \"sequences\"",
        ),
        ("ALTER TABLE halls ADD COLUMN more TEXT DEFAULT 'a'", "table \"halls\""),
        ("CREATE VIEW more AS SELECT 1", "view \"more\""),
        ("CREATE INDEX costly ON images (length(hex(zeroblob(1000000))))", "index \"costly\""),
        ("CREATE TRIGGER more AFTER DELETE ON images BEGIN DELETE FROM fields; END", "trigger \"more\""),
    ] {
        fs::copy(&path, &fresh).unwrap();
        tamper(&fresh, sql);
        for error in [Database::open(&fresh), Database::create_or_open(&fresh)].map(Result::unwrap_err) {
            assert_message(&error, &fresh, &[part, "build it again"]);
        }
    }
    fs::copy(&path, &fresh).unwrap();
    tamper(&fresh, "CREATE TABLE notes (text TEXT); CREATE INDEX by_text ON notes (text)");
    assert_eq!(Database::open(&fresh).unwrap().images().unwrap().len(), 1);
}

#[test]
fn a_picture_camera_or_field_that_is_damaged_is_an_error_that_names_it() {
    let (folder, path) = database_of(&short_walk(3));
    let fresh = folder.path().join("fresh.db");
    for (sql, part) in [
        ("DELETE FROM image_bytes WHERE image_id = 2", "image 2: its bytes are missing"),
        ("DELETE FROM cameras", "image 2: its camera is missing"),
        ("UPDATE image_bytes SET bytes = x'' WHERE image_id = 2", ", image 2: is neither"),
        (
            "UPDATE image_bytes SET bytes = substr(bytes, 1, 30000) WHERE image_id = 2",
            ", image 2: the picture is cut",
        ),
        ("UPDATE cameras SET toml = replace(toml, 'width = ', 'width = 1')", ", image 2: the picture has"),
        ("UPDATE cameras SET toml = 'hello'", ", camera 1, line 1"),
    ] {
        fs::copy(&path, &fresh).unwrap();
        tamper(&fresh, sql);
        let error = Database::open(&fresh).unwrap().picture(2).expect_err(sql);
        assert_message(&error, &fresh, &[part]);
    }
    fs::copy(&path, &fresh).unwrap();
    tamper(&fresh, "UPDATE cameras SET toml = 'fx = 1'; UPDATE fields SET toml = 'length_m = -1'");
    let database = Database::open(&fresh).unwrap();
    assert_message(&database.cameras().unwrap_err(), &fresh, &[", camera 1: the key"]);
    assert_message(&database.fields().unwrap_err(), &fresh, &[", field 1"]);
}
