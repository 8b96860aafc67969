//! Numbers as they are written.

use reality_sim_gap::report::Estimate;

/// P-values below this are all the same to a reader, and to what computes them.
const LEAST_P: f64 = 1e-99;

/// Three digits, and no more than the number has.
pub fn number(value: f64) -> String {
    digits(value, value)
}

/// A number with as many decimals as a size has for three digits; tiny and huge ones by their power of ten.
fn digits(value: f64, size: f64) -> String {
    let size = size.abs();
    if size != 0.0 && !(1e-4..1e5).contains(&size) {
        return signed(format!("{value:.1e}"));
    }
    let power = if size == 0.0 { 0 } else { size.log10().floor() as i32 };
    let decimals = (2 - power).clamp(0, 6) as usize;
    let text = format!("{value:.decimals$}");
    signed(if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    })
}

/// A number with its standard deviation, both to two digits of the latter.
pub fn estimate(estimate: &Estimate) -> String {
    let Estimate { value, sigma, unit } = estimate;
    let unit = unit_after(unit.as_deref().unwrap_or("1"));
    if *sigma <= 0.0 || !sigma.is_finite() {
        return format!("{}{unit}", number(*value));
    }
    let decimals = (1 - sigma.log10().floor() as i32).clamp(0, 9) as usize;
    let degrees = if unit == " rad" { format!(" ({}°)", number(value.to_degrees())) } else { String::new() };
    signed(format!("{value:.decimals$} ± {sigma:.decimals$}{unit}{degrees}"))
}

/// A unit as it stands behind a number; nothing for a plain number.
pub fn unit_after(unit: &str) -> String {
    match unit {
        "1" | "" => String::new(),
        "px2" => " px²".to_owned(),
        _ => format!(" {unit}"),
    }
}

/// How unlikely something is chance.
pub fn p_value(p: f64) -> String {
    match p {
        p if p < LEAST_P => format!("< {LEAST_P:e}"),
        p if p < 1e-3 => format!("{p:.0e}"),
        p => number(p.min(1.0)),
    }
}

/// Minus signs as long as a plus is wide.
fn signed(text: String) -> String {
    text.strip_prefix('-').map(|rest| format!("−{rest}")).unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits_of_any_size() {
        let cases = [
            (0.0, "0"),
            (0.12345, "0.123"),
            (-1.5, "−1.5"),
            (42.0, "42"),
            (5719.9, "5720"),
            (1.2e-7, "1.2e-7"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn an_estimate_has_the_digits_that_its_deviation_leaves() {
        let of = |value, sigma, unit: &str| estimate(&Estimate { value, sigma, unit: Some(unit.to_owned()) });
        assert_eq!(of(0.423_38, 0.006_33, "1"), "0.4234 ± 0.0063");
        assert_eq!(of(-12.3, 4.0, "px"), "−12.3 ± 4.0 px");
        assert_eq!(of(5719.9, 439.7, "1"), "5720 ± 440");
        assert_eq!(of(0.1, 0.01, "rad"), "0.100 ± 0.010 rad (5.73°)");
        assert_eq!(of(2.0, 0.0, "s"), "2 s");
    }

    #[test]
    fn p_values_keep_their_power_of_ten() {
        assert_eq!([4.86e-49, 0.0, 0.0026, 1.0].map(p_value), ["5e-49", "< 1e-99", "0.0026", "1"]);
    }
}
