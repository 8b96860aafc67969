//! A recording measured where a model expects things, and the model linearised there.

use nalgebra::Vector6;
use rayon::prelude::*;
use reality_sim_core::{pose::Motion2, sequence::SequenceError};
use reality_sim_sensor::{Chain, Model, ModelError, Stage};

use crate::{
    columns::Column,
    look::{Look, Looking, View, look},
    predict::{Rounding, pose_gradient, reported},
    recording::{Frame, Recording},
    rows::{Channel, Context, expected, measured},
    starting::{starting_values, with_value},
    steps::around,
    system::FrameRows,
    tolerance::Tolerance,
};

/// Why a recording cannot be measured.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// The recording.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// The model.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Looks at every frame where the model expects things.
pub(crate) fn look_at(
    recording: &Recording<'_>,
    model: &Model,
    search_px: f64,
) -> Result<Vec<Look>, MeasureError> {
    let chain = Chain::new(&recording.sequence.setup, &recording.sequence.field, model)?;
    let looking = Looking { search_px, gamma: recording.gamma() };
    let one = |frame: &Frame| -> Result<Look, MeasureError> {
        let (picture, bytes) = recording.picture(frame)?;
        Ok(look(&view(&chain, recording, frame), &picture, &bytes, looking))
    };
    recording.frames.par_iter().map(one).collect()
}

fn view<'a>(chain: &'a Chain, recording: &'a Recording<'_>, frame: &Frame) -> View<'a> {
    View::new(chain, &recording.trajectory, frame.time_s)
}

/// Compares what was seen with a model, and finds how the comparison changes with each column; behind them, with each
/// tolerance.
pub(crate) fn linearise(
    recording: &Recording<'_>,
    looks: &[Look],
    model: &Model,
    columns: &[Column],
    tolerances: &[Tolerance],
) -> Result<Vec<FrameRows>, MeasureError> {
    let setup = &recording.sequence.setup;
    let field = &recording.sequence.field;
    let chain = Chain::new(setup, field, model)?;
    let shifted: Vec<Shifted> =
        columns.iter().map(|column| Shifted::new(recording, model, column)).collect::<Result<_, _>>()?;
    let photometry = setup.photometry;
    let context = Context {
        gamma: recording.gamma(),
        scene: recording.scene.as_ref(),
        noise: photometry.is_some_and(|p| p.noise_shot.is_some() || p.noise_read.is_some()),
        sharpness: photometry.is_some_and(|p| p.psf_sigma_px.is_some()),
    };
    let steps = around(recording, &recording.frames.iter().collect::<Vec<_>>());
    let one = |((frame, look), about): ((&Frame, &Look), &Option<Motion2>)| {
        let rows = measured(look, frame.step, context);
        let rounding = Rounding::new(&look.noise_steps);
        let expect =
            |chain: &Chain| expected(&view(chain, recording, frame), look, &rounding, frame.step, context);
        let now = expect(&chain);
        let residuals = rows.iter().zip(&now).map(|(row, now)| row.measured - now).collect();
        let mut jacobian: Vec<Vec<(usize, f64)>> = vec![Vec::new(); rows.len()];
        let mut put = |column: usize, row: usize, change: f64| {
            if change.is_finite() && change != 0.0 {
                jacobian[row].push((column, change));
            }
        };
        for (column, shifted) in shifted.iter().enumerate() {
            if columns[column].effect().stage() == Stage::Odometry {
                if let (Some(step), Some(about)) = (frame.step, about) {
                    let reported = |chain: &Chain| reported(chain, *about, step.until_s - frame.time_s);
                    let changes = reported(&shifted.chain).into_iter().zip(reported(&chain));
                    // Behind all that was seen in the picture.
                    for (row, (then, now)) in (rows.len() - reported(&chain).len()..).zip(changes) {
                        put(column, row, (then - now) / shifted.step);
                    }
                }
                continue;
            }
            // Noise moves the mean of dark places a little: too little to be told from anything else.
            let noise_only = columns[column].effect().id() == "sensor_noise";
            let is_used = |row: usize| !noise_only || rows[row].group.channel == Channel::Noise;
            for (row, (then, now)) in
                expect(&shifted.chain).iter().zip(&now).enumerate().filter(|(row, _)| is_used(*row))
            {
                put(column, row, (then - now) / shifted.step);
            }
        }
        for (index, tolerance) in tolerances.iter().enumerate() {
            for (row, now) in now.iter().enumerate() {
                put(columns.len() + index, row, tolerance.change(&rows[row], *now));
            }
        }
        let here = view(&chain, recording, frame);
        let pose = rows
            .iter()
            .map(|row| {
                let gradient = (row.group.channel == Channel::Geometry)
                    .then(|| pose_gradient(&here, row.ground, row.normal));
                gradient.flatten().map_or_else(Vector6::zeros, Vector6::from)
            })
            .collect();
        FrameRows { rows, residuals, jacobian, pose }
    };
    Ok(recording.frames.par_iter().zip(looks).zip(&steps).map(one).collect())
}

/// The model with one parameter changed a little.
struct Shifted {
    chain: Chain,
    /// By how much the column's coordinate changed.
    step: f64,
}

impl Shifted {
    fn new(recording: &Recording<'_>, model: &Model, column: &Column) -> Result<Self, ModelError> {
        let parameter = column.parameter();
        let values = model
            .values(column.effect().id())
            .map_or_else(|| starting_values(column.effect(), recording), <[f64]>::to_vec);
        let value = values[column.parameter];
        // Inwards at the end of the range.
        let step = if value + parameter.step > parameter.range[1] { -parameter.step } else { parameter.step };
        let shifted = with_value(model, column.effect(), &values, column.parameter, value + step);
        let chain = Chain::new(&recording.sequence.setup, &recording.sequence.field, &shifted)?;
        Ok(Self { chain, step: column.coordinate(value + step) - column.coordinate(value) })
    }
}
