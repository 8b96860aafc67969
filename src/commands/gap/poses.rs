//! Reference poses of a comparison: measured, or estimated from the pictures.

use std::sync::Arc;

use reality_sim::{
    CameraPose, Pose2, Sequence,
    db::PoseSource,
    gap::{
        ReferenceSource,
        report::{Finding, text::finding_place},
        shows_lines,
    },
    pipeline::{Event, FoundPoses, Plan, PoseChoice},
};

use super::GapArgs;
use crate::commands::{
    filter::{filter_plan, pose_error},
    output::StageProgress,
};

/// Reference pose of each frame, if it has one, and the poses' source.
pub struct Reference {
    pub poses: Vec<Option<CameraPose>>,
    pub source: ReferenceSource,
}

/// Returns the sequence's own poses, those of a file, or those of the particle filter.
pub fn reference(args: &GapArgs, sequence: &Sequence) -> anyhow::Result<Reference> {
    let mut settled = Vec::new();
    let mut found = None;
    let mut progress = StageProgress::default();
    for event in plan(args, sequence).start() {
        match event.map_err(pose_error).inspect_err(|_| progress.finish())? {
            Event::LocalizationStarted { frames, .. } => progress.begin(frames)?,
            Event::Localized { index, frame, .. } => {
                progress.set(index + 1);
                settled.push(frame.settled.then(|| frame.pose.planar()));
            }
            Event::PosesFound { poses, .. } => found = Some(poses),
            _ => {}
        }
    }
    progress.finish();
    let FoundPoses { estimates, source, .. } =
        found.unwrap_or_else(|| unreachable!("a plan ends with poses"));
    let poses = estimates.into_iter().map(|estimate| estimate.map(|estimate| estimate.pose));
    Ok(match source {
        PoseSource::GroundTruth => Reference { poses: poses.collect(), source: ReferenceSource::Measured },
        PoseSource::File { .. } => estimated(sequence, poses.map(|pose| pose.map(CameraPose::planar))),
        PoseSource::Filter { .. } => estimated(sequence, settled.into_iter()),
    })
}

/// Returns the reason why no pose was found, where the pictures tell it: they show no lines.
pub fn true_cause(sequence: &Sequence, error: anyhow::Error) -> anyhow::Error {
    match shows_lines(sequence) {
        Ok(false) => {
            error.context(format!("{}: {}", sequence.folder.display(), finding_place(&Finding::NoLines)))
        }
        _ => error,
    }
}

/// Plans the localization without smoothing, which would absorb an error of the mount pose.
fn plan(args: &GapArgs, sequence: &Sequence) -> Plan {
    let poses = match &args.poses {
        Some(file) => PoseChoice::File(file.clone()),
        None if args.tag => PoseChoice::Filter,
        None => PoseChoice::ReferenceElseFilter,
    };
    let filter = filter_plan(&args.backend, args.seed).with_smoothing(false).with_unsure(true);
    Plan::new([Arc::new(sequence.clone())], poses).with_filter(filter)
}

/// Combines planar poses from the pictures with the height, pitch and roll that the robot knows. Height, pitch and roll from
/// the pictures would absorb an error of the mount pose.
fn estimated(sequence: &Sequence, planar: impl Iterator<Item = Option<Pose2>>) -> Reference {
    let height_m = sequence.setup.mount_height_m;
    let pose = |(planar, frame): (Option<Pose2>, &reality_sim::sequence::FrameRecord)| {
        planar.map(|planar| CameraPose::new(planar, height_m, frame.pitch_rad, frame.roll_rad))
    };
    Reference { poses: planar.zip(&sequence.frames).map(pose).collect(), source: ReferenceSource::Tagged }
}
