//! Results so far, by frame, for the curves and the paths. Long ones are thinned, so that the cost of a window frame does
//! not depend on the length of the recording.

use glam::DVec2;
use reality_sim_core::{
    pose::Pose2,
    sequence::{FrameRecord, Sequence},
};

use super::frame::Record;

/// Largest number of points of a curve or a path: more cannot be distinguished.
pub const MOST_POINTS: usize = 1000;

/// Record for every frame that was seen.
#[derive(Debug, Default)]
pub struct History {
    /// Records in the order of the frames.
    records: Vec<Record>,
    /// Frames among them at which the field was searched.
    searched: Vec<usize>,
    /// Frames at which settings were changed.
    changes: Vec<usize>,
}

/// Every n-th element of a list.
pub struct Thinned<T> {
    pub points: Vec<T>,
    /// Steps of the list between two points.
    pub step: usize,
}

/// Thins a list, keeping its last element.
fn thin<T, U>(list: &[T], point: impl Fn(&T) -> U) -> Thinned<U> {
    let step = list.len().div_ceil(MOST_POINTS).max(1);
    let mut points: Vec<U> = list.iter().step_by(step).map(&point).collect();
    if !list.len().saturating_sub(1).is_multiple_of(step) {
        points.extend(list.last().map(point));
    }
    Thinned { points, step }
}

impl History {
    /// Adds a record, replacing an older one of the same frame.
    pub fn add(&mut self, record: Record) {
        match self.records.binary_search_by_key(&record.index, |record| record.index) {
            Ok(place) => self.records[place] = record,
            Err(place) => self.records.insert(place, record),
        }
        match (self.searched.binary_search(&record.index), record.searched) {
            (Ok(place), false) => drop(self.searched.remove(place)),
            (Err(place), true) => self.searched.insert(place, record.index),
            _ => {}
        }
    }

    /// Records that settings were changed at a frame.
    pub fn mark_change(&mut self, index: usize) {
        if let Err(place) = self.changes.binary_search(&index) {
            self.changes.insert(place, index);
        }
    }

    /// Returns the frames at which settings were changed.
    pub fn changes(&self) -> &[usize] {
        &self.changes
    }

    /// Returns the record of a frame.
    pub fn get(&self, index: usize) -> Option<&Record> {
        let place = self.records.binary_search_by_key(&index, |record| record.index).ok()?;
        self.records.get(place)
    }

    /// Returns the records in the order of the frames.
    pub fn records(&self) -> Thinned<Record> {
        thin(&self.records, |record| *record)
    }

    /// Returns the records at which the field was searched.
    pub fn searched(&self) -> Vec<Record> {
        thin(&self.searched, |index| self.get(*index).copied()).points.into_iter().flatten().collect()
    }

    /// Returns the estimated positions up to a frame.
    pub fn path(&self, last: usize) -> Thinned<DVec2> {
        let end = self.records.partition_point(|record| record.index <= last);
        thin(&self.records[..end], |record| record.pose.planar().position_in_world())
    }

    /// Returns the first frame seen with its pose, from which the odometry path starts.
    pub fn first(&self) -> Option<(usize, Pose2)> {
        self.records.first().map(|record| (record.index, record.pose.planar()))
    }
}

/// Returns the true positions up to a frame.
pub fn true_path(sequence: &Sequence, last: usize) -> Thinned<DVec2> {
    let frames = &sequence.frames[..=last.min(sequence.frames.len() - 1)];
    let position = |frame: &FrameRecord| Some(frame.reference_pose?.planar().position_in_world());
    let Thinned { points, step } = thin(frames, position);
    Thinned { points: points.into_iter().flatten().collect(), step }
}

/// Returns the path of the odometry alone from a frame with a known pose up to a frame, without frames that have no
/// odometry.
pub fn odometry_path(sequence: &Sequence, (known, pose): (usize, Pose2), last: usize) -> Thinned<DVec2> {
    let odometry = |index: usize| sequence.frames[index].odometry;
    let indices: Vec<usize> = (known..=last).collect();
    let place =
        |index: &usize| Some(pose.moved(odometry(known)?.motion_to(odometry(*index)?)).position_in_world());
    let Thinned { points, step } = thin(&indices, place);
    Thinned { points: points.into_iter().flatten().collect(), step }
}

#[cfg(test)]
mod tests {
    use reality_sim_core::pose::CameraPose;

    use super::*;

    fn record(index: usize, searched: bool) -> Record {
        Record {
            index,
            pose: CameraPose { x_m: index as f64, ..CameraPose::default() },
            error_m: None,
            error_yaw_rad: None,
            effective_sample_size: 1.0,
            spread_m: 0.1,
            particles: 1,
            milliseconds: 1.0,
            sure: true,
            searched,
        }
    }

    #[test]
    fn frames_shown_in_any_order_are_listed_once_in_theirs() {
        let mut history = History::default();
        for index in [5, 2, 9, 2, 7] {
            history.add(record(index, index == 9));
        }
        let indices: Vec<usize> = history.records().points.iter().map(|record| record.index).collect();
        assert_eq!(indices, [2, 5, 7, 9]);
        assert_eq!(history.searched().len(), 1);
        history.add(record(9, false));
        assert!(history.searched().is_empty());
        assert_eq!(history.path(7).points, [2.0, 5.0, 7.0].map(|x| DVec2::new(x, 0.0)));
        assert_eq!(history.first().map(|(index, _)| index), Some(2));
        assert!(history.get(5).is_some() && history.get(6).is_none());
    }

    #[test]
    fn long_lists_are_thinned_and_keep_their_ends() {
        for count in [999, 1000, 1001, 2000, 2001, 20_000, 20_001, 20_017] {
            let mut history = History::default();
            (0..count).for_each(|index| history.add(record(index, false)));
            let Thinned { points, step } = history.records();
            assert!(points.len() <= MOST_POINTS + 1, "{count}: {}", points.len());
            assert_eq!((points[0].index, points[points.len() - 1].index), (0, count - 1), "{count}");
            assert!(points.windows(2).all(|pair| pair[1].index > pair[0].index));
            assert!(points.windows(2).all(|pair| pair[1].index - pair[0].index <= step));
        }
    }
}
