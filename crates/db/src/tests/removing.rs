//! Removal and replacement of images, and the halls that are measured with them.

use reality_sim_core::warp::Hall;

use super::*;

/// Stores a hall around every field.
fn measure_halls(database: &mut Database) {
    for (id, field) in database.fields().unwrap() {
        database.set_hall(id, &Hall::usual(&field)).unwrap();
    }
}

fn frames(database: &Database) -> Vec<usize> {
    database.images().unwrap().iter().map(|image| image.frame_index).collect()
}

#[test]
fn removed_frames_are_gone_and_can_be_added_again() {
    let sequence = short_walk(6);
    let (_folder, path) = database_of(&sequence);
    let mut database = Database::create_or_open(&path).unwrap();
    assert_eq!(database.remove(&sequence.name, 2..4).unwrap(), 2);
    assert_eq!(frames(&database), [0, 1, 4, 5]);
    assert_eq!(database.remove(&sequence.name, 5..usize::MAX).unwrap(), 1);
    let report = add(&mut database, &sequence).unwrap();
    assert_eq!(report, IngestReport { added: 3, replaced: 0, already_there: 3, without_pose: 0 });
    assert_eq!(database.picture(database.images().unwrap()[0].id).unwrap(), sequence.load_image(0).unwrap());
}

#[test]
fn of_a_sequence_that_is_removed_nothing_stays_and_others_stay_whole() {
    let (mut first, second) = (short_walk(3), short_walk(2));
    first.name = "another".to_owned();
    let (_folder, path) = database_of(&first);
    let mut database = Database::create_or_open(&path).unwrap();
    add(&mut database, &second).unwrap();
    assert_eq!(database.remove("another", 0..usize::MAX).unwrap(), 3);
    assert_eq!(database.sequences().unwrap().into_values().collect::<Vec<_>>(), [second.name.as_str()]);
    for image in database.images().unwrap() {
        database.picture(image.id).unwrap();
    }
    assert_eq!(database.remove(&second.name, 0..usize::MAX).unwrap(), 2);
    assert!(database.cameras().unwrap().is_empty() && database.fields().unwrap().is_empty());
}

#[test]
fn a_name_that_is_not_there_is_an_error() {
    let (_folder, path) = database_of(&short_walk(1));
    let mut database = Database::create_or_open(&path).unwrap();
    assert_message(&database.remove("wlak", 0..1).unwrap_err(), &path, &["\"wlak\"", "check the name"]);
    let mut reader = Database::open(&path).unwrap();
    assert_message(&reader.remove("walk", 0..1).unwrap_err(), &path, &["opened for reading"]);
}

#[test]
fn a_stored_picture_that_cannot_be_decoded_is_replaced_and_another_whole_one_is_refused() {
    let sequence = short_walk(3);
    let (_folder, path) = database_of(&sequence);
    tamper(&path, "UPDATE image_bytes SET bytes = substr(bytes, 1, 300) WHERE image_id = 2");
    let mut database = Database::create_or_open(&path).unwrap();
    assert!(database.picture(2).is_err());
    let report = add(&mut database, &sequence).unwrap();
    assert_eq!(report, IngestReport { added: 0, replaced: 1, already_there: 2, without_pose: 0 });
    assert_eq!(database.picture(2).unwrap(), sequence.load_image(1).unwrap());
    drop(database);
    tamper(
        &path,
        "UPDATE image_bytes SET bytes = (SELECT bytes FROM image_bytes WHERE image_id = 3) WHERE image_id = 2",
    );
    let mut database = Database::create_or_open(&path).unwrap();
    assert_message(&add(&mut database, &sequence).unwrap_err(), &path, &["another picture"]);
}

#[test]
fn a_hall_is_forgotten_when_the_images_are_no_longer_those_that_it_was_measured_with() {
    let (short, long) = (short_walk(3), short_walk(4));
    let (_folder, path) = database_of(&short);
    let mut database = Database::create_or_open(&path).unwrap();
    assert_eq!(database.fields_without_hall().unwrap().len(), 1);
    measure_halls(&mut database);
    add(&mut database, &short).unwrap();
    assert!(database.fields_without_hall().unwrap().is_empty(), "nothing has changed");
    add(&mut database, &long).unwrap();
    assert_eq!(database.fields_without_hall().unwrap().len(), 1);
    assert!(database.halls().unwrap().is_empty());
    measure_halls(&mut database);
    database.remove(&short.name, 0..1).unwrap();
    assert!(database.halls().unwrap().is_empty());
}
