//! Measurement of a recording at the lines and the carpet that a model predicts, and linearisation of the predictions.

use nalgebra::Vector6;
use rayon::prelude::*;
use reality_sim_core::{pose::Motion2, sequence::SequenceError};
use reality_sim_sensor::{Chain, Changes, Covariate, Model, ModelError};

use crate::{
    frame_index::{FrameIndex, PerFrame},
    linear_model::{
        column::ColumnIndex,
        linearized_frame::LinearizedFrame,
        mean_reflectance::MeanReflectance,
        nuisance::Nuisance,
        odometry_steps::instrumental_motions,
        parameters::FittedParameter,
        perturbed_model::PerturbedModel,
        pose_gradient::pose_gradient,
        prediction::{Nominal, Predictor, changes},
        reflectance::{PatchIndex, Tree},
        rounding::Rounding,
    },
    measurement::{
        camera::FrameCamera,
        frame::{FrameMeasurements, MeasurementConfig, measure_frame},
        quantity::{ColorChannel, Quantity},
        scalar::{Measurement, component},
    },
    recording::{Frame, Recording},
    simplification::Simplification,
    thresholds::Thresholds,
};

/// Step of the logarithm of the brightness for its forward differences.
const BRIGHTNESS_STEP: f64 = 0.01;
/// Step of the robot's own clock for its forward differences, seconds.
const CLOCK_STEP_S: f64 = 0.005;
/// Longest time between a picture and its reference pose at which the pose is that of the picture's step, seconds.
const LONGEST_CLOCK_S: f64 = Thresholds::DEFAULT.linear_model.same_step_s;

/// Reason why a recording cannot be measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// A picture of the recording cannot be read.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// The model does not describe a valid camera.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The model puts the camera on the ground or below it.
    #[error(
        "the camera of frame {index} is {height_m:.3} m high: it must be above 0, the ground; check the reference poses and \
         the model's camera_height"
    )]
    NotAboveGround {
        /// Index of the frame in the recording.
        index: usize,
        /// Height of the camera above the ground, metres.
        height_m: f64,
    },
}

/// Returns an error if the model puts the camera on the ground or below it.
pub(crate) fn check(recording: &Recording<'_>, model: &Model) -> Result<(), MeasureError> {
    let chain = Chain::new(&recording.sequence.setup, &recording.sequence.field, model)?;
    for frame in &recording.frames {
        let height_m = chain.pose(&recording.trajectory, frame.time_s, 0.5).height_m;
        if height_m <= 0.0 {
            return Err(MeasureError::NotAboveGround { index: frame.index_in_sequence, height_m });
        }
    }
    Ok(())
}

/// Measures every frame at the lines and the carpet that the model predicts. Lines are searched for up to `search_px` from
/// there.
pub(crate) fn measure_frames(
    recording: &Recording<'_>,
    model: &Model,
    search_px: f64,
) -> Result<PerFrame<FrameMeasurements>, MeasureError> {
    measure_chosen(recording, model, search_px, |_| true)
}

/// Measures the chosen frames as [`measure_frames`] does; the others get no measurements.
pub(crate) fn measure_chosen(
    recording: &Recording<'_>,
    model: &Model,
    search_px: f64,
    is_chosen: impl Fn(FrameIndex) -> bool + Sync,
) -> Result<PerFrame<FrameMeasurements>, MeasureError> {
    let chain = Chain::new(&recording.sequence.setup, &recording.sequence.field, model)?;
    let config = MeasurementConfig { search_px, gamma: recording.gamma() };
    let of_frame = |(index, frame): (FrameIndex, &Frame)| -> Result<FrameMeasurements, MeasureError> {
        if !is_chosen(index) {
            return Ok(FrameMeasurements::default());
        }
        let (picture, bytes) = recording.picture(frame)?;
        Ok(measure_frame(&frame_camera(&chain, recording, frame), &picture, &bytes, config))
    };
    let indexed: Vec<(FrameIndex, &Frame)> = recording.frames.indexed().collect();
    let frames: Result<Vec<_>, _> = indexed.into_par_iter().map(of_frame).collect();
    Ok(PerFrame::from(frames?))
}

