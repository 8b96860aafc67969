//! Detection limits of effects that were not found, and reasons why effects cannot be seen at all.

use reality_sim_sensor::{Effect, EffectIndex, Need, Parameter, Stage};
use serde::{Deserialize, Serialize};

use crate::{
    inference::effect_fit::EffectFits,
    inference::power::{PowerAnalysis, SimulatedEffect},
    linear_model::column::ColumnIndex,
    linear_model::parameters::FittedParameter,
    recording::{LEAST_VIEWS, Recording, ReferenceSource},
    thresholds::{InferenceThresholds, Thresholds},
};

const THRESHOLDS: InferenceThresholds = Thresholds::DEFAULT.inference;
/// Number of bisections: from a factor of 1.5 to 3 %.
const BISECTIONS: usize = 4;

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
    /// Whether the robot moved too little: then the recording as a whole, not its view of one effect, falls short.
    pub(crate) fn is_lack_of_movement(self) -> bool {
        matches!(self, Self::CameraAtRest | Self::RobotAtRest | Self::FewViews { .. })
    }
}

/// Returns the detection limit of an effect that is tested beside those in the model, or why it cannot be seen.
pub(crate) fn limit(
    recording: &Recording<'_>,
    power: &PowerAnalysis<'_>,
    effect: EffectIndex,
    all: &[EffectIndex],
) -> NotFound {
    let used = effect.effect();
    if let Some(input) = missing_input(recording, used) {
        return NotFound::Unobservable(UnobservableCause::MissingInput { input });
    }
    let Some((parameter, value)) = limit_of(power, effect, all) else {
        return NotFound::Unobservable(unobservable_cause(recording, used));
    };
    NotFound::Limit { value, unit: parameter.unit, parameter: parameter.name }
}

/// Returns the first observable parameter of an effect, with the size from which the effect is found beside those of the model.
/// Parameters are listed by importance. None if none can be seen.
fn limit_of(
    power: &PowerAnalysis<'_>,
    effect: EffectIndex,
    all: &[EffectIndex],
) -> Option<(&'static Parameter, f64)> {
    let fits = power.fits;
    if fits.evidence.views() < LEAST_VIEWS {
        return None;
    }
    let simulated = power.of(effect, all)?;
    fits.sizes_of(effect).into_iter().find_map(|column| {
        let sigma = sigma_beside(fits, column, all)?;
        let column = fits.columns[column.0];
        Some((column.parameter(), smallest_found(&simulated, &column, sigma)?))
    })
}

/// Returns the standard deviation of a column that is fitted beside the effects of the model. None if it cannot be seen.
fn sigma_beside(fits: &EffectFits<'_>, column: ColumnIndex, all: &[EffectIndex]) -> Option<f64> {
    let mut free = fits.columns_of(all);
    free.insert(0, column);
    let fit = fits.evidence.fit(&free)?;
    let sigma = fits.evidence.sigma(&fit, column);
    (!fit.is_prior_dominated(column) && sigma > 0.0).then_some(sigma)
}

