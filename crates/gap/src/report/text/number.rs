//! Numbers with as many digits as they deserve.

/// Half the width of a 95 % interval, in standard deviations.
const INTERVAL: f64 = 1.96;
/// Chance is not told apart below this.
const LEAST_PROBABILITY: f64 = 1e-300;
/// Significant digits of a number whose error is not known.
const DIGITS: i32 = 3;
/// Below this an uncertainty is none.
const LEAST_UNCERTAINTY: f64 = 1e-9;
/// What differs by less than this part is the same.
const MOVED: f64 = 0.02;
/// More digits after the point are never written.
const MOST_DECIMALS: i32 = 9;

/// A number with its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Quantity {
    pub(super) value: f64,
    pub(super) sigma: f64,
}

impl Quantity {
    pub(super) fn scaled(self, factor: f64) -> Self {
        Self { value: factor * self.value, sigma: factor.abs() * self.sigma }
    }

    /// Whether it is more than two standard deviations from 0.
    pub(super) fn stands_out(self) -> bool {
        self.value.abs() > 2.0 * self.sigma
    }

    /// Its size without its sign, as in "1.02°".
    pub(super) fn size(self, unit: &str) -> String {
        Self { value: self.value.abs(), ..self }.signed(unit)
    }

    /// With its sign.
    pub(super) fn signed(self, unit: &str) -> String {
        let (value, _) = with_interval(self.value, INTERVAL * self.sigma);
        format!("{value}{}", spaced(unit))
    }

    /// The 95 % interval in parentheses after a space, as in " (± 0.05°)"; nothing where it is not known.
    pub(super) fn interval(self, unit: &str) -> String {
        let (_, interval) = with_interval(self.value, INTERVAL * self.sigma);
        interval.map_or_else(String::new, |interval| format!(" (± {interval}{})", spaced(unit)))
    }
}

/// Degrees follow their number without a space.
fn spaced(unit: &str) -> String {
    if unit.is_empty() || unit.starts_with('°') { unit.to_owned() } else { format!(" {unit}") }
}

/// A number and its uncertainty, if it is known, with the digits that it leaves.
pub(crate) fn with_interval(value: f64, uncertainty: f64) -> (String, Option<String>) {
    if !value.is_finite() || !uncertainty.is_finite() || uncertainty < LEAST_UNCERTAINTY {
        return (digits(value, DIGITS), None);
    }
    let decimals = decimals_of(uncertainty);
    (rounded(value, decimals), Some(rounded(uncertainty, decimals)))
}

/// "0.520 ± 0.011": a number with its standard deviation.
pub(crate) fn with_sigma(value: f64, sigma: f64) -> String {
    let (value, sigma) = with_interval(value, sigma);
    sigma.map_or(value.clone(), |sigma| format!("{value} ± {sigma}"))
}

/// Digits after the point: two significant ones of the uncertainty while its leading ones are below 0.355, else one (the
/// rule of the Particle Data Group); none that would be 0.
fn decimals_of(uncertainty: f64) -> i32 {
    let magnitude = uncertainty.log10().floor() as i32;
    let leading = uncertainty / 10f64.powi(magnitude);
    let decimals = if leading < 3.55 { 1 - magnitude } else { -magnitude };
    let decimals = decimals.clamp(0, MOST_DECIMALS);
    let text = format!("{uncertainty:.*}", decimals as usize);
    let zeros = text.len() - text.trim_end_matches('0').len();
    if text.contains('.') { decimals - zeros as i32 } else { decimals }
}

/// With so many digits after the point and a proper minus sign.
pub(crate) fn rounded(value: f64, decimals: i32) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let text = format!("{value:.*}", decimals.max(0) as usize);
    match text.strip_prefix('-') {
        // Nothing is left of it.
        Some(rest) if rest.chars().all(|digit| matches!(digit, '0' | '.')) => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// With so many significant digits; whole numbers keep all of theirs.
pub(crate) fn digits(value: f64, significant: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return rounded(value, 0);
    }
    let decimals = (significant - 1 - value.abs().log10().floor() as i32).clamp(0, MOST_DECIMALS);
    rounded(value, decimals)
}

