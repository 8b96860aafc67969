//! Tables of the database, marks that identify its files, and migration of older versions.

use std::{
    fs::{self, File},
    io::Read,
    path::Path,
};

use rusqlite::{Connection, Transaction, TransactionBehavior};

use crate::error::DbFault;

/// Application id in the file's header: "ReSi".
const APPLICATION_ID: i64 = 0x5265_5369;

/// Schema version that this program reads and writes.
pub const SCHEMA_VERSION: i64 = STEPS.len() as i64;

/// Migration steps: the statements at `STEPS[n]` turn a database of version n into one of version n + 1. A released step
/// is never changed; another one is added.
const STEPS: [&str; 3] = [VERSION_1, VERSION_2, VERSION_3];

/// Oldest version that can be read without bringing it to the newest one.
const OLDEST_READ: i64 = 1;

/// Version from which on there are tables of the clean stage.
pub(crate) const CLEAN_STAGE_VERSION: i64 = 2;

/// The bytes are in a separate table, so that reading all poses does not touch them.
const VERSION_1: &str = "
    CREATE TABLE sequences (
        id INTEGER PRIMARY KEY,
        name TEXT NOT NULL,
        first_frame TEXT NOT NULL,
        UNIQUE (name, first_frame)
    ) STRICT;
    CREATE TABLE cameras (id INTEGER PRIMARY KEY, toml TEXT NOT NULL UNIQUE) STRICT;
    CREATE TABLE fields (id INTEGER PRIMARY KEY, toml TEXT NOT NULL UNIQUE) STRICT;
    CREATE TABLE pose_sources (
        id INTEGER PRIMARY KEY,
        kind TEXT NOT NULL CHECK (kind IN ('groundtruth', 'filter', 'file')),
        description TEXT NOT NULL,
        UNIQUE (kind, description)
    ) STRICT;
    CREATE TABLE images (
        id INTEGER PRIMARY KEY,
        sequence_id INTEGER NOT NULL REFERENCES sequences,
        frame_index INTEGER NOT NULL,
        camera_id INTEGER NOT NULL REFERENCES cameras,
        field_id INTEGER NOT NULL REFERENCES fields,
        pose_source_id INTEGER NOT NULL REFERENCES pose_sources,
        timestamp_s REAL NOT NULL,
        file_name TEXT NOT NULL,
        byte_length INTEGER NOT NULL,
        x_m REAL NOT NULL,
        y_m REAL NOT NULL,
        yaw_rad REAL NOT NULL,
        height_m REAL NOT NULL,
        pitch_rad REAL NOT NULL,
        roll_rad REAL NOT NULL,
        covariance BLOB,
        UNIQUE (sequence_id, frame_index)
    ) STRICT;
    CREATE TABLE halls (
        field_id INTEGER PRIMARY KEY REFERENCES fields,
        min_x_m REAL NOT NULL,
        min_y_m REAL NOT NULL,
        max_x_m REAL NOT NULL,
        max_y_m REAL NOT NULL,
        ceiling_m REAL NOT NULL,
        goal_depth_m REAL NOT NULL
    ) STRICT;
    CREATE TABLE image_bytes (
        image_id INTEGER PRIMARY KEY REFERENCES images,
        bytes BLOB NOT NULL
    ) STRICT;
";

/// Ground of fields, and masks of images.
const VERSION_2: &str = "
    CREATE TABLE grounds (
        field_id INTEGER PRIMARY KEY REFERENCES fields,
        min_x_m REAL NOT NULL,
        min_y_m REAL NOT NULL,
        cell_m REAL NOT NULL,
        width INTEGER NOT NULL,
        height INTEGER NOT NULL,
        colors BLOB NOT NULL,
        views BLOB NOT NULL
    ) STRICT;
    CREATE TABLE image_masks (
        image_id INTEGER PRIMARY KEY REFERENCES images,
        width INTEGER NOT NULL,
        height INTEGER NOT NULL,
        runs BLOB NOT NULL
    ) STRICT;
";

/// Columns of [`crate::ImageRecord`] and the id of the pose's source once more, next to each other: opening reads these alone, of images
/// with covariances a quarter of the pages, which counts where the system does not hold the file in memory.
const VERSION_3: &str = "
    CREATE INDEX image_records ON images (
        id, sequence_id, frame_index, camera_id, field_id, timestamp_s,
        x_m, y_m, yaw_rad, height_m, pitch_rad, roll_rad, pose_source_id
    );
