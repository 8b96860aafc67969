//! Poses of a recording: from a file, from the recording itself, or from the filter.

use std::{path::Path, sync::Arc};

use reality_sim_calibration::assess_frames;
use reality_sim_core::{
    localization::{LocalizedFrame, Localizer, Picture, Run},
    pose::CameraPose,
    refine::SmoothedPose,
    sequence::{Sequence, match_poses, read_tum},
};
use reality_sim_db::{PoseEstimate, PoseSource};

use crate::{
    error::PipelineError,
    event::{Event, FoundPoses},
    outbox::{Outbox, Stop},
    plan::{Device, FilterPlan, HoldBack, Plan, PoseChoice},
};

/// Finder of the poses of recordings, one after the other.
pub(crate) struct PoseFinder<'a> {
    plan: &'a Plan,
    outbox: &'a Outbox,
    /// Opened when it is first needed.
    device: Option<Device>,
}

impl<'a> PoseFinder<'a> {
    /// Makes a finder for the recordings of a plan.
    pub fn new(plan: &'a Plan, outbox: &'a Outbox) -> Self {
        Self { plan, outbox, device: None }
    }

    /// Finds the poses of the recording with this number.
    pub fn find(&mut self, recording: usize) -> Result<FoundPoses, Stop> {
        let sequence = self.plan.recordings[recording].clone();
        let (mut estimates, source) = match &self.plan.poses {
            PoseChoice::File(file) => from_file(file, &sequence)?,
            PoseChoice::ReferenceElseFilter if sequence.has_reference_poses() => {
                (estimates(sequence.reference_poses()), PoseSource::GroundTruth)
            }
            PoseChoice::ReferenceElseFilter | PoseChoice::Filter => self.by_filter(recording, &sequence)?,
        };
        let held_back = self.plan.hold_back.map_or_else(Vec::new, |rule| hold_back(rule, &mut estimates));
        Ok(FoundPoses { estimates, held_back, source })
    }

    fn by_filter(
        &mut self,
        recording: usize,
        sequence: &Arc<Sequence>,
    ) -> Result<(Vec<Option<PoseEstimate>>, PoseSource), Stop> {
        let FilterPlan { config, smooths, keeps_unsure, program, .. } = &self.plan.filter;
        sequence.check_pictures()?;
        let device = self.device()?;
        let builder = Localizer::builder(&sequence.setup.camera, &sequence.field)
            .start(sequence.start)
            .calibration(sequence.calibration.clone());
        let localizer = builder.config(*config).backend(device.backend).build()?;
        let (localizer, mut frames) = self.localize(recording, sequence, localizer)?;
        assess_frames(sequence, &mut frames).map_err(|error| PipelineError::from(*error))?;
        let smoothed = if *smooths { self.smooth(recording, sequence, &localizer, &frames)? } else { None };
        let estimates = PoseEstimate::of_localized(&frames, smoothed.as_deref(), *keeps_unsure);
        if estimates.iter().all(Option::is_none) {
            return Err(PipelineError::NothingSure { folder: sequence.folder.clone() }.into());
        }
        let source = PoseSource::of_filter(program, config, &device.name, smoothed.is_some());
        Ok((estimates, source))
    }

    fn device(&mut self) -> Result<Device, PipelineError> {
        if let Some(device) = &self.device {
            return Ok(device.clone());
        }
        Ok(self.device.insert((self.plan.filter.device)()?).clone())
    }

    fn localize(
        &self,
        recording: usize,
        sequence: &Arc<Sequence>,
        localizer: Localizer,
    ) -> Result<(Localizer, Vec<LocalizedFrame>), Stop> {
        let of = sequence.frames.len();
        self.outbox.send(Event::LocalizationStarted { recording, frames: of })?;
        let mut frames = Vec::with_capacity(of);
        let mut run = Run::new(localizer, sequence.clone());
        for frame in run.by_ref() {
            let frame = frame?;
            let event =
                Event::Localized { recording, index: frames.len(), of, frame: Box::new(frame.clone()) };
            self.outbox.send(event)?;
            frames.push(frame);
        }
        Ok((run.into_localizer(), frames))
    }

    fn smooth(
        &self,
        recording: usize,
        sequence: &Sequence,
        localizer: &Localizer,
        frames: &[LocalizedFrame],
    ) -> Result<Option<Vec<SmoothedPose>>, Stop> {
        let smoother = localizer.smoother();
        let Some(mut smoothing) = smoother.begin(frames) else { return Ok(None) };
        let unexplained = smoothing.unexplained().to_vec();
        for (done, &index) in unexplained.iter().enumerate() {
            let picture = Picture::from(sequence.load_image(index)?);
            smoother.revisit(&mut smoothing, index, &picture);
            self.outbox.send(Event::Revisited { recording, done: done + 1, of: unexplained.len() })?;
        }
        Ok(smoother.finish(&smoothing))
    }
}

fn from_file(
    file: &Path,
    sequence: &Sequence,
) -> Result<(Vec<Option<PoseEstimate>>, PoseSource), PipelineError> {
    let poses = match_poses(file, read_tum(file)?, &sequence.frames)?;
    if poses.iter().all(Option::is_none) {
        return Err(PipelineError::NoPoses { file: file.to_path_buf() });
    }
    let name = file.display().to_string();
    Ok((estimates(poses.into_iter()), PoseSource::File { name }))
}

fn estimates(poses: impl Iterator<Item = Option<CameraPose>>) -> Vec<Option<PoseEstimate>> {
    poses.map(|pose| pose.map(PoseEstimate::from)).collect()
}

/// Removes some of the poses: their pictures serve as ground truth for reconstructed ones.
fn hold_back(rule: HoldBack, estimates: &mut [Option<PoseEstimate>]) -> Vec<(usize, CameraPose)> {
    let known: Vec<usize> = (0..estimates.len()).filter(|&frame| estimates[frame].is_some()).collect();
    if known.len() < rule.at_least {
        return Vec::new();
    }
    let held = known.iter().skip(rule.every / 2).step_by(rule.every.max(1));
    held.filter_map(|&frame| Some((frame, estimates[frame].take()?.pose))).collect()
}
