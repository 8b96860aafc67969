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

/// Longest time between two poses that are interpolated at a frame's time, seconds. Over 0.05 s, the head of a robot that
/// nods by 1.5° at 1.7 Hz leaves the straight line by 0.05°, less than motion capture is off.
const LONGEST_STEP_S: f64 = 0.05;

/// Returns the pose of each frame: the nearest in time, if its timestamp matches, else the one interpolated between two
/// poses at most 0.05 s apart. A file without poses is allowed. Fails if there are poses, but none belongs to any frame.
pub fn match_poses(
    path: &Path,
    mut poses: Vec<StampedPose>,
    frames: &[FrameRecord],
) -> Result<Vec<Option<CameraPose>>, SequenceError> {
    poses.sort_by(|a, b| a.timestamp_s.total_cmp(&b.timestamp_s));
    let pose = |frame: &FrameRecord| {
        let time_s = frame.timestamp_s;
        nearest(&poses, time_s).map(|stamped| stamped.pose).or_else(|| interpolated(&poses, time_s))
    };
    let matched: Vec<_> = frames.iter().map(pose).collect();
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

/// Returns the poses that belong to no frame, in order of time, each time once.
pub(super) fn between_frames(mut poses: Vec<StampedPose>, frames: &[FrameRecord]) -> Vec<StampedPose> {
    poses.sort_by(|a, b| a.timestamp_s.total_cmp(&b.timestamp_s));
    poses.dedup_by(|a, b| a.timestamp_s == b.timestamp_s);
    let after = |time_s: f64| frames.partition_point(|frame| frame.timestamp_s < time_s);
    let is_of_frame = |pose: &StampedPose| {
        let around = after(pose.timestamp_s).saturating_sub(1)..frames.len().min(after(pose.timestamp_s) + 1);
        frames[around].iter().any(|frame| (frame.timestamp_s - pose.timestamp_s).abs() <= TOLERANCE_S)
    };
    poses.retain(|pose| !is_of_frame(pose));
    poses
}

/// Returns the pose whose timestamp matches best; the poses are sorted by time.
fn nearest(poses: &[StampedPose], timestamp_s: f64) -> Option<&StampedPose> {
    let after = poses.partition_point(|pose| pose.timestamp_s < timestamp_s);
    let distance_s = |pose: &StampedPose| (pose.timestamp_s - timestamp_s).abs();
    poses[after.saturating_sub(1)..poses.len().min(after + 1)]
        .iter()
        .min_by(|a, b| distance_s(a).total_cmp(&distance_s(b)))
        .filter(|pose| distance_s(pose) <= TOLERANCE_S)
}

/// Interpolates between the poses before and after a time, if they are near enough: linearly, the rotation at a constant
/// rate. The poses are sorted by time.
fn interpolated(poses: &[StampedPose], timestamp_s: f64) -> Option<CameraPose> {
    let after = poses.partition_point(|pose| pose.timestamp_s < timestamp_s);
    let (before, after) = (poses.get(after.checked_sub(1)?)?, poses.get(after)?);
    let step_s = after.timestamp_s - before.timestamp_s;
    if step_s > LONGEST_STEP_S {
        return None;
    }
    let part = (timestamp_s - before.timestamp_s) / step_s;
    let position = before.pose.position_in_world().lerp(after.pose.position_in_world(), part);
    let [from, to] = [before, after].map(|stamped| stamped.pose.quaternion_world_from_camera());
    Some(CameraPose::from_world_from_camera(position, from.slerp(to, part)))
}
