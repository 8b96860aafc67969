//! A recording measured where a model expects things, and the model linearised there.

use nalgebra::Vector6;
use rayon::prelude::*;
use reality_sim_core::{pose::Motion2, sequence::SequenceError};
use reality_sim_sensor::{Chain, Changes, Model, ModelError};

use crate::{
    linear_model::column::ColumnIndex,
    linear_model::initial_values::{starting_values, with_value},
    linear_model::nuisance::Nuisance,
    linear_model::odometry_steps::around,
    linear_model::parameters::FittedParameter,
    linear_model::prediction::{Rounding, pose_gradient, reported},
    linear_model::residual::{Context, expected, measured},
    linear_model::system::LinearizedFrame,
    measurement::frame::{FrameCamera, FrameMeasurements, MeasurementConfig, measure_frame},
    measurement::quantity::Quantity,
    measurement::scalar::Measurement,
    recording::{Frame, Recording},
};

/// Numbers of a step of the odometry: forward, left, turn.
const STEP: usize = 3;

/// Why a recording cannot be measured.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// The recording.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// The model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A model that puts the camera under the carpet.
    #[error(
        "the camera of frame {index} is {height_m:.3} m high: it must be above 0, the ground; check the reference poses and \
         the model's camera_height"
    )]
    NotAboveGround {
        /// Of the frame in the recording.
        index: usize,
        /// There, metres.
        height_m: f64,
    },
}

/// Refuses a model that has the camera on the ground or under it.
pub(crate) fn check(recording: &Recording<'_>, model: &Model) -> Result<(), MeasureError> {
    let chain = Chain::new(&recording.sequence.setup, &recording.sequence.field, model)?;
    for frame in &recording.frames {
        let height_m = chain.pose(&recording.trajectory, frame.time_s, 0.5).height_m;
        if height_m <= 0.0 {
            return Err(MeasureError::NotAboveGround { index: frame.index, height_m });
        }
    }
    Ok(())
}

/// Looks at every frame where the model expects things.
pub(crate) fn measure_frames(
    recording: &Recording<'_>,
    model: &Model,
    search_px: f64,
) -> Result<Vec<FrameMeasurements>, MeasureError> {
    let chain = Chain::new(&recording.sequence.setup, &recording.sequence.field, model)?;
    let looking = MeasurementConfig { search_px, gamma: recording.gamma() };
    let one = |frame: &Frame| -> Result<FrameMeasurements, MeasureError> {
        let (picture, bytes) = recording.picture(frame)?;
        Ok(measure_frame(&frame_camera(&chain, recording, frame), &picture, &bytes, looking))
    };
    recording.frames.par_iter().map(one).collect()
}

fn frame_camera<'a>(chain: &'a Chain, recording: &'a Recording<'_>, frame: &Frame) -> FrameCamera<'a> {
    FrameCamera::new(chain, &recording.trajectory, frame.time_s)
}

/// Compares what was seen with a model, and finds how the comparison changes with each column; behind them, with each
/// tolerance.
pub(crate) fn linearise(
    recording: &Recording<'_>,
    looks: &[FrameMeasurements],
    model: &Model,
    columns: &[FittedParameter],
    tolerances: &[Nuisance],
) -> Result<Vec<LinearizedFrame>, MeasureError> {
    let setup = &recording.sequence.setup;
    let photometry = setup.photometry;
    let linear = Linear {
        recording,
        chain: Chain::new(setup, &recording.sequence.field, model)?,
        columns,
        shifted: columns
            .iter()
            .map(|column| Shifted::new(recording, model, column))
            .collect::<Result<_, _>>()?,
        tolerances,
        context: Context {
            gamma: recording.gamma(),
            scene: recording.scene.as_ref(),
            noise: photometry.is_some_and(|p| p.noise_shot.is_some() || p.noise_read.is_some()),
            sharpness: photometry.is_some_and(|p| p.psf_sigma_px.is_some()),
        },
    };
    let steps = around(recording, &recording.frames.iter().collect::<Vec<_>>());
    let frames = recording.frames.par_iter().zip(looks).zip(&steps);
    Ok(frames.map(|((frame, look), about)| linear.frame(frame, look, *about)).collect())
}

