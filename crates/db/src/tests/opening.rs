//! Files that are not a complete image database of this version.

use std::error::Error;

use super::*;
use crate::{database::query_of_records, record::POSE_SOURCE_COLUMN};

#[test]
fn what_is_not_a_database_is_refused_and_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.db");
    let error = Database::open(&path).unwrap_err();
    assert_message(&error, &path, &["there is no such file", "build the database first"]);
    assert!(names_in(folder.path()).is_empty());
    for error in
        [Database::open(folder.path()), Database::create_or_open(folder.path())].map(Result::unwrap_err)
    {
        assert_message(&error, folder.path(), &["not a regular file"]);
    }
    for bytes in [&b"hello"[..], &[0; 100], &[0xff; 5000], &b"SQLite format 3\0"[..]] {
        fs::write(&path, bytes).unwrap();
        for error in [Database::open(&path), Database::create_or_open(&path)].map(Result::unwrap_err) {
            assert_message(&error, &path, &["build"]);
        }
        assert_eq!(fs::read(&path).unwrap(), bytes);
    }
    let error = Database::create_or_open(&folder.path().join("none/a.db")).unwrap_err();
    assert_message(&error, folder.path(), &["cannot be opened", "check that its folder exists"]);
}

#[test]
fn what_sqlite_says_is_kept_as_the_source_of_the_fault() {
    let folder = tempfile::tempdir().unwrap();
    let error = Database::create_or_open(&folder.path().join("none/a.db")).unwrap_err();
    let fault = error.source().unwrap();
    assert!(matches!(fault.downcast_ref(), Some(DbFault::CannotOpen { .. })));
    assert!(fault.source().is_some_and(<dyn Error>::is::<rusqlite::Error>));
}

#[test]
fn an_empty_file_is_refused_for_reading_and_becomes_a_database_for_writing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.db");
    fs::write(&path, "").unwrap();
    assert_message(&Database::open(&path).unwrap_err(), &path, &["holds nothing yet"]);
    drop(Database::create_or_open(&path).unwrap());
    assert!(Database::open(&path).unwrap().images().unwrap().is_empty());
}

#[test]
fn the_database_of_another_program_is_refused_and_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.db");
    tamper(&path, "CREATE TABLE images (id INTEGER PRIMARY KEY, camera_id INTEGER, name TEXT)");
    let before = fs::read(&path).unwrap();
    for error in [Database::open(&path), Database::create_or_open(&path)].map(Result::unwrap_err) {
        assert_message(&error, &path, &["is not an image database of this program"]);
    }
    assert_eq!(fs::read(&path).unwrap(), before);
}

#[test]
fn a_newer_version_is_refused_and_says_which() {
    let (_folder, path) = database_of(&short_walk(1));
    tamper(&path, &format!("PRAGMA user_version = {}", SCHEMA_VERSION + 6));
    for error in [Database::open(&path), Database::create_or_open(&path)].map(Result::unwrap_err) {
        let found = format!("schema version {}", SCHEMA_VERSION + 6);
        assert_message(&error, &path, &[&found, "update the program"]);
    }
    tamper(&path, "PRAGMA user_version = -1");
    assert_message(&Database::open(&path).unwrap_err(), &path, &["not an image database"]);
}

#[test]
fn a_cut_off_file_is_noticed_when_it_is_opened() {
    let (folder, path) = database_of(&short_walk(3));
    let bytes = fs::read(&path).unwrap();
    let cut = folder.path().join("cut.db");
    // SQLite treats a file of one byte as an empty one.
    for length in [2, 50, 100, 1000, 4095, 4096, 5000, bytes.len() / 2, bytes.len() - 4096, bytes.len() - 1] {
        fs::write(&cut, &bytes[..length]).unwrap();
        for error in [Database::open(&cut), Database::create_or_open(&cut)].map(Result::unwrap_err) {
            assert_message(&error, &cut, &["build"]);
        }
    }
    let error = Database::open(&cut).unwrap_err();
    assert_message(&error, &cut, &["is cut off", &(bytes.len() - 1).to_string(), &bytes.len().to_string()]);
}

#[test]
fn damage_anywhere_is_an_error_or_harmless_and_never_a_panic() {
    let (folder, path) = database_of(&short_walk(2));
    let bytes = fs::read(&path).unwrap();
    let damaged = folder.path().join("damaged.db");
    let mut errors = 0;
    // A step of prime length reaches headers, cells and overflow pages alike.
    for start in (0..30_000).step_by(127).chain((30_000..bytes.len()).step_by(10_007)) {
        let mut copy = bytes.clone();
        let end = bytes.len().min(start + 16);
        copy[start..end].iter_mut().for_each(|byte| *byte ^= 0xa5);
        fs::write(&damaged, copy).unwrap();
        if let Err(error) = read_all(&damaged) {
            assert_message(&error, &damaged, &[": "]);
            errors += 1;
        }
    }
    assert!(errors > 10, "{errors}");
    fs::write(&damaged, [&bytes[..4096], &vec![0xa5; bytes.len() - 4096]].concat()).unwrap();
    assert_message(&read_all(&damaged).unwrap_err(), &damaged, &["is damaged", "build it again"]);
}

#[test]
fn names_that_sqlite_takes_for_something_else_are_files() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["file:a.db?mode=memory", "a b%20c?.db", ":memory:"] {
        let path = folder.path().join(name);
        drop(Database::create_or_open(&path).unwrap());
        assert!(path.is_file(), "{name}");
        Database::open(&path).unwrap();
    }
}

/// Returns how SQLite reads the records of all images.
fn plan_of_records(path: &Path) -> String {
    let connection = rusqlite::Connection::open(path).unwrap();
    let query = format!("EXPLAIN QUERY PLAN {}", query_of_records(POSE_SOURCE_COLUMN));
    connection.query_row(&query, [], |row| row.get("detail")).unwrap()
}

#[test]
fn records_are_read_from_their_own_pages_and_in_a_database_of_the_second_version_from_those_of_the_images() {
    let (_folder, path) = database_of(&short_walk(3));
    let records = Database::open(&path).unwrap().images().unwrap();
    assert_eq!(plan_of_records(&path), "SCAN images USING COVERING INDEX image_records");
    tamper(&path, "DROP INDEX image_records; PRAGMA user_version = 2");
    assert_eq!(plan_of_records(&path), "SCAN images");
    assert_eq!(Database::open(&path).unwrap().images().unwrap(), records);
    Database::create_or_open(&path).unwrap();
    assert_eq!(plan_of_records(&path), "SCAN images USING COVERING INDEX image_records");
    assert_eq!(Database::open(&path).unwrap().images().unwrap(), records);
}
