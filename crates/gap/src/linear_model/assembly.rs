//! Normal equations assembled by frame, by view and by cell of the field.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use crate::{
    frame_index::ViewIndex,
    linear_model::{
        column::ColumnIndex,
        linearized_frame::LinearizedFrame,
        normal_equations::{NormalEquations, WeightedRow},
        pose_projection::PoseProjection,
        reflectance::PatchIndex,
    },
    measurement::quantity::Quantity,
    thresholds::Thresholds,
};

/// Side of a cell of the field, metres.
const CELL_M: f64 = Thresholds::DEFAULT.linear_model.cluster_cell_m;

/// Returns the normal equations of each frame, with the projection of its pose error.
pub(super) fn by_frame(
    frames: &[&LinearizedFrame],
    weights: &[Vec<f64>],
    pose_sigmas: &[f64; 6],
) -> (Vec<NormalEquations>, Vec<PoseProjection>) {
    let of_frame = |(frame, weights): (&&LinearizedFrame, &Vec<f64>)| {
        let projection = PoseProjection::new(frame, weights, pose_sigmas);
        let rows = (0..frame.measurements.len()).collect();
        (assemble(&[Part { frame, weights, projection: &projection, rows }]), projection)
    };
    frames.par_iter().zip(weights).map(of_frame).unzip()
}

/// Returns the normal equations of each view that has any. `views` gives each frame's view.
pub(super) fn by_view(frames: &[NormalEquations], views: &[ViewIndex]) -> Vec<NormalEquations> {
    let mut members: BTreeMap<ViewIndex, Vec<&NormalEquations>> = BTreeMap::new();
    for (frame, view) in frames.iter().zip(views) {
        members.entry(*view).or_default().push(frame);
    }
    let sums = members.into_values().map(|frames| NormalEquations::sum(frames.into_iter()));
    sums.filter(|equations| !equations.is_empty()).collect()
}

/// Returns the normal equations of each cell of the field, without the odometry.
pub(super) fn by_cell(
    frames: &[&LinearizedFrame],
    weights: &[Vec<f64>],
    projections: &[PoseProjection],
) -> Vec<NormalEquations> {
    let mut parts: BTreeMap<[i32; 2], Vec<Part<'_>>> = BTreeMap::new();
    for ((frame, weights), projection) in frames.iter().zip(weights).zip(projections) {
        for (cell, rows) in rows_by_cell(frame) {
            parts.entry(cell).or_default().push(Part { frame, weights, projection, rows });
        }
    }
    parts.into_values().collect::<Vec<_>>().par_iter().map(|parts| assemble(parts)).collect()
}

/// Returns the rows of a frame's measurements of the field, by the cell that they lie in.
fn rows_by_cell(frame: &LinearizedFrame) -> BTreeMap<[i32; 2], Vec<usize>> {
    let mut rows: BTreeMap<[i32; 2], Vec<usize>> = BTreeMap::new();
    for (row, measurement) in frame.measurements.iter().enumerate() {
        if !measurement.quantity.is_proprioceptive() {
            let cell = (measurement.ground / CELL_M).floor();
            rows.entry([cell.x as i32, cell.y as i32]).or_default().push(row);
        }
    }
    rows
}

/// Part of a frame's measurements.
struct Part<'a> {
    frame: &'a LinearizedFrame,
    weights: &'a [f64],
    projection: &'a PoseProjection,
    /// Indices of the measurements in the frame, in order.
    rows: Vec<usize>,
}

impl Part<'_> {
    /// Iterates over the rows with a positive weight.
    fn weighted(&self) -> impl Iterator<Item = usize> {
        self.rows.iter().copied().filter(|&row| self.weights[row] > 0.0)
    }

    fn is_line_offset(&self, row: usize) -> bool {
        self.frame.measurements[row].quantity == Quantity::LineOffset
    }

    /// Returns the columns with a derivative in these measurements, directly or through the pose.
    fn columns(&self) -> BTreeSet<ColumnIndex> {
        let direct = self.weighted().flat_map(|row| &self.frame.jacobian[row]).map(|(column, _)| *column);
        let has_offsets = self.weighted().any(|row| self.is_line_offset(row));
        let by_pose = self.projection.columns.iter().copied().filter(|_| has_offsets);
        direct.chain(by_pose).collect()
    }

    /// Returns the patches of the field that these measurements depend on.
    fn patches(&self) -> BTreeSet<PatchIndex> {
        self.weighted().filter_map(|row| Some(self.frame.patches[row]?.0)).collect()
    }
}

/// Returns `J̃ᵀ W J` and `J̃ᵀ W r` of parts of frames.
fn assemble(parts: &[Part<'_>]) -> NormalEquations {
    let columns: BTreeSet<ColumnIndex> = parts.iter().flat_map(Part::columns).collect();
    let patches: BTreeSet<PatchIndex> = parts.iter().flat_map(Part::patches).collect();
    let mut equations = NormalEquations::zero(columns.into_iter().collect(), patches.into_iter().collect());
    for part in parts {
        for row in part.weighted() {
            let derivatives: Vec<(usize, f64)> = part.frame.jacobian[row]
                .iter()
                .map(|(column, derivative)| (equations.position(*column), *derivative))
                .collect();
            let weighted = WeightedRow {
                weight: part.weights[row],
                residual: part.frame.residuals[row],
                derivatives: &derivatives,
                patch: part.frame.patches[row],
            };
            for &(position, derivative) in &derivatives {
                equations.add(position, derivative, &weighted);
            }
            equations.add_to_patch(&weighted);
            if part.is_line_offset(row) {
                let PoseProjection { columns, pose_changes } = part.projection;
                for (&column, pose_change) in columns.iter().zip(pose_changes) {
                    let projected = -pose_change.dot(&part.frame.pose_gradients[row]);
                    equations.add(equations.position(column), projected, &weighted);
                }
            }
        }
    }
    equations
}
