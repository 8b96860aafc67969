//! The Parquet table.

use std::path::Path;

use reality_sim::sequence::decode_image;
use reality_sim_formats::frame_table::{FrameTable, PictureQuality};

use super::{options::ExportArgs, source::Source};
use crate::commands::output::frame_progress;

/// Writes the table of the pictures, or of the rows of a file of details.
pub fn export(args: &ExportArgs, source: &Source) -> anyhow::Result<()> {
    let pictures = &source.posed.pictures;
    let mut facts = source.facts.clone();
    if !args.no_quality {
        let progress = frame_progress(pictures.len())?;
        for (index, (facts, picture)) in facts.iter_mut().zip(pictures).enumerate() {
            let camera = source.posed.camera(picture);
            let bytes = source.picture_bytes(index)?;
            let decoded = decode_image(Path::new(&facts.image), &bytes, [camera.width, camera.height])?;
            facts.quality = Some(PictureQuality::of(&decoded));
            progress.inc(1);
        }
        progress.finish_and_clear();
    }
    let table = match &args.details {
        Some(details) => {
            let mut table = FrameTable::read_details(details)?;
            let times_s: Vec<f64> = pictures.iter().map(|picture| picture.timestamp_s).collect();
            table.add_facts(&times_s, &facts);
            table
        }
        None => FrameTable::of_pictures(pictures, &facts),
    };
    Ok(table.write_parquet(&args.out)?)
}
