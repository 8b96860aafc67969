//! What is stored of the clean stage: the ground of every field, and the masks of images.

use std::{collections::BTreeMap, io::Cursor};

use glam::DVec2;
use image::{GrayImage, ImageFormat, RgbImage};
use reality_sim_core::sequence::decode_image;
use rusqlite::{OptionalExtension, Row, Transaction, params};

use crate::{
    database::Database,
    error::{DbError, DbFault},
    ground::Ground,
    image_mask::ImageMask,
    schema::CLEAN_STAGE_VERSION,
};

/// Row of a ground.
struct StoredGround {
    min_m: DVec2,
    cell_m: f64,
    size: [u32; 2],
    colors: Vec<u8>,
    views: Vec<u8>,
}

impl Database {
    /// Returns whether the ground of a field is stored, and with it the masks of the field's images.
    pub fn has_ground(&self, field_id: i64) -> Result<bool, DbError> {
        let count = self.read_clean_stage(|transaction| {
            let query = "SELECT count(*) FROM grounds WHERE field_id = ?1";
            Ok(transaction.query_row(query, [field_id], |row| row.get::<_, i64>(0))?)
        });
        Ok(count?.is_some_and(|count| count > 0))
    }

    /// Returns the ground of a field, if one is stored.
    pub fn ground(&self, field_id: i64) -> Result<Option<Ground>, DbError> {
        let bad = |problem| DbFault::BadRow { table: "ground", id: field_id, problem };
        let stored = self.read_clean_stage(|transaction| {
            let query = "SELECT min_x_m, min_y_m, cell_m, width, height, colors, views FROM grounds \
                 WHERE field_id = ?1";
            let stored = transaction.query_row(query, [field_id], StoredGround::from_row).optional()?;
            match &stored {
                Some(stored) if !Ground::has_place(stored.min_m, stored.cell_m) => {
                    Err(bad("its place is none"))
                }
                Some(StoredGround { size: [width, height], .. }) if !Ground::has_size(*width, *height) => {
                    Err(bad("its size is none"))
                }
                _ => Ok(stored),
            }
        })?;
        let Some(StoredGround { min_m, cell_m, size, colors, views }) = stored.flatten() else {
            return Ok(None);
        };
        let origin = self.origin("ground", field_id);
        let decode = |bytes: &[u8]| decode_image(&origin, bytes, size);
        let (colors, views) = (decode(&colors)?, decode(&views)?);
        let views = GrayImage::from_fn(size[0], size[1], |u, v| image::Luma([views.get_pixel(u, v).0[0]]));
        Ok(Some(Ground { min_m, cell_m, colors, views }))
    }

    /// Returns the masks of a field's images, by the images' ids. Images without an entry hide nothing.
    pub fn image_masks(&self, field_id: i64) -> Result<BTreeMap<i64, ImageMask>, DbError> {
        let masks = self.read_clean_stage(|transaction| {
            let query = "SELECT image_id, width, height, runs FROM image_masks \
                 JOIN images ON images.id = image_id WHERE field_id = ?1";
            let mut statement = transaction.prepare(query)?;
            let mut rows = statement.query([field_id])?;
            let mut masks = BTreeMap::new();
            while let Some(row) = rows.next()? {
                let id = row.get(0)?;
                let runs = row.get_ref(3)?.as_blob().map_err(rusqlite::Error::from)?;
                let mask = ImageMask::from_runs(row.get(1)?, row.get(2)?, runs);
                let problem = "its runs are not those of a mask";
                masks.insert(id, mask.ok_or(DbFault::BadRow { table: "mask of image", id, problem })?);
            }
            Ok(masks)
        });
        masks.map(Option::unwrap_or_default)
    }

