//! Databases merged and split by field: what was known of every image stays known.

use reality_sim_core::{pose::CameraPose, warp::Hall};

use super::{cleaning::with_clean_stage, *};

/// Everything that is stored of an image, but for ids.
#[derive(Debug, Clone, PartialEq)]
struct Known {
    sequence: String,
    frame_index: usize,
    timestamp_s: f64,
    pose: CameraPose,
    covariance: Option<Matrix6<f64>>,
    file_name: String,
    source: PoseSource,
    field_length_m: f64,
    bytes: Vec<u8>,
}

fn all_known(database: &Database) -> Vec<Known> {
    let (sequences, fields) = (database.sequences().unwrap(), database.fields().unwrap());
    let sources = database.pose_sources().unwrap();
    let mut images = Vec::new();
    database.each_image(|image, details| images.push((image, details))).unwrap();
    let known = |(image, details): (ImageRecord, ImageDetails)| Known {
        sequence: sequences[&image.sequence_id].clone(),
        frame_index: image.frame_index,
        timestamp_s: image.timestamp_s,
        pose: image.pose,
        covariance: details.covariance,
        file_name: details.file_name,
        source: sources[&details.pose_source_id].clone(),
        field_length_m: fields[&image.field_id].length_m,
        bytes: database.image_bytes(image.id).unwrap(),
    };
    let mut known: Vec<Known> = images.into_iter().map(known).collect();
    known.sort_by(|a, b| (&a.sequence, a.frame_index).cmp(&(&b.sequence, b.frame_index)));
    known
}

/// Returns the walk's first frames under another name, on a field that is longer by so many metres.
fn walk_elsewhere(frames: usize, name: &str, longer_m: f64) -> Sequence {
    let mut sequence = short_walk(frames);
    sequence.name = name.to_owned();
    sequence.field.length_m += longer_m;
    sequence
}

fn field_of_length(database: &Database, length_m: f64) -> i64 {
    let fields = database.fields().unwrap();
    *fields.iter().find(|(_, field)| (field.length_m - length_m).abs() < 1e-9).unwrap().0
}

fn goes_on(_: usize) -> bool {
    true
}

fn new_database() -> (TempDir, Database) {
    let folder = tempfile::tempdir().unwrap();
    let database = Database::create_or_open(&folder.path().join("new.db")).unwrap();
    (folder, database)
}

#[test]
fn merged_databases_hold_what_one_of_all_recordings_holds() {
    // More frames than are committed together.
    let (first, second) = (long_walk(150), walk_elsewhere(7, "elsewhere", 1.0));
    let ((_a, first_path), (_b, second_path)) = (database_of(&first), database_of(&second));
    let (_c, mut merged) = new_database();
    for (path, added) in [(&first_path, 150), (&second_path, 7)] {
        let report = merged.copy_from(&Database::open(path).unwrap(), None, goes_on).unwrap();
        assert_eq!(report, IngestReport { added, ..IngestReport::default() });
    }
    let (_d, together) = database_of(&first);
    let mut together = Database::create_or_open(&together).unwrap();
    add(&mut together, &second).unwrap();
    assert_eq!(all_known(&merged), all_known(&together));
    assert_eq!(merged.cameras().unwrap().len(), together.cameras().unwrap().len());

    let report = merged.copy_from(&Database::open(&first_path).unwrap(), None, goes_on).unwrap();
    assert_eq!(report, IngestReport { already_there: 150, ..IngestReport::default() });
    // A recording is recognised in a database that has it from another one.
    assert_eq!(add(&mut merged, &second).unwrap().already_there, 7);
}

#[test]
fn a_copy_that_was_stopped_goes_on() {
    let sequence = long_walk(150);
    let (_folder, path) = database_of(&sequence);
    let (_new, mut copy) = new_database();
    let other = Database::open(&path).unwrap();
    let mut done = Vec::new();
    let stopped = copy.copy_from(&other, None, |images| {
        done.push(images);
        false
    });
    assert_eq!((stopped.unwrap().added, done.len()), (done[0], 1));
    assert!(done[0] < 150);
    let report = copy.copy_from(&other, None, goes_on).unwrap();
    assert_eq!((report.already_there, report.added), (done[0], 150 - done[0]));
    assert_eq!(all_known(&copy), all_known(&other));
}

