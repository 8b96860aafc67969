//! Cross-validation over the training frames: each part of the recording in turn is left out and compared with a fit to all
//! others.

use crate::{
    inference::{evidence::Evidence, gain::HeldOutGains, split::stretch},
    linear_model::{column::ColumnIndex, reduced_equations::ReducedEquations},
    thresholds::Thresholds,
};

const FOLDS: usize = Thresholds::DEFAULT.inference.folds;
const RUN: usize = Thresholds::DEFAULT.inference.fold_run_frames;

/// Way to divide frames into folds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FoldKind {
    /// Each fold is one stretch of the recording. Neighbouring frames see the same things, so frames of one fold must not
    /// predict each other.
    Stretches,
    /// Each fold consists of many short runs of frames, so that whatever changes over time is seen before and after each
    /// run.
    ShortRuns,
}

/// Fold: the frames that are left out, and the equations of all others.
#[derive(Debug)]
struct Fold {
    left_out: Vec<usize>,
    others: ReducedEquations,
}

/// Folds of a linear system.
#[derive(Debug)]
pub(crate) struct CrossValidation {
    stretches: Vec<Fold>,
    runs: Vec<Fold>,
}

impl CrossValidation {
    /// Divides the frames of a system into folds.
    pub(crate) fn new(evidence: &Evidence<'_>) -> Self {
        let system = evidence.system;
        let count = system.frames.len();
        let folds = FOLDS.min(count).max(1);
        let fold = |is_left_out: &dyn Fn(usize) -> bool| -> Fold {
            let (left_out, others): (Vec<usize>, Vec<usize>) =
                (0..count).partition(|frame| is_left_out(*frame));
            let others = others.iter().map(|&frame| &system.frames[frame]);
            Fold { left_out, others: ReducedEquations::new(others, &system.columns) }
        };
        let stretches =
            (0..folds).map(|index| fold(&|frame| stretch(frame, count, folds) == index)).collect();
        let runs = (0..folds).map(|index| fold(&|frame| frame / RUN % folds == index)).collect();
        Self { stretches, runs }
    }

    /// Returns the gains of freeing a set of columns over the present model, each frame's from a fit to the frames outside its
    /// fold. The `shared` columns are also free in the set that this one is compared with. Where the other frames do not
    /// constrain a shared column, it keeps the model's value: otherwise a line that is seen only in the frames left out would
    /// drown the difference between the two sets. None if a fit is singular.
    pub(crate) fn gains(
        &self,
        evidence: &Evidence<'_>,
        free: &[ColumnIndex],
        shared: &[ColumnIndex],
        kind: FoldKind,
    ) -> Option<HeldOutGains> {
        let (system, base) = (evidence.system, &evidence.base);
        let mut gains = vec![0.0; system.frames.len()];
        // The prior draws a column towards neutral, but a shared one towards the model's value.
        let mut offset_from_prior = base.clone();
        for &column in shared {
            offset_from_prior[column.0] = 0.0;
        }
        let folds = match kind {
            FoldKind::Stretches => &self.stretches,
            FoldKind::ShortRuns => &self.runs,
        };
        for fold in folds {
            let delta = fold.others.fit_beside(free, &offset_from_prior, &-base)?.delta;
            for &frame in &fold.left_out {
                gains[frame] = system.frames[frame].gain(&delta, &system.columns);
            }
        }
        Some(HeldOutGains::new(gains, &evidence.fit(free)?.delta, &system.columns))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        linear_model::system::LinearSystem,
        testing::{system_of, two_column_frames},
    };
    use nalgebra::{DMatrix, DVector};

    fn cross_validation(frames: usize) -> CrossValidation {
        let one = || (DMatrix::identity(1, 1), DVector::zeros(1));
        let system = system_of((0..frames).map(|_| one()).collect());
        CrossValidation::new(&Evidence::new(&system, DVector::zeros(1)))
    }

    #[test]
    fn every_frame_is_left_out_once() {
        for frames in [1, 5, 6, 7, 45] {
            let folds = cross_validation(frames);
            for kind in [&folds.stretches, &folds.runs] {
                let mut all: Vec<usize> = kind.iter().flat_map(|fold| fold.left_out.clone()).collect();
                all.sort_unstable();
                assert_eq!(all, (0..frames).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn stretches_are_in_one_piece_and_runs_are_spread() {
        let folds = cross_validation(48);
        assert!(
            folds.stretches.iter().all(|fold| fold.left_out.windows(2).all(|pair| pair[1] == pair[0] + 1))
        );
        assert_eq!(folds.runs[1].left_out, [2, 3, 14, 15, 26, 27, 38, 39]);
    }

    const BOTH: [ColumnIndex; 2] = [ColumnIndex(0), ColumnIndex(1)];

    fn system(seed: u64, truth: [f64; 2]) -> LinearSystem {
        system_of(two_column_frames(seed, truth, 0.5))
    }

    /// Returns the gains of freeing columns at a model with these coordinates.
    fn gains(system: &LinearSystem, base: &DVector<f64>, free: &[ColumnIndex]) -> HeldOutGains {
        let evidence = Evidence::new(system, base.clone());
        CrossValidation::new(&evidence).gains(&evidence, free, &[], FoldKind::Stretches).unwrap()
    }

    #[test]
    fn an_effect_gains_on_frames_that_the_fit_has_not_seen() {
        let neutral = DVector::zeros(2);
        for seed in 0..200 {
            let system = system(seed, [0.6, -0.2]);
            let gain = gains(&system, &neutral, &BOTH).over(&gains(&system, &neutral, &[]));
            assert!(gain.value > 0.0 && gain.score() > 2.0, "{seed}: {gain:?}");
        }
    }

    #[test]
    fn an_absent_effect_gains_nothing_on_frames_that_the_fit_has_not_seen() {
        let neutral = DVector::zeros(2);
        let gain = |seed: u64| {
            let system = system(seed, [0.5, 0.0]);
            gains(&system, &neutral, &BOTH).over(&gains(&system, &neutral, &BOTH[..1])).value
        };
        assert!((0..100).map(gain).sum::<f64>() < 0.0);
    }

    #[test]
    fn an_effect_of_the_model_that_is_not_free_is_removed_from_it() {
        let mut frames = two_column_frames(3, [0.4, 0.0], 0.0);
        // The model has the effect already, so no residual remains.
        let base = DVector::from_vec(vec![0.4, 0.0]);
        for (a, g) in &mut frames {
            *g -= &*a * &base;
        }
        let system = system_of(frames);
        let gain = gains(&system, &base, &BOTH[1..]).over(&gains(&system, &base, &BOTH));
        assert!(gain.value < -50.0, "{gain:?}");
        let kept = Evidence::new(&system, base).fit(&BOTH).unwrap();
        assert!(kept.delta[0].abs() < 0.1);
    }
}
