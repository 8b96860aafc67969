//! Opening and reading of a database.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{self, Path, PathBuf},
    sync::{Mutex, PoisonError},
    time::Duration,
};

use glam::DVec2;
use image::RgbImage;
use reality_sim_core::{
    field::FieldDimensions,
    sequence::{CameraSetup, decode_image, model_of_camera},
    warp::Hall,
};
use rusqlite::{Connection, OpenFlags, OptionalExtension, Row, Transaction, TransactionBehavior, params};

use crate::{
    error::{DbError, DbFault},
    record::{
        DETAIL_COLUMNS, IMAGE_COLUMNS, IMAGE_WIDTH, ImageDetails, ImageRecord, POSE_SOURCE_COLUMN, PoseSource,
    },
    schema,
    work_limit::WorkLimit,
};

/// Time to wait for another program to finish its transaction.
const BUSY_TIMEOUT: Duration = Duration::from_secs(10);

/// Size up to which a writer's changed pages stay in memory until they are committed, KiB: readers need not wait.
const WRITER_CACHE_KIB: i64 = 32 << 10;

/// Image database indexed by pose.
///
/// Threads share a database through an `Arc`; they then read one after the other and decode in parallel. A thread that
/// needs its own connection opens the file itself. Any number of programs may read while one writes, and every method sees
/// only whole transactions. While nobody writes, the database is a single file, which can be read wherever it is.
#[derive(Debug)]
pub struct Database {
    path: PathBuf,
    pub(crate) connection: Mutex<Connection>,
    work_limit: WorkLimit,
    is_writer: bool,
}

impl Database {
    /// Opens a database for reading. Fails if there is no file, or if the file is not a complete image database.
    pub fn open(path: &Path) -> Result<Self, DbError> {
        Self::try_open(path).map_err(|fault| DbError::new(path, fault))
    }

    /// Opens a database for writing, creates it if there is none, and migrates an older version to the current one.
    pub fn create_or_open(path: &Path) -> Result<Self, DbError> {
        Self::try_create_or_open(path).map_err(|fault| DbError::new(path, fault))
    }

    /// Returns whether a file bears the mark of an image database, of whatever version. Whether it is whole shows when it is opened.
    pub fn is_at(path: &Path) -> bool {
        schema::is_marked(path)
    }

    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the records of all images, in the order of their ids.
    pub fn images(&self) -> Result<Vec<ImageRecord>, DbError> {
        self.read(|transaction| {
            let mut images = Vec::new();
            each_record(transaction, POSE_SOURCE_COLUMN, |image, _| {
                images.push(image);
                Ok(())
            })?;
            images.shrink_to_fit();
            Ok(images)
        })
    }

    /// Hands over all images with their details, in the order of their ids.
    pub fn each_image(&self, mut take: impl FnMut(ImageRecord, ImageDetails)) -> Result<(), DbError> {
        self.read(|transaction| {
            each_record(transaction, DETAIL_COLUMNS, |image, row| {
                let details = ImageDetails::from_row(row, IMAGE_WIDTH)?;
                if let Some(problem) = details.problem() {
                    return Err(DbFault::BadRow { table: "image", id: image.id, problem });
                }
                take(image, details);
                Ok(())
            })
        })
    }

    /// Returns the names of the sequences by id. Two recordings may have the same name.
    pub fn sequences(&self) -> Result<BTreeMap<i64, String>, DbError> {
        self.read(|transaction| texts(transaction, "SELECT id, name FROM sequences"))
    }

    /// Returns the cameras by id.
    pub fn cameras(&self) -> Result<BTreeMap<i64, CameraSetup>, DbError> {
        let texts = self.read(|transaction| texts(transaction, "SELECT id, toml FROM cameras"))?;
        let setup =
            |(id, text): (i64, String)| Ok((id, CameraSetup::from_toml(&self.origin("camera", id), &text)?));
        texts.into_iter().map(setup).collect()
    }

    /// Returns the texts of the models by which recordings were corrected before they were stored, by the ids of the
    /// corrected cameras.
    pub fn models(&self) -> Result<BTreeMap<i64, String>, DbError> {
        let texts = self.read(|transaction| texts(transaction, "SELECT id, toml FROM cameras"))?;
        Ok(texts.into_iter().filter_map(|(id, text)| Some((id, model_of_camera(&text)?))).collect())
    }

