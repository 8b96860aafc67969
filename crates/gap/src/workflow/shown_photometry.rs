//! Brightness and blur as a recording shows them, which are the nominal ones of a later recording by the same camera.

use reality_sim_core::{sequence::Photometry, statistics::median};
use reality_sim_sensor::{Chain, Model, sampled_sigma_px, sampled_variance_px2};

use crate::{
    inference::linearized_recording::search_px,
    linear_model::linearization::{MeasureError, Others, linearise, measure_frames, measured_patches},
    linear_model::mean_reflectance::MeanReflectance,
    measurement::quantity::Quantity,
    recording::Recording,
    thresholds::Thresholds,
};

/// Returns the photometry of a recording's camera with the medians of what its pictures show: the linear values of lines and
/// carpet without the effects of `model`, and the blur beside them. Gamma, black level and noise are the nominal ones.
///
/// # Errors
///
/// Returns an error if a picture cannot be read, or if the model does not describe a valid camera.
pub fn shown_photometry(recording: &Recording<'_>, model: &Model) -> Result<Photometry, MeasureError> {
    let setup = &recording.sequence.setup;
    let search = Thresholds::DEFAULT.inference.search_again;
    let measurements = measure_frames(recording, model, search_px(recording, search))?;
    let chain = Chain::new(setup, &recording.sequence.field, model)?;
    let shown = MeanReflectance::shown(recording, &measurements, &chain);
    let others = Others { nuisances: &[], patches: &measured_patches(&measurements) };
    let frames = linearise(recording, &measurements, model, &[], others)?;
    let more_px2 = frames.iter().flat_map(|frame| {
        let rows = frame.measurements.iter().zip(&frame.residuals);
        rows.filter(|(row, value)| row.quantity == Quantity::LineBlur && value.is_finite())
            .map(|(_, value)| *value)
    });
    let more_px2: Vec<f64> = more_px2.collect();
    let stated = setup.photometry.unwrap_or(Photometry::of_gamma(recording.gamma()));
    let stated_px2 = sampled_variance_px2(stated.psf_sigma_px.unwrap_or(0.0));
    let is_known = |rgb: [f64; 3]| rgb.iter().all(|value| value.is_finite()).then_some(rgb);
    Ok(Photometry {
        line_linear_rgb: is_known(shown.line.linear_rgb).or(stated.line_linear_rgb),
        carpet_linear_rgb: is_known(shown.carpet.linear_rgb).or(stated.carpet_linear_rgb),
        psf_sigma_px: if more_px2.is_empty() {
            stated.psf_sigma_px
        } else {
            Some(sampled_sigma_px(stated_px2 + median(more_px2)))
        },
        ..stated
    })
}