fn frame_camera<'a>(chain: &'a Chain, recording: &'a Recording<'_>, frame: &Frame) -> FrameCamera<'a> {
    FrameCamera::new(chain, &recording.trajectory, frame.time_s)
}

/// Parameters beside those of effects that a linearisation has columns of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Others<'a> {
    /// Nuisance parameters, in the order of their columns.
    pub(crate) nuisances: &'a [Nuisance],
    /// Patches of the field whose reflectance is free.
    pub(crate) patches: &'a Tree,
}

/// Returns the patches of the field in which levels were measured.
pub(crate) fn measured_patches(measurements: &PerFrame<FrameMeasurements>) -> Tree {
    let of_frame = |frame: &FrameMeasurements| {
        let lines = frame.lines.iter().filter(|line| line.profile.level.is_some());
        let lines = lines.map(|line| (Quantity::LineLevel as fn(ColorChannel) -> Quantity, line.ground));
        let carpet = Quantity::CarpetLevel as fn(ColorChannel) -> Quantity;
        let blocks = frame.blocks.iter().map(|block| (carpet, block.ground));
        let places: Vec<_> = lines.chain(blocks).collect();
        places
            .into_iter()
            .flat_map(|(level, ground)| ColorChannel::ALL.map(|color| (level(color), ground)))
            .collect::<Vec<_>>()
    };
    Tree::new(measurements.iter().flat_map(of_frame))
}

/// Returns the residuals of every frame with their Jacobian. The columns of the fitted parameters come first, by forward
/// differences, followed by those of the nuisance parameters and of the reflectance.
pub(crate) fn linearise(
    recording: &Recording<'_>,
    measurements: &PerFrame<FrameMeasurements>,
    model: &Model,
    parameters: &[FittedParameter],
    others: Others<'_>,
) -> Result<PerFrame<LinearizedFrame>, MeasureError> {
    let setup = &recording.sequence.setup;
    let photometry = setup.photometry;
    let perturbed = parameters.iter().map(|parameter| PerturbedModel::new(recording, model, parameter));
    let chain = Chain::new(setup, &recording.sequence.field, model)?;
    let linearization = Linearization {
        recording,
        parameters,
        perturbed: perturbed.collect::<Result<_, _>>()?,
        others,
        nominal: Nominal {
            gamma: recording.gamma(),
            reflectance: MeanReflectance::new(recording, measurements, &chain),
            noise: photometry.is_some_and(|p| p.noise_shot.is_some() || p.noise_read.is_some()),
        },
        chain,
    };
    let motions = instrumental_motions(recording, &recording.frames.iter().collect::<Vec<_>>());
    let roundings = Rounding::of_frames(measurements);
    let measured = measurements.as_slice().par_iter().zip(&roundings);
    let frames = recording.frames.as_slice().par_iter().zip(measured).zip(&motions);
    let linearized: Vec<LinearizedFrame> = frames
        .map(|((frame, (measured, rounding)), motion)| {
            linearization.frame(frame, measured, rounding, *motion)
        })
        .collect();
    let simplified = |frame: LinearizedFrame| match recording.simplification {
        Some(Simplification::ExactPoses) => frame.at_exact_pose(),
        Some(Simplification::EvenSurfaces) => frame.on_even_surfaces(),
        _ => frame,
    };
    Ok(linearized.into_iter().map(simplified).collect::<Vec<_>>().into())
}

/// Model with its perturbations, at which frames are linearised.
struct Linearization<'a> {
    recording: &'a Recording<'a>,
    chain: Chain,
    parameters: &'a [FittedParameter],
    /// Models for the forward differences, one for each parameter.
    perturbed: Vec<PerturbedModel>,
    others: Others<'a>,
    nominal: Nominal,
}

