//! One row a picture: pose, covariance, and what is known of its quality. Unknown values are null.

mod columns;
mod details;
mod parquet_file;
mod quality;
mod table;
mod values;

pub use self::{
    columns::{COVARIANCE_AXES, Kind, covariance_column, known_columns},
    quality::PictureQuality,
    table::{Column, FrameTable, PictureFacts},
    values::Values,
};
