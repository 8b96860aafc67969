//! The reference poses of a comparison: measured, or found in the pictures.

use anyhow::bail;

use reality_sim::{
    CameraPose, Pose2, Sequence,
    gap::ReferenceSource,
    sequence::{match_poses, read_tum},
};

use super::GapArgs;
use crate::commands::filter;

/// One pose a frame, where there is one, and where they come from.
pub struct Reference {
    pub poses: Vec<Option<CameraPose>>,
    pub source: ReferenceSource,
}

/// The sequence's own, those of a file, or those of the particle filter.
pub fn reference(args: &GapArgs, sequence: &Sequence) -> anyhow::Result<Reference> {
    if let Some(file) = &args.poses {
        let poses = match_poses(file, read_tum(file)?, &sequence.frames)?;
        if poses.iter().all(Option::is_none) {
            bail!("{}: holds no poses: make it with `tag --out`", file.display());
        }
        return Ok(tagged(sequence, poses.into_iter().map(|pose| pose.map(CameraPose::planar))));
    }
    if !args.tag && sequence.has_reference_poses() {
        return Ok(Reference {
            poses: sequence.reference_poses().collect(),
            source: ReferenceSource::Measured,
        });
    }
    by_filter(args, sequence)
}

fn by_filter(args: &GapArgs, sequence: &Sequence) -> anyhow::Result<Reference> {
    let frames = filter::tagged(sequence, &args.backend, args.seed)?.frames;
    let planar = frames.iter().map(|frame| frame.settled.then(|| frame.pose.planar()));
    Ok(tagged(sequence, planar))
}

/// Places found in the pictures, with the height, pitch and roll that the robot knows of itself: those of the pictures
/// would have taken in whatever is wrong with the mount.
fn tagged(sequence: &Sequence, planar: impl Iterator<Item = Option<Pose2>>) -> Reference {
    let height_m = sequence.setup.mount_height_m;
    let pose = |(planar, frame): (Option<Pose2>, &reality_sim::sequence::FrameRecord)| {
        planar.map(|planar| CameraPose::new(planar, height_m, frame.pitch_rad, frame.roll_rad))
    };
    Reference { poses: planar.zip(&sequence.frames).map(pose).collect(), source: ReferenceSource::Tagged }
}