";

/// Returns whether a file's header is that of an SQLite database with this application id: bytes 68 to 71,
/// <https://www.sqlite.org/fileformat.html>.
pub(crate) fn is_marked(path: &Path) -> bool {
    let mut header = [0; 72];
    let is_read = File::open(path).and_then(|mut file| file.read_exact(&mut header)).is_ok();
    is_read
        && header.starts_with(b"SQLite format 3\0")
        && header[68..] == (APPLICATION_ID as u32).to_be_bytes()
}

/// Refuses a file that is not a complete database of a version that can be read. Changes nothing.
pub(crate) fn check(connection: &Connection, path: &Path) -> Result<(), DbFault> {
    let transaction = connection.unchecked_transaction()?;
    if is_empty(&transaction)? {
        return Err(DbFault::NothingStored);
    }
    if application_id(&transaction)? != APPLICATION_ID {
        return Err(DbFault::NotADatabase);
    }
    check_length(&transaction, path)?;
    let found = version(&transaction)?;
    check_known(found, SCHEMA_VERSION)?;
    if found < OLDEST_READ {
        return Err(DbFault::Older { found, known: SCHEMA_VERSION });
    }
    check_parts(&transaction, &STEPS[..found as usize])
}

/// Refuses a database in which a table is not as these steps make it, or that has views or triggers: a view in place of a
/// table could run for ever, a trigger could change what is written. Tables beside its own are of no interest, with
/// their indices; one on its own tables could compute anything whenever something is stored.
fn check_parts(connection: &Connection, steps: &[&str]) -> Result<(), DbFault> {
    let own = Connection::open_in_memory()?;
    steps.iter().try_for_each(|step| own.execute_batch(step))?;
    let (expected, mut found) = (parts(&own)?, parts(connection)?);
    for part in &expected {
        match found.iter().position(|other| other == part) {
            Some(index) => drop(found.swap_remove(index)),
            None => return Err(part.is_foreign()),
        }
    }
    let is_own = |part: &Part| expected.iter().any(|own| own.table == part.table);
    let harmful = found.iter().find(|part| part.kind == "view" || part.kind == "trigger" || is_own(part));
    harmful.map_or(Ok(()), |part| Err(part.is_foreign()))
}

/// Entry of the database's own list of its tables, indices, views and triggers.
#[derive(PartialEq)]
struct Part {
    kind: String,
    name: String,
    /// Table that it belongs to.
    table: String,
    sql: Option<String>,
}

impl Part {
    fn is_foreign(&self) -> DbFault {
        DbFault::ForeignSchema { kind: self.kind.clone(), name: self.name.clone() }
    }
}

fn parts(connection: &Connection) -> rusqlite::Result<Vec<Part>> {
    let mut statement = connection.prepare("SELECT type, name, tbl_name, sql FROM sqlite_schema")?;
    let part = |row: &rusqlite::Row<'_>| {
        Ok(Part { kind: row.get(0)?, name: row.get(1)?, table: row.get(2)?, sql: row.get(3)? })
    };
    statement.query_map([], part)?.collect()
}

/// Turns an empty file into a database, and migrates one of an older version.
pub(crate) fn prepare(connection: &mut Connection, path: &Path) -> Result<(), DbFault> {
    migrate(connection, path, &STEPS)?;
    check_parts(connection, &STEPS)
}

/// Runs the steps that a database has not had yet, all or none of them.
fn migrate(connection: &mut Connection, path: &Path, steps: &[&str]) -> Result<(), DbFault> {
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    if is_empty(&transaction)? {
        transaction.pragma_update(None, "application_id", APPLICATION_ID)?;
    } else if application_id(&transaction)? != APPLICATION_ID {
        return Err(DbFault::NotADatabase);
    } else {
        check_length(&transaction, path)?;
    }
    let (found, known) = (version(&transaction)?, steps.len() as i64);
    check_known(found, known)?;
    let done = usize::try_from(found).unwrap_or_default();
    for step in &steps[done..] {
        transaction.execute_batch(step)?;
    }
    if found < known {
        transaction.pragma_update(None, "user_version", known)?;
    }
    Ok(transaction.commit()?)
}

fn check_known(found: i64, known: i64) -> Result<(), DbFault> {
    match found {
        ..0 => Err(DbFault::NotADatabase),
        found if found > known => Err(DbFault::Newer { found, known }),
        _ => Ok(()),
    }
}

