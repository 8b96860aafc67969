//! Databases that somebody changed: with values that the program never writes, or with bytes at random. They are read or
//! refused, without a panic. `PROPTEST_CASES` sets how many are tried.

use proptest::prelude::*;
use rusqlite::{Connection, types::Value};

use super::*;

/// Reads everything that can be read. Returns the first error.
fn read_all(path: &Path) -> Result<(), DbError> {
    let database = Database::open(path)?;
    database.sequences()?;
    database.cameras()?;
    database.models()?;
    database.fields()?;
    database.halls()?;
    database.pose_sources()?;
    for field_id in database.fields()?.into_keys() {
        database.has_ground(field_id)?;
        database.ground(field_id)?;
        database.image_masks(field_id)?;
    }
    database.fields_without_ground()?;
    details_of(&database)?;
    for image in database.images()? {
        database.picture(image.id)?;
    }
    Ok(())
}

fn assert_read_or_refused(path: &Path) {
    if let Err(error) = read_all(path) {
        let message = error.to_string();
        assert!(!message.contains(char::is_control) && !message.is_empty(), "{message:?}");
    }
}

/// Makes the bytes of a small database once.
fn small() -> Vec<u8> {
    static MADE: std::sync::OnceLock<Vec<u8>> = std::sync::OnceLock::new();
    let make = || {
        let (_folder, path) = cleaning::with_clean_stage();
        fs::read(path).unwrap()
    };
    MADE.get_or_init(make).clone()
}

/// Lists every table with each of its columns.
fn columns(connection: &Connection) -> Vec<(String, String)> {
    let query = "SELECT m.name, c.name FROM sqlite_schema m, pragma_table_info(m.name) c WHERE m.type = 'table' ORDER BY 1, 2";
    let mut statement = connection.prepare(query).unwrap();
    let rows = statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?))).unwrap();
    rows.map(Result::unwrap).collect()
}

fn any_value() -> impl Strategy<Value = Value> {
    prop_oneof![
        Just(Value::Null),
        any::<i64>().prop_map(Value::Integer),
        (-3..3_i64).prop_map(Value::Integer),
        any::<f64>().prop_map(Value::Real),
        "\\PC{0,20}|\u{1b}\\[2J\n".prop_map(Value::Text),
        prop::collection::vec(any::<u8>(), 0..300).prop_map(Value::Blob),
    ]
}

proptest! {
    // Each case writes a file of half a megabyte.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn hostile_values_are_read_or_refused(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any_value()), 1..3),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.db");
        fs::write(&path, small()).unwrap();
        let connection = Connection::open(&path).unwrap();
        connection.execute_batch("PRAGMA foreign_keys = OFF; PRAGMA ignore_check_constraints = ON").unwrap();
        let columns = columns(&connection);
        for (place, value) in changes {
            let (table, column) = place.get(&columns);
            // Rules of the schema may refuse a value; then the file stays as it is.
            let _ = connection.execute(&format!("UPDATE {table} SET {column} = ?1"), [value]);
        }
        drop(connection);
        assert_read_or_refused(&path);
    }

    #[test]
    fn hostile_bytes_are_read_or_refused(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..40),
        end in prop::option::weighted(0.2, any::<prop::sample::Index>()),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.db");
        let mut bytes = small();
        // The first pages hold the schema and the rows, most of the others only pictures.
        let rows = bytes.len().min(64 << 10);
        for (place, byte) in changes {
            bytes[place.index(rows)] = byte;
        }
        if let Some(end) = end {
            bytes.truncate(end.index(bytes.len()));
        }
        fs::write(&path, bytes).unwrap();
        assert_read_or_refused(&path);
    }
}
