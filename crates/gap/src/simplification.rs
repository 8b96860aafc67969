//! What can be left out of the workflow, to see what it is worth.

/// Part of the workflow that is left out, or a simpler one in its place. The study of `docs/gap.md` compares the workflow with each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Simplification {
    /// Reference poses are taken to be exact.
    ExactPoses,
    /// Carpet and paint are taken to have one reflectance each, in all places.
    EvenSurfaces,
    /// The effect with the largest gain is named, whatever else explains as much.
    LargestGain,
    /// All parameters are free, and effects are dropped by the Bayesian information criterion.
    InformationCriterion,
    /// Effects are added as long as held-out parts of the recording are predicted better.
    CrossValidation,
}