impl Linearization<'_> {
    /// Linearises a frame. `motion` is that of the robot at about the time of the frame's odometry step.
    fn frame(
        &self,
        frame: &Frame,
        measured: &FrameMeasurements,
        rounding: &Rounding,
        motion: Option<Motion2>,
    ) -> LinearizedFrame {
        let mut measurements = measured.measurements(self.nominal.gamma);
        measurements.extend(frame.step.into_iter().flat_map(|step| Measurement::of_odometry(step.odometry)));
        measurements.extend(frame.stated_attitude_rad.into_iter().flat_map(Measurement::of_attitude));
        let predictor = |chain| Predictor {
            camera: frame_camera(chain, self.recording, frame),
            frame: measured,
            rounding,
            step_until_s: frame.step.map(|step| step.until_s),
            nominal: self.nominal,
            own_clock_s: 0.0,
        };
        let predicted = predictor(&self.chain).predict(&measurements);
        let by_brightness = self.by_brightness(predictor(&self.chain), &measurements, &predicted);
        let by_clock = by_own_clock(predictor(&self.chain), &measurements, &predicted);
        let mut jacobian = Jacobian::new(measurements.len());
        for (column, (parameter, perturbed)) in (0..).zip(self.parameters.iter().zip(&self.perturbed)) {
            // A shift in time depends on other motions than the step's own, whose errors the residual has.
            let is_shift = perturbed.chain.odometry_delay_s() != self.chain.odometry_delay_s();
            let derivatives = if self.is_between_poses(parameter) {
                vec![0.0; measurements.len()]
            } else if parameter.effect().about().changes == Changes::Odometry && !is_shift {
                self.odometry_derivatives(perturbed, frame, motion, &measurements)
            } else {
                let stage = parameter.effect().about().stage;
                let values = predictor(&perturbed.chain)
                    .predict_where(&measurements, |quantity| changes(stage, quantity));
                differences(parameter, &measurements, &predicted, &values, perturbed.step)
            };
            jacobian.push(ColumnIndex(column), derivatives);
        }
        for (column, nuisance) in (self.parameters.len()..).zip(self.others.nuisances) {
            let rows = measurements.iter().zip(&predicted).zip(by_brightness.iter().zip(&by_clock));
            let derivatives = rows.map(|((measurement, value), (by_brightness, by_clock))| {
                let by_input =
                    if measurement.quantity.is_proprioceptive() { by_clock } else { by_brightness };
                nuisance.derivative(measurement, *value, *by_input)
            });
            jacobian.push(ColumnIndex(column), derivatives.collect());
        }
        let residuals = measurements
            .iter()
            .zip(&predicted)
            .map(|(measurement, value)| measurement.measured - value)
            .collect();
        let pose_gradients = self.pose_gradients(frame, &measurements);
        let patches = measurements.iter().zip(by_brightness).map(|pair| self.patch(pair.0, pair.1)).collect();
        LinearizedFrame { measurements, residuals, jacobian: jacobian.rows, patches, pose_gradients }
    }

    /// Whether an effect follows the steps of a robot whose pictures were taken at other times than its reference poses, which
    /// are too far apart to show the steps in between.
    fn is_between_poses(&self, parameter: &FittedParameter) -> bool {
        let follows_steps = parameter.effect().about().covariates.contains(&Covariate::GaitPhase);
        follows_steps && self.chain.clock_s().abs() > LONGEST_CLOCK_S && !self.recording.trajectory.is_dense()
    }

    /// Returns the derivatives of all levels by the logarithm of the light that the surface reflects.
    fn by_brightness(
        &self,
        mut predictor: Predictor<'_>,
        measurements: &[Measurement],
        predicted: &[f64],
    ) -> Vec<f64> {
        let brighter = |linear: f64| linear * BRIGHTNESS_STEP.exp();
        let MeanReflectance { line, carpet } = &mut predictor.nominal.reflectance;
        (line.linear_rgb, carpet.linear_rgb) =
            (line.linear_rgb.map(brighter), carpet.linear_rgb.map(brighter));
        let values = predictor.predict_where(measurements, Quantity::is_level);
        let derivative = |(value, predicted): (f64, &f64)| (value - predicted) / BRIGHTNESS_STEP;
        values.into_iter().zip(predicted).map(derivative).collect()
    }

    /// Returns the patch of the field in which a level was measured, with the derivative by the logarithm of its reflectance.
    fn patch(&self, measurement: &Measurement, by_brightness: f64) -> Option<(PatchIndex, f64)> {
        let is_known = measurement.quantity.is_level() && by_brightness.is_finite();
        let patch =
            is_known.then(|| self.others.patches.smallest_at(measurement.quantity, measurement.ground));
        Some((patch??, by_brightness))
    }

    /// Returns the derivatives of all measurements by a parameter of the odometry, at this motion of the robot.
    fn odometry_derivatives(
        &self,
        perturbed: &PerturbedModel,
        frame: &Frame,
        motion: Option<Motion2>,
        measurements: &[Measurement],
    ) -> Vec<f64> {
        let Some((motion, step)) = motion.zip(frame.step) else { return vec![0.0; measurements.len()] };
        let duration_s = step.until_s - frame.time_s;
        let [unperturbed, perturbed_odometry] =
            [&self.chain, &perturbed.chain].map(|chain| chain.odometry(motion, duration_s));
        let derivative = |measurement: &Measurement| {
            let of = |motion: Motion2| component(motion, measurement.quantity);
            (of(perturbed_odometry) - of(unperturbed)) / perturbed.step
        };
        measurements.iter().map(derivative).collect()
    }

    /// Returns the gradients of [`LinearizedFrame::pose_gradients`].
    fn pose_gradients(&self, frame: &Frame, measurements: &[Measurement]) -> Vec<Vector6<f64>> {
        let camera = frame_camera(&self.chain, self.recording, frame);
        let gradient = |measurement: &Measurement| {
            let is_line = measurement.quantity == Quantity::LineOffset;
            let gradient = is_line.then(|| pose_gradient(&camera, measurement.ground, measurement.normal));
            gradient.flatten().map_or_else(Vector6::zeros, Vector6::from)
        };
        measurements.iter().map(gradient).collect()
    }
}

