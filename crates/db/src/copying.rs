//! Copying of images from one database into another: databases are merged by it, and split by field.

use std::collections::{BTreeMap, btree_map::Entry};

use rusqlite::{OptionalExtension, Row, Transaction, params};

use crate::{
    database::{Database, all, texts},
    error::{DbError, DbFault},
    image_mask::ImageMask,
    ingest::{BATCH_BYTES, BATCH_FRAMES, IngestReport},
    insert::{Shared, insert},
    record::{
        DETAIL_COLUMNS, IMAGE_COLUMNS, IMAGE_WIDTH, ImageDetails, ImageRecord, PoseEstimate, PoseSource,
        unsigned,
    },
    recording::{NewImage, Recording},
};

impl Database {
    /// Adds the images of another database with everything that is known of them: those of one of its fields, or all.
    ///
    /// Images are recognised as [`Database::ingest`] does: those that are there are compared, and another picture, pose, camera or field
    /// is [`DbFault::Changed`]. They are committed in batches; after an error, or when the program is killed, all committed batches stay, and
    /// the next call continues. `goes_on` gets the number of images done after each batch; once it returns false, the rest is left for
    /// another call.
    ///
    /// Hall and clean stage of a field come along if this database then holds the same images of the field as the other one. Otherwise
    /// they are forgotten, as they were found without the others.
    pub fn copy_from(
        &mut self,
        other: &Self,
        field_id: Option<i64>,
        mut goes_on: impl FnMut(usize) -> bool,
    ) -> Result<IngestReport, DbError> {
        let mut report = IngestReport::default();
        let origins = Origins::of(other)?;
        let mut last = i64::MIN;
        loop {
            let images = other.read(|transaction| batch(transaction, field_id, last))?;
            let Some(end) = images.last() else { break };
            last = end.record.id;
            let recordings =
                origins.recordings(&images).map_err(|fault| DbError::new(other.path(), fault))?;
            self.write(|transaction| {
                let mut shared = BTreeMap::new();
                for (ids, recording) in &recordings {
                    shared.insert(ids, Shared::find_or_add(transaction, recording)?);
                }
                for image in &images {
                    let ids = image.origin();
                    report.count(insert(transaction, &recordings[&ids], &shared[&ids], &image.as_new())?);
                }
                Ok(())
            })?;
            if !goes_on(report.stored()) {
                return Ok(report);
            }
        }
        let is_copied = |id: &i64| field_id.is_none_or(|field_id| field_id == *id);
        let mut fields = origins.fields.iter().filter(|(id, _)| is_copied(id));
        fields.try_for_each(|(id, field)| self.copy_surroundings(other, *id, field))?;
        Ok(report)
    }

    /// Returns how many images show each field that any shows, by the fields' ids.
    pub fn images_by_field(&self) -> Result<BTreeMap<i64, usize>, DbError> {
        let query = "SELECT field_id, count(*) FROM images GROUP BY field_id";
        self.read(|transaction| all(transaction, query, |row| Ok((row.get(0)?, unsigned(row, 1)?))))
    }

    /// Copies hall and clean stage of a field, whose images were copied, if both databases hold the same images of it.
    fn copy_surroundings(&mut self, other: &Self, field_id: i64, field: &str) -> Result<(), DbError> {
        let query = "SELECT id FROM fields WHERE toml = ?1";
        let own_id = self.read(|transaction| {
            Ok(transaction.query_row(query, [field], |row| row.get::<_, i64>(0)).optional()?)
        })?;
        let Some(own_id) = own_id else { return Ok(()) };
        if self.images_by_field()?.get(&own_id) != other.images_by_field()?.get(&field_id) {
            return Ok(());
        }
        if self.fields_without_hall()?.contains(&own_id)
            && let Some(hall) = other.halls()?.get(&field_id)
        {
            self.set_hall(own_id, hall)?;
        }
        if !self.has_ground(own_id)?
            && let Some(ground) = other.ground(field_id)?
        {
            let masks = self.own_masks(other, other.image_masks(field_id)?)?;
            self.set_clean_stage(own_id, &ground, &masks)?;
        }
        Ok(())
    }

    /// Gives masks of another database's images the ids that the images have here.
    fn own_masks(
        &self,
        other: &Self,
        masks: BTreeMap<i64, ImageMask>,
    ) -> Result<BTreeMap<i64, ImageMask>, DbError> {
        let name = "SELECT name, first_frame, frame_index FROM images
            JOIN sequences ON sequences.id = sequence_id WHERE images.id = ?1";
        let find = "SELECT images.id FROM images JOIN sequences ON sequences.id = sequence_id
            WHERE name = ?1 AND first_frame = ?2 AND frame_index = ?3";
        let named: Vec<((String, String, i64), ImageMask)> = other.read(|transaction| {
            let mut statement = transaction.prepare(name)?;
            let mut name = |id| statement.query_row([id], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)));
            masks.into_iter().map(|(id, mask)| Ok((name(id)?, mask))).collect()
        })?;
        self.read(|transaction| {
            let mut statement = transaction.prepare(find)?;
            named
                .into_iter()
                .map(|(name, mask)| Ok((statement.query_row(name, |row| row.get(0))?, mask)))
                .collect()
        })
    }
}

