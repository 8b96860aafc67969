//! Normal equations assembled by frame, by view and by cell of the field.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use crate::{
    linear_model::{
        column::ColumnIndex, linearized_frame::LinearizedFrame, normal_equations::NormalEquations,
        pose_projection::PoseProjection,
    },
    measurement::quantity::Quantity,
    thresholds::Thresholds,
};

/// Side of a cell of the field, metres.
const CELL_M: f64 = Thresholds::DEFAULT.linear_model.cluster_cell_m;

/// Normal equations of each frame, and the pose's projection in it.
pub(super) fn by_frame(
    frames: &[&LinearizedFrame],
    weights: &[Vec<f64>],
    pose_sigmas: &[f64; 6],
) -> (Vec<NormalEquations>, Vec<PoseProjection>) {
    let of_frame = |(frame, weights): (&&LinearizedFrame, &Vec<f64>)| {
        let projection = PoseProjection::new(frame, weights, pose_sigmas);
        let rows: Vec<usize> = (0..frame.measurements.len()).collect();
        (sums_of(&[Part { frame, weights, projection: &projection, rows }]), projection)
    };
    frames.par_iter().zip(weights).map(of_frame).unzip()
}

/// Normal equations of each view that has any; `views` gives each frame's view.
pub(super) fn by_view(frames: &[NormalEquations], views: &[usize]) -> Vec<NormalEquations> {
    let count = views.iter().max().map_or(0, |last| last + 1);
    let of_view = |view: usize| {
        let frames = frames.iter().zip(views).filter(move |(_, of)| **of == view);
        NormalEquations::together(frames.map(|(frame, _)| frame))
    };
    (0..count).map(of_view).filter(|sums| !sums.is_empty()).collect()
}

/// Frames by their indices, each with some of its measurements.
type RowsOfFrames = Vec<(usize, Vec<usize>)>;

/// Normal equations of each cell of the field, without the odometry.
pub(super) fn by_cell(
    frames: &[&LinearizedFrame],
    weights: &[Vec<f64>],
    projections: &[PoseProjection],
) -> Vec<NormalEquations> {
    // For each cell the frames that see it, with their measurements there.
    let mut members: BTreeMap<(i32, i32), RowsOfFrames> = BTreeMap::new();
    for (index, frame) in frames.iter().enumerate() {
        for (row, _) in frame.measurements.iter().enumerate().filter(|(_, row)| !row.quantity.is_odometry()) {
            let cell = (frame.measurements[row].ground / CELL_M).floor();
            let lists = members.entry((cell.x as i32, cell.y as i32)).or_default();
            match lists.last_mut() {
                Some((last, rows)) if *last == index => rows.push(row),
                _ => lists.push((index, vec![row])),
            }
        }
    }
    let of_cell = |lists: RowsOfFrames| {
        let part = |(index, rows): (usize, Vec<usize>)| Part {
            frame: frames[index],
            weights: &weights[index],
            projection: &projections[index],
            rows,
        };
        sums_of(&lists.into_iter().map(part).collect::<Vec<_>>())
    };
    members.into_values().collect::<Vec<_>>().into_par_iter().map(of_cell).collect()
}

/// Some measurements of a frame.
struct Part<'a> {
    frame: &'a LinearizedFrame,
    weights: &'a [f64],
    projection: &'a PoseProjection,
    rows: Vec<usize>,
}

impl Part<'_> {
    /// Measurements with a weight.
    fn counted(&self) -> impl Iterator<Item = usize> {
        self.rows.iter().copied().filter(|&row| self.weights[row] > 0.0)
    }

    fn is_line(&self, row: usize) -> bool {
        self.frame.measurements[row].quantity == Quantity::LineOffset
    }

    /// Columns with a derivative in these measurements, directly or through the pose.
    fn columns(&self) -> BTreeSet<ColumnIndex> {
        let plain = self.counted().flat_map(|row| &self.frame.jacobian[row]).map(|(column, _)| *column);
        let lines = self.counted().any(|row| self.is_line(row));
        let imitated = self.projection.columns.iter().copied().filter(|_| lines);
        plain.chain(imitated).collect()
    }
}

/// `J̃ᵀ W J` and `J̃ᵀ W r` of some measurements of some frames.
fn sums_of(parts: &[Part<'_>]) -> NormalEquations {
    let columns: BTreeSet<ColumnIndex> = parts.iter().flat_map(Part::columns).collect();
    let mut sums = NormalEquations::zero(columns.into_iter().collect());
    for part in parts {
        for row in part.counted() {
            let (weight, residual) = (part.weights[row], part.frame.residuals[row]);
            let plain = part.frame.jacobian[row].iter();
            let plain: Vec<(usize, f64)> =
                plain.map(|(column, value)| (sums.place(*column), *value)).collect();
            for &(place, value) in &plain {
                sums.add(place, value, &plain, weight, residual);
            }
            if part.is_line(row) {
                for (&column, change) in part.projection.columns.iter().zip(&part.projection.changes) {
                    let place = sums.place(column);
                    sums.add(place, -change.dot(&part.frame.pose[row]), &plain, weight, residual);
                }
            }
        }
    }
    sums
}
