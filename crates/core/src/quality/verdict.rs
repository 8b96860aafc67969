//! Whether the poses of a recording are good, by their agreement with the pictures alone: the thresholds, and what they were made of.

use super::recording::RecordingQuality;

/// Fraction of lines within 5 px from which poses are good.
const GOOD_LINES: f64 = 0.85;
/// Fraction of lines within 5 px from which poses are doubtful rather than bad.
const DOUBTFUL_LINES: f64 = 0.6;
/// Completeness from which poses are good, and from which they are doubtful rather than bad.
const GOOD_COMPLETENESS: f64 = 0.9;
const DOUBTFUL_COMPLETENESS: f64 = 0.6;

/// Judgement of the poses of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// As of right poses.
    Good,
    /// As of poses 5 cm off.
    Doubtful,
    /// As of poses 10 cm off, or most pictures have no solution.
    Bad,
    /// No line was seen in a picture that has a solution.
    NothingSeen,
}

impl RecordingQuality {
    /// Judges the poses.
    pub fn verdict(&self) -> Verdict {
        if self.measured == 0 {
            return if self.completeness > 0.0 { Verdict::NothingSeen } else { Verdict::Bad };
        }
        let least = |lines: f64, completeness: f64| {
            self.lines_within_5px >= lines && self.completeness >= completeness
        };
        match () {
            () if least(GOOD_LINES, GOOD_COMPLETENESS) => Verdict::Good,
            () if least(DOUBTFUL_LINES, DOUBTFUL_COMPLETENESS) => Verdict::Doubtful,
            () => Verdict::Bad,
        }
    }
}

impl Verdict {
    /// Returns the word of the judgement, and what it means.
    fn words(self) -> &'static str {
        match self {
            Self::Good => "good, as of right poses",
            Self::Doubtful => "doubtful, as of poses 5 cm off or a focal length 2 % off",
            Self::Bad => "bad, as of poses 10 cm or 2° off, or lost",
            Self::NothingSeen => "not known: no line of the field is seen well enough",
        }
    }
}

impl RecordingQuality {
    /// Says in one sentence how many of the field's lines are met, and whether that is good.
    pub fn sentence(&self) -> String {
        let percent = |fraction: f64| format!("{:.0} %", 100.0 * fraction);
        let solved = format!("{} of the pictures have a solution", percent(self.completeness));
        let verdict = self.verdict().words();
        if self.measured == 0 {
            return format!("{solved}: {verdict}");
        }
        let [near, wide] = [self.lines_within_5px, self.lines_within_10px].map(percent);
        format!("{near} of the field's lines are met within 5 px, {wide} within 10 px; {solved}: {verdict}")
    }
}