    /// Returns the fields by id.
    pub fn fields(&self) -> Result<BTreeMap<i64, FieldDimensions>, DbError> {
        let texts = self.read(|transaction| texts(transaction, "SELECT id, toml FROM fields"))?;
        let field = |(id, text): (i64, String)| {
            Ok((id, FieldDimensions::from_toml(&self.origin("field", id), &text)?))
        };
        texts.into_iter().map(field).collect()
    }

    /// Returns the measured halls, by the ids of their fields.
    pub fn halls(&self) -> Result<BTreeMap<i64, Hall>, DbError> {
        let query = "SELECT field_id, min_x_m, min_y_m, max_x_m, max_y_m, ceiling_m, goal_depth_m FROM halls";
        let hall = |row: &Row<'_>| {
            let hall = Hall {
                min_m: DVec2::new(row.get(1)?, row.get(2)?),
                max_m: DVec2::new(row.get(3)?, row.get(4)?),
                ceiling_m: row.get(5)?,
                goal_depth_m: row.get(6)?,
            };
            Ok((row.get(0)?, hall))
        };
        let halls: BTreeMap<i64, Hall> = self.read(|transaction| all(transaction, query, hall))?;
        let fields = self.fields()?;
        for (&id, hall) in &halls {
            if fields.get(&id).is_none_or(|field| !hall.holds(field)) {
                let problem = "it does not hold its field";
                return Err(DbError::new(&self.path, DbFault::BadRow { table: "hall", id, problem }));
            }
        }
        Ok(halls)
    }

    /// Returns the ids of the fields that images show, and around which no hall is stored: none was measured yet, or images
    /// were added, replaced or removed since, which forgets it.
    pub fn fields_without_hall(&self) -> Result<Vec<i64>, DbError> {
        let query = "SELECT DISTINCT field_id FROM images WHERE field_id NOT IN (SELECT field_id FROM halls) \
             ORDER BY field_id";
        self.read(|transaction| all(transaction, query, |row| row.get(0)))
    }

    /// Stores the measured hall around a field and replaces an earlier one.
    pub fn set_hall(&mut self, field_id: i64, hall: &Hall) -> Result<(), DbError> {
        if self.fields()?.get(&field_id).is_none_or(|field| !hall.holds(field)) {
            let problem = "it does not hold its field";
            return Err(DbError::new(&self.path, DbFault::BadRow { table: "hall", id: field_id, problem }));
        }
        let Hall { min_m, max_m, ceiling_m, goal_depth_m } = *hall;
        self.write(|transaction| {
            let values = params![field_id, min_m.x, min_m.y, max_m.x, max_m.y, ceiling_m, goal_depth_m];
            let query = "INSERT OR REPLACE INTO halls VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)";
            Ok(transaction.execute(query, values).map(drop)?)
        })
    }

    /// Returns the sources of poses, by id.
    pub fn pose_sources(&self) -> Result<BTreeMap<i64, PoseSource>, DbError> {
        self.read(|transaction| {
            let query = "SELECT id, kind, description FROM pose_sources";
            let rows: Vec<(i64, String, String)> =
                all(transaction, query, |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))?;
            let source = |(id, kind, description): (i64, String, String)| {
                let unknown = DbFault::BadRow { table: "pose source", id, problem: "its kind is not known" };
                Ok((id, PoseSource::from_columns(&kind, description).ok_or(unknown)?))
            };
            rows.into_iter().map(source).collect()
        })
    }

    /// Returns the JPEG or PNG file of an image, as it was recorded.
    pub fn image_bytes(&self, id: i64) -> Result<Vec<u8>, DbError> {
        self.read(|transaction| bytes_of(transaction, id))
    }

    /// Decodes an image, in its camera's size.
    pub fn picture(&self, id: i64) -> Result<RgbImage, DbError> {
        let (camera_id, text, bytes) = self.read(|transaction| {
            let (camera_id, text) = camera_of(transaction, id)?;
            Ok((camera_id, text, bytes_of(transaction, id)?))
        })?;
        let camera = CameraSetup::from_toml(&self.origin("camera", camera_id), &text)?.camera;
        Ok(decode_image(&self.origin("image", id), &bytes, [camera.width, camera.height])?)
    }

    /// Decodes an image whose camera is known to have pictures of this size: width, height. Faster than [`Database::picture`], which
    /// looks the camera up.
    pub fn picture_of_size(&self, id: i64, size: [u32; 2]) -> Result<RgbImage, DbError> {
        Ok(decode_image(&self.origin("image", id), &self.image_bytes(id)?, size)?)
    }

    /// Runs queries that all see the same state of the database.
    pub(crate) fn read<T>(
        &self,
        work: impl FnOnce(&Transaction<'_>) -> Result<T, DbFault>,
    ) -> Result<T, DbError> {
        let connection = self.connection.lock().unwrap_or_else(PoisonError::into_inner);
        self.work_limit.renew(file_bytes(&self.path));
        let transaction =
            connection.unchecked_transaction().map_err(|error| DbError::new(&self.path, error))?;
        work(&transaction).map_err(|fault| DbError::new(&self.path, fault))
    }

    /// Runs statements of which all take effect, or, after an error, none. Fails if the database was opened for reading.
    pub(crate) fn write<T>(
        &mut self,
        work: impl FnOnce(&Transaction<'_>) -> Result<T, DbFault>,
    ) -> Result<T, DbError> {
        let fail = |fault: DbFault| DbError::new(&self.path, fault);
        if !self.is_writer {
            return Err(fail(DbFault::OpenedForReading));
        }
        let connection = self.connection.get_mut().unwrap_or_else(PoisonError::into_inner);
        self.work_limit.renew(file_bytes(&self.path));
        let transaction = connection
            .transaction_with_behavior(TransactionBehavior::Immediate)
            .map_err(|error| fail(error.into()))?;
        let result = work(&transaction).map_err(fail)?;
        transaction.commit().map_err(|error| fail(error.into()))?;
        Ok(result)
    }

    /// Name of a part of the database in errors.
    pub(crate) fn origin(&self, what: &str, id: i64) -> PathBuf {
        let mut origin = self.path.clone().into_os_string();
        origin.push(format!(", {what} {id}"));
        origin.into()
    }

    fn try_open(path: &Path) -> Result<Self, DbFault> {
        if !fs::metadata(path)?.is_file() {
            return Err(DbFault::NotAFile);
        }
        // A reader may write, where it can, to roll back what a killed writer left; where it cannot, SQLite falls back to
        // reading.
        let (connection, work_limit) = connect(path, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
        connection.pragma_update(None, "query_only", true)?;
        schema::check(&connection, path)?;
        let connection = Mutex::new(connection);
        Ok(Self { path: path.to_path_buf(), connection, work_limit, is_writer: false })
    }

    fn try_create_or_open(path: &Path) -> Result<Self, DbFault> {
        if fs::metadata(path).is_ok_and(|metadata| !metadata.is_file()) {
            return Err(DbFault::NotAFile);
        }
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_CREATE;
        let (mut connection, work_limit) = connect(path, flags)?;
        if connection.is_readonly("main")? {
            return Err(DbFault::ReadOnly);
        }
        connection.pragma_update(None, "cache_size", -WRITER_CACHE_KIB)?;
        schema::prepare(&mut connection, path)?;
        let connection = Mutex::new(connection);
        Ok(Self { path: path.to_path_buf(), connection, work_limit, is_writer: true })
    }
}

/// Reads the file of an image.
fn bytes_of(transaction: &Transaction<'_>, id: i64) -> Result<Vec<u8>, DbFault> {
    let query = "SELECT bytes FROM image_bytes WHERE image_id = ?1";
    if let Some(bytes) = transaction.query_row(query, [id], |row| row.get(0)).optional()? {
        return Ok(bytes);
    }
    let is_stored = transaction.prepare("SELECT 1 FROM images WHERE id = ?1")?.exists([id])?;
    Err(match is_stored {
        true => DbFault::BadRow { table: "image", id, problem: "its bytes are missing" },
        false => DbFault::NoSuchImage { id },
    })
}

/// Reads the camera of an image: its id and its text.
fn camera_of(transaction: &Transaction<'_>, id: i64) -> Result<(i64, String), DbFault> {
    let query = "SELECT camera_id, toml FROM images LEFT JOIN cameras ON cameras.id = camera_id \
         WHERE images.id = ?1";
    let row = |row: &Row<'_>| Ok((row.get(0)?, row.get::<_, Option<String>>(1)?));
    let (camera_id, text) =
        transaction.query_row(query, [id], row).optional()?.ok_or(DbFault::NoSuchImage { id })?;
    let missing = DbFault::BadRow { table: "image", id, problem: "its camera is missing" };
    Ok((camera_id, text.ok_or(missing)?))
}

/// Returns the length of a file, bytes; 0 where there is none yet.
fn file_bytes(path: &Path) -> u64 {
    fs::metadata(path).map_or(0, |metadata| metadata.len())
}

fn connect(path: &Path, flags: OpenFlags) -> Result<(Connection, WorkLimit), DbFault> {
    // An absolute path is never one of the special names that SQLite does not treat as a file.
    let mut connection =
        Connection::open_with_flags(path::absolute(path)?, flags | OpenFlags::SQLITE_OPEN_NO_MUTEX)?;
    connection.busy_timeout(BUSY_TIMEOUT)?;
    let work_limit = WorkLimit::new(&mut connection, file_bytes(path))?;
    // Somebody else may have made the file.
    connection.pragma_update(None, "trusted_schema", false)?;
    connection.pragma_update(None, "cell_size_check", true)?;
    Ok((connection, work_limit))
}

/// Hands over the checked records of all images, each with its row, in which `further` columns follow those of the record. The first of them is
/// the id of the pose's source.
fn each_record(
    transaction: &Transaction<'_>,
    further: &str,
    mut take: impl FnMut(ImageRecord, &Row<'_>) -> Result<(), DbFault>,
) -> Result<(), DbFault> {
    let known = References::read(transaction)?;
    let mut statement = transaction.prepare(&query_of_records(further))?;
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        let image = ImageRecord::from_row(row)?;
        let pose_source_id = row.get(IMAGE_WIDTH)?;
        if let Some(problem) = image.problem().or_else(|| known.missing(&image, pose_source_id)) {
            return Err(DbFault::BadRow { table: "image", id: image.id, problem });
        }
        take(image, row)?;
    }
    Ok(())
}

/// Returns the query of all records in the order of their ids, with `further` columns. If those are no more than the id of the pose's source,
/// it is answered from the index of records.
pub(crate) fn query_of_records(further: &str) -> String {
    format!("SELECT {IMAGE_COLUMNS}, {further} FROM images ORDER BY id")
}

/// Ids that images refer to.
struct References {
    sequences: BTreeSet<i64>,
    cameras: BTreeSet<i64>,
    fields: BTreeSet<i64>,
    pose_sources: BTreeSet<i64>,
}

impl References {
    fn read(transaction: &Transaction<'_>) -> Result<Self, DbFault> {
        let ids = |table: &str| all(transaction, &format!("SELECT id FROM {table}"), |row| row.get(0));
        Ok(Self {
            sequences: ids("sequences")?,
            cameras: ids("cameras")?,
            fields: ids("fields")?,
            pose_sources: ids("pose_sources")?,
        })
    }

    /// Returns which of those of an image does not exist, if any.
    fn missing(&self, image: &ImageRecord, pose_source_id: i64) -> Option<&'static str> {
        if !self.sequences.contains(&image.sequence_id) {
            Some("its sequence is missing")
        } else if !self.cameras.contains(&image.camera_id) {
            Some("its camera is missing")
        } else if !self.fields.contains(&image.field_id) {
            Some("its field is missing")
        } else if !self.pose_sources.contains(&pose_source_id) {
            Some("its pose source is missing")
        } else {
            None
        }
    }
}

/// Reads pairs of an id and a text.
pub(crate) fn texts(transaction: &Transaction<'_>, query: &str) -> Result<BTreeMap<i64, String>, DbFault> {
    all(transaction, query, |row| Ok((row.get(0)?, row.get(1)?)))
}

/// Reads all rows of a query.
pub(crate) fn all<T, C: FromIterator<T>>(
    transaction: &Transaction<'_>,
    query: &str,
    row: impl FnMut(&Row<'_>) -> rusqlite::Result<T>,
) -> Result<C, DbFault> {
    Ok(transaction.prepare(query)?.query_map([], row)?.collect::<rusqlite::Result<C>>()?)
}
