//! What was found so far, by frame: for the curves and the paths.

use glam::DVec2;
use reality_sim_core::{pose::Pose2, sequence::Sequence};

use super::frame::Record;

/// A record for every frame that was seen.
#[derive(Debug, Default)]
pub struct History {
    records: Vec<Option<Record>>,
}

impl History {
    /// Nothing seen yet of so many frames.
    pub fn new(frames: usize) -> Self {
        Self { records: vec![None; frames] }
    }

    /// Keeps a record, in place of an older one of the same frame.
    pub fn add(&mut self, record: Record) {
        if let Some(slot) = self.records.get_mut(record.index) {
            *slot = Some(record);
        }
    }

    /// What was found, in the order of the frames.
    pub fn records(&self) -> impl Iterator<Item = &Record> {
        self.records.iter().flatten()
    }

    /// Places found up to a frame.
    pub fn path(&self, last: usize) -> impl Iterator<Item = DVec2> {
        let seen = self.records.iter().take(last + 1).flatten();
        seen.map(|record| record.pose.planar().position_in_world())
    }
}

/// True places up to a frame.
pub fn true_path(sequence: &Sequence, last: usize) -> impl Iterator<Item = DVec2> {
    let known = sequence.groundtruth.iter().take(last + 1).flatten();
    known.map(|pose| pose.planar().position_in_world())
}

/// Where the odometry alone leads from a pose at the first frame, up to a frame. Empty where the recording has none.
pub fn odometry_path(sequence: &Sequence, start: Pose2, last: usize) -> Vec<Pose2> {
    let first = sequence.frames.first().and_then(|frame| frame.odometry);
    let readings = sequence.frames.iter().take(last + 1).map_while(|frame| frame.odometry);
    first.map_or_else(Vec::new, |first| readings.map(|now| start.moved(first.motion_to(now))).collect())
}
