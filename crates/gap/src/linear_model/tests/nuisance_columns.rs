//! Columns of the nuisance parameters against central differences of a prediction with each of them.

use reality_sim_sensor::Model;

use super::{recording, sequence};
use crate::{
    linear_model::{
        linearization::{linearise, measure_frames},
        nuisance::{Nuisance, nuisances, patch_at},
    },
    measurement::{quantity::Quantity, scalar::Measurement},
};

/// Half the width of a central difference, in standard deviations of the nuisance parameter.
const STEP: f64 = 1e-4;
/// Allowed relative error of a derivative.
const TOLERANCE: f64 = 1e-6;

/// Returns the prediction for a nuisance parameter that is `deviations` standard deviations from its nominal value.
fn predicted(nuisance: &Nuisance, measurement: &Measurement, nominal: f64, deviations: f64) -> f64 {
    let is_blur = measurement.quantity == Quantity::LineBlur;
    let is_carpet = measurement.quantity.is_carpet_level();
    match *nuisance {
        Nuisance::Offset { quantity, sigma } if quantity == measurement.quantity => {
            nominal + deviations * sigma
        }
        Nuisance::Width { sigma } if is_blur => nominal + deviations * sigma * measurement.half_width_px.ln(),
        Nuisance::Kernel { sigma } if is_blur => nominal * (1.0 + deviations * sigma),
        Nuisance::ThinKernel { sigma } if is_blur => {
            let widths = measurement.half_width_px / nominal.sqrt();
            nominal * (1.0 + deviations * sigma / widths.exp())
        }
        // Levels are logarithms of linear values.
        Nuisance::Patch { cell, sigma } if is_carpet && patch_at(measurement.ground) == cell => {
            (nominal.exp() * (deviations * sigma).exp()).ln()
        }
        Nuisance::Sheen { power, sigma } if is_carpet => {
            let reflected = sigma * (1.0 - measurement.cos_incidence).powi(power);
            (nominal.exp() + deviations * reflected).ln()
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
    let nuisances = nuisances(measurements.as_slice());
    let frames = linearise(&recording, &measurements, &model, &[], &nuisances).unwrap();
    let mut seen = vec![false; nuisances.len()];
    for frame in &frames {
        let rows = frame.measurements.iter().zip(&frame.residuals).zip(&frame.jacobian);
        for ((measurement, residual), derivatives) in rows.filter(|((_, residual), _)| residual.is_finite()) {
            let nominal = measurement.measured - residual;
            for (column, nuisance) in nuisances.iter().enumerate() {
                let at = |deviations: f64| predicted(nuisance, measurement, nominal, deviations);
                let difference = (at(STEP) - at(-STEP)) / (2.0 * STEP);
                let derivative =
                    derivatives.iter().find(|(of, _)| of.0 == column).map_or(0.0, |entry| entry.1);
                let allowed = TOLERANCE * difference.abs() + 1e-9;
                assert!((derivative - difference).abs() < allowed, "{nuisance:?}: {derivative} {difference}");
                seen[column] |= derivative != 0.0;
            }
        }
    }
    assert!(seen.iter().all(|seen| *seen), "every nuisance parameter must change some measurement");
}
