//! The table in memory.

use std::path::PathBuf;

use super::{
    columns::{COVARIANCE_AXES, covariance_column, known_columns},
    quality::PictureQuality,
    values::Values,
};
use crate::posed::PosedPicture;

/// Largest difference of timestamps that belong to one picture, seconds: files may be rounded to milliseconds.
const TOLERANCE_S: f64 = 0.51e-3;

/// Column of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name, with the unit.
    pub name: String,
    /// Values, one a row.
    pub values: Values,
}

/// Table with one row a picture. It always has the columns of [`known_columns`], in their order, and may have more behind them.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameTable {
    rows: usize,
    pub(super) columns: Vec<Column>,
}

/// What a source knows of a picture beside its pose.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PictureFacts {
    /// Name of the recording.
    pub sequence: String,
    /// File in the recording.
    pub image: PathBuf,
    /// Covariance of x, y, yaw, height, pitch and roll, metres and radians.
    pub covariance: Option<[[f64; 6]; 6]>,
    /// Brightness and sharpness of the picture.
    pub quality: Option<PictureQuality>,
}

impl FrameTable {
    /// Makes a table of empty rows.
    pub(super) fn empty(rows: usize) -> Self {
        let columns = known_columns()
            .into_iter()
            .map(|(name, kind)| Column { name, values: kind.nulls(rows) })
            .collect();
        Self { rows, columns }
    }

    /// Makes the table of pictures, with what is known of each.
    pub fn of_pictures(pictures: &[PosedPicture], facts: &[PictureFacts]) -> Self {
        let mut table = Self::empty(pictures.len());
        for (row, picture) in pictures.iter().enumerate() {
            let pose = picture.pose;
            table.set_number("timestamp_s", row, picture.timestamp_s);
            let values = [pose.x_m, pose.y_m, pose.yaw_rad, pose.height_m, pose.pitch_rad, pose.roll_rad];
            for (axis, value) in COVARIANCE_AXES.into_iter().zip(values) {
                table.set_number(axis, row, value);
            }
        }
        for (row, facts) in facts.iter().take(table.rows).enumerate() {
            table.set_facts(row, facts);
        }
        table
    }

    /// Fills rows with what is known of the pictures of their times, and leaves out pictures that have no row.
    pub fn add_facts(&mut self, times_s: &[f64], facts: &[PictureFacts]) {
        let Some(Values::Numbers(rows)) = self.column("timestamp_s") else { return };
        let mut order: Vec<usize> = (0..times_s.len()).collect();
        order.sort_by(|a, b| times_s[*a].total_cmp(&times_s[*b]));
        let picture_at = |row_s: f64| {
            let first = order.partition_point(|picture| times_s[*picture] < row_s - TOLERANCE_S);
            order.get(first).copied().filter(|picture| times_s[*picture] <= row_s + TOLERANCE_S)
        };
        let of_row: Vec<Option<usize>> = rows.iter().map(|row_s| picture_at((*row_s)?)).collect();
        for (row, picture) in of_row.into_iter().enumerate() {
            if let Some(facts) = picture.and_then(|picture| facts.get(picture)) {
                self.set_facts(row, facts);
            }
        }
    }

    fn set_facts(&mut self, row: usize, facts: &PictureFacts) {
        self.set_text("sequence", row, facts.sequence.clone());
        self.set_text("image", row, facts.image.to_string_lossy().into_owned());
        if let Some(quality) = facts.quality {
            self.set_number("brightness", row, quality.brightness);
            self.set_number("sharpness", row, quality.sharpness);
        }
        let Some(covariance) = facts.covariance else { return };
        for (a, axis) in COVARIANCE_AXES.into_iter().enumerate() {
            self.set_number(&format!("sigma_{axis}"), row, covariance[a][a].sqrt());
            for (b, other) in COVARIANCE_AXES.into_iter().enumerate().skip(a) {
                self.set_number(&covariance_column(axis, other), row, covariance[a][b]);
            }
        }
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Returns all columns.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Returns the values of a column, if it is there.
    pub fn column(&self, name: &str) -> Option<&Values> {
        self.columns.iter().find(|column| column.name == name).map(|column| &column.values)
    }

    pub(super) fn column_mut(&mut self, name: &str) -> Option<&mut Values> {
        self.columns.iter_mut().find(|column| column.name == name).map(|column| &mut column.values)
    }

    fn set_number(&mut self, name: &str, row: usize, value: f64) {
        if let Some(Values::Numbers(values)) = self.column_mut(name) {
            values[row] = Some(value).filter(|value| value.is_finite());
        }
    }

    fn set_text(&mut self, name: &str, row: usize, value: String) {
        if let Some(Values::Texts(values)) = self.column_mut(name) {
            values[row] = Some(value);
        }
    }
}
