//! Every nuisance's column against a central difference of the prediction with what the nuisance stands for.

use reality_sim_sensor::Model;

use super::{recording, sequence};
use crate::{
    linear_model::{
        linearization::{linearise, measure_frames},
        nuisance::{Nuisance, cell_of, nuisances},
    },
    measurement::{quantity::Quantity, scalar::Measurement},
};

/// Half the width of a central difference, in the nuisance's standard deviations.
const STEP: f64 = 1e-4;
/// A column may be off by this part of its value.
const TOLERANCE: f64 = 1e-6;

/// A prediction with a nuisance that is this many of its standard deviations off.
fn predicted(nuisance: &Nuisance, measurement: &Measurement, expected: f64, deviations: f64) -> f64 {
    let is_blur = measurement.quantity == Quantity::LineBlur;
    let is_carpet = measurement.quantity.is_carpet_level();
    match *nuisance {
        Nuisance::Offset { quantity, sigma } if quantity == measurement.quantity => {
            expected + deviations * sigma
        }
        Nuisance::Width { sigma } if is_blur => {
            expected + deviations * sigma * measurement.half_width_px.ln()
        }
        Nuisance::Kernel { sigma } if is_blur => expected * (1.0 + deviations * sigma),
        Nuisance::ThinKernel { sigma } if is_blur => {
            let widths = measurement.half_width_px / expected.sqrt();
            expected * (1.0 + deviations * sigma / widths.exp())
        }
        // Levels are logarithms of linear values.
        Nuisance::Patch { cell, sigma } if is_carpet && cell_of(measurement.ground) == cell => {
            (expected.exp() * (deviations * sigma).exp()).ln()
        }
        Nuisance::Sheen { power, sigma } if is_carpet => {
            let reflected = sigma * (1.0 - measurement.cos_incidence).powi(power);
            (expected.exp() + deviations * reflected).ln()
        }
        _ => expected,
    }
}

#[test]
fn each_nuisance_changes_what_is_expected_as_its_column_says() {
    let sequence = sequence();
    let recording = recording(&sequence);
    let model = Model::default();
    let measurements = measure_frames(&recording, &model, 20.0).unwrap();
    let nuisances = nuisances(&measurements);
    let frames = linearise(&recording, &measurements, &model, &[], &nuisances).unwrap();
    let mut seen = vec![false; nuisances.len()];
    for frame in &frames {
        let rows = frame.measurements.iter().zip(&frame.residuals).zip(&frame.jacobian);
        for ((measurement, residual), derivatives) in rows.filter(|((_, residual), _)| residual.is_finite()) {
            let expected = measurement.measured - residual;
            for (column, nuisance) in nuisances.iter().enumerate() {
                let at = |deviations: f64| predicted(nuisance, measurement, expected, deviations);
                let difference = (at(STEP) - at(-STEP)) / (2.0 * STEP);
                let derivative =
                    derivatives.iter().find(|(of, _)| of.0 == column).map_or(0.0, |entry| entry.1);
                let allowed = TOLERANCE * difference.abs() + 1e-9;
                assert!((derivative - difference).abs() < allowed, "{nuisance:?}: {derivative} {difference}");
                seen[column] |= derivative != 0.0;
            }
        }
    }
    assert!(seen.iter().all(|seen| *seen), "a nuisance changes nothing that is measured");
}