    /// Returns the ids of the fields that images show, and of which no ground is stored: none was found yet, or images were
    /// added, replaced or removed since, which forgets it.
    pub fn fields_without_ground(&self) -> Result<Vec<i64>, DbError> {
        let fields = self.read_clean_stage(|transaction| {
            let query = "SELECT DISTINCT field_id FROM images \
                 WHERE field_id NOT IN (SELECT field_id FROM grounds) ORDER BY field_id";
            let mut statement = transaction.prepare(query)?;
            let ids = statement.query_map([], |row| row.get(0))?;
            Ok(ids.collect::<rusqlite::Result<_>>()?)
        });
        fields.map(Option::unwrap_or_default)
    }

    /// Stores the ground of a field with the masks of its images, by the images' ids, and replaces earlier ones. Masks that hide
    /// nothing are not stored.
    pub fn set_clean_stage(
        &mut self,
        field_id: i64,
        ground: &Ground,
        masks: &BTreeMap<i64, ImageMask>,
    ) -> Result<(), DbError> {
        if !ground.is_possible() || !self.fields()?.contains_key(&field_id) {
            let problem = "it is not that of a field";
            return Err(DbError::new(
                self.path(),
                DbFault::BadRow { table: "ground", id: field_id, problem },
            ));
        }
        let fail = |error| DbError::new(self.path(), DbFault::from(error));
        let colors = png_of_colors(&ground.colors).map_err(fail)?;
        let views = png_of_numbers(&ground.views).map_err(fail)?;
        self.write(|transaction| {
            forget_clean_stage(transaction, field_id)?;
            let (width, height) = ground.colors.dimensions();
            transaction.execute(
                "INSERT INTO grounds VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)",
                params![
                    field_id,
                    ground.min_m.x,
                    ground.min_m.y,
                    ground.cell_m,
                    width,
                    height,
                    colors,
                    views
                ],
            )?;
            let mut insert = transaction.prepare("INSERT INTO image_masks VALUES (?1, ?2, ?3, ?4)")?;
            for (id, mask) in masks.iter().filter(|(_, mask)| !mask.is_empty()) {
                let [width, height] = mask.size();
                insert.execute(params![id, width, height, mask.to_runs()])?;
            }
            Ok(())
        })
    }

    /// Reads from the tables of the clean stage; `None` in a database of a version that has none.
    fn read_clean_stage<T>(
        &self,
        work: impl FnOnce(&Transaction<'_>) -> Result<T, DbFault>,
    ) -> Result<Option<T>, DbError> {
        self.read(|transaction| {
            let version: i64 = transaction.pragma_query_value(None, "user_version", |row| row.get(0))?;
            (version >= CLEAN_STAGE_VERSION).then(|| work(transaction)).transpose()
        })
    }
}

impl StoredGround {
    fn from_row(row: &Row<'_>) -> rusqlite::Result<Self> {
        Ok(Self {
            min_m: DVec2::new(row.get(0)?, row.get(1)?),
            cell_m: row.get(2)?,
            size: [row.get(3)?, row.get(4)?],
            colors: row.get(5)?,
            views: row.get(6)?,
        })
    }
}

/// Forgets the ground of a field, and the masks of its images: they were found together.
pub(crate) fn forget_clean_stage(transaction: &Transaction<'_>, field_id: i64) -> rusqlite::Result<()> {
    // It goes through the masks, of which there are none while a recording is stored, and never through all images.
    let masks = "DELETE FROM image_masks WHERE (SELECT field_id FROM images WHERE id = image_id) = ?1";
    transaction.execute(masks, [field_id])?;
    transaction.execute("DELETE FROM grounds WHERE field_id = ?1", [field_id]).map(drop)
}

fn png_of_colors(colors: &RgbImage) -> image::ImageResult<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    colors.write_to(&mut bytes, ImageFormat::Png).map(|()| bytes.into_inner())
}

fn png_of_numbers(numbers: &GrayImage) -> image::ImageResult<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    numbers.write_to(&mut bytes, ImageFormat::Png).map(|()| bytes.into_inner())
}
