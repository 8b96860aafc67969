//! Verdict on a recording, from what was found.

use crate::{
    diagnostics::finding::Finding,
    report::data::{EffectReport, Unobservable, Verdict},
};

/// Returns the answer in one word. Unexplained findings outweigh supported effects, and a confusable effect outweighs one
/// that is certain.
pub(crate) fn verdict(
    effects: &[EffectReport],
    unexplained: &[Finding],
    unobservable: &[Unobservable],
) -> Verdict {
    if !unexplained.is_empty() {
        Verdict::Unknown
    } else if effects.iter().any(|effect| !effect.confusable_with.is_empty()) {
        Verdict::Confusable
    } else if !effects.is_empty() {
        Verdict::Named
    } else if unobservable.iter().any(|effect| effect.cause.is_lack_of_movement()) {
        Verdict::Inconclusive
    } else {
        Verdict::None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        inference::detection_limit::{MissingInput, UnobservableCause},
        testing::effect_report,
    };

    const LEFT: Finding = Finding::Flicker { size: 0.1, p_value: 1e-4 };

    fn sure() -> EffectReport {
        effect_report("vignetting", 0.4)
    }

    fn confusable() -> EffectReport {
        EffectReport { confusable_with: vec!["uneven_illumination".to_owned()], ..sure() }
    }

    fn unseen(cause: UnobservableCause) -> Unobservable {
        Unobservable { id: "rolling_shutter".to_owned(), cause }
    }

    #[test]
    fn an_unexplained_finding_makes_the_verdict_unknown_whatever_was_named() {
        for effects in [vec![], vec![sure()], vec![confusable()]] {
            assert_eq!(verdict(&effects, &[LEFT], &[]), Verdict::Unknown);
        }
    }

    #[test]
    fn one_confusable_effect_makes_the_verdict_confusable() {
        assert_eq!(verdict(&[sure(), confusable()], &[], &[]), Verdict::Confusable);
    }

    #[test]
    fn effects_are_named_although_others_cannot_be_seen() {
        let unseen = unseen(UnobservableCause::CameraAtRest);
        assert_eq!(verdict(&[sure()], &[], &[unseen]), Verdict::Named);
    }

    #[test]
    fn without_effects_a_lack_of_movement_makes_the_verdict_inconclusive() {
        let causes = [
            UnobservableCause::CameraAtRest,
            UnobservableCause::RobotAtRest,
            UnobservableCause::FewViews { views: 3, needed: 8 },
        ];
        for cause in causes {
            assert_eq!(verdict(&[], &[], &[unseen(cause)]), Verdict::Inconclusive, "{cause:?}");
        }
        // Single effects that cannot be judged are listed beside the verdict: `Report::not_judged`.
        let missing = UnobservableCause::MissingInput { input: MissingInput::Noise };
        for cause in [missing, UnobservableCause::NotSeparable] {
            assert_eq!(verdict(&[], &[], &[unseen(cause)]), Verdict::None);
        }
        assert_eq!(verdict(&[], &[], &[unseen(missing), unseen(causes[0])]), Verdict::Inconclusive);
    }

    #[test]
    fn without_effects_findings_and_causes_nothing_is_missing() {
        assert_eq!(verdict(&[], &[], &[]), Verdict::None);
    }
}
