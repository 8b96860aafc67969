//! Reference poses of a comparison, with progress.

use reality_sim::{
    Sequence,
    comparison::ReferencePoses,
    gap::{
        report::{Finding, text::finding_place},
        shows_lines,
    },
    pipeline::{Event, PipelineError, PoseChoice},
};

use super::GapArgs;
use crate::commands::{
    filter::{filter_plan, pose_error},
    output::StageProgress,
};

/// Finds the sequence's own poses, those of a file, or those of the particle filter.
pub fn reference(args: &GapArgs, sequence: &Sequence) -> anyhow::Result<ReferencePoses> {
    let choice = match &args.poses {
        Some(file) => PoseChoice::File(file.clone()),
        None if args.tag => PoseChoice::Filter,
        None => PoseChoice::ReferenceElseFilter,
    };
    let filter = filter_plan(&args.backend, args.seed);
    let mut progress = StageProgress::default();
    let found = ReferencePoses::find(sequence, choice, filter, |event| {
        match event {
            Event::LocalizationStarted { frames, .. } => progress.begin(*frames)?,
            Event::Localized { index, .. } => progress.set(index + 1),
            _ => {}
        }
        anyhow::Ok(())
    });
    progress.finish();
    found.map_err(|error| error.downcast::<PipelineError>().map_or_else(|other| other, pose_error))
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
