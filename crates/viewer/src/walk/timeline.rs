//! Playback times of a recording: long pauses are shortened.

use reality_sim_core::sequence::Sequence;

/// Longest pause during playback, seconds.
const LONGEST_PAUSE_S: f64 = 2.0;

/// Playback time of each frame, seconds after the first.
#[derive(Debug, Clone)]
pub struct Timeline {
    played_s: Vec<f64>,
}

impl Timeline {
    /// Makes the timeline of a recording with at least one frame.
    pub fn new(sequence: &Sequence) -> Self {
        let mut now_s = 0.0;
        let pauses = sequence.frames.windows(2).map(|pair| pair[1].timestamp_s - pair[0].timestamp_s);
        let later = pauses.map(|pause_s| {
            now_s += pause_s.clamp(0.0, LONGEST_PAUSE_S);
            now_s
        });
        let played_s = std::iter::once(0.0).chain(later).collect();
        Self { played_s }
    }

    /// Returns the playback time of a frame.
    pub fn at_s(&self, index: usize) -> f64 {
        self.played_s[index]
    }

    /// Returns the playback time of the last frame.
    pub fn end_s(&self) -> f64 {
        self.played_s[self.played_s.len() - 1]
    }

    /// Returns how long a frame is shown; 0 for the last one.
    pub fn pause_after_s(&self, index: usize) -> f64 {
        self.played_s.get(index + 1).map_or(0.0, |next_s| next_s - self.played_s[index])
    }

    /// Returns the frame nearest to a time.
    pub fn frame_at(&self, time_s: f64) -> usize {
        let after = self.played_s.partition_point(|played_s| *played_s < time_s);
        let before = after.saturating_sub(1);
        match self.played_s.get(after) {
            Some(after_s) if after_s - time_s < time_s - self.played_s[before] => after,
            Some(_) if before == after => after,
            _ => before,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn timeline(times_s: &[f64]) -> Timeline {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/walk");
        let mut sequence = Sequence::open(&folder).unwrap();
        sequence.frames.truncate(times_s.len());
        sequence.frames.iter_mut().zip(times_s).for_each(|(frame, &time_s)| frame.timestamp_s = time_s);
        Timeline::new(&sequence)
    }

    #[test]
    fn long_pauses_are_cut_short_and_short_ones_are_as_recorded() {
        let timeline = timeline(&[100.0, 100.5, 5000.0, 5000.25]);
        let played_s: Vec<f64> = (0..4).map(|index| timeline.at_s(index)).collect();
        assert_eq!(played_s, [0.0, 0.5, 2.5, 2.75]);
        assert_eq!(timeline.end_s(), 2.75);
        assert_eq!([0, 1, 3].map(|index| timeline.pause_after_s(index)), [0.5, 2.0, 0.0]);
    }

    #[test]
    fn every_time_has_its_nearest_frame() {
        let timeline = timeline(&[0.0, 1.0, 2.0]);
        let found = [-5.0, 0.0, 0.4, 0.6, 1.0, 1.9, 2.0, 99.0].map(|time_s| timeline.frame_at(time_s));
        assert_eq!(found, [0, 0, 0, 1, 1, 2, 2, 2]);
        assert_eq!(self::timeline(&[7.0]).frame_at(3.0), 0);
    }
}
