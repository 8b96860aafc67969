//! Tests of the decisions about effects, on simulated linear systems.

mod effect_tests;
mod model_search;

use glam::DVec2;
use nalgebra::{DVector, Vector6};
use reality_sim_sensor::{EffectIndex, Model};

use crate::{
    frame_index::{PerFrame, ViewIndex},
    linear_model::{
        column::ColumnIndex,
        linearized_frame::LinearizedFrame,
        parameters::FittedParameter,
        system::{LinearSystem, Weighting},
    },
    measurement::{quantity::Quantity, scalar::Measurement},
    recording::ReferenceKind,
    testing::{Noise, measurement, parameters},
};

/// Number of frames of a simulated recording; each frame is a view of its own.
const FRAMES: usize = 60;
/// Number of measurements in a frame.
const ROWS: usize = 20;

/// Derivative of a measurement by a column, from the frame and from independent random numbers of that measurement.
type Signature = fn(frame: usize, numbers: &[f64]) -> f64;

/// Simulated recording: measurements of one quantity that depend on columns of real effects by invented signatures. Sizes
/// are in multiples of the material size.
#[derive(Clone)]
struct World {
    columns: Vec<FittedParameter>,
    signatures: Vec<Signature>,
    /// True size of each column.
    truth: Vec<f64>,
    /// Factor of the true sizes, by frame and column.
    course: fn(usize, usize) -> f64,
    seed: u64,
}

fn effect(id: &str) -> EffectIndex {
    EffectIndex::find(id).unwrap()
}

impl World {
    /// Creates a recording. Each effect is given by its id, the signature of its first size, and the true value of that
    /// size.
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
            course: |_, _| 1.0,
            seed: 1,
        }
    }

    /// Returns the coordinate of a column whose size is `size` times the material size.
    fn coordinate(&self, column: usize, size: f64) -> f64 {
        let parameter = self.columns[column].parameter();
        let value = self.columns[column].coordinate(parameter.neutral + size.abs() * parameter.material);
        value * size.signum()
    }

    /// Returns the residuals of a model with its linearisation. A change of a column by its material size changes the
    /// measurements by its signature.
    fn frames(&self, model: &Model) -> PerFrame<LinearizedFrame> {
        let mut noise = Noise(self.seed);
        let units: Vec<f64> = (0..self.columns.len()).map(|column| self.coordinate(column, 1.0)).collect();
        let left = |frame: usize, column: usize| {
            let truth = (self.course)(frame, column) * self.coordinate(column, self.truth[column]);
            truth - self.columns[column].coordinate_in(model)
        };
        (0..FRAMES)
            .map(|frame| {
                let mut made = LinearizedFrame {
                    measurements: Vec::new(),
                    residuals: Vec::new(),
                    jacobian: Vec::new(),
                    patches: vec![None; ROWS],
                    pose_gradients: vec![Vector6::zeros(); ROWS],
                };
                for row in 0..ROWS {
                    let numbers: Vec<f64> = (0..4).map(|_| noise.next()).collect();
                    let changes: Vec<f64> = self
                        .signatures
                        .iter()
                        .zip(&units)
                        .map(|(signature, unit)| signature(frame, &numbers) / unit)
                        .collect();
                    let explained: f64 =
                        (0..).zip(&changes).map(|(column, change)| change * left(frame, column)).sum();
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
        let views: Vec<ViewIndex> = (0..frames.len()).map(ViewIndex).collect();
        let columns = parameters(self.columns.len());
        let (weighting, _) = Weighting::estimate(frames, &columns, ReferenceKind::Whole);
        LinearSystem::new(frames, columns, &weighting, &views)
    }

    /// Returns a model in the columns' coordinates.
    fn base(&self, model: &Model) -> DVector<f64> {
        crate::inference::effect_fit::base(&self.columns, model)
    }
}
