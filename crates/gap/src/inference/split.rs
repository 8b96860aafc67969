//! Split into training frames and held-out frames.

use crate::{
    frame_index::{FrameIndex, PerFrame},
    thresholds::Thresholds,
};

const RUN: usize = Thresholds::DEFAULT.inference.held_out_run_frames;
const EVERY: usize = Thresholds::DEFAULT.inference.held_out_every;

/// Returns the stretch that the frame at a position is in, if `count` frames are divided into `stretches` successive stretches of equal
/// length.
pub(crate) fn stretch(position: usize, count: usize, stretches: usize) -> usize {
    position * stretches / count
}

/// Split into training frames and held-out frames, which no fit sees.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct HeldOutSplit {
    /// Whether each frame is held out.
    is_held_out: PerFrame<bool>,
}

impl HeldOutSplit {
    /// Holds out every fourth run of frames; the seed chooses the first one.
    pub(crate) fn new(frames: usize, seed: u64) -> Self {
        // Short recordings have shorter runs, so that both kinds of frames are spread over the whole recording.
        let run = RUN.min(frames / (2 * EVERY)).max(1);
        let first = (seed % EVERY as u64) as usize;
        let is_held_out = (0..frames).map(|frame| (frame / run) % EVERY == (first + 2) % EVERY).collect();
        Self { is_held_out }
    }

    /// Returns the indices of the training frames, in order.
    pub(crate) fn training(&self) -> impl Iterator<Item = FrameIndex> {
        self.frames(false)
    }

    /// Returns the indices of the held-out frames, in order.
    pub(crate) fn held_out(&self) -> impl Iterator<Item = FrameIndex> {
        self.frames(true)
    }

    /// Whether a frame is held out; false for a frame that does not exist.
    pub(crate) fn is_held_out(&self, frame: FrameIndex) -> bool {
        self.is_held_out.get(frame).copied().unwrap_or(false)
    }

    fn frames(&self, held_out: bool) -> impl Iterator<Item = FrameIndex> {
        let frames = self.is_held_out.indexed();
        frames.filter(move |(_, is_held_out)| **is_held_out == held_out).map(|(frame, _)| frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_frame_is_in_one_of_two_sets_and_both_sets_are_spread_over_the_recording() {
        for frames in [12, 20, 60, 61, 240] {
            for seed in 0..9 {
                let split = HeldOutSplit::new(frames, seed);
                let (training, held_out): (Vec<_>, Vec<_>) =
                    (split.training().collect(), split.held_out().collect());
                let mut all: Vec<_> = training.iter().chain(&held_out).copied().collect();
                all.sort_unstable();
                assert_eq!(all, FrameIndex::first(frames).collect::<Vec<_>>());
                let share = held_out.len() as f64 / frames as f64;
                assert!((0.12..0.4).contains(&share), "{frames} {seed}: {share}");
            }
        }
        assert_ne!(HeldOutSplit::new(60, 0), HeldOutSplit::new(60, 1), "the seed chooses");
    }
}
