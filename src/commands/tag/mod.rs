//! `reality-sim tag`: finds the camera pose of every picture of a sequence.

mod options;
mod report;

use std::path::PathBuf;

use anyhow::bail;
use image::RgbImage;
use indicatif::ProgressBar;

use reality_sim::{
    CameraPose, LocalizedFrame, Localizer, Observation, Pose2, Sequence, StampedPose,
    evaluation::PoseError,
    localization::Picture,
    overlay::{BorderOutline, Overlay},
    refine::SmoothedPose,
    sequence::{save_image, write_atomically},
    write_tum,
};

pub use self::options::TagArgs;
use self::report::{PoseResult, Report, details_csv};
use super::output::{
    check_distinct, check_output_file, create_output_folder, frame_progress, print, print_json,
};

/// Runs the command.
pub fn run(args: &TagArgs) -> anyhow::Result<()> {
    let sequence = args.open_sequence()?;
    check_outputs(args, &sequence)?;

    let config = args.config();
    let device = args.device()?;
    let Sequence { setup, field, start, .. } = &sequence;
    let builder = Localizer::builder(&setup.camera, field).config(config).start(*start);
    let mut localizer = builder.backend(device.backend.clone()).build()?;
    let progress = frame_progress(sequence.frames.len())?;
    let frames = localize(args, &sequence, &mut localizer, &progress);
    progress.finish_and_clear();
    let frames = frames?;

    let results = if args.smooth { smoothed(&sequence, &localizer, &frames)? } else { filtered(&frames) };
    let poses: Vec<CameraPose> = results.iter().map(|result| result.pose).collect();
    if let Some(details) = &args.details {
        write_atomically(details, details_csv(&sequence, &frames, &results).as_bytes())?;
    }
    if let Some(out) = &args.out {
        let stamped = sequence.frames.iter().zip(&poses);
        let stamped: Vec<StampedPose> = stamped
            .map(|(frame, pose)| StampedPose { timestamp_s: frame.timestamp_s, pose: *pose })
            .collect();
        write_tum(out, &stamped)?;
    }
    let report = Report::new(args, &sequence, &config, &device, &frames, &poses);
    if args.json { print_json(&report) } else { print(&report.text(&sequence.name)) }
}

/// Localizes every picture, and draws it if that is requested.
fn localize(
    args: &TagArgs,
    sequence: &Sequence,
    localizer: &mut Localizer,
    progress: &ProgressBar,
) -> anyhow::Result<Vec<LocalizedFrame>> {
    let first = args.frames.map_or(0, |range| range.first);
    let (mut frames, mut path) = (Vec::with_capacity(sequence.frames.len()), Vec::new());
    let mut run = localizer.run(sequence);
    while let Some(frame) = run.next() {
        let (frame, index) = (frame?, frames.len());
        progress.inc(1);
        if let Some(truth) = sequence.frames[index].reference_pose {
            let error_cm = 100.0 * PoseError::new(frame.pose, truth).distance_m;
            progress.set_message(format!("{error_cm:.1} cm off"));
        }
        if let (Some(folder), Some(observation)) = (&args.overlay, run.observation()) {
            path.push(frame.pose);
            let file = folder.join(format!("{:06}.jpg", first + index));
            let truth = sequence.frames[index].reference_pose;
            save_image(&file, &draw(sequence, observation, &frame, truth, run.localizer(), &path)?)?;
        }
        frames.push(frame);
    }
    Ok(frames)
}

/// Returns the filter's pose of every picture, from this and earlier pictures only.
fn filtered(frames: &[LocalizedFrame]) -> Vec<PoseResult> {
    let sigmas =
        |frame: &LocalizedFrame| frame.fit.map(|fit| fit.covariance.diagonal().map(f64::sqrt).into());
    frames.iter().map(|frame| PoseResult { pose: frame.pose, sigmas: sigmas(frame) }).collect()
}

/// Returns the most probable poses of the whole recording.
fn smoothed(
    sequence: &Sequence,
    localizer: &Localizer,
    frames: &[LocalizedFrame],
) -> anyhow::Result<Vec<PoseResult>> {
    let picture = |index| sequence.load_image(index).map(Picture::from);
    let Some(smoothed) = localizer.smoother().smooth(frames, picture)? else {
        bail!(
            "{}: no picture shows enough of the lines to smooth the poses: leave out --smooth",
            sequence.folder.display()
        );
    };
    let result = |pose: &SmoothedPose| PoseResult {
        pose: pose.pose,
        sigmas: Some(pose.covariance.diagonal().map(f64::sqrt).into()),
    };
    Ok(smoothed.iter().map(result).collect())
}

/// Checks the outputs first: nobody should wait for an hour and learn then that the result cannot be written.
fn check_outputs(args: &TagArgs, sequence: &Sequence) -> anyhow::Result<()> {
    let inputs = args.inputs(sequence);
    let files: Vec<&PathBuf> = [&args.out, &args.details].into_iter().flatten().collect();
    files.iter().try_for_each(|file| check_output_file(file, &inputs))?;
    check_distinct(&files)?;
    args.overlay.as_ref().map_or(Ok(()), |folder| create_output_folder(folder, &inputs))
}

fn draw(
    sequence: &Sequence,
    observation: &Observation,
    frame: &LocalizedFrame,
    truth: Option<CameraPose>,
    localizer: &Localizer,
    path: &[CameraPose],
) -> anyhow::Result<RgbImage> {
    let border = localizer.border(observation);
    let overlay = Overlay {
        camera: &sequence.setup.camera,
        field: &sequence.field,
        pose: frame.pose,
        truth,
        border: Some(BorderOutline {
            corners_in_heading: &border.outline_in_heading,
            camera_in_heading: observation.mount.at(Pose2::default()),
        }),
        particles: &localizer.particles()?,
        path,
    };
    Ok(overlay.draw((**observation.picture.pixels()).clone()))
}
