//! Analysis of a recording with a model, up to the report.

use std::collections::BTreeMap;

use nalgebra::DVector;
use rayon::prelude::*;
use reality_sim_sensor::{EffectIndex, Model, Parameter, Role};

use crate::{
    diagnostics::DETECTORS,
    diagnostics::detector::{FitResiduals, FrameResiduals},
    diagnostics::finding::Finding,
    diagnostics::objects::objects,
    frame_index::FrameIndex,
    inference::confirmation::without,
    inference::detection_limit::{NotFound, limit},
    inference::effect_fit::EffectFits,
    inference::effect_test::{EffectTest, EffectTests},
    inference::gain::Gain,
    inference::held_out::{ChannelGap, HeldOutResiduals},
    inference::light_pattern::light_pattern,
    inference::model_error::ModelError,
    inference::power::PowerAnalysis,
    inference::recording_source::{FittedRecording, Linearize},
    inference::selected_model::SelectedModel,
    linear_model::column::ColumnIndex,
    linear_model::fitted_residuals::FittedResiduals,
    linear_model::linearization::MeasureError,
    measurement::quantity::Channel,
    progress::Progress,
    recording::{LEAST_VIEWS, Recording},
    report::analysis::Analysis,
    report::data::{EffectReport, Estimate, Gap, Limit, NotFoundReport, PosesReport, Report, Unobservable},
    report::maps::maps,
    thresholds::{ReportThresholds, Thresholds},
    workflow::input_mistakes::fault,
    workflow::selection::{Options, as_given, find},
    workflow::stopped::stopped,
    workflow::verdict::verdict,
};

const THRESHOLDS: ReportThresholds = Thresholds::DEFAULT.report;

/// Runs the whole workflow: finds the effects that a model lacks, adds them, and evaluates the result on held-out frames. Where
/// the recording's files hold a mistake, or its pictures do not show its field, that is all that is reported. `progress` is called
/// at every stage.
///
/// # Errors
///
/// Returns an error if a picture cannot be read, or if the model does not describe a valid camera.
pub fn analyse(
    recording: &Recording<'_>,
    model: &Model,
    options: &Options,
    progress: &dyn Fn(Progress),
) -> Result<Analysis, MeasureError> {
    if let Some(fault) = fault(recording)? {
        return Ok(stopped(recording, model, options.seed, fault));
    }
    let found = find(recording, model, options, progress)?;
    progress(Progress::Evaluating);
    let tests = found.effect_tests();
    let before = HeldOutResiduals::new(recording, &found, model)?;
    let after = HeldOutResiduals::new(recording, &found, &found.linearized.model)?;
    let channels = compared(recording, &found, model)?;
    let mut effects = effect_reports(recording, &tests, &found, (&found.named, model))?;
    effects.sort_by(|a, b| b.held_out_gain.value.total_cmp(&a.held_out_gain.value));
    let in_model = effect_reports(recording, &tests, &found, (&found.given, model))?;
    let delta = nuisance_fit(&found);
    let model_error = ModelError::new(&found, &before, &after);
    let left = compared(recording, &found, &found.linearized.model)?;
    let fit = fit_residuals(recording, &found, &delta, (&left, &model_error));
    // A pattern in a single view may be due to that place.
    let has_views = tests.fits.evidence.views() >= LEAST_VIEWS;
    let unexplained = if has_views { findings(&fit) } else { Vec::new() };
    let objects = objects(&fit);
    let (not_found, unobservable) = others(recording, &found, &tests);
    let report = Report {
        recording: recording.sequence.name.clone(),
        frames: recording.frames.len(),
        held_out_frames: found.split.held_out().count(),
        left_out: recording.left_out.iter().map(|path| path.display().to_string()).collect(),
        verdict: verdict(&effects, &unexplained, &unobservable),
        effects,
        in_model,
        unexplained,
        objects,
        gap: whole_gap(channels),
        not_found,
        unobservable,
        poses: poses(recording, &found),
        maps: maps(recording, &found, &before, &after),
        shown_frame: shown_frame(recording, &found, &before),
        seed: options.seed,
        field: recording.sequence.field.clone(),
    };
    Ok(Analysis { report, model: found.linearized.model.clone() })
}

