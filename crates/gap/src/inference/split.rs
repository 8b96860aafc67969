//! Split into training frames and held-out frames.

use crate::thresholds::Thresholds;

const RUN: usize = Thresholds::DEFAULT.inference.held_out_run_frames;
const EVERY: usize = Thresholds::DEFAULT.inference.held_out_every;

/// Returns the stretch that a frame is in, if `count` frames are divided into `stretches` successive stretches of equal
/// length.
pub(crate) fn stretch(frame: usize, count: usize, stretches: usize) -> usize {
    frame * stretches / count
}

/// Split into training frames and held-out frames, which no fit sees.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct HeldOutSplit {
    judged: Vec<bool>,
}

impl HeldOutSplit {
    /// Holds out every fourth run of frames; the seed chooses the first one.
    pub(crate) fn new(frames: usize, seed: u64) -> Self {
        // Short recordings have shorter runs, so that both kinds of frames are spread over the whole recording.
        let run = RUN.min(frames / (2 * EVERY)).max(1);
        let first = (seed % EVERY as u64) as usize;
        Self { judged: (0..frames).map(|frame| (frame / run) % EVERY == (first + 2) % EVERY).collect() }
    }

    pub(crate) fn fitted(&self) -> impl Iterator<Item = usize> {
        self.judged.iter().enumerate().filter(|(_, judged)| !**judged).map(|(frame, _)| frame)
    }

    /// Whether a frame is held out; false for a frame that does not exist.
    pub(crate) fn is_judged(&self, frame: usize) -> bool {
        self.judged.get(frame).copied().unwrap_or(false)
    }

    pub(crate) fn judged(&self) -> impl Iterator<Item = usize> {
        self.judged.iter().enumerate().filter(|(_, judged)| **judged).map(|(frame, _)| frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_frame_is_either_fitted_or_judged_and_both_are_spread_over_the_recording() {
        for frames in [12, 20, 60, 61, 240] {
            for seed in 0..9 {
                let split = HeldOutSplit::new(frames, seed);
                let (fitted, judged): (Vec<_>, Vec<_>) = (split.fitted().collect(), split.judged().collect());
                let mut all: Vec<_> = fitted.iter().chain(&judged).copied().collect();
                all.sort_unstable();
                assert_eq!(all, (0..frames).collect::<Vec<_>>());
                let part = judged.len() as f64 / frames as f64;
                assert!((0.12..0.4).contains(&part), "{frames} {seed}: {part}");
            }
        }
        assert_ne!(HeldOutSplit::new(60, 0), HeldOutSplit::new(60, 1), "the seed chooses");
    }
}