/// Returns the smallest size of a parameter at which the effect is found in nine simulated recordings of ten. None if that is
/// beyond the parameter's range.
fn smallest_found(simulated: &SimulatedEffect<'_>, column: &FittedParameter, sigma: f64) -> Option<f64> {
    let parameter = column.parameter();
    let [low, high] = parameter.range;
    let farthest = if high - parameter.neutral >= parameter.neutral - low { high } else { low };
    let reach = column.coordinate(farthest).abs();
    let is_found = |coordinate: f64| {
        let signed = if farthest < parameter.neutral && column.coordinate(farthest) < 0.0 {
            -coordinate
        } else {
            coordinate
        };
        simulated.is_found_in(THRESHOLDS.power, column.parameter, signed)
    };
    let material = column.coordinate(parameter.neutral + parameter.material).abs();
    // The search starts where few are found: a third of what a test of this parameter alone would find.
    let mut below = (0.5 * material).max(sigma).min(0.5 * reach);
    let mut above = (2.0 * below).min(reach);
    while !is_found(above) {
        if above >= reach {
            return None;
        }
        (below, above) = (above, (1.5 * above).min(reach));
    }
    for _ in 0..BISECTIONS {
        let middle = (below * above).sqrt();
        if is_found(middle) { above = middle } else { below = middle }
    }
    let value = column.size(above);
    let farthest_size = (farthest - parameter.neutral).abs();
    (value < farthest_size).then_some(value)
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
        Need::NominalReflectance => {
            photometry.is_some_and(|p| p.line_linear_rgb.is_some() || p.carpet_linear_rgb.is_some())
        }
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
        frame_index::ViewIndex,
        inference::effect_test::{EffectTest, EffectTests},
        inference::evidence::Evidence,
        linear_model::system::LinearSystem,
        testing::{Noise, system_of},
    };

    const FRAMES: usize = 40;

    /// Returns frames with this much information each on a single column, in which the effect has this coordinate.
    fn system(seed: u64, information: f64, coordinate: f64) -> LinearSystem {
        let mut noise = Noise(seed);
        let mut frame = || {
            let score = information * coordinate + information.sqrt() * noise.next();
            (DMatrix::from_element(1, 1, information), DVector::from_element(1, score))
        };
        system_of((0..FRAMES).map(|_| frame()).collect())
    }

    fn pitch() -> FittedParameter {
        let effect = EffectIndex::find("mount_pitch").unwrap();
        FittedParameter { effect, parameter: 0 }
    }

    fn with_fits<T>(system: &LinearSystem, use_fits: impl FnOnce(&EffectFits<'_>) -> T) -> T {
        let evidence = Evidence::new(system, DVector::zeros(1));
        use_fits(&EffectFits { evidence, columns: &[pitch()] })
    }

    /// Returns the detection limit in a recording that lacks the effect.
    fn limit_in(seed: u64, information: f64) -> Option<f64> {
        with_fits(&system(seed, information, 0.0), |fits| {
            let power = PowerAnalysis::new(fits, (0..FRAMES).map(ViewIndex).collect());
            limit_of(&power, pitch().effect, &[]).map(|(_, value)| value)
        })
    }

    /// Whether the effect is named in a recording in which it has this size.
    fn is_named(seed: u64, information: f64, size: f64) -> bool {
        with_fits(&system(seed, information, pitch().coordinate(size)), |fits| {
            let evidence = Evidence::new(fits.evidence.system, DVector::zeros(1));
            let tests = EffectTests::new(EffectFits { evidence, columns: fits.columns });
            tests.test(pitch().effect, &[], 1).as_ref().is_some_and(EffectTest::is_supported)
        })
    }

    /// Returns the information of a frame with which the estimate's standard deviation is this part of the material size.
    fn information(part: f64) -> f64 {
        let sigma = part * pitch().coordinate(pitch().parameter().material);
        1.0 / (FRAMES as f64 * sigma * sigma)
    }

    #[test]
    fn an_effect_at_its_limit_is_named_in_nine_recordings_of_ten_also_where_the_material_size_binds() {
        for part in [0.6, 0.2, 0.05] {
            let information = information(part);
            let limits: Vec<f64> = (0..24).filter_map(|seed| limit_in(seed, information)).collect();
            assert_eq!(limits.len(), 24);
            let limit = limits.iter().sum::<f64>() / 24.0;
            let named = (0..400).filter(|&seed| is_named(1000 + seed, information, limit)).count();
            assert!((340..=384).contains(&named), "{named} of 400 at {limit}, {part}");
            let seldom = (0..400).filter(|&seed| is_named(1000 + seed, information, 0.4 * limit)).count();
            assert!(seldom < 200, "{seldom} of 400 well below it, {part}");
        }
    }

    #[test]
    fn more_information_lowers_the_limit_down_to_the_material_size() {
        let material = pitch().parameter().material;
        let limit = |part: f64| limit_in(3, information(part)).unwrap();
        assert!((limit(2.0) / limit(1.0) - 2.0).abs() < 0.2, "{} {}", limit(2.0), limit(1.0));
        let least = limit(0.01);
        assert!(least > material && least < 1.1 * material, "{least} {material}");
    }

    #[test]
    fn an_effect_with_hardly_any_information_has_no_limit() {
        assert_eq!(limit_in(3, 1e-3), None);
    }
}
