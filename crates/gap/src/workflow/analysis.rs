//! From a recording and a model to the report.

use std::collections::BTreeMap;

use nalgebra::DVector;
use reality_sim_sensor::{EffectIndex, Estimates, Model, text::Uncertain};

use crate::{
    diagnostics::dynamic_objects::moving,
    diagnostics::nominal_consistency::strained,
    diagnostics::odometry::following,
    diagnostics::passing,
    diagnostics::residual_patterns::{Pattern, Residuals, patterns},
    inference::detection_limit::{NotFound, limit},
    inference::effect_test::{EffectTest, EffectTests},
    inference::gain::Gain,
    inference::held_out::{ChannelGap, HeldOutResiduals, gaps, restless},
    inference::model_error::ModelError,
    linear_model::linearization::MeasureError,
    linear_model::parameters::FittedParameter,
    linear_model::system::FittedResiduals,
    measurement::quantity::{Channel, ColorChannel, Quantity},
    recording::{Frame, LEAST_VIEWS, Recording, ReferenceSource},
    report::data::{
        EffectReport, Estimate, Gap, Limit, NotFoundReport, PosesReport, Report, Unexplained, Unobservable,
        Verdict,
    },
    report::maps::maps,
    report::text,
    workflow::progress::Progress,
    workflow::selection::{Options, SelectedModel, as_given, find},
};

/// What the workflow made of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// All that was found.
    pub report: Report,
    /// The extended model.
    pub model: Model,
}

/// Runs the whole workflow: finds the effects that a model misses, adds them, and judges the result. `progress` hears
/// of every stage.
///
/// # Errors
///
/// A picture that cannot be read, or a model that is no camera.
pub fn analyse(
    recording: &Recording<'_>,
    model: &Model,
    options: &Options,
    progress: &dyn Fn(Progress),
) -> Result<Analysis, MeasureError> {
    let found = find(recording, model, options, progress)?;
    progress(Progress::Judging);
    let tests = found.effect_tests();
    let all = found.all();
    let before = HeldOutResiduals::new(recording, &found, model)?;
    let after = HeldOutResiduals::new(recording, &found, &found.measured.model)?;
    let channels = gaps(&found, &before, &after);
    let gap = whole_gap(&channels);
    let mut effects = effect_reports(recording, &tests, &found, &found.named, &after)?;
    effects.sort_by(|a, b| b.held_out_gain.value.total_cmp(&a.held_out_gain.value));
    let in_model = effect_reports(recording, &tests, &found, &found.given, &after)?;
    // What is odd in one view may be the place's.
    let unexplained = if tests.evidence.views() < LEAST_VIEWS {
        Vec::new()
    } else {
        let explained = ModelError::new(&found, &before, &after);
        let mut unexplained = unexplained(recording, &found, &tests, &all, &explained);
        if recording.source == ReferenceSource::Measured {
            unexplained.extend(restless(&channels, &explained));
        }
        unexplained
    };
    let (not_found, unobservable) = others(recording, &tests, &all);
    let verdict = verdict(&effects, &unexplained, &unobservable);
    let system = &found.measured.system;
    let [a, b, c, d, e, f] = system.pose_sigmas;
    let mut report = Report {
        recording: recording.sequence.name.clone(),
        frames: recording.frames.len(),
        judged_frames: found.split.judged().count(),
        left_out: recording.left_out.iter().map(|path| path.display().to_string()).collect(),
        verdict,
        summary: String::new(),
        effects,
        in_model,
        unexplained,
        gap,
        not_found,
        unobservable: unobservable.into_iter().map(|(_, report)| report).collect(),
        poses: PosesReport {
            source: recording.source,
            rotation_sigma_rad: [a, b, c],
            position_sigma_m: [d, e, f],
            absorbed: absorbed(recording.source).to_owned(),
        },
        maps: maps(recording, &found, &before, &after),
        shown_frame: shown_frame(recording, &found, &before),
        seed: options.seed,
        field: recording.sequence.field.clone(),
    };
    report.summary = text::summary(text::Findings {
        verdict,
        effects: &report.effects,
        in_model: &report.in_model,
        given: model,
        unexplained: &report.unexplained,
        gap: &report.gap,
        not_found: &report.not_found,
        unobservable: &report.unobservable,
    });
    Ok(Analysis { report, model: found.measured.model.clone() })
}

/// The gap of a model as it is, nothing added: what a simulation that has these effects would get wrong, in noise floors; on
/// the frames that [`analyse`] judges on.
///
/// # Errors
///
/// As of [`analyse`].
pub fn gap_of(recording: &Recording<'_>, model: &Model, options: &Options) -> Result<Gap, MeasureError> {
    let found = as_given(recording, model, options)?;
    let judged = HeldOutResiduals::new(recording, &found, model)?;
    Ok(whole_gap(&gaps(&found, &judged, &judged)))
}

/// A model less one effect.
fn without(model: &Model, effect: EffectIndex) -> Model {
    let id = effect.effect().id();
    let mut model = model.clone();
    model.effects.retain(|used| used.effect.id() != id);
    model
}

