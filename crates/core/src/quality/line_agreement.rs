//! Counts of the lines in one picture that a pose meets and misses.

/// Lines of the field in one picture at one pose, counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LineAgreement {
    /// Lines that the picture shows within 25 px of where the pose projects them.
    pub seen: u32,
    /// Those of them that lie within 5 px.
    pub within_5px: u32,
    /// Those of them that lie within 10 px.
    pub within_10px: u32,
    /// Lines that the pose projects into the picture, broad and long enough to be seen, and that are not to be seen there.
    pub unseen: u32,
    /// White strokes on the carpet that are no line or mark of the field as seen from the pose.
    pub unexplained: u32,
}

impl LineAgreement {
    /// Returns the fraction of the lines within 5 px, JaC@5; `None` if there are none, neither seen nor projected.
    pub fn fraction_within_5px(&self) -> Option<f64> {
        self.jaccard_index(self.within_5px)
    }

    /// Returns the fraction of the lines within 10 px, JaC@10; `None` if there are none, neither seen nor projected.
    pub fn fraction_within_10px(&self) -> Option<f64> {
        self.jaccard_index(self.within_10px)
    }

    fn jaccard_index(&self, true_positives: u32) -> Option<f64> {
        let all = self.seen + self.unseen + self.unexplained;
        (all > 0).then(|| f64::from(true_positives) / f64::from(all))
    }
}
