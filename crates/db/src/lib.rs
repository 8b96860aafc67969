//! Pictures with the poses they were taken at, in one file: what a simulator looks up instead of rendering.
//!
//! The file is an SQLite database: [`Database::ingest`] puts recordings with their poses in, the other methods of
//! [`Database`] read. It holds the pictures' files as they were recorded, and the cameras and fields as the text of
//! their files. Units and frames are those of [`reality_sim_core::pose`].

pub mod coverage;
mod database;
mod error;
pub mod index;
mod ingest;
pub mod metric;
mod record;
mod schema;

pub use self::{
    database::Database,
    error::{DbError, DbFault},
    ingest::IngestReport,
    record::{ImageRecord, PoseEstimate, PoseSource},
    schema::SCHEMA_VERSION,
};

#[cfg(test)]
mod tests;
