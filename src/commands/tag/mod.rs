//! `reality-sim tag`: a camera pose for every picture of a sequence.

mod options;
mod report;

use std::sync::Arc;

use anyhow::bail;
use image::RgbImage;

use reality_sim::{
    CameraPose, Pose2, Sequence, StampedPose, TaggedFrame, Tagger,
    evaluation::PoseError,
    overlay::{BorderOutline, Overlay},
    refine::SmoothedPose,
    sequence::{save_image, write_atomically},
    tag::{recorded, smooth_sequence, tag_sequence},
    write_tum,
};

pub use self::options::TagArgs;
use self::report::{PoseResult, Report, details_csv};
use super::output::{check_output_file, create_output_folder, frame_progress, print, print_json};

/// Runs the command.
pub fn run(args: &TagArgs) -> anyhow::Result<()> {
    let sequence = args.open_sequence()?;
    check_outputs(args, &sequence)?;

    let config = args.config();
    let device = args.device()?;
    let Sequence { setup, field, start, .. } = &sequence;
    let mut tagger = Tagger::with_backend(&setup.camera, field, *start, config, device.backend.clone())?;
    let progress = frame_progress(sequence.frames.len())?;
    let mut path = Vec::new();
    let first = args.frames.map_or(0, |range| range.first);
    let tagged = tag_sequence(&sequence, &mut tagger, |index, frame, picture, tagger| {
        progress.inc(1);
        if let Some(truth) = sequence.frames[index].reference_pose {
            let error_cm = 100.0 * PoseError::new(frame.pose, truth).distance_m;
            progress.set_message(format!("{error_cm:.1} cm off"));
        }
        match &args.overlay {
            Some(folder) => {
                path.push(frame.pose);
                let file = folder.join(format!("{:06}.jpg", first + index));
                save_image(&file, &draw(&sequence, index, frame, picture, tagger, &path))
            }
            None => Ok(()),
        }
    })
    .inspect_err(|_| progress.finish_and_clear())?;
    progress.finish_and_clear();

    let results = if args.smooth { smoothed(&sequence, &tagger, &tagged)? } else { filtered(&tagged) };
    let poses: Vec<CameraPose> = results.iter().map(|result| result.pose).collect();
    if let Some(details) = &args.details {
        write_atomically(details, details_csv(&sequence, &tagged, &results).as_bytes())?;
    }
    if let Some(out) = &args.out {
        let stamped = sequence.frames.iter().zip(&poses);
        let stamped: Vec<StampedPose> = stamped
            .map(|(frame, pose)| StampedPose { timestamp_s: frame.timestamp_s, pose: *pose })
            .collect();
        write_tum(out, &stamped)?;
    }
    let report = Report::new(args, &sequence, &config, &device, &tagged, &poses);
    if args.json { print_json(&report) } else { print(&report.text(&sequence.name)) }
}

/// Every picture's pose as it was found when the picture came.
fn filtered(tagged: &[TaggedFrame]) -> Vec<PoseResult> {
    let sigmas = |frame: &TaggedFrame| frame.fit.map(|fit| fit.covariance.diagonal().map(f64::sqrt).into());
    tagged.iter().map(|frame| PoseResult { pose: frame.pose, sigmas: sigmas(frame) }).collect()
}

/// The most probable poses of the whole recording.
fn smoothed(sequence: &Sequence, tagger: &Tagger, tagged: &[TaggedFrame]) -> anyhow::Result<Vec<PoseResult>> {
    let Some(smoothed) = smooth_sequence(sequence, tagger, tagged)? else {
        bail!(
            "{}: no picture shows enough of the lines to smooth the poses: tag without --smooth",
            sequence.folder.display()
        );
    };
    let result = |pose: &SmoothedPose| PoseResult {
        pose: pose.pose,
        sigmas: Some(pose.covariance.diagonal().map(f64::sqrt).into()),
    };
    Ok(smoothed.iter().map(result).collect())
}

/// Whoever waited for an hour must not learn then that the result has no place.
fn check_outputs(args: &TagArgs, sequence: &Sequence) -> anyhow::Result<()> {
    let inputs = args.inputs(sequence);
    for output in [&args.out, &args.details].into_iter().flatten() {
        check_output_file(output, &inputs)?;
    }
    if let (Some(out), Some(details)) = (&args.out, &args.details)
        && out == details
    {
        bail!("{}: is given for --out and for --details: give two names", out.display());
    }
    args.overlay.as_ref().map_or(Ok(()), |folder| create_output_folder(folder, &inputs))
}

fn draw(
    sequence: &Sequence,
    index: usize,
    frame: &TaggedFrame,
    picture: &Arc<RgbImage>,
    tagger: &Tagger,
    path: &[CameraPose],
) -> RgbImage {
    let attitude = recorded(sequence, index, picture).attitude;
    let border = tagger.border(picture, attitude);
    let overlay = Overlay {
        camera: &sequence.setup.camera,
        field: &sequence.field,
        pose: frame.pose,
        truth: sequence.frames[index].reference_pose,
        border: Some(BorderOutline {
            corners_in_heading: &border.outline_in_heading,
            camera_in_heading: attitude.at(Pose2::default()),
        }),
        particles: &tagger.particles(),
        path,
    };
    overlay.draw((**picture).clone())
}
