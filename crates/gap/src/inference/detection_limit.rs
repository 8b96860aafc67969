//! How large an effect that was not found would have to be to be found, and which cannot be seen at all.

use reality_sim_sensor::{Effect, EffectIndex, Need, Stage};
use serde::{Deserialize, Serialize};

use crate::{
    inference::effect_test::EffectTests,
    inference::hypothesis_test::student_quantile,
    linear_model::column::ColumnIndex,
    recording::{LEAST_VIEWS, Recording},
    thresholds::{InferenceThresholds, Thresholds},
};

const THRESHOLDS: InferenceThresholds = Thresholds::DEFAULT.inference;

/// An effect that was not found.
#[derive(Debug, Clone, PartialEq)]
pub enum NotFound {
    /// It would have been found at this size of its first parameter.
    Limit {
        /// As in the parameter's unit.
        value: f64,
        /// The parameter's.
        unit: &'static str,
        /// The parameter's.
        parameter: &'static str,
    },
    /// It cannot be seen in this recording.
    Unobservable(UnobservableCause),
}

/// Why an effect cannot be seen in a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum UnobservableCause {
    /// The recording's files do not have what the effect is compared with.
    MissingInput {
        /// What they do not have.
        input: MissingInput,
    },
    /// The camera hardly moves: nothing depends on when a row or a picture is taken.
    CameraAtRest,
    /// The robot hardly moves: its odometry has nothing to report.
    RobotAtRest,
    /// Too few views: what is odd in one of them may be the place's own.
    FewViews {
        /// Number of views.
        views: usize,
        /// Number from which on effects can be seen.
        needed: usize,
    },
    /// Other parts of the model, or errors of the poses, change these pictures as the effect does.
    NotSeparable,
}

/// Part of a recording's files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MissingInput {
    /// Odometry of the frames.
    Odometry,
    /// Nominal reflectance of lines and carpet.
    Reflectance,
    /// Nominal noise of the sensor.
    Noise,
    /// Nominal sharpness of the picture.
    Sharpness,
}

impl UnobservableCause {
    /// Whether another recording by the same robot would do; else its files lack something.
    pub(crate) fn is_of_the_recording(self) -> bool {
        !matches!(self, Self::MissingInput { .. })
    }
}

/// What can be said of an effect beside those in the model.
pub(crate) fn limit(
    recording: &Recording<'_>,
    naming: &EffectTests<'_>,
    effect: EffectIndex,
    all: &[EffectIndex],
) -> NotFound {
    let used = effect.effect();
    if let Some(input) = missing_input(recording, used) {
        return NotFound::Unobservable(UnobservableCause::MissingInput { input });
    }
    let columns = naming.columns_of(&[effect]);
    let sizes: Vec<ColumnIndex> =
        columns.into_iter().filter(|&column| naming.columns[column.0].is_size()).collect();
    // The first that can be seen: parameters are listed by their weight.
    let limit = sizes.iter().find_map(|&column| Some((column, limit_of(naming, column, all)?)));
    let Some((column, value)) = limit else {
        return NotFound::Unobservable(unseen_cause(recording, used));
    };
    let parameter = naming.columns[column.0].parameter();
    NotFound::Limit { value, unit: parameter.unit, parameter: parameter.name }
}

/// The limit of one column alone beside the effects of the model, in its unit. None where it cannot be seen.
fn limit_of(naming: &EffectTests<'_>, column: ColumnIndex, all: &[EffectIndex]) -> Option<f64> {
    if naming.evidence.views() < LEAST_VIEWS {
        return None;
    }
    let mut free = naming.columns_of(all);
    free.insert(0, column);
    let fit = naming.evidence.fit(&free)?;
    let sigma = naming.evidence.sigma(&fit, column);
    if fit.tells_nothing(column) || sigma <= 0.0 {
        return None;
    }
    let tests = naming.effects().len() as f64;
    let degrees = naming.evidence.degrees() as f64;
    let sure = student_quantile(1.0 - THRESHOLDS.significance / (2.0 * tests), degrees);
    let coordinate = (sure + student_quantile(THRESHOLDS.power, degrees)) * sigma;
    let parameter = naming.columns[column.0].parameter();
    let value = naming.columns[column.0].size(coordinate).max(parameter.material);
    let reach = (parameter.range[1] - parameter.neutral).max(parameter.neutral - parameter.range[0]);
    (value < reach).then_some(value)
}

