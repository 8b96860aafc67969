//! Who watches while pictures are localized: an MCAP file, Foxglove's websocket. Also details as Parquet.

use std::{fs, path::Path};

use anyhow::Context;

use reality_sim::{
    CameraPose, LocalizedFrame, Localizer, Sequence,
    sequence::write_atomically,
    tagging::{TaggedPose, covariance_rows},
};
use reality_sim_formats::{
    frame_table::{FrameTable, PictureFacts},
    show::{FoxgloveTopics, LogFile, Shot},
};

use super::options::TagArgs;
use crate::commands::receivers::Receivers;

/// Watchers of one run.
pub struct Watchers(Receivers<FoxgloveTopics>);

/// Returns whether a file is an MCAP file by its ending.
pub fn is_log(path: &Path) -> bool {
    has_ending(path, "mcap")
}

fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending))
}

impl Watchers {
    /// Begins the file and starts the server that the options name.
    pub fn start(args: &TagArgs) -> anyhow::Result<Self> {
        // Smoothed poses are known only at the end, by `write_log`.
        let log = args.out.as_deref().filter(|out| is_log(out) && !args.smooth);
        let receivers = Receivers::of_file(log)?;
        #[cfg(feature = "live")]
        let receivers = receivers.and_server(&args.serving)?;
        Ok(Self(receivers))
    }

    /// Shows a picture with its pose and the particles.
    pub fn show(
        &mut self,
        sequence: &Sequence,
        index: usize,
        frame: &LocalizedFrame,
        localizer: &Localizer,
    ) -> anyhow::Result<()> {
        if self.0.is_empty() {
            return Ok(());
        }
        let picture = read_picture(sequence, index)?;
        let particles = localizer.particles()?;
        self.0.send(&shot(sequence, index, &picture, frame.pose, &particles));
        Ok(())
    }

    /// Completes what they got.
    pub fn finish(self) -> anyhow::Result<()> {
        self.0.finish()
    }
}

/// Writes an MCAP file of poses without particles.
pub fn write_log(path: &Path, sequence: &Sequence, poses: &[CameraPose]) -> anyhow::Result<()> {
    let log = LogFile::create(path)?;
    for (index, pose) in poses.iter().enumerate() {
        log.log(&shot(sequence, index, &read_picture(sequence, index)?, *pose, &[]));
    }
    Ok(log.finish()?)
}

/// Writes the table of details, as Parquet if the file's ending says so.
pub fn write_details(
    path: &Path,
    csv: &str,
    sequence: &Sequence,
    results: &[TaggedPose],
) -> anyhow::Result<()> {
    if !has_ending(path, "parquet") {
        return Ok(write_atomically(path, csv.as_bytes())?);
    }
    let mut table = FrameTable::parse_details(path, csv)?;
    let facts = sequence.frames.iter().zip(results).map(|(frame, result)| PictureFacts {
        sequence: sequence.name.clone(),
        image: frame.image.clone(),
        covariance: result.covariance.as_ref().map(covariance_rows),
        quality: None,
    });
    let times_s: Vec<f64> = sequence.frames.iter().map(|frame| frame.timestamp_s).collect();
    table.add_facts(&times_s, &facts.collect::<Vec<_>>());
    Ok(table.write_parquet(path)?)
}

fn read_picture(sequence: &Sequence, index: usize) -> anyhow::Result<Vec<u8>> {
    let path = sequence.image_path(index)?;
    fs::read(&path).with_context(|| format!("{}: cannot be read: check the disk", path.display()))
}

fn shot<'a>(
    sequence: &'a Sequence,
    index: usize,
    picture: &'a [u8],
    pose: CameraPose,
    particles: &'a [CameraPose],
) -> Shot<'a> {
    Shot {
        timestamp_s: sequence.frames[index].timestamp_s,
        picture,
        camera: &sequence.setup.camera,
        field: &sequence.field,
        pose,
        particles,
    }
}
