//! Who watches while pictures are localized: an MCAP file, Foxglove's websocket. Also details as Parquet.

use std::{fs, path::Path};

use anyhow::Context;

use reality_sim::{
    CameraPose, LocalizedFrame, Localizer, Sequence,
    sequence::write_atomically,
    tagging::{TaggedPose, covariance_rows},
};
#[cfg(feature = "live")]
use reality_sim_formats::show::LiveView;
use reality_sim_formats::{
    frame_table::{FrameTable, PictureFacts},
    show::{LogFile, Shot},
};

use super::options::TagArgs;

/// Watchers of one run.
pub struct Watchers {
    log: Option<LogFile>,
    #[cfg(feature = "live")]
    live: Option<LiveView>,
}

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
        let log = args.out.as_ref().filter(|out| is_log(out) && !args.smooth);
        Ok(Self {
            log: log.map(|path| LogFile::create(path)).transpose()?,
            #[cfg(feature = "live")]
            live: args.serving.start()?,
        })
    }

    fn is_idle(&self) -> bool {
        #[cfg(feature = "live")]
        let has_live = self.live.is_some();
        #[cfg(not(feature = "live"))]
        let has_live = false;
        self.log.is_none() && !has_live
    }

    /// Shows a picture with its pose and the particles.
    pub fn show(
        &mut self,
        sequence: &Sequence,
        index: usize,
        frame: &LocalizedFrame,
        localizer: &Localizer,
    ) -> anyhow::Result<()> {
        if self.is_idle() {
            return Ok(());
        }
        let picture = read_picture(sequence, index)?;
        let particles = localizer.particles()?;
        let shot = shot(sequence, index, &picture, frame.pose, &particles);
        if let Some(log) = &self.log {
            log.log(&shot);
        }
        #[cfg(feature = "live")]
        if let Some(live) = &mut self.live {
            live.show(&shot);
        }
        Ok(())
    }

    /// Completes the file, and then ends the server: a client that has stalled may hold up its end, and costs no file.
    pub fn finish(self) -> anyhow::Result<()> {
        let finished = self.log.map_or(Ok(()), LogFile::finish);
        #[cfg(feature = "live")]
        if let Some(live) = self.live {
            live.stop();
        }
        Ok(finished?)
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
