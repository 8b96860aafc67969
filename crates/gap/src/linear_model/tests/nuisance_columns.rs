//! Columns of the nuisance parameters against central differences of a prediction with each of them.

use reality_sim_core::sequence::Photometry;
use reality_sim_sensor::{Chain, Model, Surface};

use super::{recording, sequence};
use crate::{
    linear_model::{
        linearization::{Others, linearise, measure_frames, measured_patches},
        mean_reflectance::MeanReflectance,
        nuisance::{Nuisance, nuisances},
        texture::CarpetTexture,
    },
    measurement::{quantity::Quantity, scalar::Measurement},
};

/// Half the width of a central difference, in standard deviations of the nuisance parameter.
const STEP: f64 = 1e-4;
/// Allowed relative error of a derivative.
const TOLERANCE: f64 = 1e-6;

/// Returns the prediction for a nuisance parameter that is `deviations` standard deviations from its nominal value.
/// `by_brightness` is the derivative of a level by the logarithm of the light.
fn predicted(
    nuisance: &Nuisance,
    measurement: &Measurement,
    nominal: f64,
    by_brightness: f64,
    deviations: f64,
) -> f64 {
    let is_blur = measurement.quantity == Quantity::LineBlur;
    let is_noise = measurement.quantity == Quantity::NoiseVariance;
    let surface = measurement.quantity.surface();
    match *nuisance {
        Nuisance::Offset { quantity, sigma } if quantity == measurement.quantity => {
            nominal + deviations * sigma * if surface.is_some() { by_brightness } else { 1.0 }
        }
        Nuisance::Gain { surface: None, sigma } if surface.is_some() => {
            nominal + by_brightness * deviations * sigma
        }
        Nuisance::Gain { surface: Some(only), sigma } if surface == Some(only) => {
            nominal + by_brightness * deviations * sigma
        }
        Nuisance::ThinLine { sigma } if surface == Some(Surface::Line) => {
            nominal + by_brightness * deviations * sigma / measurement.half_width_px
        }
        Nuisance::Width { sigma } if is_blur => nominal + deviations * sigma * measurement.half_width_px.ln(),
        Nuisance::Kernel { sigma } if is_blur => nominal * (1.0 + deviations * sigma),
        Nuisance::ThinKernel { sigma } if is_blur => {
            let widths = measurement.half_width_px / nominal.sqrt();
            nominal * (1.0 + deviations * sigma / widths.exp())
        }
        // Levels are logarithms of linear values.
        Nuisance::Sheen { power, sigma, carpet } if surface == Some(Surface::Carpet) => {
            let Quantity::CarpetLevel(color) = measurement.quantity else { return nominal };
            let own = carpet[color as usize];
            let reflected = sigma * (1.0 - measurement.cos_incidence).powi(power);
            nominal + by_brightness * ((own + deviations * reflected) / own).ln()
        }
        Nuisance::Pile { axis, sigma } if surface == Some(Surface::Carpet) => {
            let incidence = measurement.cos_incidence.acos();
            let along = measurement.view_direction[axis] / measurement.view_direction.length().max(1e-12);
            nominal + by_brightness * deviations * sigma * along * incidence.sin()
        }
        Nuisance::NoiseExponent { log_reference, sigma } if is_noise => {
            let brightness = (measurement.log_brightness - log_reference).exp();
            (nominal.exp() * brightness.powf(deviations * sigma)).ln()
        }
        Nuisance::Texture { octave, contrast, .. } if is_noise => {
            // Half as many pixels on a length along the view, and a half power of that across, for each octave.
            let octaves = measurement.cos_incidence.powf(-1.5).log2().min(4.0);
            let part = (1.0 - (octaves - octave as f64).abs()).max(0.0);
            let grey = 255.0 * contrast * measurement.luma_slope;
            (nominal.exp() + deviations * part * grey * grey).ln()
        }
        _ => nominal,
    }
}

#[test]
fn every_nuisance_column_is_the_derivative_of_the_prediction() {
    let sequence = sequence();
    let recording = recording(&sequence);
    let model = Model::default();
    let measurements = measure_frames(&recording, &model, 20.0).unwrap();
    let chain = Chain::new(&sequence.setup, &sequence.field, &model).unwrap();
    let nuisances = nuisances(
        &MeanReflectance::new(&recording, &measurements, &chain),
        &CarpetTexture::default(),
        &Photometry { psf_sigma_px: Some(0.5), ..Photometry::of_gamma(2.2) },
    );
    let patches = measured_patches(&measurements);
    let others = Others { nuisances: &nuisances, patches: &patches };
    let frames = linearise(&recording, &measurements, &model, &[], others).unwrap();
    let mut seen = vec![false; nuisances.len()];
    for frame in &frames {
        let rows = frame.measurements.iter().zip(&frame.residuals).zip(&frame.jacobian).zip(&frame.patches);
        for (((measurement, residual), derivatives), patch) in
            rows.filter(|(((_, residual), _), _)| residual.is_finite())
        {
            let nominal = measurement.measured - residual;
            let by_brightness = patch.map_or(1.0, |(_, derivative)| derivative);
            for (column, nuisance) in nuisances.iter().enumerate() {
                let at =
                    |deviations: f64| predicted(nuisance, measurement, nominal, by_brightness, deviations);
                let difference = (at(STEP) - at(-STEP)) / (2.0 * STEP);
                let derivative =
                    derivatives.iter().find(|(of, _)| of.0 == column).map_or(0.0, |entry| entry.1);
                let allowed = TOLERANCE * difference.abs() + 1e-9;
                assert!((derivative - difference).abs() < allowed, "{nuisance:?}: {derivative} {difference}");
                seen[column] |= derivative != 0.0;
            }
        }
    }
    let is_seen = nuisances.iter().zip(&seen).filter(|(nuisance, _)| {
        // Few pictures show carpet at all angles.
        !matches!(nuisance, Nuisance::Texture { .. })
    });
    assert!(is_seen.clone().all(|(_, seen)| *seen), "every nuisance parameter must change some measurement");
}

#[test]
fn a_level_grows_with_the_reflectance_of_the_patch_that_it_was_measured_in() {
    let sequence = sequence();
    let recording = recording(&sequence);
    let model = Model::default();
    let measurements = measure_frames(&recording, &model, 20.0).unwrap();
    let patches = measured_patches(&measurements);
    let others = Others { nuisances: &[], patches: &patches };
    let frames = linearise(&recording, &measurements, &model, &[], others).unwrap();
    for (row, patch) in frames.iter().flat_map(|frame| frame.measurements.iter().zip(&frame.patches)) {
        match (row.quantity.surface(), patch) {
            (Some(_), Some((patch, derivative))) => {
                assert_eq!(patches.smallest_at(row.quantity, row.ground), Some(*patch));
                // The mean over noise bends the encoding a little at dark levels.
                assert!((derivative - 1.0).abs() < 0.05, "{derivative}");
            }
            (None, patch) => assert!(patch.is_none()),
            (Some(_), None) => assert!(!row.measured.is_finite(), "{row:?}"),
        }
    }
}
