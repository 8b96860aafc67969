//! Readers beside a writer, and places where nothing can be written.

use std::{
    sync::atomic::{AtomicBool, Ordering},
    thread,
};

use super::*;

#[test]
fn readers_see_whole_batches_while_a_writer_adds() {
    let sequence = long_walk(480);
    let (_folder, path) = database_of(&short_walk(1));
    let finished = AtomicBool::new(false);
    thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                let database = Database::open(&path).unwrap();
                let mut last = 1;
                loop {
                    let was_finished = finished.load(Ordering::Acquire);
                    let images = database.images().unwrap();
                    let count = images.len();
                    assert!(count >= last, "{count} after {last}");
                    assert!((count - 1).is_multiple_of(64) || count == 481, "{count}");
                    let image = images.last().unwrap();
                    let length = details_of(&database).unwrap()[&image.id].byte_length;
                    assert_eq!(database.image_bytes(image.id).unwrap().len() as u64, length);
                    last = count;
                    if was_finished {
                        break assert_eq!(count, 481);
                    }
                }
            });
        }
        let mut writer = Database::create_or_open(&path).unwrap();
        let report = add(&mut writer, &sequence);
        finished.store(true, Ordering::Release);
        assert_eq!(report.unwrap().added, 480);
    });
}

#[test]
fn a_finished_database_is_one_file() {
    let (folder, path) = database_of(&walk());
    assert_eq!(names_in(folder.path()), ["walk.db"]);
    let reader = Database::open(&path).unwrap();
    reader.images().unwrap();
    assert_eq!(names_in(folder.path()), ["walk.db"]);
    let writer = Database::create_or_open(&path).unwrap();
    assert_eq!(names_in(folder.path()), ["walk.db"]);
    drop((reader, writer));
    assert_eq!(names_in(folder.path()), ["walk.db"]);
}
