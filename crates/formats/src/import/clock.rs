//! Jumps of the robot's clock, lost and doubled frames.

use super::shot::Shot;
use crate::log::LATEST_NS;

/// Difference between the steps of the stamps and of the log beyond which a clock has jumped, nanoseconds.
const JUMP_NS: i64 = 500_000_000;

/// Share of steps with jumps beyond which it is the log's times that mean nothing.
const MAX_SHARE: f64 = 0.25;

/// Step, in usual ones, beyond which frames have been lost.
const GAP: f64 = 1.5;

/// Corrections of a clock that was set back while the log was written.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Clock {
    /// From which time of the log on how much is added to stamps, nanoseconds.
    corrections: Vec<(i64, i64)>,
    /// Stamp minus time of the log before the first correction, nanoseconds.
    bias_ns: i64,
    /// Number of jumps.
    pub jumps: usize,
}

impl Clock {
    /// Finds the jumps in the stamps of pictures, which are in the order of the log. Where a clock was set back, later stamps are
    /// moved, so that time goes on as in the log; where it leapt ahead they stay.
    pub fn of(shots: &[Shot]) -> Self {
        let steps = shots
            .windows(2)
            .map(|pair| (pair[1].time_ns - pair[0].time_ns, pair[1].log_time_ns - pair[0].log_time_ns));
        let leaps =
            |(stamps, log): (i64, i64)| log >= 0 && stamps.saturating_sub(log).saturating_abs() > JUMP_NS;
        let leap_count = steps.clone().filter(|step| leaps(*step)).count();
        let log_is_sound = leap_count as f64 <= MAX_SHARE * shots.len().saturating_sub(1) as f64;
        let bias_ns = shots.first().map_or(0, |shot| shot.time_ns.saturating_sub(shot.log_time_ns));
        let mut clock = Self { corrections: Vec::new(), bias_ns, jumps: 0 };
        let mut added: i64 = 0;
        for (step, shot) in steps.zip(shots.iter().skip(1)) {
            let is_leap = log_is_sound && leaps(step);
            clock.jumps += usize::from(step.0 < 0 || is_leap);
            if is_leap && (step.0 < 0 || added != 0) {
                added = added.saturating_add(step.1.saturating_sub(step.0));
                clock.corrections.push((shot.log_time_ns, added));
            }
        }
        clock
    }

    /// Returns a stamp as the clock would have given it without jumps.
    pub fn corrected(&self, stamp_ns: i64, log_time_ns: i64) -> i64 {
        if self.corrections.is_empty() {
            return stamp_ns;
        }
        let after = self.corrections.partition_point(|(from, _)| *from <= log_time_ns);
        // Near a jump, a message may have been stamped before it and logged after it.
        let around = after.saturating_sub(2)..(after + 1).min(self.corrections.len());
        let none = (around.start == 0).then_some(0);
        let candidates = self.corrections[around].iter().map(|(_, added)| *added).chain(none);
        let expected = log_time_ns.saturating_add(self.bias_ns);
        let moved = candidates.map(|added| stamp_ns.saturating_add(added));
        let nearest = moved.min_by_key(|stamp| stamp.saturating_sub(expected).saturating_abs());
        nearest.unwrap_or(stamp_ns).clamp(-LATEST_NS, LATEST_NS)
    }
}

/// Counts frames that are missing between others, which are in order of time.
pub fn lost_frames(times_ns: &[i64]) -> usize {
    let mut steps: Vec<i64> = times_ns.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let in_order = steps.clone();
    steps.sort_unstable();
    let Some(&usual) = steps.get(steps.len() / 2).filter(|usual| **usual > 0) else { return 0 };
    let lost = |step: &i64| {
        let steps = *step as f64 / usual as f64;
        if steps > GAP { steps.round() as usize - 1 } else { 0 }
    };
    in_order.iter().map(lost).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shots(times_ms: &[(i64, i64)]) -> Vec<Shot> {
        let shot = |&(time, log): &(i64, i64)| Shot {
            time_ns: time * 1_000_000,
            log_time_ns: log * 1_000_000,
            number: 0,
        };
        times_ms.iter().map(shot).collect()
    }

    #[test]
    fn a_clock_that_is_set_back_goes_on_as_the_log_does() {
        let shots = shots(&[
            (0, 5),
            (100, 105),
            (200, 206),
            (-9000, 305),
            (-8900, 405),
            (-8800, 505),
            (-8700, 605),
            (-8600, 705),
        ]);
        let clock = Clock::of(&shots);
        assert_eq!(clock.jumps, 1);
        let times: Vec<i64> =
            shots.iter().map(|shot| clock.corrected(shot.time_ns, shot.log_time_ns)).collect();
        assert_eq!(times[2], 200_000_000);
        assert_eq!(times[3], 299_000_000);
        assert_eq!(times[4], 399_000_000);
        // Stamped before the jump, logged after it.
        assert_eq!(clock.corrected(250_000_000, 310_000_000), 250_000_000);
    }

    #[test]
    fn a_steady_clock_has_no_jumps_whatever_the_log_says() {
        assert_eq!(Clock::of(&shots(&[(0, 0), (1000, 1), (2000, 2), (3000, 3)])).jumps, 0);
        assert_eq!(Clock::of(&shots(&[(0, 0), (200, 200), (400, 400)])), Clock::default());
    }

    #[test]
    fn lost_frames_are_counted_by_the_usual_step() {
        assert_eq!(lost_frames(&[0, 10, 20, 50, 60]), 2);
        assert_eq!(lost_frames(&[]), 0);
        assert_eq!(lost_frames(&[1]), 0);
    }
}