/// Whether nothing was ever stored: the file has no bytes, or its writer was killed before the first commit.
fn is_empty(transaction: &Transaction<'_>) -> rusqlite::Result<bool> {
    let tables: i64 = transaction.query_row("SELECT count(*) FROM sqlite_schema", [], |row| row.get(0))?;
    Ok(tables == 0 && application_id(transaction)? == 0 && version(transaction)? == 0)
}

/// Checks the length of the file: SQLite notices a truncated file only when it needs the missing part. In a transaction
/// nobody else changes the length.
fn check_length(transaction: &Transaction<'_>, path: &Path) -> Result<(), DbFault> {
    let pages = u64::from(pragma::<u32>(transaction, "page_count")?);
    let page_bytes = u64::from(pragma::<u32>(transaction, "page_size")?);
    let (found_bytes, expected_bytes) = (fs::metadata(path)?.len(), pages * page_bytes);
    if found_bytes < expected_bytes {
        return Err(DbFault::Truncated { found_bytes, expected_bytes });
    }
    Ok(())
}

fn application_id(transaction: &Transaction<'_>) -> rusqlite::Result<i64> {
    pragma(transaction, "application_id")
}

fn version(transaction: &Transaction<'_>) -> rusqlite::Result<i64> {
    pragma(transaction, "user_version")
}

fn pragma<T: rusqlite::types::FromSql>(transaction: &Transaction<'_>, name: &str) -> rusqlite::Result<T> {
    transaction.pragma_query_value(None, name, |row| row.get(0))
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    /// Three versions of a database of another kind.
    const FIRST: &str =
        "CREATE TABLE things (id INTEGER PRIMARY KEY, name TEXT); INSERT INTO things (name) VALUES ('a')";
    const SECOND: &str = "ALTER TABLE things ADD COLUMN length_m REAL NOT NULL DEFAULT 2.5";
    const THIRD: &str = "CREATE INDEX by_name ON things (name); UPDATE things SET name = name || name";

    fn database() -> (tempfile::TempDir, PathBuf, Connection) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.db");
        let connection = Connection::open(&path).unwrap();
        (folder, path, connection)
    }

    fn found(connection: &Connection) -> i64 {
        connection.pragma_query_value(None, "user_version", |row| row.get(0)).unwrap()
    }

    #[test]
    fn every_older_version_becomes_the_newest_and_keeps_its_rows() {
        let steps = [FIRST, SECOND, THIRD];
        for start in 0..=steps.len() {
            let (_folder, path, mut connection) = database();
            migrate(&mut connection, &path, &steps[..start]).unwrap();
            assert_eq!(found(&connection), start as i64);
            migrate(&mut connection, &path, &steps).unwrap();
            migrate(&mut connection, &path, &steps).unwrap();
            assert_eq!(found(&connection), 3);
            let row = connection.query_row("SELECT name, length_m FROM things", [], |row| {
                Ok((row.get::<_, String>(0)?, row.get::<_, f64>(1)?))
            });
            assert_eq!(row.unwrap(), ("aa".to_owned(), 2.5), "from version {start}");
        }
    }

    #[test]
    fn a_step_that_fails_leaves_the_old_version() {
        let (_folder, path, mut connection) = database();
        migrate(&mut connection, &path, &[FIRST]).unwrap();
        let fault = migrate(&mut connection, &path, &[FIRST, SECOND, "DROP TABLE nothing"]).unwrap_err();
        assert!(matches!(fault, DbFault::Damaged { .. }), "{fault}");
        assert_eq!(found(&connection), 1);
        assert!(connection.query_row("SELECT length_m FROM things", [], |_| Ok(())).is_err());
    }

    #[test]
    fn fewer_steps_than_the_version_is_a_newer_database() {
        let (_folder, path, mut connection) = database();
        migrate(&mut connection, &path, &[FIRST, SECOND]).unwrap();
        let fault = migrate(&mut connection, &path, &[FIRST]).unwrap_err();
        assert!(matches!(fault, DbFault::Newer { found: 2, known: 1 }), "{fault}");
    }

    #[test]
    fn a_reader_says_that_an_older_version_has_to_be_opened_for_writing() {
        let (_folder, path, connection) = database();
        connection.pragma_update(None, "application_id", APPLICATION_ID).unwrap();
        assert!(matches!(check(&connection, &path), Err(DbFault::Older { found: 0, known: SCHEMA_VERSION })));
    }
}