#[test]
fn a_field_is_split_off_with_its_hall_and_its_clean_stage() {
    // Another field's images come first, so that ids differ in the copy.
    let elsewhere = walk_elsewhere(5, "elsewhere", 1.0);
    let (_folder, path) = database_of(&elsewhere);
    let (_clean, clean_path) = with_clean_stage();
    let clean = Database::open(&clean_path).unwrap();
    let length_m = short_walk(1).field.length_m;
    let mut both = Database::create_or_open(&path).unwrap();
    both.copy_from(&clean, None, goes_on).unwrap();
    let field_id = field_of_length(&both, length_m);
    let hall = Hall::usual(&both.fields().unwrap()[&field_id]);
    both.set_hall(field_id, &hall).unwrap();
    assert_eq!(both.images_by_field().unwrap()[&field_id], 3);

    let (_new, mut copy) = new_database();
    let report = copy.copy_from(&both, Some(field_id), goes_on).unwrap();
    assert_eq!(report, IngestReport { added: 3, ..IngestReport::default() });
    assert_eq!(all_known(&copy), all_known(&clean));
    let own_id = field_of_length(&copy, length_m);
    assert_eq!(copy.fields().unwrap().len(), 1);
    assert_eq!(copy.halls().unwrap()[&own_id], hall);
    let clean_id = field_of_length(&clean, length_m);
    assert_eq!(copy.ground(own_id).unwrap(), clean.ground(clean_id).unwrap());
    let masks_by_frame = |database: &Database, field_id| {
        let frame =
            |id| database.images().unwrap().into_iter().find(|image| image.id == id).unwrap().frame_index;
        let masks = database.image_masks(field_id).unwrap().into_iter();
        masks.map(|(id, mask)| (frame(id), mask)).collect::<BTreeMap<usize, ImageMask>>()
    };
    assert_eq!(masks_by_frame(&copy, own_id), masks_by_frame(&clean, clean_id));
    assert!(!copy.image_masks(own_id).unwrap().is_empty());

    // Both were found without the images that are added now.
    let more = walk_elsewhere(2, "more", 0.0);
    let (_more, more_path) = database_of(&more);
    copy.copy_from(&Database::open(&more_path).unwrap(), None, goes_on).unwrap();
    assert!(copy.halls().unwrap().is_empty() && !copy.has_ground(own_id).unwrap());
}

#[test]
fn another_pose_of_the_same_picture_is_refused_and_nothing_is_lost() {
    let sequence = short_walk(3);
    let (_a, path) = database_of(&sequence);
    let (_b, other_path) = database_of(&sequence);
    tamper(&other_path, "UPDATE images SET x_m = x_m + 0.1 WHERE frame_index = 1");
    let mut database = Database::create_or_open(&path).unwrap();
    let before = all_known(&database);
    let error = database.copy_from(&Database::open(&other_path).unwrap(), None, goes_on).unwrap_err();
    assert_message(&error, &path, &["frame 1", "another pose"]);
    assert_eq!(all_known(&database), before);
}

#[test]
fn a_database_that_is_damaged_is_the_one_that_is_named() {
    let (_a, path) = database_of(&short_walk(3));
    for (damage, words) in [
        ("DELETE FROM image_bytes WHERE image_id = 2", ["image 2", "bytes"]),
        ("UPDATE images SET yaw_rad = 9e999 WHERE id = 3", ["image 3", "pose"]),
        ("UPDATE images SET sequence_id = 77 WHERE id = 1", ["image 1", "sequence"]),
    ] {
        let (_b, damaged) = database_of(&short_walk(3));
        tamper(&damaged, damage);
        let mut database = Database::create_or_open(&path).unwrap();
        let error = database.copy_from(&Database::open(&damaged).unwrap(), None, goes_on).unwrap_err();
        assert_message(&error, &damaged, &words);
        assert_eq!(database.images().unwrap().len(), 3);
    }
}

#[test]
fn only_image_databases_bear_the_mark() {
    let (folder, path) = database_of(&short_walk(1));
    assert!(Database::is_at(&path));
    let other = folder.path().join("other.db");
    tamper(&other, "CREATE TABLE messages (id INTEGER)");
    assert!(!Database::is_at(&other) && !Database::is_at(folder.path()));
    fs::write(&other, "SQLite").unwrap();
    assert!(!Database::is_at(&other));
}
