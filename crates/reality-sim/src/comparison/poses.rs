//! Reference poses of a comparison: measured, or estimated from the pictures.

use std::sync::Arc;

use reality_sim_core::{
    pose::{CameraPose, Pose2},
    sequence::{FrameRecord, Sequence},
};
use reality_sim_db::PoseSource;
use reality_sim_gap::ReferenceSource;
use reality_sim_pipeline::{Event, FilterPlan, FoundPoses, PipelineError, Plan, PoseChoice};

/// Reference pose of each frame of a recording, and what they are known from.
#[derive(Debug, Clone)]
pub struct ReferencePoses {
    /// Pose of each frame that has one.
    pub poses: Vec<Option<CameraPose>>,
    /// Source of the poses.
    pub source: ReferenceSource,
}

impl ReferencePoses {
    /// Finds the recording's own poses, those of a file, or those of the particle filter, whose steps are reported while it works; an error of
    /// the report ends the work.
    ///
    /// The filter does not smooth, which would absorb an error of the mount pose.
    pub fn find<E: From<PipelineError>>(
        sequence: &Sequence,
        choice: PoseChoice,
        filter: FilterPlan,
        mut report: impl FnMut(&Event) -> Result<(), E>,
    ) -> Result<Self, E> {
        let filter = filter.with_smoothing(false).with_unsure(true);
        let plan = Plan::new([Arc::new(sequence.clone())], choice).with_filter(filter);
        let mut settled = Vec::new();
        let mut found = None;
        for event in plan.start() {
            let event = event?;
            report(&event)?;
            match event {
                Event::Localized { frame, .. } => settled.push(frame.settled.then(|| frame.pose.planar())),
                Event::PosesFound { poses, .. } => found = Some(poses),
                _ => {}
            }
        }
        let FoundPoses { estimates, source, .. } =
            found.unwrap_or_else(|| unreachable!("a plan ends with poses"));
        let poses = estimates.into_iter().map(|estimate| estimate.map(|estimate| estimate.pose));
        Ok(match source {
            PoseSource::GroundTruth => Self { poses: poses.collect(), source: ReferenceSource::Measured },
            PoseSource::File { .. } => estimated(sequence, poses.map(|pose| pose.map(CameraPose::planar))),
            PoseSource::Filter { .. } => estimated(sequence, settled.into_iter()),
        })
    }
}

/// Combines planar poses from the pictures with the height, pitch and roll that the robot knows. Height, pitch and roll from
/// the pictures would absorb an error of the mount pose.
fn estimated(sequence: &Sequence, planar: impl Iterator<Item = Option<Pose2>>) -> ReferencePoses {
    let height_m = sequence.setup.mount_height_m;
    let pose = |(planar, frame): (Option<Pose2>, &FrameRecord)| {
        planar.map(|planar| CameraPose::new(planar, height_m, frame.pitch_rad, frame.roll_rad))
    };
    ReferencePoses {
        poses: planar.zip(&sequence.frames).map(pose).collect(),
        source: ReferenceSource::Tagged,
    }
}