/// What an effect needs and the recording's files do not have.
fn missing_input(recording: &Recording<'_>, effect: &dyn Effect) -> Option<MissingInput> {
    let missing = effect.about().needs.iter().find(|need| !provides(recording, **need))?;
    Some(match missing {
        Need::Odometry => MissingInput::Odometry,
        Need::NominalReflectance => MissingInput::Reflectance,
        Need::NominalNoise => MissingInput::Noise,
        Need::NominalSharpness => MissingInput::Sharpness,
    })
}

fn provides(recording: &Recording<'_>, need: Need) -> bool {
    let photometry = recording.sequence.setup.photometry;
    match need {
        Need::Odometry => recording.sequence.frames.iter().any(|frame| frame.odometry.is_some()),
        Need::NominalReflectance => recording.scene.is_some(),
        Need::NominalNoise => photometry.is_some_and(|p| p.noise_shot.is_some() || p.noise_read.is_some()),
        Need::NominalSharpness => photometry.is_some_and(|p| p.psf_sigma_px.is_some()),
    }
}

fn unseen_cause(recording: &Recording<'_>, effect: &dyn Effect) -> UnobservableCause {
    let moves = recording.moves();
    let views = recording.views().last().map_or(0, |last| last + 1);
    match effect.stage() {
        Stage::Motion if !moves => UnobservableCause::CameraAtRest,
        Stage::Odometry if !moves => UnobservableCause::RobotAtRest,
        _ if views < LEAST_VIEWS => UnobservableCause::FewViews { views, needed: LEAST_VIEWS },
        _ => UnobservableCause::NotSeparable,
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::{
        inference::evidence::Evidence,
        linear_model::parameters::FittedParameter,
        linear_model::system::LinearSystem,
        testing::{Noise, system_of},
    };

    /// Forty frames with this much information each on the one column, in which the effect is this large.
    fn system(seed: u64, information: f64, size: f64) -> LinearSystem {
        let mut noise = Noise(seed);
        let mut frame = || {
            let score = information * size + information.sqrt() * noise.next();
            (DMatrix::from_element(1, 1, information), DVector::from_element(1, score))
        };
        system_of((0..40).map(|_| frame()).collect())
    }

    fn pitch() -> FittedParameter {
        let effect = EffectIndex::find("mount_pitch").unwrap();
        FittedParameter { effect, parameter: 0 }
    }

    /// The limit, and how unlikely what is fitted is chance.
    fn limit_and_p(seed: u64, information: f64, size: f64) -> (Option<f64>, f64) {
        let system = system(seed, information, size);
        let evidence = Evidence::new(&system, DVector::zeros(1));
        let naming = EffectTests { evidence, columns: &[pitch()] };
        let fit = naming.evidence.fit(&[ColumnIndex(0)]).unwrap();
        (limit_of(&naming, ColumnIndex(0), &[]), naming.evidence.p_value(&fit, &[ColumnIndex(0)]))
    }

    #[test]
    fn an_effect_at_its_limit_is_found_in_nine_recordings_of_ten() {
        let limits: Vec<f64> = (0..200).filter_map(|seed| limit_and_p(seed, 2.0, 0.0).0).collect();
        assert_eq!(limits.len(), 200);
        let limit = limits.iter().sum::<f64>() / 200.0;
        let size = pitch().coordinate(limit);
        let found =
            (0..400).filter(|&seed| limit_and_p(1000 + seed, 2.0, size).1 < THRESHOLDS.significance).count();
        assert!((320..=396).contains(&found), "{found} of 400 at {limit}");
        let half = (0..400)
            .filter(|&seed| limit_and_p(1000 + seed, 2.0, 0.4 * size).1 < THRESHOLDS.significance)
            .count();
        assert!(half < 160, "{half} of 400 well below it");
    }

    #[test]
    fn more_information_lowers_the_limit_to_what_matters_and_no_farther() {
        let limit = |information: f64| limit_and_p(3, information, 0.0).0.unwrap();
        assert!((limit(2.0) / limit(8.0) - 2.0).abs() < 0.2, "{} {}", limit(2.0), limit(8.0));
        assert_eq!(limit(1e7), pitch().parameter().material);
    }

    #[test]
    fn what_the_pictures_hardly_tell_of_has_no_limit() {
        assert_eq!(limit_and_p(3, 1e-3, 0.0).0, None);
    }
}
