//! Times that the window's own thread takes for a frame.

use std::collections::VecDeque;

/// Number of frames kept.
const KEPT: usize = 300;

/// Times of the last frames.
#[derive(Debug, Default)]
pub struct FrameTimes(VecDeque<f32>);

impl FrameTimes {
    /// Adds the time of a frame, milliseconds.
    pub fn add(&mut self, milliseconds: f32) {
        if self.0.len() == KEPT {
            self.0.pop_front();
        }
        self.0.push_back(milliseconds);
    }

    /// Returns the time of the last frame, milliseconds.
    pub fn last(&self) -> Option<f32> {
        self.0.back().copied()
    }

    /// Returns the median, the 95 % quantile and the maximum in words.
    pub fn summary(&self) -> String {
        let mut sorted: Vec<f32> = self.0.iter().copied().collect();
        sorted.sort_by(f32::total_cmp);
        let at = |share: f32| sorted[((sorted.len() - 1) as f32 * share).round() as usize];
        if sorted.is_empty() {
            return String::new();
        }
        format!(
            "Time of the window's own thread for a frame, the last {}:\nmedian {:.1} ms, 95 % below {:.1} ms, slowest {:.1} ms",
            sorted.len(),
            at(0.5),
            at(0.95),
            at(1.0)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_summary_is_of_the_last_frames_only() {
        let mut times = FrameTimes::default();
        assert_eq!((times.last(), times.summary().as_str()), (None, ""));
        times.add(1000.0);
        (0..KEPT).for_each(|frame| times.add(frame as f32));
        assert_eq!(times.last(), Some(KEPT as f32 - 1.0));
        let summary = times.summary();
        assert!(summary.contains("last 300:"), "{summary}");
        assert!(summary.contains("median 150.0 ms, 95 % below 284.0 ms, slowest 299.0 ms"), "{summary}");
    }
}
