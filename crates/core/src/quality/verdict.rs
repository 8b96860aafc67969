//! Whether the poses of a recording are good, by their agreement with the pictures alone: the thresholds, and what they were made of.
//!
//! JaC@5 at the reference poses and at poses that are wrong by a known amount (`examples/line_quality.rs` measures it). The thresholds were
//! chosen by the first four rows; the others were kept apart, and were measured with the finished rule.
//!
//! | recording | right | 2 cm | 5 cm | 10 cm | 20 cm | yaw 2° | pitch 2° | focal length 2 % | lost |
//! |---|---|---|---|---|---|---|---|---|---|
//! | demonstration walk | 0.99 | 0.96 | 0.76 | 0.49 | 0.24 | 0.96 | 0.54 | 0.74 | 0.01 |
//! | another ray-traced walk, each tenth picture | 1.00 | 0.97 | 0.83 | 0.57 | 0.35 | 0.90 | 0.49 | 0.70 | 0.01 |
//! | real fisheye, Middle Size League | 0.91 | 0.91 | 0.84 | 0.73 | 0.54 | 0.76 | 0.02 | 0.89 | 0.01 |
//! | real NAO, top camera | 0.97 | 0.88 | 0.71 | 0.48 | 0.22 | 0.55 | 0.04 | 0.91 | 0.01 |
//! | real NAO, bottom camera | 0.92 | 0.77 | 0.63 | 0.45 | 0.23 | 0.57 | 0.04 | 0.87 | 0.01 |
//! | `assets/pitch`, by another renderer | 1.00 | 0.85 | 0.67 | 0.46 | 0.26 | 0.70 | 0.54 | 0.87 | 0.01 |
//! | a third hall and lens, ray-traced | 0.99 | 0.90 | 0.71 | 0.50 | 0.29 | 0.79 | 0.42 | 0.53 | 0.01 |
//! | a fourth hall and lens, ray-traced | 0.99 | 0.94 | 0.81 | 0.53 | 0.26 | 0.83 | 0.46 | 0.69 | 0.01 |
//! | single pictures at random poses, ray-traced | 1.00 | 0.95 | 0.76 | 0.54 | 0.32 | 0.84 | 0.51 | 0.75 | 0.01 |
//!
//! So right poses, and all but one recording's at 2 cm, are good; those 5 cm off are doubtful; those 10 cm off are bad, except on the larger
//! field of the Middle Size League, where lines are farther away; lost ones are bad everywhere. A focal length 0.5 % off changes nothing
//! (0.01 at most), and a mirror pose is as good as the right one. The thresholds of completeness follow from
//! what `tag` reaches: 1.00 on the walks, 0.90 and 0.88 on the stills of the NAO, 0.68 on those of the fisheye, which lie up to half a minute
//! apart and of which some show a line or two.

use super::recording::RecordingQuality;

/// Fraction of lines within 5 px from which poses are good, and from which they are doubtful rather than bad.
const GOOD_LINES: f64 = 0.85;
const DOUBTFUL_LINES: f64 = 0.6;
/// Completeness from which poses are good, and from which they are doubtful rather than bad.
const GOOD_COMPLETENESS: f64 = 0.85;
const DOUBTFUL_COMPLETENESS: f64 = 0.5;

/// Judgement of the poses of a recording, the worst last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// As at right poses.
    Good,
    /// As at poses 5 cm off, or too many pictures have no solution.
    Doubtful,
    /// As at poses 10 cm off, or most pictures have no solution.
    Bad,
    /// Unknown: no picture that has a solution shows or should show a line.
    NothingSeen,
}

impl RecordingQuality {
    /// Judges the poses.
    pub fn verdict(&self) -> Verdict {
        match (self.verdict_of_lines(), self.verdict_of_completeness()) {
            (Verdict::NothingSeen, Verdict::Bad) => Verdict::Bad,
            (of_lines, of_completeness) => of_lines.max(of_completeness),
        }
    }

    fn verdict_of_lines(&self) -> Verdict {
        match self.lines_within_5px {
            _ if self.measured == 0 => Verdict::NothingSeen,
            fraction if fraction >= GOOD_LINES => Verdict::Good,
            fraction if fraction >= DOUBTFUL_LINES => Verdict::Doubtful,
            _ => Verdict::Bad,
        }
    }

    fn verdict_of_completeness(&self) -> Verdict {
        match self.completeness {
            fraction if fraction >= GOOD_COMPLETENESS => Verdict::Good,
            fraction if fraction >= DOUBTFUL_COMPLETENESS => Verdict::Doubtful,
            _ => Verdict::Bad,
        }
    }

    /// Says in one sentence how many of the field's lines are met, and whether that is good.
    pub fn sentence(&self) -> String {
        let percent = |fraction: f64| format!("{:.0} %", 100.0 * fraction);
        let solved = format!("{} of the pictures have a solution", percent(self.completeness));
        let words = self.words();
        if self.measured == 0 {
            return format!("{solved}: {words}");
        }
        let [near, wide] = [self.lines_within_5px, self.lines_within_10px].map(percent);
        format!("{near} of the field's lines are met within 5 px, {wide} within 10 px; {solved}: {words}")
    }

    /// Returns the word of the judgement, and what it means or comes from.
    fn words(&self) -> &'static str {
        let by_lines = self.measured > 0 && self.verdict_of_lines() >= self.verdict_of_completeness();
        match self.verdict() {
            Verdict::Good => "good, as at right poses",
            Verdict::Doubtful if by_lines => "doubtful, as at poses 5 cm off or a focal length 2 % off",
            Verdict::Doubtful => "doubtful, as too many have none",
            Verdict::Bad if by_lines => "bad, as at poses 10 cm or 2° off, or lost",
            Verdict::Bad => "bad, as most have none",
            Verdict::NothingSeen => "whether that is good is not known, as no line is seen well enough",
        }
    }
}