/// Part of each channel's distance to the noise floor that is closed, where there is one worth closing.
fn closed(gaps: &BTreeMap<Channel, ChannelGap>) -> BTreeMap<String, f64> {
    let part = |gap: &ChannelGap| {
        let open = gap.before - gap.floor;
        (open > 0.1 * gap.floor).then(|| (gap.before - gap.after) / open)
    };
    gaps.iter()
        .filter_map(|(channel, gap)| Some((channel.name().to_owned(), part(gap)?)))
        .filter(|(_, part)| *part > 0.1)
        .collect()
}

/// All channels together, each in units of its noise floor.
fn whole_gap(gaps: &BTreeMap<Channel, ChannelGap>) -> Gap {
    let count = gaps.len().max(1) as f64;
    let mean = |of: fn(&ChannelGap) -> f64| {
        let squares: f64 = gaps.values().map(|gap| (of(gap) / gap.floor.max(1e-9)).powi(2)).sum();
        (squares / count).sqrt()
    };
    Gap {
        before: mean(|gap| gap.before),
        after: mean(|gap| gap.after),
        floor: 1.0,
        unit: "noise floors".to_owned(),
        channels: gaps.iter().map(|(channel, gap)| (channel.name().to_owned(), gap.clone())).collect(),
    }
}

/// Effects of the model, each with what would be closed less without it.
fn effect_reports(
    recording: &Recording<'_>,
    tests: &EffectTests<'_>,
    found: &SelectedModel,
    effects: &[EffectIndex],
    after: &HeldOutResiduals,
) -> Result<Vec<EffectReport>, MeasureError> {
    let all = found.all();
    let cases = effects.iter().filter_map(|&effect| tests.test(effect, &all, tests.effects().len()));
    let report = |case: EffectTest| {
        let alone = without(&found.measured.model, case.effect);
        let closes = closed(&gaps(found, &HeldOutResiduals::new(recording, found, &alone)?, after));
        Ok(effect_report(tests, &case, found, closes))
    };
    cases.map(report).collect()
}

fn gain(gain: Gain) -> Estimate {
    Estimate { value: gain.value, sigma: gain.sigma, unit: None }
}

