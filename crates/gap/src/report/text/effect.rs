//! Effects in words.

use reality_sim_sensor::{
    Effect, Estimates, Stage, effect,
    text::{Uncertain, digits, with_sigma},
};

use crate::report::data::{EffectReport, Estimate, Limit, NotFoundReport};

/// Returns what the effect does, in the direction of its estimates: "the camera looks higher than the robot believes". An
/// effect that is not in the library is called by its id.
pub fn effect_name(report: &EffectReport) -> &str {
    effect(&report.id).map_or(report.id.as_str(), |known| name_and_signature(known, report).0)
}

/// Returns the signature by which the effect was recognised, as a clause after "because".
pub fn effect_because(report: &EffectReport) -> &'static str {
    effect(&report.id).map_or("", |known| name_and_signature(known, report).1)
}

/// Returns the effect's size with a 95 % interval: "at the corner 42 % of the light is lost (± 1 %)". A value at the end of its
/// range is no measurement, and has no interval.
pub fn effect_size(report: &EffectReport) -> String {
    if report.parameters.values().any(|estimate| estimate.at_range_end) {
        return at_range_end(report);
    }
    let (values, correlation) = (values(report), |one: &str, other: &str| correlation(report, one, other));
    let estimates = Estimates::new(&values, &correlation);
    effect(&report.id).map_or_else(|| estimates.listed(), |known| known.size_in_words(&estimates))
}

/// Returns, for each effect that this one is confusable with, what to record to tell them apart.
pub fn deciding_recordings(report: &EffectReport) -> Vec<&'static str> {
    let recording = |id: &String| Some(effect(id)?.recording_that_would_decide());
    report.confusable_with.iter().filter_map(recording).collect()
}

/// Returns the library's name of an effect, or its id if it is not in the library.
pub fn library_name(id: &str) -> &str {
    effect(id).map_or(id, |known| known.name())
}

/// Returns "at the end of the plausible range (k1 = 0.15): camera.toml is probably wrong".
fn at_range_end(report: &EffectReport) -> String {
    let ends = report.parameters.iter().filter(|(_, value)| value.at_range_end);
    let ends: Vec<String> = ends.map(|(name, value)| format!("{name} = {}", estimate(value))).collect();
    let file = match effect(&report.id).map(<dyn Effect>::stage) {
        Some(Stage::World) => "field.toml",
        Some(Stage::Odometry) => "frames.csv",
        _ => "camera.toml",
    };
    format!("at the end of the plausible range ({}): {file} is probably wrong", ends.join(", "))
}

/// Returns a number with its standard deviation and its unit: "0.0178 ± 0.0004 rad"; without the former at the end of its range.
pub fn estimate(estimate: &Estimate) -> String {
    let unit = estimate.unit.as_deref().filter(|unit| *unit != "1").unwrap_or("");
    if estimate.at_range_end {
        return format!("{} {unit}", digits(estimate.value, 2)).trim_end().to_owned();
    }
    format!("{} {unit}", with_sigma(estimate.value, estimate.sigma)).trim_end().to_owned()
}

/// Returns the size from which an effect would have been found: "0.080°", "4.0 ms".
pub fn limit(report: &NotFoundReport) -> String {
    let Limit { value, unit } = &report.detection_limit;
    match effect(&report.id) {
        Some(known) => known.limit_in_words(&report.parameter, *value),
        None => format!("{} = {} {unit}", report.parameter, digits(*value, 2)),
    }
}

fn name_and_signature(known: &dyn Effect, report: &EffectReport) -> (&'static str, &'static str) {
    let (values, correlation) = (values(report), |one: &str, other: &str| correlation(report, one, other));
    known.name_and_signature(&Estimates::new(&values, &correlation))
}

/// Returns estimates with their standard deviations, in the order of the library's parameters.
fn values(report: &EffectReport) -> Vec<(&'static str, Uncertain)> {
    let parameters = effect(&report.id).map_or(&[][..], |known| known.parameters());
    let value = |name: &'static str| {
        let Estimate { value, sigma, .. } = report.parameters.get(name)?;
        Some((name, Uncertain { value: *value, sigma: *sigma }))
    };
    parameters.iter().filter_map(|parameter| value(parameter.name)).collect()
}

fn correlation(report: &EffectReport, one: &str, other: &str) -> f64 {
    let of = |one: &str, other: &str| report.correlations.get(one)?.get(other).copied();
    of(one, other).or_else(|| of(other, one)).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::effect_report;

    #[test]
    fn a_name_follows_the_sign_of_the_estimate() {
        let mut pitch = effect_report("mount_pitch", 0.02);
        assert_eq!(effect_name(&pitch), effect("mount_pitch").unwrap().name());
        pitch.parameters.get_mut("pitch_rad").unwrap().value = -0.02;
        assert_ne!(effect_name(&pitch), effect("mount_pitch").unwrap().name());
    }

    #[test]
    fn correlations_are_found_in_either_order() {
        let mut noise = effect_report("sensor_noise", 0.01);
        noise.correlations.entry("shot".to_owned()).or_default().insert("read_variance".to_owned(), -0.9);
        assert_eq!(correlation(&noise, "shot", "read_variance"), -0.9);
        assert_eq!(correlation(&noise, "read_variance", "shot"), -0.9);
        assert_eq!(correlation(&noise, "shot", "strength"), 0.0);
    }

    #[test]
    fn an_effect_that_the_library_does_not_have_is_called_by_its_id() {
        let strange = effect_report("gremlins", 0.1);
        assert_eq!((effect_name(&strange), effect_because(&strange)), ("gremlins", ""));
        assert_eq!(library_name("gremlins"), "gremlins");
    }

    #[test]
    fn a_value_at_the_end_of_its_range_is_no_measurement() {
        let mut pitch = effect_report("mount_pitch", 0.02);
        assert!(effect_size(&pitch).contains('±'));
        pitch.parameters.get_mut("pitch_rad").unwrap().at_range_end = true;
        let said = effect_size(&pitch);
        let expected =
            "at the end of the plausible range (pitch_rad = 0.020 rad): camera.toml is probably wrong";
        assert_eq!(said, expected);
    }

    #[test]
    fn estimates_have_their_unit_unless_they_are_plain_numbers() {
        let of = |unit: Option<&str>| {
            estimate(&Estimate {
                value: 0.421,
                sigma: 0.0051,
                unit: unit.map(str::to_owned),
                at_range_end: false,
            })
        };
        assert_eq!(
            [of(Some("px")), of(Some("1")), of(None)],
            ["0.421 ± 0.005 px", "0.421 ± 0.005", "0.421 ± 0.005"]
        );
    }
}
