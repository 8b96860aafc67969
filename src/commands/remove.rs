//! `reality-sim remove`: removes pictures from a database.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use reality_sim::{db::Database, sequence::counted};

use super::{
    frame_range::FrameRange,
    output::{aligned, print, print_json},
};

/// Options of `remove`.
#[derive(Debug, Args)]
pub struct RemoveArgs {
    /// Database, as `build` makes it
    database: PathBuf,
    /// Name of the sequence whose pictures are removed, as `info` shows it
    #[arg(long, value_name = "NAME")]
    sequence: String,
    /// Remove only frames A to B − 1, counted from 0
    #[arg(long, value_name = "A..B", value_parser = FrameRange::parse)]
    frames: Option<FrameRange>,
    /// Print the report as one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    database: String,
    sequence: String,
    /// Number of images that were removed.
    removed: usize,
    /// Number of images now in the database.
    images: usize,
}

/// Runs the command.
pub fn run(args: &RemoveArgs) -> anyhow::Result<()> {
    // Opening for writing would create a database that is not there.
    drop(Database::open(&args.database)?);
    let mut database = Database::create_or_open(&args.database)?;
    let frames = args.frames.map_or(0..usize::MAX, |range| range.among(usize::MAX));
    let removed = database.remove(&args.sequence, frames)?;
    let report = Report {
        database: args.database.display().to_string(),
        sequence: args.sequence.clone(),
        removed,
        images: database.images()?.len(),
    };
    if args.json { print_json(&report) } else { print(&report.text()) }
}

impl Report {
    fn text(&self) -> String {
        let Self { database, sequence, removed, images } = self;
        aligned(&[
            ("removed", format!("{} of {sequence}", counted(*removed, "picture"))),
            ("database", format!("{database}, {}", counted(*images, "picture"))),
        ])
    }
}
