//! `reality-sim export`: writes poses and pictures in the formats of other programs.

mod options;
mod source;
mod table;

use serde::Serialize;

use reality_sim::{StampedPose, sequence::counted, write_tum};
use reality_sim_formats::{
    PosedPictures,
    colmap::write_colmap,
    nerfstudio::write_nerfstudio,
    show::{LogFile, Shot},
};

pub use self::options::ExportArgs;
use self::{options::Format, source::Source};
use super::{
    output::{aligned, check_output_file, frame_progress, print, print_json},
    output_folder::OutputFolder,
};

/// Report that `--json` prints.
#[derive(Serialize)]
struct Report {
    source: String,
    format: Format,
    /// Pictures with a pose, which were exported.
    pictures: usize,
    /// Pictures without a pose, which were left out.
    without_pose: usize,
    cameras: usize,
    undistorted: bool,
    out: String,
}

/// Runs the command.
pub fn run(args: &ExportArgs) -> anyhow::Result<()> {
    let source = Source::open(args)?;
    if args.format.is_folder() {
        OutputFolder::check(&args.out, &source.inputs)?;
    } else {
        check_output_file(&args.out, &source.inputs)?;
    }
    match args.format {
        Format::Colmap | Format::Nerfstudio => export_folder(args, &source)?,
        Format::Tum => write_tum(&args.out, &stamped(&source.posed))?,
        Format::Mcap => export_log(args, &source)?,
        Format::Parquet => table::export(args, &source)?,
    }
    let report = Report {
        source: args.source.display().to_string(),
        format: args.format,
        pictures: source.posed.pictures.len(),
        without_pose: source.without_pose,
        cameras: source.posed.cameras.len(),
        undistorted: args.undistortion().is_some(),
        out: args.out.display().to_string(),
    };
    if args.json { print_json(&report) } else { print(&report.text()) }
}

/// Writes the pictures, then the model that names them.
fn export_folder(args: &ExportArgs, source: &Source) -> anyhow::Result<()> {
    let progress = frame_progress(source.posed.pictures.len())?;
    let mut done = |count: usize| progress.set_position(count as u64);
    let undistortion = args.undistortion();
    let written = source.posed.write_pictures(source, &args.out, undistortion.as_ref(), &mut done);
    progress.finish_and_clear();
    let written = written?;
    match args.format {
        Format::Nerfstudio => write_nerfstudio(&written, &args.out)?,
        _ => write_colmap(&written, &args.out, args.encodings())?,
    }
    Ok(())
}

/// Writes an MCAP file, without particles: they are known only while `tag` runs.
fn export_log(args: &ExportArgs, source: &Source) -> anyhow::Result<()> {
    let posed = &source.posed;
    let progress = frame_progress(posed.pictures.len())?;
    let log = LogFile::create(&args.out)?;
    for (index, picture) in posed.pictures.iter().enumerate() {
        log.log(&Shot {
            timestamp_s: picture.timestamp_s,
            picture: &source.picture_bytes(index)?,
            camera: posed.camera(picture),
            field: &posed.field,
            pose: picture.pose,
            particles: &[],
        });
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok(log.finish()?)
}

fn stamped(posed: &PosedPictures) -> Vec<StampedPose> {
    let pictures = posed.pictures.iter();
    pictures.map(|picture| StampedPose { timestamp_s: picture.timestamp_s, pose: picture.pose }).collect()
}

impl Report {
    fn text(&self) -> String {
        let mut lines = vec![("source", self.source.clone())];
        lines.push((
            "pictures",
            format!("{} of {}", counted(self.pictures, "picture"), counted(self.cameras, "camera")),
        ));
        if self.without_pose > 0 {
            lines.push(("", format!("{} left out: without a pose", self.without_pose)));
        }
        lines.push((self.format.name(), self.out.clone()));
        aligned(&lines)
    }
}
