//! The decisions about effects, on made-up linear systems.

mod effect_tests;
mod model_search;

use glam::DVec2;
use nalgebra::{DVector, Vector6};
use reality_sim_sensor::{EffectIndex, Model};

use crate::{
    linear_model::{
        column::ColumnIndex,
        parameters::FittedParameter,
        system::{LinearSystem, LinearizedFrame},
    },
    measurement::{quantity::Quantity, scalar::Measurement},
    recording::ReferenceKind,
    testing::{Noise, measurement},
};

/// Frames of a made-up recording, each a view of its own.
const FRAMES: usize = 60;
/// Measurements in a frame.
const ROWS: usize = 20;

/// How each column changes a measurement in a frame, from independent numbers of that measurement.
type Signature = fn(frame: usize, numbers: &[f64]) -> f64;

/// A made-up world: measurements of one quantity that depend on columns of real effects in a made-up way. Sizes are in
/// multiples of what is material.
#[derive(Clone)]
struct World {
    columns: Vec<FittedParameter>,
    signatures: Vec<Signature>,
    /// Of each column.
    truth: Vec<f64>,
    seed: u64,
}

fn effect(id: &str) -> EffectIndex {
    EffectIndex::find(id).unwrap()
}

impl World {
    /// Every effect is given by its id, the signature of its first size, and the true size of that.
    fn new(effects: &[(&str, Signature, f64)]) -> Self {
        let column = |id: &str| {
            let effect = effect(id);
            let parameters = effect.effect().parameters();
            let sizes = 0..parameters.len();
            let columns = sizes.map(|parameter| FittedParameter { effect, parameter });
            columns.into_iter().find(FittedParameter::is_size).unwrap()
        };
        Self {
            columns: effects.iter().map(|(id, ..)| column(id)).collect(),
            signatures: effects.iter().map(|(_, signature, _)| *signature).collect(),
            truth: effects.iter().map(|(.., truth)| *truth).collect(),
            seed: 1,
        }
    }

    /// The fitted number of a column that is this many times what is material.
    fn coordinate(&self, column: usize, size: f64) -> f64 {
        let parameter = self.columns[column].parameter();
        let value = self.columns[column].coordinate(parameter.neutral + size.abs() * parameter.material);
        value * size.signum()
    }

    /// What a model leaves of the measurements, linearised. A column's change with a material size is its signature.
    fn frames(&self, model: &Model) -> Vec<LinearizedFrame> {
        let mut noise = Noise(self.seed);
        let units: Vec<f64> = (0..self.columns.len()).map(|column| self.coordinate(column, 1.0)).collect();
        let left: Vec<f64> = (0..self.columns.len())
            .map(|column| {
                let truth = self.coordinate(column, self.truth[column]);
                truth - self.columns[column].coordinate_in(model)
            })
            .collect();
        (0..FRAMES)
            .map(|frame| {
                let mut made = LinearizedFrame {
                    measurements: Vec::new(),
                    residuals: Vec::new(),
                    jacobian: Vec::new(),
                    pose: vec![Vector6::zeros(); ROWS],
                };
                for row in 0..ROWS {
                    let numbers: Vec<f64> = (0..4).map(|_| noise.next()).collect();
                    let changes: Vec<f64> = self
                        .signatures
                        .iter()
                        .zip(&units)
                        .map(|(signature, unit)| signature(frame, &numbers) / unit)
                        .collect();
                    let explained: f64 = changes.iter().zip(&left).map(|(change, left)| change * left).sum();
                    let ground = DVec2::new(0.5 * frame as f64, 0.5 * row as f64);
                    made.measurements.push(Measurement { ground, ..measurement(Quantity::LineBlur) });
                    made.residuals.push(explained + noise.next());
                    made.jacobian.push(
                        changes
                            .into_iter()
                            .enumerate()
                            .map(|(column, change)| (ColumnIndex(column), change))
                            .collect(),
                    );
                }
                made
            })
            .collect()
    }

    fn system(&self, frames: &[&LinearizedFrame]) -> LinearSystem {
        let views: Vec<usize> = (0..frames.len()).collect();
        LinearSystem::new(frames, self.columns.len(), ReferenceKind::Whole, &views)
    }

    /// Where a model is, in the columns' coordinates.
    fn base(&self, model: &Model) -> DVector<f64> {
        crate::inference::effect_test::base(&self.columns, model)
    }
}