/// A part of one in percent: "93 %".
pub(crate) fn percent(part: f64) -> String {
    format!("{} %", rounded(100.0 * part, 0))
}

/// "0.03", "1.2·10⁻⁹".
pub(crate) fn probability(p_value: f64) -> String {
    if !p_value.is_finite() {
        return "–".to_owned();
    }
    if p_value < LEAST_PROBABILITY {
        return "< 10⁻³⁰⁰".to_owned();
    }
    if p_value >= 1e-3 {
        return digits(p_value, 2);
    }
    let text = format!("{p_value:.1e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    format!("{mantissa}·10{}", exponent.chars().map(superscript).collect::<String>())
}

fn superscript(digit: char) -> char {
    match digit {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4'..='9' => char::from_u32('⁴' as u32 + digit as u32 - '4' as u32).unwrap_or(digit),
        _ => '⁰',
    }
}

/// The part of the distance to the noise floor that is closed; none where there was nothing to close.
pub(crate) fn closed(before: f64, after: f64, floor: f64) -> Option<f64> {
    let part = (before - after) / (before - floor);
    (before > floor && part.is_finite()).then_some(part)
}

/// Whether a gap is another one than before, not the same up to where lines were found anew.
pub(crate) fn has_moved(before: f64, after: f64) -> bool {
    (before - after).abs() > MOVED * before
}

/// The factor and the unit in which residuals of a channel are shown: logarithms as percent.
pub(crate) fn in_channel<'a>(channel: &str, unit: &'a str) -> (f64, &'a str) {
    match (channel, unit) {
        ("photometry" | "noise" | "sharpness", "1") => (100.0, "%"),
        (_, "px2") => (1.0, "px²"),
        (_, "1") => (1.0, ""),
        _ => (1.0, unit),
    }
}

/// A size of a channel's residuals with so many significant digits: "0.13 px²", "7.4 %".
pub(crate) fn amount(channel: &str, size: f64, unit: &str, significant: i32) -> String {
    let (factor, unit) = in_channel(channel, unit);
    format!("{} {unit}", digits(factor * size, significant)).trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_has_the_digits_that_its_uncertainty_leaves() {
        let cases = [
            (1.0234, 0.0512, "1.02", "0.05"),
            (42.31, 0.98, "42", "1"),
            (0.5203, 0.0118, "0.520", "0.012"),
            (-0.066_94, 0.000_21, "−0.06694", "0.00021"),
            (123.4, 37.0, "123", "37"),
            (0.001, 0.2, "0.0", "0.2"),
        ];
        for (value, uncertainty, number, interval) in cases {
            assert_eq!(with_interval(value, uncertainty), (number.to_owned(), Some(interval.to_owned())));
        }
    }

    #[test]
    fn an_unknown_uncertainty_is_not_written() {
        for uncertainty in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(with_interval(0.012_345, uncertainty), ("0.0123".to_owned(), None));
        }
    }

    #[test]
    fn what_is_no_number_is_a_dash() {
        for value in [f64::NAN, f64::INFINITY] {
            assert_eq!(digits(value, 2), "–");
            assert_eq!(probability(value), "–");
            assert_eq!(with_sigma(value, 1.0), "–");
        }
    }

    #[test]
    fn nothing_is_never_negative() {
        assert_eq!(rounded(-0.001, 2), "0.00");
        assert_eq!(digits(-0.0, 3), "0");
    }

    #[test]
    fn small_probabilities_are_powers_of_ten() {
        assert_eq!(probability(0.0312), "0.031");
        assert_eq!(probability(1.24e-9), "1.2·10⁻⁹");
        assert_eq!(probability(3e-145), "3.0·10⁻¹⁴⁵");
        assert_eq!(probability(0.0), "< 10⁻³⁰⁰");
    }

    #[test]
    fn a_gap_that_was_none_cannot_be_closed() {
        assert_eq!(closed(1.0, 1.0, 1.0), None);
        assert_eq!(closed(f64::NAN, 1.0, 1.0), None);
        assert_eq!(closed(3.0, 1.5, 1.0), Some(0.75));
    }
}