/// Returns the gap of a model as it is, in noise floors, on the same held-out frames as [`analyse`]: the error of a
/// simulation with exactly these effects.
///
/// # Errors
///
/// Returns the same errors as [`analyse`].
pub fn gap_of(recording: &Recording<'_>, model: &Model, options: &Options) -> Result<Gap, MeasureError> {
    let found = as_given(recording, model, options)?;
    Ok(whole_gap(compared(recording, &found, model)?))
}

/// Returns the gaps of a model and of the extended one on held-out frames.
fn compared(
    recording: &Recording<'_>,
    found: &SelectedModel,
    model: &Model,
) -> Result<BTreeMap<Channel, ChannelGap>, MeasureError> {
    let source = FittedRecording { recording, columns: &found.columns, split: &found.split };
    Ok(source.compare(model, &found.linearized)?.gaps())
}

/// Returns the fraction of each channel's distance to the noise floor that is closed, for channels with a distance worth
/// closing.
fn closed(gaps: &BTreeMap<Channel, ChannelGap>) -> BTreeMap<Channel, f64> {
    let part = |gap: &ChannelGap| {
        let open = gap.before - gap.floor;
        (open > THRESHOLDS.least_open_gap * gap.floor).then(|| ((gap.before - gap.after) / open).min(1.0))
    };
    let parts = gaps.iter().filter_map(|(channel, gap)| Some((*channel, part(gap)?)));
    parts.filter(|(_, part)| *part > THRESHOLDS.least_closed_part).collect()
}

/// Combines all channels, each in units of its noise floor.
fn whole_gap(channels: BTreeMap<Channel, ChannelGap>) -> Gap {
    let count = channels.len().max(1) as f64;
    let mean = |of: fn(&ChannelGap) -> f64| {
        let gaps = Channel::ALL.iter().filter_map(|channel| channels.get(channel));
        let squares: f64 = gaps.map(|gap| (of(gap) / gap.floor.max(1e-9)).powi(2)).sum();
        (squares / count).sqrt()
    };
    Gap { before: mean(|gap| gap.before), after: mean(|gap| gap.after), floor: 1.0, channels }
}

/// Returns the source of the reference poses with their estimated scatter.
fn poses(recording: &Recording<'_>, found: &SelectedModel) -> PosesReport {
    let [a, b, c, d, e, f] = found.linearized.system.pose_sigmas;
    PosesReport { source: recording.source, rotation_sigma_rad: [a, b, c], position_sigma_m: [d, e, f] }
}

/// Reports the effects of the model, each with the part of the gap that would stay open without it.
fn effect_reports(
    recording: &Recording<'_>,
    tests: &EffectTests<'_>,
    found: &SelectedModel,
    (effects, given): (&[EffectIndex], &Model),
) -> Result<Vec<EffectReport>, MeasureError> {
    let all = found.all();
    let tested = tests.fits.effects().len();
    let made = effects.iter().filter_map(|&effect| tests.test(effect, &all, tested));
    let report = |test: EffectTest| {
        let others = without(&found.linearized.model, test.effect);
        let closes = closed(&compared(recording, found, &others)?);
        Ok(effect_report(&tests.fits, &test, found, given, closes))
    };
    made.map(report).collect()
}

/// Returns a gain as an estimate without a unit.
fn gain(gain: Gain) -> Estimate {
    Estimate { value: gain.value, sigma: gain.sigma, unit: None, at_range_end: false }
}

/// Reports a tested effect. `closes` is the part of each channel's gap that the effect closes.
fn effect_report(
    fits: &EffectFits<'_>,
    test: &EffectTest,
    found: &SelectedModel,
    given: &Model,
    closes: BTreeMap<Channel, f64>,
) -> EffectReport {
    let effect = test.effect.effect();
    let given = given.values(effect.id()).unwrap_or_default();
    let given = effect.parameters().iter().zip(given);
    let confusable = found.confusable_with(test.effect).into_iter();
    EffectReport {
        id: effect.id().to_owned(),
        parameters: estimates(fits, test, &found.linearized.model),
        correlations: correlations(fits, test),
        given: given.map(|(parameter, value)| (parameter.name.to_owned(), *value)).collect(),
        p_value: found.p_value(test),
        held_out_gain: gain(test.gain),
        confusable_with: confusable.map(|other| other.effect().id().to_owned()).collect(),
        closes,
    }
}

