//! Cross-validation over the training frames: each part of the recording in turn is left out and compared with a fit to all
//! others.

use nalgebra::DVector;

use crate::{
    inference::split::stretch, linear_model::column::ColumnIndex,
    linear_model::reduced_equations::ReducedEquations, linear_model::system::LinearSystem,
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
    /// Divides a system into folds. `parameters` is the number of columns of fitted parameters.
    pub(crate) fn new(system: &LinearSystem, parameters: usize) -> Self {
        let count = system.frames.len();
        let folds = FOLDS.min(count).max(1);
        let fold = |is_left_out: &dyn Fn(usize) -> bool| -> Fold {
            let (left_out, others): (Vec<usize>, Vec<usize>) =
                (0..count).partition(|frame| is_left_out(*frame));
            let others = others.iter().map(|&frame| &system.frames[frame]);
            Fold { left_out, others: ReducedEquations::of(others, system.size, parameters) }
        };
        let stretches =
            (0..folds).map(|index| fold(&|frame| stretch(frame, count, folds) == index)).collect();
        let runs = (0..folds).map(|index| fold(&|frame| frame / RUN % folds == index)).collect();
        Self { stretches, runs }
    }

    /// Returns, frame by frame, the gain of freeing a set of columns over the present model. `base` is the present model in
    /// the columns' coordinates. The `shared` columns are also free in the set that this one is compared with. Where the
    /// other frames do not constrain a shared column, it keeps the model's value: otherwise a line that is seen only in the
    /// frames left out would drown the difference between the two sets.
    pub(crate) fn gains(
        &self,
        system: &LinearSystem,
        base: &DVector<f64>,
        free: &[ColumnIndex],
        shared: &[ColumnIndex],
        kind: FoldKind,
    ) -> Option<Vec<f64>> {
        let mut gains = vec![0.0; system.frames.len()];
        let mut drawn_to = base.clone();
        for &column in shared {
            drawn_to[column.0] = 0.0;
        }
        let folds = match kind {
            FoldKind::Stretches => &self.stretches,
            FoldKind::ShortRuns => &self.runs,
        };
        for fold in folds {
            let delta = fold.others.fit_beside(free, &drawn_to, &-base)?.delta;
            for &frame in &fold.left_out {
                gains[frame] = system.frames[frame].gain(&delta);
            }
        }
        Some(gains)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::system_of;
    use nalgebra::DMatrix;

    fn cross_validation(frames: usize) -> CrossValidation {
        let one = || (DMatrix::identity(1, 1), DVector::zeros(1));
        CrossValidation::new(&system_of((0..frames).map(|_| one()).collect()), 1)
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
}
