//! Values over time, and what they are between two messages.

use glam::{DQuat, DVec3};

use super::clock::Clock;
use crate::message::{Attitude, Rigid};

/// Longest time between two samples between which is interpolated, nanoseconds.
const LONGEST_STEP_NS: i64 = 250_000_000;

/// Most by which a step may be longer than the usual one if no sample is missing in between.
const LONGEST_STEP: f64 = 1.5;

/// Value that can be interpolated.
pub trait Blend: Copy {
    /// Returns the value at a part of the way from this one to another.
    fn blend(self, to: Self, part: f64) -> Self;
}

impl Blend for f64 {
    fn blend(self, to: Self, part: f64) -> Self {
        self + part * (to - self)
    }
}

impl Blend for DQuat {
    fn blend(self, to: Self, part: f64) -> Self {
        self.slerp(to, part)
    }
}

impl Blend for Rigid {
    fn blend(self, to: Self, part: f64) -> Self {
        let translation: DVec3 = self.translation.lerp(to.translation, part);
        Self::new(self.rotation.slerp(to.rotation, part), translation)
    }
}

impl Blend for Attitude {
    fn blend(self, to: Self, part: f64) -> Self {
        Self { level_from_body: self.level_from_body.slerp(to.level_from_body, part) }
    }
}

/// Value at a time.
#[derive(Debug, Clone, Copy)]
pub struct Sample<T> {
    /// Time of the value by the robot, nanoseconds.
    pub time_ns: i64,
    /// Time at which it was logged, nanoseconds.
    pub log_time_ns: i64,
    /// Value.
    pub value: T,
}

/// Values over time.
#[derive(Debug, Clone)]
pub struct Series<T> {
    samples: Vec<Sample<T>>,
    usual_step_ns: i64,
}

impl<T> Default for Series<T> {
    fn default() -> Self {
        Self { samples: Vec::new(), usual_step_ns: 0 }
    }
}

impl<T: Blend> Series<T> {
    /// Adds a value.
    pub fn push(&mut self, sample: Sample<T>) {
        self.samples.push(sample);
    }

    /// Puts the values in order of time, which jumps of the clock have disturbed, each time once.
    pub fn finish(&mut self, clock: &Clock) {
        for sample in &mut self.samples {
            sample.time_ns = clock.corrected(sample.time_ns, sample.log_time_ns);
        }
        self.samples.sort_by_key(|sample| sample.time_ns);
        self.samples.dedup_by_key(|sample| sample.time_ns);
        let mut steps: Vec<i64> =
            self.samples.windows(2).map(|pair| pair[1].time_ns - pair[0].time_ns).collect();
        steps.sort_unstable();
        self.usual_step_ns = steps.get(steps.len() / 2).copied().unwrap_or(0);
    }

    /// Returns whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// Returns the values in order of time.
    pub fn samples(&self) -> &[Sample<T>] {
        &self.samples
    }

    /// Returns the value at a time: that of this time, or interpolated between two neighbours of which none is missing in
    /// between, or the nearest, if it is at most the tolerance away, nanoseconds.
    pub fn at(&self, time_ns: i64, tolerance_ns: i64) -> Option<T> {
        let after = self.samples.partition_point(|sample| sample.time_ns < time_ns);
        let next = self.samples.get(after);
        if let Some(exact) = next.filter(|next| next.time_ns == time_ns) {
            return Some(exact.value);
        }
        let previous = after.checked_sub(1).and_then(|before| self.samples.get(before));
        if let (Some(previous), Some(next)) = (previous, next) {
            let step_ns = next.time_ns - previous.time_ns;
            let is_near = [previous, next].iter().any(|end| (end.time_ns - time_ns).abs() <= tolerance_ns);
            let is_whole = step_ns as f64 <= LONGEST_STEP * self.usual_step_ns as f64;
            if step_ns <= LONGEST_STEP_NS && (is_whole || is_near) {
                let part = (time_ns - previous.time_ns) as f64 / step_ns as f64;
                return Some(previous.value.blend(next.value, part));
            }
        }
        let distance = |sample: &&Sample<T>| (sample.time_ns - time_ns).abs();
        let nearest = [previous, next].into_iter().flatten().min_by_key(distance);
        nearest.filter(|sample| distance(sample) <= tolerance_ns).map(|sample| sample.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(times_ms: &[i64]) -> Series<f64> {
        let mut series = Series::default();
        for &time in times_ms {
            series.push(Sample { time_ns: time * 1_000_000, log_time_ns: 0, value: time as f64 });
        }
        series.finish(&Clock::default());
        series
    }

    #[test]
    fn values_are_interpolated_where_none_is_missing() {
        let series = series(&[0, 100, 200, 300, 500, 600]);
        let at = |time_ms: f64| series.at((time_ms * 1e6) as i64, 20_000_000);
        assert_eq!(at(100.0), Some(100.0));
        assert!((at(150.0).unwrap() - 150.0).abs() < 1e-9);
        assert_eq!(at(400.0), None);
        assert!((at(310.0).unwrap() - 310.0).abs() < 1e-9);
        assert_eq!(at(615.0), Some(600.0));
        assert_eq!(at(650.0), None);
    }
}