/// Returns estimates of an effect's parameters by their names.
fn estimates(fits: &EffectFits<'_>, test: &EffectTest, model: &Model) -> BTreeMap<String, Estimate> {
    let estimate = |index: ColumnIndex| {
        let column = &fits.columns[index.0];
        let sigma = fits.evidence.sigma(&test.fit, index);
        // The value is that of the model file; a further fit would change it by less than its last step did.
        let coordinate = fits.evidence.base[index.0];
        let (value, sigma) = (column.value(coordinate), column.value_sigma(coordinate, sigma));
        let parameter = column.parameter();
        let (unit, at_range_end) = (Some(parameter.unit.to_owned()), is_at_range_end(parameter, value));
        (parameter.name.to_owned(), Estimate { value, sigma, unit, at_range_end })
    };
    let fitted = fits.columns_of(&[test.effect]).into_iter().map(estimate);
    fitted.chain(fixed(test.effect, model)).collect()
}

/// Whether a value lies at an end of its parameter's range. Where the effect vanishes is no such end.
fn is_at_range_end(parameter: &Parameter, value: f64) -> bool {
    let [low, high] = parameter.range;
    let near = THRESHOLDS.range_end * (high - low);
    [low, high].iter().any(|end| (value - end).abs() <= near && (parameter.neutral - end).abs() > near)
}

/// Iterates over the parameters that the recording gives.
fn fixed(effect: EffectIndex, model: &Model) -> impl Iterator<Item = (String, Estimate)> {
    let parameters = effect.effect().parameters().iter();
    let values = model.values(effect.effect().id()).unwrap_or_default();
    let given = parameters.zip(values).filter(|(parameter, _)| parameter.role == Role::Fixed);
    given.map(|(parameter, &value)| {
        let unit = Some(parameter.unit.to_owned());
        (parameter.name.to_owned(), Estimate { value, sigma: 0.0, unit, at_range_end: false })
    })
}

/// Returns correlations of these estimates' errors; each pair of parameters appears once, in their order.
fn correlations(fits: &EffectFits<'_>, test: &EffectTest) -> BTreeMap<String, BTreeMap<String, f64>> {
    let columns = fits.columns_of(&[test.effect]);
    let name = |column: ColumnIndex| fits.columns[column.0].parameter().name.to_owned();
    let mut correlations: BTreeMap<String, BTreeMap<String, f64>> = BTreeMap::new();
    for (index, &one) in columns.iter().enumerate() {
        for &other in &columns[index + 1..] {
            let correlation = fits.evidence.correlation(&test.fit, [one, other]);
            correlations.entry(name(one)).or_default().insert(name(other), correlation);
        }
    }
    correlations
}

/// Reports the effects outside the model: those with a detection limit, and those that are unobservable.
fn others(
    recording: &Recording<'_>,
    found: &SelectedModel,
    tests: &EffectTests<'_>,
) -> (Vec<NotFoundReport>, Vec<Unobservable>) {
    let (all, effects) = (found.all(), tests.fits.effects());
    let views = recording.views();
    let power = PowerAnalysis::new(&tests.fits, found.split.training().map(|frame| views[frame]).collect());
    let outside: Vec<EffectIndex> = effects.iter().copied().filter(|effect| !all.contains(effect)).collect();
    let limits: Vec<NotFound> =
        outside.par_iter().map(|&effect| limit(recording, &power, effect, &all)).collect();
    let (mut not_found, mut unobservable) = (Vec::new(), Vec::new());
    for (index, limit) in outside.into_iter().zip(limits) {
        let id = index.effect().id().to_owned();
        match limit {
            NotFound::Limit { value, unit, parameter } => {
                let test = tests.test(index, &all, effects.len());
                not_found.push(NotFoundReport {
                    id,
                    parameter: parameter.to_owned(),
                    detection_limit: Limit { value, unit: unit.to_owned() },
                    p_value: test.as_ref().map_or(1.0, |test| test.p_value),
                    held_out_gain: gain(test.map_or_else(Gain::default, |test| test.gain)),
                });
            }
            NotFound::Unobservable(cause) => unobservable.push(Unobservable { id, cause }),
        }
    }
    (not_found, unobservable)
}