/// Ids of what an image shares with others: sequence, camera, field and source of the pose.
type OriginIds = [i64; 4];

/// Image with everything that is stored of it.
struct CopiedImage {
    record: ImageRecord,
    details: ImageDetails,
    estimate: PoseEstimate,
    bytes: Vec<u8>,
}

impl CopiedImage {
    /// Reads an image from [`IMAGE_COLUMNS`], [`DETAIL_COLUMNS`] and its bytes.
    fn from_row(row: &Row<'_>) -> Result<Self, DbFault> {
        let record = ImageRecord::from_row(row)?;
        let details = ImageDetails::from_row(row, IMAGE_WIDTH)?;
        let bad = |problem| DbFault::BadRow { table: "image", id: record.id, problem };
        if let Some(problem) = record.problem().or_else(|| details.problem()) {
            return Err(bad(problem));
        }
        let bytes: Option<Vec<u8>> = row.get("bytes")?;
        let bytes = bytes.ok_or(bad("its bytes are missing"))?;
        let estimate = PoseEstimate { pose: record.pose, covariance: details.covariance };
        Ok(Self { record, details, estimate, bytes })
    }

    fn origin(&self) -> OriginIds {
        let ImageRecord { sequence_id, camera_id, field_id, .. } = self.record;
        [sequence_id, camera_id, field_id, self.details.pose_source_id]
    }

    fn as_new(&self) -> NewImage<'_> {
        NewImage {
            frame_index: self.record.frame_index,
            timestamp_s: self.record.timestamp_s,
            file_name: &self.details.file_name,
            estimate: &self.estimate,
            bytes: &self.bytes,
        }
    }
}

/// Reads the images after this id, as many as are committed together.
fn batch(
    transaction: &Transaction<'_>,
    field_id: Option<i64>,
    last: i64,
) -> Result<Vec<CopiedImage>, DbFault> {
    let query = format!(
        "SELECT {IMAGE_COLUMNS}, {DETAIL_COLUMNS}, bytes FROM images LEFT JOIN image_bytes ON image_id = id
            WHERE id > ?1 AND (?2 IS NULL OR field_id = ?2) ORDER BY id"
    );
    let mut statement = transaction.prepare(&query)?;
    let mut rows = statement.query(params![last, field_id])?;
    let (mut images, mut held_bytes) = (Vec::new(), 0);
    while images.len() < BATCH_FRAMES
        && held_bytes < BATCH_BYTES
        && let Some(row) = rows.next()?
    {
        let image = CopiedImage::from_row(row)?;
        held_bytes += image.bytes.len();
        images.push(image);
    }
    Ok(images)
}

/// What the images of a database share, by its ids.
struct Origins {
    /// Names and first frames.
    sequences: BTreeMap<i64, (String, String)>,
    /// Texts of their files, and sizes of their pictures, pixels.
    cameras: BTreeMap<i64, (String, [u32; 2])>,
    /// Texts of their files.
    fields: BTreeMap<i64, String>,
    sources: BTreeMap<i64, PoseSource>,
}

impl Origins {
    /// Reads what images share, and checks that all of it can be read from this database.
    fn of(database: &Database) -> Result<Self, DbError> {
        database.fields()?;
        let setups = database.cameras()?;
        let (sources, sequence) = (database.pose_sources()?, "SELECT id, name, first_frame FROM sequences");
        database.read(|transaction| {
            let size = |id| setups.get(&id).map(|setup| [setup.camera.width, setup.camera.height]);
            let cameras = texts(transaction, "SELECT id, toml FROM cameras")?.into_iter();
            Ok(Self {
                sequences: all(transaction, sequence, |row| Ok((row.get(0)?, (row.get(1)?, row.get(2)?))))?,
                cameras: cameras.filter_map(|(id, text)| Some((id, (text, size(id)?)))).collect(),
                fields: texts(transaction, "SELECT id, toml FROM fields")?,
                sources,
            })
        })
    }

    /// Returns what these images belong to.
    fn recordings(&self, images: &[CopiedImage]) -> Result<BTreeMap<OriginIds, Recording>, DbFault> {
        let mut recordings = BTreeMap::new();
        for image in images {
            if let Entry::Vacant(place) = recordings.entry(image.origin()) {
                place.insert(self.recording(image)?);
            }
        }
        Ok(recordings)
    }

    fn recording(&self, image: &CopiedImage) -> Result<Recording, DbFault> {
        let [sequence_id, camera_id, field_id, source_id] = image.origin();
        let bad = |problem| DbFault::BadRow { table: "image", id: image.record.id, problem };
        let (name, first_frame) = self.sequences.get(&sequence_id).ok_or(bad("its sequence is missing"))?;
        let (camera, size) = self.cameras.get(&camera_id).ok_or(bad("its camera is missing"))?;
        Ok(Recording {
            name: name.clone(),
            first_frame: first_frame.clone(),
            size: *size,
            camera: camera.clone(),
            field: self.fields.get(&field_id).ok_or(bad("its field is missing"))?.clone(),
            source: self.sources.get(&source_id).ok_or(bad("its pose source is missing"))?.clone(),
        })
    }
}
