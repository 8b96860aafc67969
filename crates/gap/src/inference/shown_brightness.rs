//! Brightness of surfaces whose nominal brightness the recording's files do not give, as the training frames show it under a model.
//!
//! Where it is given, the gap is the error of a simulator that uses it. Where it is not, no simulator could know it: each model is
//! compared with what it makes of the training frames, so that the gap shows the light and the camera alone.

use reality_sim_sensor::Surface;

use crate::{
    frame_index::PerFrame,
    inference::split::HeldOutSplit,
    linear_model::{column::Columns, linearized_frame::LinearizedFrame, system::LinearSystem},
    recording::Recording,
};

/// Returns frames that were linearised without fitted parameters, with the levels of surfaces of unknown brightness compared with
/// what the training frames show of them. The reflectance of single places is not used: light that stays in its place would go
/// into it.
pub(crate) fn at_shown_brightness(
    recording: &Recording<'_>,
    mut frames: PerFrame<LinearizedFrame>,
    nuisances: usize,
    (system, split): (&LinearSystem, &HeldOutSplit),
) -> PerFrame<LinearizedFrame> {
    let unknown = surfaces_of_unknown_brightness(recording);
    if unknown.is_empty() {
        return frames;
    }
    let columns = Columns { parameters: 0, nuisances, field: system.columns.field.clone() };
    let training: Vec<&LinearizedFrame> = split.training().map(|frame| &frames[frame]).collect();
    let values = system.nuisances_of_levels(&training, &columns);
    for (frame, _) in recording.frames.indexed() {
        let LinearizedFrame { measurements, residuals, jacobian, .. } = &mut frames[frame];
        for ((measurement, residual), row) in measurements.iter().zip(residuals).zip(jacobian) {
            if measurement.quantity.surface().is_some_and(|surface| unknown.contains(&surface)) {
                *residual -=
                    row.iter().map(|(column, derivative)| values[column.0] * derivative).sum::<f64>();
            }
        }
    }
    frames
}

fn surfaces_of_unknown_brightness(recording: &Recording<'_>) -> Vec<Surface> {
    let photometry = recording.sequence.setup.photometry;
    let is_known = |surface: &Surface| {
        photometry.is_some_and(|given| match surface {
            Surface::Line => given.line_linear_rgb.is_some(),
            Surface::Carpet => given.carpet_linear_rgb.is_some(),
        })
    };
    Surface::ALL.into_iter().filter(|surface| !is_known(surface)).collect()
}
