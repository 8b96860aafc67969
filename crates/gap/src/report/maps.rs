//! Maps of residuals: in the picture, on the field, over time.

use std::collections::BTreeMap;

use glam::DVec2;

use reality_sim_core::statistics::{median, robust_sigma};

use crate::{
    frame_index::{FrameIndex, PerFrame},
    inference::held_out::HeldOutResiduals,
    inference::selected_model::SelectedModel,
    measurement::quantity::Channel,
    measurement::scalar::Measurement,
    recording::Recording,
    report::data::{Course, Map, Maps},
    thresholds::{ReportThresholds, Thresholds},
};

const THRESHOLDS: ReportThresholds = Thresholds::DEFAULT.report;

/// Returns the maps of every channel that was measured.
pub(crate) fn maps(
    recording: &Recording<'_>,
    found: &SelectedModel,
    before: &HeldOutResiduals,
    after: &HeldOutResiduals,
) -> BTreeMap<Channel, Maps> {
    let camera = &recording.sequence.setup.camera;
    let size = DVec2::new(f64::from(camera.width), f64::from(camera.height));
    let half = recording.sequence.field.carpet_half_extent_m();
    let cells = (2.0 * half / THRESHOLDS.map_field_cell_m).ceil();
    let field_rows = [cells.x as usize, cells.y as usize];
    let mut maps = BTreeMap::new();
    for channel in Channel::ALL {
        let of = |all: &HeldOutResiduals| -> Vec<(FrameIndex, Measurement, f64)> {
            residuals(found, all, channel)
        };
        let (before, after) = (of(before), of(after));
        if after.is_empty() {
            continue;
        }
        let map = |grid: [usize; 2], extent: [f64; 4], place: &dyn Fn(&Measurement) -> DVec2| Map {
            columns: grid[0],
            rows: grid[1],
            extent,
            before: medians(&before, grid, place),
            after: medians(&after, grid, place),
        };
        let in_picture = |measurement: &Measurement| (measurement.pixel + 0.5) / size;
        // The field's map begins at the upper left as seen from above, with x to the right and y up.
        let on_field = |measurement: &Measurement| {
            let place = (measurement.ground + half) / (2.0 * half);
            DVec2::new(place.x, 1.0 - place.y)
        };
        let extent = [0.0, 0.0, size.x, size.y];
        let field_extent = [-half.x, half.y, half.x, -half.y];
        maps.insert(
            channel,
            Maps {
                picture: map(THRESHOLDS.map_picture_grid, extent, &in_picture),
                field: map(field_rows, field_extent, &on_field),
                time: course(recording, found, &before, &after),
            },
        );
    }
    maps
}

/// Returns a channel's residuals without outliers, each with its frame and measurement.
fn residuals(
    found: &SelectedModel,
    all: &HeldOutResiduals,
    channel: Channel,
) -> Vec<(FrameIndex, Measurement, f64)> {
    let frames = found.linearized.frames.indexed().zip(&all.residuals);
    frames
        .flat_map(|((frame, linearized), residuals)| {
            let residuals = linearized.measurements.iter().zip(residuals);
            residuals.map(move |(measurement, residual)| (frame, *measurement, *residual))
        })
        .filter(|(_, measurement, residual)| {
            measurement.quantity.channel() == channel && residual.is_finite()
        })
        .collect()
}

/// Returns the median of each cell's residuals, row by row. `place` maps the grid to 0 to 1 along both axes. None for a cell
/// with too few measurements.
fn medians(
    residuals: &[(FrameIndex, Measurement, f64)],
    grid: [usize; 2],
    place: &dyn Fn(&Measurement) -> DVec2,
) -> Vec<Option<f64>> {
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); grid[0] * grid[1]];
    for (_, measurement, residual) in residuals {
        let cell = place(measurement) * DVec2::new(grid[0] as f64, grid[1] as f64);
        if cell.cmpge(DVec2::ZERO).all() && cell.x < grid[0] as f64 && cell.y < grid[1] as f64 {
            values[cell.y as usize * grid[0] + cell.x as usize].push(*residual);
        }
    }
    // Medians are robust against robots that hide the field.
    let median = |values: &mut Vec<f64>| {
        (values.len() >= THRESHOLDS.least_map_measurements).then(|| median(values.iter().copied()))
    };
    values.iter_mut().map(median).collect()
}

/// Returns the sizes of a channel's residuals frame by frame.
fn course(
    recording: &Recording<'_>,
    found: &SelectedModel,
    before: &[(FrameIndex, Measurement, f64)],
    after: &[(FrameIndex, Measurement, f64)],
) -> Course {
    let count = recording.frames.len();
    let sizes = |residuals: &[(FrameIndex, Measurement, f64)]| -> Vec<Option<f64>> {
        let mut values: PerFrame<Vec<f64>> = PerFrame::from(vec![Vec::new(); count]);
        residuals.iter().for_each(|(frame, _, residual)| values[*frame].push(residual.abs()));
        let robust = |values: &Vec<f64>| (!values.is_empty()).then(|| robust_sigma(values.iter().copied()));
        values.iter().map(robust).collect()
    };
    Course {
        time_s: recording.frames.iter().map(|frame| frame.time_s).collect(),
        held_out: FrameIndex::first(count).map(|frame| found.split.is_held_out(frame)).collect(),
        before: sizes(before),
        after: sizes(after),
    }
}
