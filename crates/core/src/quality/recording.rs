//! Quality of all poses of a recording.

use super::line_agreement::LineAgreement;

/// Agreement of a recording's poses with its pictures, as three fractions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RecordingQuality {
    /// Mean fraction of the lines within 5 px, JaC@5, over the pictures that have a solution and show or should show lines; 0 if
    /// there are none.
    pub lines_within_5px: f64,
    /// The same within 10 px, JaC@10.
    pub lines_within_10px: f64,
    /// Fraction of the pictures that have a solution: a pose at which the lines fit, and at no other place but its mirror pose.
    pub completeness: f64,
    /// Number of pictures over which the lines were averaged.
    pub measured: usize,
}

impl RecordingQuality {
    /// Summarises the pictures of a recording: the agreement of each, and whether it has a solution
    /// ([`crate::localization::LocalizedFrame::settled`]).
    pub fn new(pictures: impl IntoIterator<Item = (LineAgreement, bool)>) -> Self {
        let (mut count, mut solved) = (0_usize, 0_usize);
        let (mut measured, mut sums) = (0_usize, [0.0; 2]);
        for (agreement, has_solution) in pictures {
            count += 1;
            if !has_solution {
                continue;
            }
            solved += 1;
            let fractions = agreement.fraction_within_5px().zip(agreement.fraction_within_10px());
            if let Some((within_5px, within_10px)) = fractions {
                measured += 1;
                sums = [sums[0] + within_5px, sums[1] + within_10px];
            }
        }
        let [lines_within_5px, lines_within_10px] = sums.map(|sum| sum / measured.max(1) as f64);
        let completeness = solved as f64 / count.max(1) as f64;
        Self { lines_within_5px, lines_within_10px, completeness, measured }
    }
}
