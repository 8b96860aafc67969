//! Reference poses of the frames, matched by timestamp.

use std::path::Path;

use super::{
    error::{Fault, SequenceError},
    frames::FrameRecord,
    tum::StampedPose,
};
use crate::pose::CameraPose;

/// Maximum difference of matching timestamps, seconds: both files may be rounded to milliseconds.
const TOLERANCE_S: f64 = 0.51e-3;

/// Returns for each frame the pose nearest in time, if it is near enough. A file without poses is allowed. Fails if
/// there are poses, but none belongs to any frame.
pub fn match_poses(
    path: &Path,
    mut poses: Vec<StampedPose>,
    frames: &[FrameRecord],
) -> Result<Vec<Option<CameraPose>>, SequenceError> {
    poses.sort_by(|a, b| a.timestamp_s.total_cmp(&b.timestamp_s));
    let matched: Vec<_> = frames.iter().map(|frame| nearest(&poses, frame.timestamp_s)).collect();
    match (poses.as_slice(), frames) {
        ([first_pose, ..], [first_frame, ..]) if matched.iter().all(Option::is_none) => {
            let fault = Fault::TimestampsDoNotMatch {
                first_frame_s: first_frame.timestamp_s,
                last_frame_s: frames.last().unwrap_or(first_frame).timestamp_s,
                first_pose_s: first_pose.timestamp_s,
                last_pose_s: poses.last().unwrap_or(first_pose).timestamp_s,
            };
            Err(SequenceError::of_file(path, fault))
        }
        _ => Ok(matched),
    }
}

/// Returns the pose nearest in time; the poses are sorted by time.
fn nearest(poses: &[StampedPose], timestamp_s: f64) -> Option<CameraPose> {
    let after = poses.partition_point(|pose| pose.timestamp_s < timestamp_s);
    let distance_s = |pose: &StampedPose| (pose.timestamp_s - timestamp_s).abs();
    poses[after.saturating_sub(1)..poses.len().min(after + 1)]
        .iter()
        .min_by(|a, b| distance_s(a).total_cmp(&distance_s(b)))
        .filter(|pose| distance_s(pose) <= TOLERANCE_S)
        .map(|pose| pose.pose)
}
