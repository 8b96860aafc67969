//! Numbers of the gap and its channels as readable text.

use reality_sim_sensor::text::digits;

use super::channel::scale;
use crate::measurement::quantity::Channel;

/// Smallest p-value that is written out.
const LEAST_PROBABILITY: f64 = 1e-300;

/// Returns a p-value as text: "0.031", "1.2·10⁻⁹".
pub fn probability(p_value: f64) -> String {
    let power_of_ten =
        |exponent: &str| format!("10{}", exponent.chars().map(superscript).collect::<String>());
    said_probability(p_value, |mantissa, exponent| format!("{mantissa}·{}", power_of_ten(exponent)), "10⁻³⁰⁰")
}

/// Returns a p-value as text for fonts without superscript digits: "0.031", "1.2e-9".
pub fn plain_probability(p_value: f64) -> String {
    said_probability(p_value, |mantissa, exponent| format!("{mantissa}e{exponent}"), "1e-300")
}

/// Returns a p-value as text. `small` joins a mantissa and an exponent; `least` is the text of the smallest p-value.
fn said_probability(p_value: f64, small: impl Fn(&str, &str) -> String, least: &str) -> String {
    if !p_value.is_finite() {
        return "–".to_owned();
    }
    if p_value < LEAST_PROBABILITY {
        return format!("< {least}");
    }
    if p_value >= 1e-3 {
        return digits(p_value, 2);
    }
    let text = format!("{p_value:.1e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    small(mantissa, exponent)
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

/// Returns the fraction of the distance to the noise floor that is closed, at most all of it: what is left may be below the
/// floor by chance. None if there was nothing to close.
pub(crate) fn closed(before: f64, after: f64, floor: f64) -> Option<f64> {
    let part = (before - after) / (before - floor);
    (before > floor && part.is_finite()).then_some(part.min(1.0))
}

/// Returns a channel's size as text with this many significant digits: "0.13 px²", "7.4 %". `unit` is the unit of `size`.
pub fn amount(channel: Channel, size: f64, unit: &str, significant: i32) -> String {
    let (factor, unit) = scale(channel, unit);
    format!("{} {unit}", digits(factor * size, significant)).trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_is_not_finite_is_a_dash() {
        for value in [f64::NAN, f64::INFINITY] {
            assert_eq!(probability(value), "–");
        }
    }

    #[test]
    fn small_probabilities_are_powers_of_ten() {
        assert_eq!(probability(0.0312), "0.031");
        assert_eq!(probability(1.24e-9), "1.2·10⁻⁹");
        assert_eq!(probability(3e-145), "3.0·10⁻¹⁴⁵");
        assert_eq!(probability(0.0), "< 10⁻³⁰⁰");
        assert_eq!([0.0312, 1.24e-9, 0.0].map(plain_probability), ["0.031", "1.2e-9", "< 1e-300"]);
    }

    #[test]
    fn without_a_gap_no_part_of_it_is_closed() {
        assert_eq!(closed(1.0, 1.0, 1.0), None);
        assert_eq!(closed(f64::NAN, 1.0, 1.0), None);
        assert_eq!(closed(3.0, 1.5, 1.0), Some(0.75));
        assert_eq!(closed(3.0, 0.9, 1.0), Some(1.0), "less than the floor is left, by chance");
    }
}
