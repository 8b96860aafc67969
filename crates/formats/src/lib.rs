//! Logs and models of others in and out: a robot's log becomes a recording, tags and databases become models that other
//! programs read.
//!
//! | what | where |
//! |---|---|
//! | which kind of input lies at a path | [`Input`] |
//! | logs of robots, as streams of messages | [`log`], [`message`] |
//! | a log as a recording | [`import`] |
//! | pictures with poses, on their way out | [`posed::PosedPictures`], [`undistort::Undistortion`] |
//! | COLMAP's models, written and read | [`colmap`] |
//! | nerfstudio's `transforms.json`, written and read | [`nerfstudio`] |
//! | pictures and a table with any columns, read by a mapping | [`mapped_table`] |
//! | what Foxglove shows, in an MCAP file or live | [`show`] |
//! | what a simulator's camera sees, as ROS 2's messages | [`ros2`] |
//! | one row a picture, as Parquet | [`frame_table::FrameTable`] |
//! | Parquet tables of any columns, read | [`parquet_rows`] |

pub mod colmap;
mod file;
pub mod frame_table;
pub mod import;
mod input;
pub mod line_points;
pub mod log;
pub mod mapped_table;
pub mod message;
pub mod model_error;
pub mod model_import;
pub mod nerfstudio;
pub mod parquet_rows;
mod pixels;
pub mod posed;
pub mod ros2;
mod schema;
pub mod show;
pub mod undistort;

pub use self::{
    input::Input,
    model_error::{ModelError, ModelFault},
    model_import::{ModelImport, ModelImportReport},
    posed::{PictureFiles, PosedPicture, PosedPictures},
};
