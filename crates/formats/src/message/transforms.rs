//! Poses and transforms between frames.

use super::{Header, Rigid, header::frame_name};
use crate::schema::View;

/// Most poses or transforms that are read of one message.
const MAX_POSES: usize = 100_000;

/// Transform with the names of its frames.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedTransform {
    /// Time, and the frame in which the other one is given.
    pub header: Header,
    /// Frame that is given.
    pub child: String,
    /// Pose of the child in its parent.
    pub parent_from_child: Rigid,
}

/// Reads a message of transforms, or of a single one; damaged ones are left out.
pub fn transforms(message: &View<'_>) -> Option<Vec<NamedTransform>> {
    let mut read = Vec::new();
    match message.field("transforms") {
        Some(list) => list.each(&mut |one| {
            if read.len() < MAX_POSES {
                read.extend(transform(&one));
            }
        })?,
        None => read.push(transform(message)?),
    }
    Some(read)
}

fn transform(message: &View<'_>) -> Option<NamedTransform> {
    let child = message.field("child_frame_id").as_ref().and_then(frame_name)?;
    let transform = message.field("transform").unwrap_or(*message);
    Some(NamedTransform { header: Header::of(message), child, parent_from_child: Rigid::read(&transform)? })
}

/// Pose by dead reckoning.
#[derive(Debug, Clone, PartialEq)]
pub struct OdometrySample {
    /// Time, and frame of the dead reckoning.
    pub header: Header,
    /// Frame whose pose it is; empty if the message does not say.
    pub child: String,
    /// Pose of the child.
    pub odometry_from_child: Rigid,
}

/// Reads a message of odometry.
pub fn odometry(message: &View<'_>) -> Option<OdometrySample> {
    let child = message.field("child_frame_id").as_ref().and_then(frame_name).unwrap_or_default();
    let odometry_from_child = Rigid::read(&message.field("pose")?.field("pose")?)?;
    Some(OdometrySample { header: Header::of(message), child, odometry_from_child })
}

/// Reads the poses of a message: one, with covariance or without, or those of a path, each with its time.
pub fn poses(message: &View<'_>) -> Option<Vec<(Header, Rigid)>> {
    if let Some(path) = message.field("poses") {
        let mut read = Vec::new();
        path.each(&mut |one| {
            let pose = one.field("pose").as_ref().and_then(Rigid::read);
            if let Some(pose) = pose.filter(|_| read.len() < MAX_POSES) {
                read.push((Header::of(&one), pose));
            }
        })?;
        return Some(read);
    }
    let pose = message.field("pose")?;
    let pose = pose.field("pose").unwrap_or(pose);
    Some(vec![(Header::of(message), Rigid::read(&pose)?)])
}
