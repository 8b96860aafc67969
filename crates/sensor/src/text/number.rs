//! Numbers with the digits that their uncertainty justifies.

/// Half width of a 95 % interval, in standard deviations.
pub(super) const INTERVAL: f64 = 1.96;
/// Significant digits of a number whose error is not known.
const DIGITS: i32 = 3;
/// Least uncertainty; smaller ones count as none.
const LEAST_UNCERTAINTY: f64 = 1e-9;
/// Largest number of digits after the point.
const MOST_DECIMALS: i32 = 9;

/// A number with its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertain {
    /// The number.
    pub value: f64,
    /// Standard deviation of the value.
    pub sigma: f64,
}

impl Uncertain {
    /// Multiplies the number and its standard deviation by a factor.
    pub fn scaled(self, factor: f64) -> Self {
        Self { value: factor * self.value, sigma: factor.abs() * self.sigma }
    }

    /// Whether it is more than two standard deviations from 0.
    pub fn stands_out(self) -> bool {
        self.value.abs() > 2.0 * self.sigma
    }
}

/// Rounds a number and its uncertainty, if it is known, to the digits that the uncertainty justifies.
pub fn with_interval(value: f64, uncertainty: f64) -> (String, Option<String>) {
    if !value.is_finite() || !uncertainty.is_finite() || uncertainty < LEAST_UNCERTAINTY {
        return (digits(value, DIGITS), None);
    }
    let decimals = decimals_of(uncertainty);
    (rounded(value, decimals), Some(rounded(uncertainty, decimals)))
}

/// Writes a number with its standard deviation: "0.520 ± 0.011".
pub fn with_sigma(value: f64, sigma: f64) -> String {
    let (value, sigma) = with_interval(value, sigma);
    sigma.map_or(value.clone(), |sigma| format!("{value} ± {sigma}"))
}

/// Returns the number of digits after the point: two significant digits of the uncertainty while its leading digits are
/// below 0.355, else one (the rule of the Particle Data Group), but none that would be 0.
fn decimals_of(uncertainty: f64) -> i32 {
    let magnitude = uncertainty.log10().floor() as i32;
    let leading = uncertainty / 10f64.powi(magnitude);
    let decimals = if leading < 3.55 { 1 - magnitude } else { -magnitude };
    let decimals = decimals.clamp(0, MOST_DECIMALS);
    let text = format!("{uncertainty:.*}", decimals as usize);
    let zeros = text.len() - text.trim_end_matches('0').len();
    if text.contains('.') { decimals - zeros as i32 } else { decimals }
}

/// Writes a value with this many digits after the point and a proper minus sign.
pub fn rounded(value: f64, decimals: i32) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let text = format!("{value:.*}", decimals.max(0) as usize);
    match text.strip_prefix('-') {
        // The number has been rounded to zero.
        Some(rest) if rest.chars().all(|digit| matches!(digit, '0' | '.')) => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// Writes a value with this many significant digits; whole numbers keep all of theirs.
pub fn digits(value: f64, significant: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return rounded(value, 0);
    }
    let decimals = (significant - 1 - value.abs().log10().floor() as i32).clamp(0, MOST_DECIMALS);
    rounded(value, decimals)
}

/// Writes a fraction in percent: "93 %".
pub fn percent(part: f64) -> String {
    format!("{} %", rounded(100.0 * part, 0))
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
    fn a_value_that_is_not_finite_is_a_dash() {
        for value in [f64::NAN, f64::INFINITY] {
            assert_eq!(digits(value, 2), "–");
            assert_eq!(with_sigma(value, 1.0), "–");
        }
    }

    #[test]
    fn nothing_is_never_negative() {
        assert_eq!(rounded(-0.001, 2), "0.00");
        assert_eq!(digits(-0.0, 3), "0");
    }
}
