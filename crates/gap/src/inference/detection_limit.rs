//! Detection limits of effects that were not found, and reasons why effects cannot be seen at all.

use reality_sim_sensor::{Effect, EffectIndex, Need, Stage};
use serde::{Deserialize, Serialize};

use crate::{
    inference::effect_fit::EffectFits,
    inference::hypothesis_test::student_quantile,
    linear_model::column::ColumnIndex,
    recording::{LEAST_VIEWS, Recording, ReferenceSource},
    thresholds::{InferenceThresholds, Thresholds},
};

const THRESHOLDS: InferenceThresholds = Thresholds::DEFAULT.inference;

/// Outcome for an effect that was not found.
#[derive(Debug, Clone, PartialEq)]
pub enum NotFound {
    /// The effect would have been found at this size of one of its parameters.
    Limit {
        /// Size in the parameter's unit.
        value: f64,
        /// Unit of the parameter.
        unit: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
    },
    /// The effect cannot be seen in this recording.
    Unobservable(UnobservableCause),
}

/// Reason why an effect cannot be seen in a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum UnobservableCause {
    /// The recording's files lack what the effect is compared with.
    MissingInput {
        /// Missing part of the files.
        input: MissingInput,
    },
    /// The camera hardly moves, so nothing depends on when a row or a picture is taken.
    CameraAtRest,
    /// The robot hardly moves, so its odometry has nothing to report.
    RobotAtRest,
    /// There are too few views: residuals of a single view may come from that place instead of the camera.
    FewViews {
        /// Number of views.
        views: usize,
        /// Least number of views at which effects can be seen.
        needed: usize,
    },
    /// Other parts of the model, or pose errors, change these pictures in the same way as the effect.
    NotSeparable,
}

/// Part of a recording's files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MissingInput {
    /// Odometry of the frames.
    Odometry,
    /// Reference poses that something other than the pictures measured.
    MeasuredPoses,
    /// Nominal reflectance of lines and carpet.
    Reflectance,
    /// Nominal noise of the sensor.
    Noise,
    /// Nominal sharpness of the picture.
    Sharpness,
}

impl UnobservableCause {
    /// Whether another recording by the same robot would help. Otherwise the recording's files lack something.
    pub(crate) fn is_of_the_recording(self) -> bool {
        !matches!(self, Self::MissingInput { .. })
    }
}

/// Returns the detection limit of an effect that is tested beside those in the model, or why it cannot be seen.
pub(crate) fn limit(
    recording: &Recording<'_>,
    fits: &EffectFits<'_>,
    effect: EffectIndex,
    all: &[EffectIndex],
) -> NotFound {
    let used = effect.effect();
    if let Some(input) = missing_input(recording, used) {
        return NotFound::Unobservable(UnobservableCause::MissingInput { input });
    }
    // The first observable parameter counts: parameters are listed by importance.
    let mut sizes = fits.sizes_of(effect).into_iter();
    let limit = sizes.find_map(|column| Some((column, limit_of(fits, column, all)?)));
    let Some((column, value)) = limit else {
        return NotFound::Unobservable(unobservable_cause(recording, used));
    };
    let parameter = fits.columns[column.0].parameter();
    NotFound::Limit { value, unit: parameter.unit, parameter: parameter.name }
}

/// Returns the detection limit of a single column beside the effects of the model, in the column's unit. None if it cannot
/// be seen.
fn limit_of(fits: &EffectFits<'_>, column: ColumnIndex, all: &[EffectIndex]) -> Option<f64> {
    if fits.evidence.views() < LEAST_VIEWS {
        return None;
    }
    let mut free = fits.columns_of(all);
    free.insert(0, column);
    let fit = fits.evidence.fit(&free)?;
    let sigma = fits.evidence.sigma(&fit, column);
    if fit.is_prior_dominated(column) || sigma <= 0.0 {
        return None;
    }
    let tests = fits.effects().len() as f64;
    let degrees_of_freedom = fits.evidence.degrees_of_freedom() as f64;
    let quantile = |probability: f64| student_quantile(probability, degrees_of_freedom);
    let critical_score = quantile(1.0 - THRESHOLDS.significance / (2.0 * tests));
    let coordinate = (critical_score + quantile(THRESHOLDS.power)) * sigma;
    let parameter = fits.columns[column.0].parameter();
    let value = fits.columns[column.0].size(coordinate).max(parameter.material);
    let reach = (parameter.range[1] - parameter.neutral).max(parameter.neutral - parameter.range[0]);
    (value < reach).then_some(value)
}

/// Returns the first input that an effect needs and the recording's files lack.
fn missing_input(recording: &Recording<'_>, effect: &dyn Effect) -> Option<MissingInput> {
    let missing = effect.about().needs.iter().find(|need| !provides(recording, **need))?;
    Some(match missing {
        Need::Odometry => MissingInput::Odometry,
        Need::MeasuredPoses => MissingInput::MeasuredPoses,
        Need::NominalReflectance => MissingInput::Reflectance,
        Need::NominalNoise => MissingInput::Noise,
        Need::NominalSharpness => MissingInput::Sharpness,
    })
}

/// Whether a recording's files have an input.
fn provides(recording: &Recording<'_>, need: Need) -> bool {
    let photometry = recording.sequence.setup.photometry;
    match need {
        Need::Odometry => recording.sequence.frames.iter().any(|frame| frame.odometry.is_some()),
        Need::MeasuredPoses => recording.source == ReferenceSource::Measured,
        Need::NominalReflectance => recording.reflectance.is_some(),
        Need::NominalNoise => photometry.is_some_and(|p| p.noise_shot.is_some() || p.noise_read.is_some()),
        Need::NominalSharpness => photometry.is_some_and(|p| p.psf_sigma_px.is_some()),
    }
}

/// Returns why a recording that has all inputs cannot show an effect.
fn unobservable_cause(recording: &Recording<'_>, effect: &dyn Effect) -> UnobservableCause {
    let moves = recording.moves();
    let views = recording.view_count();
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

    /// Returns forty frames with this much information each on a single column, in which the effect has this size.
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

    /// Returns the detection limit and the p-value of the fit.
    fn limit_and_p(seed: u64, information: f64, size: f64) -> (Option<f64>, f64) {
        let system = system(seed, information, size);
        let evidence = Evidence::new(&system, DVector::zeros(1));
        let fits = EffectFits { evidence, columns: &[pitch()] };
        let fit = fits.evidence.fit(&[ColumnIndex(0)]).unwrap();
        (limit_of(&fits, ColumnIndex(0), &[]), fits.evidence.p_value(&fit, &[ColumnIndex(0)]))
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
    fn more_information_lowers_the_limit_down_to_the_material_size() {
        let limit = |information: f64| limit_and_p(3, information, 0.0).0.unwrap();
        assert!((limit(2.0) / limit(8.0) - 2.0).abs() < 0.2, "{} {}", limit(2.0), limit(8.0));
        assert_eq!(limit(1e7), pitch().parameter().material);
    }

    #[test]
    fn an_effect_with_hardly_any_information_has_no_limit() {
        assert_eq!(limit_and_p(3, 1e-3, 0.0).0, None);
    }
}