/// Returns the residuals of the training frames with only poses and nuisance parameters fitted; `delta` is that fit.
fn fit_residuals<'a>(
    recording: &'a Recording<'a>,
    found: &'a SelectedModel,
    delta: &'a DVector<f64>,
    (left, model_error): (&'a BTreeMap<Channel, ChannelGap>, &'a ModelError),
) -> FitResiduals<'a> {
    let linearized = &found.linearized;
    FitResiduals {
        recording,
        start_s: recording.start_s(),
        frames: frame_residuals(recording, found, delta),
        steps: found.split.training().map(|frame| &recording.frames[frame]).collect(),
        measurements: found.split.training().map(|frame| &linearized.measurements[frame]).collect(),
        sigmas: &linearized.system.sigmas,
        nuisances: &linearized.nuisances,
        nuisance_values: &delta.as_slice()[found.columns.len()..linearized.system.columns.dense()],
        model_error,
        light: light_pattern(recording, found),
        left,
    }
}

/// Returns what no effect explains.
fn findings(fit: &FitResiduals<'_>) -> Vec<Finding> {
    DETECTORS.iter().flat_map(|detector| detector.detect(fit)).collect()
}

/// Returns the change of all columns that fits the nuisance parameters. The effects' fit has converged, so they keep their
/// values.
fn nuisance_fit(found: &SelectedModel) -> DVector<f64> {
    let fits = found.effect_fits();
    let mut delta = fits
        .evidence
        .fit(&fits.columns_of(&found.all()))
        .map_or_else(|| DVector::zeros(found.linearized.system.columns.len()), |fit| fit.delta);
    delta.rows_mut(0, found.columns.len()).fill(0.0);
    delta
}

/// Returns the residuals of the training frames after a change `delta` of all columns, with the poses refitted.
fn frame_residuals<'a>(
    recording: &Recording<'_>,
    found: &'a SelectedModel,
    delta: &DVector<f64>,
) -> Vec<FrameResiduals<'a>> {
    let system = &found.linearized.system;
    let camera = &recording.sequence.setup.camera;
    let fitted = found.split.training().zip(&system.weights);
    fitted
        .map(|(index, weights)| {
            let frame = &found.linearized.frames[index];
            FrameResiduals {
                measurements: &frame.measurements,
                values: FittedResiduals::new(frame, weights, delta, &system.columns, &system.pose_sigmas)
                    .residuals,
                time_s: recording.frames[index].time_s,
                camera: found.linearized.measurements[index].camera_in_world.truncate(),
                size: [camera.width, camera.height],
            }
        })
        .collect()
}

/// Returns the held-out frame with the largest gap before the selection.
fn shown_frame(recording: &Recording<'_>, found: &SelectedModel, before: &HeldOutResiduals) -> usize {
    let most = THRESHOLDS.most_shown_sigmas * THRESHOLDS.most_shown_sigmas;
    let size = |frame: FrameIndex| -> f64 {
        let measurements = found.linearized.frames[frame].measurements.iter();
        let squares = measurements.zip(&before.residuals[frame]).filter_map(|(measurement, residual)| {
            let sigma = found.linearized.system.sigmas.get(&measurement.quantity)?;
            residual.is_finite().then(|| (residual / sigma).powi(2).min(most))
        });
        squares.sum()
    };
    let frame = found.split.held_out().max_by(|&a, &b| size(a).total_cmp(&size(b)));
    frame.map_or(0, |frame| recording.frames[frame].index_in_sequence)
}
