//! The clean stage: stored, read, forgotten, and missing from databases of the first version.

use std::collections::BTreeMap;

use glam::DVec2;
use image::{GrayImage, Luma, Rgb, RgbImage};

use super::*;

fn ground() -> Ground {
    Ground {
        min_m: DVec2::new(-0.5, -0.25),
        cell_m: 0.05,
        colors: RgbImage::from_fn(20, 10, |u, v| Rgb([u as u8, 7 * v as u8, 90])),
        views: GrayImage::from_fn(20, 10, |u, v| Luma([(u * v % 5) as u8])),
    }
}

fn masks(database: &Database) -> BTreeMap<i64, ImageMask> {
    let ids = database.images().unwrap().into_iter().map(|image| image.id);
    ids.map(|id| (id, ImageMask::new([16, 12], |u, v| (u + v) as i64 % 7 == id))).collect()
}

fn only_field(database: &Database) -> i64 {
    *database.fields().unwrap().keys().next().unwrap()
}

/// Makes a database of three images with a clean stage.
pub fn with_clean_stage() -> (TempDir, PathBuf) {
    let (folder, path) = database_of(&short_walk(3));
    let mut database = Database::create_or_open(&path).unwrap();
    let (field_id, masks) = (only_field(&database), masks(&database));
    database.set_clean_stage(field_id, &ground(), &masks).unwrap();
    (folder, path)
}

/// Turns a database into one of the first version.
fn of_first_version(path: &Path) {
    let later = "DROP INDEX image_records; DROP TABLE grounds; DROP TABLE image_masks";
    tamper(path, &format!("{later}; PRAGMA user_version = 1"));
}

#[test]
fn what_was_stored_is_read_again() {
    let (_folder, path) = database_of(&short_walk(3));
    let mut database = Database::create_or_open(&path).unwrap();
    let field_id = only_field(&database);
    assert_eq!(database.fields_without_ground().unwrap(), [field_id]);
    assert!(!database.has_ground(field_id).unwrap() && database.ground(field_id).unwrap().is_none());
    let mut masks = masks(&database);
    let empty = *masks.keys().next_back().unwrap();
    masks.insert(empty, ImageMask::new([4, 3], |_, _| false));
    database.set_clean_stage(field_id, &ground(), &masks).unwrap();
    let database = Database::open(&path).unwrap();
    assert!(database.has_ground(field_id).unwrap());
    assert_eq!(database.ground(field_id).unwrap(), Some(ground()));
    masks.remove(&empty);
    assert_eq!(database.image_masks(field_id).unwrap(), masks, "masks that hide nothing are not stored");
    assert!(database.fields_without_ground().unwrap().is_empty());
    assert!(database.image_masks(field_id + 1).unwrap().is_empty());
}

#[test]
fn it_is_forgotten_with_every_image_that_is_added_or_removed() {
    let (_folder, path) = with_clean_stage();
    let mut database = Database::create_or_open(&path).unwrap();
    let field_id = only_field(&database);
    add(&mut database, &short_walk(4)).unwrap();
    assert!(!database.has_ground(field_id).unwrap() && database.image_masks(field_id).unwrap().is_empty());
    let masks = masks(&database);
    database.set_clean_stage(field_id, &ground(), &masks).unwrap();
    add(&mut database, &short_walk(4)).unwrap();
    assert!(database.has_ground(field_id).unwrap(), "nothing new");
    let name = short_walk(1).name;
    database.remove(&name, 0..1).unwrap();
    assert!(!database.has_ground(field_id).unwrap() && database.image_masks(field_id).unwrap().is_empty());
    let images = database.images().unwrap().len();
    database.remove(&name, 0..usize::MAX).unwrap();
    assert!(images == 3 && database.fields().unwrap().is_empty());
}

#[test]
fn impossible_grounds_are_refused() {
    let (_folder, path) = database_of(&short_walk(1));
    let mut database = Database::create_or_open(&path).unwrap();
    let field_id = only_field(&database);
    let refused = [
        (field_id, Ground { cell_m: 0.0, ..ground() }),
        (field_id, Ground { min_m: DVec2::new(f64::NAN, 0.0), ..ground() }),
        (field_id, Ground { views: GrayImage::new(20, 11), ..ground() }),
        (field_id, Ground { views: GrayImage::new(0, 0), colors: RgbImage::new(0, 0), ..ground() }),
        (field_id + 1, ground()),
    ];
    for (field_id, ground) in refused {
        let error = database.set_clean_stage(field_id, &ground, &BTreeMap::new()).unwrap_err();
        assert_message(&error, &path, &["ground"]);
    }
}

#[test]
fn damaged_parts_are_errors_that_name_them() {
    for (sql, part) in [
        ("UPDATE grounds SET width = 21", "ground"),
        ("UPDATE grounds SET width = 4000000000", "ground"),
        ("UPDATE grounds SET cell_m = 1e300", "ground"),
        ("UPDATE grounds SET colors = x'00'", "ground"),
        ("UPDATE image_masks SET runs = x'ffffffff7f'", "mask of image"),
        ("UPDATE image_masks SET height = 13", "mask of image"),
        ("UPDATE image_masks SET height = 2147483647", "mask of image"),
    ] {
        let (_folder, path) = with_clean_stage();
        tamper(&path, sql);
        let database = Database::open(&path).unwrap();
        let field_id = only_field(&database);
        let error = database.ground(field_id).map(drop).and(database.image_masks(field_id).map(drop));
        assert_message(&error.expect_err(sql), &path, &[part]);
    }
}

#[test]
fn a_database_of_the_first_version_is_read_without_it_and_gets_its_tables_when_it_is_written() {
    let (_folder, path) = with_clean_stage();
    of_first_version(&path);
    let database = Database::open(&path).unwrap();
    let field_id = only_field(&database);
    assert_eq!(database.images().unwrap().len(), 3);
    assert!(!database.has_ground(field_id).unwrap());
    assert_eq!(database.ground(field_id).unwrap(), None);
    assert!(database.image_masks(field_id).unwrap().is_empty());
    drop(database);
    let mut database = Database::create_or_open(&path).unwrap();
    assert_eq!(database.fields_without_ground().unwrap(), [field_id]);
    let masks = masks(&database);
    database.set_clean_stage(field_id, &ground(), &masks).unwrap();
    assert_eq!(database.ground(field_id).unwrap(), Some(ground()));
}