fn effect_report(
    tests: &EffectTests<'_>,
    case: &EffectTest,
    found: &SelectedModel,
    closes: BTreeMap<String, f64>,
) -> EffectReport {
    let effect = case.effect.effect();
    let estimates: Vec<(&'static str, Estimate)> = tests
        .columns_of(&[case.effect])
        .into_iter()
        .map(|index| {
            let column: &FittedParameter = &tests.columns[index.0];
            let sigma = tests.evidence.sigma(&case.fit, index);
            // As in the model's file: the last fit's step from there is less than matters.
            let coordinate = tests.evidence.base[index.0];
            let (value, sigma) = (column.value(coordinate), column.value_sigma(coordinate, sigma));
            (
                column.parameter().name,
                Estimate { value, sigma, unit: Some(column.parameter().unit.to_owned()) },
            )
        })
        .collect();
    let uncertain: Vec<(&'static str, Uncertain)> = estimates
        .iter()
        .map(|(name, Estimate { value, sigma, .. })| (*name, Uncertain { value: *value, sigma: *sigma }))
        .collect();
    let correlation = |one: &str, other: &str| {
        let column = |name: &str| {
            let mut columns = tests.columns_of(&[case.effect]).into_iter();
            columns.find(|&column| tests.columns[column.0].parameter().name == name)
        };
        let both = column(one).zip(column(other));
        both.map_or(0.0, |(one, other)| tests.evidence.correlation(&case.fit, [one, other]))
    };
    let rivals = found.confusable_with(case.effect);
    let in_words = Estimates::new(&uncertain, &correlation);
    let (name, because) = effect.name_and_signature(&in_words);
    EffectReport {
        id: effect.id().to_owned(),
        name: name.to_owned(),
        size: effect.size_in_words(&in_words),
        parameters: estimates.into_iter().map(|(name, estimate)| (name.to_owned(), estimate)).collect(),
        p_value: found.p_value(case),
        held_out_gain: gain(case.gain),
        confusable_with: rivals.iter().map(|&rival| rival.effect().id().to_owned()).collect(),
        recording_that_would_decide: rivals
            .iter()
            .map(|&rival| rival.effect().recording_that_would_decide().to_owned())
            .collect(),
        because: because.to_owned(),
        closes,
    }
}

/// Effects that are not in the model: with their limits, or unseen with whether another recording would do.
fn others(
    recording: &Recording<'_>,
    tests: &EffectTests<'_>,
    all: &[EffectIndex],
) -> (Vec<NotFoundReport>, Vec<(bool, Unobservable)>) {
    let (mut not_found, mut unobservable) = (Vec::new(), Vec::new());
    let effects = tests.effects();
    for &index in effects.iter().filter(|effect| !all.contains(effect)) {
        let effect = index.effect();
        match limit(recording, tests, index, all) {
            NotFound::Limit { value, unit, parameter } => {
                let case = tests.test(index, all, effects.len());
                not_found.push(NotFoundReport {
                    id: effect.id().to_owned(),
                    name: effect.name().to_owned(),
                    parameter: parameter.to_owned(),
                    detection_limit: Limit { value, unit: unit.to_owned() },
                    p_value: case.as_ref().map_or(1.0, |case| case.p_value),
                    held_out_gain: gain(case.map_or_else(Gain::default, |case| case.gain)),
                });
            }
            NotFound::Unobservable { reason, remedy, by_recording } => {
                let report = Unobservable {
                    id: effect.id().to_owned(),
                    name: effect.name().to_owned(),
                    reason,
                    recording_that_would_decide: remedy,
                };
                unobservable.push((by_recording, report));
            }
        }
    }
    (not_found, unobservable)
}

fn verdict(
    effects: &[EffectReport],
    unexplained: &[Unexplained],
    unobservable: &[(bool, Unobservable)],
) -> Verdict {
    if !unexplained.is_empty() {
        Verdict::Unknown
    } else if effects.iter().any(|effect| !effect.confusable_with.is_empty()) {
        Verdict::Confusable
    } else if !effects.is_empty() {
        Verdict::Named
    } else if unobservable.iter().any(|(by_recording, _)| *by_recording) {
        Verdict::Inconclusive
    } else {
        Verdict::None
    }
}

/// Residuals of the fitted frames with nothing but poses and tolerances fitted.
fn unexplained(
    recording: &Recording<'_>,
    found: &SelectedModel,
    tests: &EffectTests<'_>,
    all: &[EffectIndex],
    explained: &ModelError,
) -> Vec<Unexplained> {
    let mut delta = tests.evidence.fit(&tests.columns_of(all)).map_or_else(
        || DVector::zeros(found.columns.len() + found.measured.tolerances.len()),
        |fit| fit.delta,
    );
    // The model has settled: effects stay where they are.
    for column in 0..found.columns.len() {
        delta[column] = 0.0;
    }
    let system = &found.measured.system;
    let camera = &recording.sequence.setup.camera;
    let frames: Vec<&Frame> = found.split.fitted().map(|frame| &recording.frames[frame]).collect();
    let residuals: Vec<Residuals<'_>> = found
        .split
        .fitted()
        .zip(&system.weights)
        .map(|(frame, weights)| {
            let rows = &found.measured.frames[frame];
            Residuals {
                measurements: &rows.measurements,
                values: FittedResiduals::new(rows, weights, &delta, &system.pose_sigmas).residuals,
                time_s: recording.frames[frame].time_s,
                camera: found.measured.looks[frame].camera.truncate(),
                size: [camera.width, camera.height],
            }
        })
        .collect();
    let looks: Vec<_> = found.split.fitted().map(|frame| &found.measured.looks[frame]).collect();
    let found_patterns = patterns(&residuals, &system.sigmas, explained, recording.frames[0].time_s);
    let mut unexplained: Vec<Unexplained> = found_patterns.iter().map(unexplained_pattern).collect();
    unexplained.extend(passing::bands(&residuals));
    let carpet =
        system.sigmas.get(&Quantity::CarpetLevel(ColorChannel::Green)).copied().unwrap_or(f64::INFINITY);
    unexplained.extend(passing::things(&residuals, carpet));
    unexplained.extend(moving(&residuals, carpet));
    unexplained.extend(following(recording, &frames, &residuals, &system.sigmas, explained));
    let fitted = &delta.as_slice()[found.columns.len()..];
    unexplained.extend(strained(&found.measured.tolerances, fitted, explained));
    unexplained.extend(crate::diagnostics::missing_lines::missing(&looks, &recording.sequence.field));
    unexplained
}

fn unexplained_pattern(pattern: &Pattern) -> Unexplained {
    Unexplained {
        channel: pattern.channel.name().to_owned(),
        r#where: pattern.place(),
        size: pattern.reported_size(),
        unit: pattern.channel.unit().to_owned(),
        p_value: Some(pattern.p_value),
    }
}

/// What poses that were found in the pictures themselves cannot show.
fn absorbed(source: ReferenceSource) -> &'static str {
    match source {
        ReferenceSource::Measured => "",
        ReferenceSource::Tagged => {
            "place and heading were found in these pictures: whatever moves all lines as another place or heading would is in the poses and not seen here (a camera turned sideways on the robot, part of a time offset while the robot turns); pitch, roll and height are the robot's own, effects on them are seen against those"
        }
    }
}

/// The judged frame with the largest gap before.
fn shown_frame(recording: &Recording<'_>, found: &SelectedModel, before: &HeldOutResiduals) -> usize {
    let size = |frame: usize| -> f64 {
        let rows = found.measured.frames[frame].measurements.iter().zip(&before.residuals[frame]);
        let squares = rows.filter_map(|(row, residual)| {
            let sigma = found.measured.system.sigmas.get(&row.quantity)?;
            residual.is_finite().then(|| (residual / sigma).powi(2).min(100.0))
        });
        squares.sum()
    };
    let frame = found.split.judged().max_by(|&a, &b| size(a).total_cmp(&size(b)));
    frame.map_or(0, |frame| recording.frames[frame].index)
}
