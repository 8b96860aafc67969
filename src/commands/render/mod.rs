//! `reality-sim render`: makes the picture at a pose, or those along a path.

mod balls;
mod options;
mod painter;
mod report;

use std::{path::Path, sync::Arc};

use anyhow::Context;
use image::DynamicImage;

use reality_sim::{
    Archive, StampedPose,
    evaluation::percentile,
    montage::strip,
    sensor::Trajectory,
    sequence::{read_camera, save_image},
};

pub use self::options::RenderArgs;
use self::{
    balls::BallComposer,
    options::PictureMethod,
    painter::{Painted, Painter, Work},
    report::{Report, used},
};
use super::{
    model_file::{ModelArgs, Use},
    output::{frame_progress, print, print_json},
    output_folder::OutputFolder,
};

/// Number of pictures of a path in its strip.
const STRIP_PICTURES: usize = 8;

/// Runs the command.
pub fn run(args: &RenderArgs) -> anyhow::Result<()> {
    let model = ModelArgs { model: args.model.clone() }.read()?;
    let archive = args.synthesis.archive(&args.database, model.as_ref())?;
    let poses = args.poses(&archive)?;
    let folder = args.check_outputs()?;
    let mut setup = archive.setup().clone();
    if let Some(file) = &args.camera {
        let other = read_camera(file)?;
        setup.camera = other.camera;
        setup.photometry = other.photometry.or(setup.photometry);
    }
    let synthesizer = Arc::new(args.synthesis.synthesizer(archive.clone(), setup.camera.clone())?);
    let painter = match (&model, args.method) {
        (Some(model), PictureMethod::Simulated) => {
            Painter::with_model(model, &archive, trajectory(args, &poses)?, &setup)?
        }
        (model, PictureMethod::Recorded(method)) if !args.ball.is_empty() => {
            let composer = BallComposer::new(&synthesizer, method, model.as_ref(), &args.ball)?;
            Painter::Composed(&synthesizer, method, Box::new(composer))
        }
        (_, method) => Painter::new(method, &synthesizer, &setup),
    };
    let mut report = match (&args.path, &folder) {
        (Some(path), Some(folder)) => along_path(args, (path, folder), &painter, &poses)?,
        _ => at_pose(args, &painter, &archive, poses[0])?,
    };
    let purpose = match args.method {
        PictureMethod::Simulated => Use::Simulation,
        PictureMethod::Recorded(_) => Use::Pictures { is_corrected: archive.corrected_by().is_some() },
    };
    report.corrections = model.map(|model| model.words(archive.setup(), archive.field(), purpose));
    if args.json { print_json(&report) } else { print(&report.text()) }
}

/// Returns the camera's trajectory through the poses; at a single pose the camera stands still.
fn trajectory(args: &RenderArgs, poses: &[StampedPose]) -> anyhow::Result<Trajectory> {
    let Some(path) = &args.path else { return Ok(Trajectory::still(poses[0].pose)) };
    let stamped: Vec<_> = poses.iter().map(|stamped| (stamped.timestamp_s, stamped.pose)).collect();
    Trajectory::new(&stamped).with_context(|| path.display().to_string())
}

fn at_pose(
    args: &RenderArgs,
    painter: &Painter,
    archive: &Archive,
    pose: StampedPose,
) -> anyhow::Result<Report> {
    painter.paint(pose)?;
    // The picture is drawn again to measure the time with the neighbours already decoded.
    let Painted { work, milliseconds } = painter.paint(pose)?;
    save_image(&args.out, work.picture())?;
    let mut report = Report {
        method: painter.name(),
        pictures: 1,
        milliseconds,
        covered: None,
        used: Vec::new(),
        corrections: None,
        out: args.out.display().to_string(),
    };
    if let Work::Reconstructed(reconstruction) = work {
        if let Some(file) = &args.origins {
            save_image(file, &reconstruction.origin_picture())?;
        }
        if let Some(file) = &args.trust {
            save_image(file, &DynamicImage::from(reconstruction.trust_picture()).into_rgb8())?;
        }
        report.method = reconstruction.method;
        report.covered = Some(reconstruction.covered());
        report.used = used(archive, &reconstruction)?;
    }
    Ok(report)
}

fn along_path(
    args: &RenderArgs,
    (path, folder): (&Path, &OutputFolder),
    painter: &Painter,
    poses: &[StampedPose],
) -> anyhow::Result<Report> {
    let progress = frame_progress(poses.len())?;
    let mut times = Vec::new();
    let mut covered = Vec::new();
    let mut shown = Vec::new();
    for (index, &pose) in poses.iter().enumerate() {
        let painted = painter.paint(pose).inspect_err(|_| progress.finish_and_clear());
        let Painted { work, milliseconds } =
            painted.with_context(|| format!("{}, pose {}", path.display(), index + 1))?;
        save_image(&folder.file(format!("{index:06}.png"))?, work.picture())?;
        times.push(milliseconds);
        covered.extend(work.covered());
        if is_in_strip(index, poses.len()) {
            shown.push(work.picture().clone());
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    if let Some(file) = &args.strip {
        save_image(file, &strip(&shown))?;
    }
    times.sort_by(f64::total_cmp);
    Ok(Report {
        method: painter.name(),
        pictures: poses.len(),
        milliseconds: percentile(&times, 0.5).unwrap_or_default(),
        covered: (!covered.is_empty()).then(|| covered.iter().sum::<f64>() / covered.len() as f64),
        used: Vec::new(),
        corrections: None,
        out: args.out.display().to_string(),
    })
}

/// Whether a picture is one of those spread evenly over the path.
fn is_in_strip(index: usize, count: usize) -> bool {
    let shown = count.min(STRIP_PICTURES);
    (0..shown).any(|i| i * (count - 1) / (shown - 1).max(1) == index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_shows_first_and_last_and_no_more_than_fit() {
        for count in 1..40 {
            let shown: Vec<usize> = (0..count).filter(|&index| is_in_strip(index, count)).collect();
            assert_eq!(shown.len(), count.min(STRIP_PICTURES));
            assert_eq!((shown[0], shown[shown.len() - 1]), (0, count - 1));
        }
    }
}