/// What frames are compared with.
struct Linear<'a> {
    recording: &'a Recording<'a>,
    chain: Chain,
    columns: &'a [FittedParameter],
    /// For each column.
    shifted: Vec<Shifted>,
    tolerances: &'a [Nuisance],
    context: Context<'a>,
}

impl Linear<'_> {
    /// `about` is how the robot moves at about this time.
    fn frame(&self, frame: &Frame, look: &FrameMeasurements, about: Option<Motion2>) -> LinearizedFrame {
        let rows = measured(look, frame.step, self.context);
        let rounding = Rounding::new(&look.noise_steps);
        let expect = |chain: &Chain| {
            expected(&frame_camera(chain, self.recording, frame), look, &rounding, frame.step, self.context)
        };
        let now = expect(&self.chain);
        let residuals = rows.iter().zip(&now).map(|(row, now)| row.measured - now).collect();
        let mut jacobian: Vec<Vec<(ColumnIndex, f64)>> = vec![Vec::new(); rows.len()];
        let mut put = |column: usize, row: usize, change: f64| {
            if change.is_finite() && change != 0.0 {
                jacobian[row].push((ColumnIndex(column), change));
            }
        };
        for (index, (column, shifted)) in self.columns.iter().zip(&self.shifted).enumerate() {
            let changes = column.effect().about().changes;
            if changes == Changes::Odometry {
                let step = about.and_then(|about| self.odometry_change(shifted, frame, about));
                // Behind all that was seen in the picture.
                for (part, change) in step.into_iter().flatten().enumerate() {
                    put(index, rows.len() - STEP + part, change);
                }
                continue;
            }
            for (row, (then, now)) in expect(&shifted.chain).iter().zip(&now).enumerate() {
                if changes != Changes::Noise || rows[row].quantity == Quantity::NoiseVariance {
                    put(index, row, (then - now) / shifted.step);
                }
            }
        }
        for (index, tolerance) in self.tolerances.iter().enumerate() {
            for (row, now) in now.iter().enumerate() {
                put(self.columns.len() + index, row, tolerance.change(&rows[row], *now));
            }
        }
        let pose = self.pose_changes(frame, &rows);
        LinearizedFrame { measurements: rows, residuals, jacobian, pose }
    }

    /// Change of the three numbers of a frame's step with a column of the odometry.
    fn odometry_change(&self, shifted: &Shifted, frame: &Frame, about: Motion2) -> Option<[f64; STEP]> {
        let duration_s = frame.step?.until_s - frame.time_s;
        let [now, then] = [&self.chain, &shifted.chain].map(|chain| reported(chain, about, duration_s));
        Some(std::array::from_fn(|part| (then[part] - now[part]) / shifted.step))
    }

    /// See [`LinearizedFrame::pose`].
    fn pose_changes(&self, frame: &Frame, rows: &[Measurement]) -> Vec<Vector6<f64>> {
        let here = frame_camera(&self.chain, self.recording, frame);
        let change = |row: &Measurement| {
            let is_line = row.quantity == Quantity::LineOffset;
            let gradient = is_line.then(|| pose_gradient(&here, row.ground, row.normal));
            gradient.flatten().map_or_else(Vector6::zeros, Vector6::from)
        };
        rows.iter().map(change).collect()
    }
}

/// The model with one parameter changed a little.
struct Shifted {
    chain: Chain,
    /// By how much the column's coordinate changed.
    step: f64,
}

impl Shifted {
    fn new(recording: &Recording<'_>, model: &Model, column: &FittedParameter) -> Result<Self, ModelError> {
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
