//! `reality-sim tag`: finds the camera pose of every picture of a sequence.

mod options;
mod report;
mod watch;

use std::path::PathBuf;

use anyhow::{Context, bail};
use image::RgbImage;
use indicatif::ProgressBar;

use reality_sim::{
    CameraPose, LocalizedFrame, Localizer, Observation, Pose2, Sequence, StampedPose,
    calibration::{Assessment, assess_frames},
    evaluation::PoseError,
    overlay::{BorderOutline, Overlay},
    quality::LineAgreement,
    sequence::{counted, save_image},
    tagging::{LinesOfPictures, TaggedPose},
    write_tum,
};

pub use self::options::{TagArgs, field_by_name};
use self::{
    report::{Report, details_csv},
    watch::{Watchers, is_log, write_details, write_log},
};
use super::{
    input::Recording,
    model_file::Use,
    output::{check_distinct, check_output_file, frame_progress, print, print_json},
    output_folder::OutputFolder,
};

/// Runs the command.
pub fn run(args: &TagArgs) -> anyhow::Result<()> {
    let model = args.model.read()?;
    let recording = Recording::open(&args.sequence, args.field.as_deref())?;
    let mut sequence = args.open_sequence(recording.folder(), model.as_ref())?;
    let overlays = check_outputs(args, &sequence)?;
    sequence.check_pictures()?;

    let config = args.config();
    let device = args.device()?;
    let builder = Localizer::builder(&sequence.setup.camera, &sequence.field);
    let builder = builder
        .config(config)
        .start(sequence.start)
        .calibration(sequence.calibration.clone())
        .backend(device.backend.clone());
    let mut localizer = builder.build()?;
    let wanted = sequence.frames.len();
    let mut watchers = Watchers::start(args)?;
    let progress = frame_progress(wanted)?;
    let (mut frames, mut lines) = (Vec::with_capacity(wanted), LinesOfPictures::new(&sequence, args.smooth));
    let outputs = (&progress, overlays.as_ref(), &mut watchers);
    let found = (&mut frames, &mut lines);
    let localized = localize(args, &sequence, &mut localizer, outputs, found);
    progress.finish_and_clear();
    // What was found before a picture failed is written all the same.
    sequence.frames.truncate(frames.len());
    if frames.is_empty() {
        return localized;
    }

    let assessed = assessed(args, &sequence, &mut frames)?;
    let results =
        if args.smooth { smoothed(&sequence, &localizer, &frames)? } else { TaggedPose::filtered(&frames) };
    let poses: Vec<CameraPose> = results.iter().map(|result| result.pose).collect();
    let lines = lines.agreement(&poses);
    watchers.finish()?;
    write(args, &sequence, (&frames, &lines), &results)?;
    localized.with_context(|| match args.out.as_ref().or(args.details.as_ref()) {
        Some(file) => {
            format!("{}: holds the first {} of {}", file.display(), frames.len(), counted(wanted, "frame"))
        }
        None => format!("frame {}", frames.len()),
    })?;
    let corrections = model.map(|model| model.words(&sequence.setup, &sequence.field, Use::Recording));
    let report =
        Report::new(args, &sequence, &config, &device, &frames, &poses).with_corrections(corrections);
    let report = report.with_lines(&frames, &lines).with_calibration(&sequence, assessed.as_ref());
    if args.json { print_json(&report) } else { print(&report.text(&sequence.name)) }
}

/// Writes the files that were asked for.
fn write(
    args: &TagArgs,
    sequence: &Sequence,
    (frames, lines): (&[LocalizedFrame], &[LineAgreement]),
    results: &[TaggedPose],
) -> anyhow::Result<()> {
    let poses: Vec<CameraPose> = results.iter().map(|result| result.pose).collect();
    if let Some(details) = &args.details {
        write_details(details, &details_csv(sequence, frames, results, lines), sequence, results)?;
    }
    match &args.out {
        Some(log) if is_log(log) && args.smooth => write_log(log, sequence, &poses)?,
        // The frames are in the log already.
        Some(log) if is_log(log) => {}
        Some(out) => {
            let stamped = sequence.frames.iter().zip(&poses);
            let stamped: Vec<StampedPose> = stamped
                .map(|(frame, pose)| StampedPose { timestamp_s: frame.timestamp_s, pose: *pose })
                .collect();
            write_tum(out, &stamped)?;
        }
        None => {}
    }
    Ok(())
}

/// Localizes every picture, and draws it if that is requested. After an error `frames` holds those before it.
fn localize(
    args: &TagArgs,
    sequence: &Sequence,
    localizer: &mut Localizer,
    (progress, overlays, watchers): (&ProgressBar, Option<&OutputFolder>, &mut Watchers),
    (frames, lines): (&mut Vec<LocalizedFrame>, &mut LinesOfPictures),
) -> anyhow::Result<()> {
    let first = args.frames.map_or(0, |range| range.first);
    let mut path = Vec::new();
    let mut run = localizer.run(sequence);
    while let Some(frame) = run.next() {
        let (frame, index) = (frame?, frames.len());
        progress.inc(1);
        if let Some(truth) = sequence.frames[index].reference_pose {
            let error_cm = 100.0 * PoseError::new(frame.pose, truth).distance_m;
            progress.set_message(format!("{error_cm:.1} cm off"));
        }
        if let (Some(folder), Some(observation)) = (overlays, run.observation()) {
            path.push(frame.pose);
            let file = folder.file(format!("{:06}.jpg", first + index))?;
            let truth = sequence.frames[index].reference_pose;
            save_image(&file, &draw(sequence, observation, &frame, truth, run.localizer(), &path)?)?;
        }
        lines.add(run.localizer(), frame.pose);
        watchers.show(sequence, index, &frame, run.localizer())?;
        frames.push(frame);
    }
    Ok(())
}

/// Makes what the calibration is worth a part of the covariances, if they are asked for: it takes looking at some pictures once more.
fn assessed(
    args: &TagArgs,
    sequence: &Sequence,
    frames: &mut [LocalizedFrame],
) -> anyhow::Result<Option<Assessment>> {
    Ok(if args.details.is_some() { assess_frames(sequence, frames)? } else { None })
}

/// Returns the most probable poses of the whole recording.
fn smoothed(
    sequence: &Sequence,
    localizer: &Localizer,
    frames: &[LocalizedFrame],
) -> anyhow::Result<Vec<TaggedPose>> {
    let Some(smoothed) = TaggedPose::smoothed(sequence, localizer, frames)? else {
        bail!(
            "{}: no picture shows enough of the lines to smooth the poses: leave out --smooth",
            sequence.folder.display()
        );
    };
    Ok(smoothed)
}

/// Checks the outputs first: nobody should wait for an hour and learn then that the result cannot be written.
fn check_outputs(args: &TagArgs, sequence: &Sequence) -> anyhow::Result<Option<OutputFolder>> {
    let inputs = args.inputs(sequence);
    let files: Vec<&PathBuf> = [&args.out, &args.details].into_iter().flatten().collect();
    files.iter().try_for_each(|file| check_output_file(file, &inputs))?;
    check_distinct(&files)?;
    args.overlay.as_ref().map(|folder| OutputFolder::check(folder, &inputs)).transpose()
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