/// Returns the derivatives of what odometry, joints and IMU say by the time that their clock is ahead, per second.
fn by_own_clock(mut predictor: Predictor<'_>, measurements: &[Measurement], predicted: &[f64]) -> Vec<f64> {
    predictor.own_clock_s = CLOCK_STEP_S;
    let values = predictor.predict_where(measurements, Quantity::is_proprioceptive);
    values.into_iter().zip(predicted).map(|(value, predicted)| (value - predicted) / CLOCK_STEP_S).collect()
}

/// Returns the derivatives of all predictions by a parameter, as forward differences.
fn differences(
    parameter: &FittedParameter,
    measurements: &[Measurement],
    predicted: &[f64],
    perturbed: &[f64],
    step: f64,
) -> Vec<f64> {
    let noise_only = parameter.effect().about().changes == Changes::Noise;
    let difference = |((measurement, value), perturbed): ((&Measurement, &f64), &f64)| {
        let counts = !noise_only || measurement.quantity == Quantity::NoiseVariance;
        if counts { (perturbed - value) / step } else { 0.0 }
    };
    measurements.iter().zip(predicted).zip(perturbed).map(difference).collect()
}

/// Sparse rows of a Jacobian, filled column by column.
struct Jacobian {
    rows: Vec<Vec<(ColumnIndex, f64)>>,
}

impl Jacobian {
    fn new(rows: usize) -> Self {
        Self { rows: vec![Vec::new(); rows] }
    }

    /// Adds a column; derivatives that are zero or not finite are left out.
    fn push(&mut self, column: ColumnIndex, derivatives: Vec<f64>) {
        for (row, derivative) in self.rows.iter_mut().zip(derivatives) {
            if derivative.is_finite() && derivative != 0.0 {
                row.push((column, derivative));
            }
        }
    }
}
