//! Frames a second.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

/// Time over which pictures are counted.
const SPAN: Duration = Duration::from_secs(1);

/// Times at which the pictures of the last second were finished.
#[derive(Debug, Default)]
pub struct FrameRate(VecDeque<Instant>);

impl FrameRate {
    /// Adds a picture that was finished at a time, which must not be before that of the last one.
    pub fn add(&mut self, finished: Instant) {
        self.0.retain(|earlier| finished.duration_since(*earlier) <= SPAN);
        self.0.push_back(finished);
    }

    /// Returns the number of pictures per second; `None` where there is one alone, as when nothing has changed for a while.
    pub fn per_s(&self) -> Option<f64> {
        let span = self.0.back()?.duration_since(*self.0.front()?);
        let steps = self.0.len().checked_sub(1).filter(|steps| *steps > 0)?;
        (!span.is_zero()).then(|| steps as f64 / span.as_secs_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_that_of_the_last_second_only() {
        let (mut rate, start) = (FrameRate::default(), Instant::now());
        assert_eq!(rate.per_s(), None);
        for number in 0..100 {
            rate.add(start + Duration::from_millis(100 * number));
            let per_s = rate.per_s();
            assert_eq!(per_s.map(f64::round), (number > 0).then_some(10.0), "{number}");
        }
        for number in 0..100 {
            rate.add(start + Duration::from_millis(10_000 + 25 * number));
        }
        assert!((rate.per_s().unwrap() - 40.0).abs() < 1e-9);
    }

    #[test]
    fn a_picture_alone_has_no_rate() {
        let (mut rate, start) = (FrameRate::default(), Instant::now());
        rate.add(start);
        assert_eq!(rate.per_s(), None);
        rate.add(start + Duration::from_secs(5));
        assert_eq!(rate.per_s(), None, "the one before was too long ago");
        rate.add(start + Duration::from_secs(5));
        assert_eq!(rate.per_s(), None, "no time has passed between the two");
    }
}
