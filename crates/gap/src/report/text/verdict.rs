//! Verdict in one word.

use crate::report::data::Verdict;

/// Returns the verdict's word: "nothing missing".
pub fn verdict_word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::None => "nothing missing",
        Verdict::Named => "named",
        Verdict::Confusable => "confusable",
        Verdict::Unknown => "unknown",
        Verdict::Inconclusive => "inconclusive",
    }
}

/// Returns what the verdict means.
pub fn verdict_meaning(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::None => "Nothing is missing that these frames would show, among what can be judged",
        Verdict::Named => "Effects were named, and nothing significant is left",
        Verdict::Confusable => "An effect was found that these frames cannot tell from others",
        Verdict::Unknown => "Something significant is left that is in no effect's shape",
        Verdict::Inconclusive => "These frames cannot tell",
    }
}
