//! Nominal brightness that would have to be farther off than it is trusted: no effect explains it, tolerances do not, either.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::{naming::ALPHA, report::Unexplained, rows::Channel, tolerance::Tolerance};

/// Colours in the order of a picture's channels.
const COLORS: [&str; 3] = ["red", "green", "blue"];

/// What a fit makes of the tolerances of brightness, in their standard deviations: too much of all together is told, with
/// the one that is farthest off.
pub(crate) fn strained(tolerances: &[Tolerance], fitted: &[f64]) -> Option<Unexplained> {
    let of_brightness: Vec<(&Tolerance, f64)> = tolerances
        .iter()
        .zip(fitted.iter().copied())
        .filter(|(tolerance, _)| is_nominal(tolerance))
        .collect();
    let squares: f64 = of_brightness.iter().map(|(_, value)| value * value).sum();
    let chi_squared = ChiSquared::new(of_brightness.len().max(1) as f64).ok()?;
    let p_value = chi_squared.sf(squares);
    let (farthest, value) = of_brightness.into_iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    let (name, sigma) = named(farthest)?;
    (p_value < ALPHA).then(|| Unexplained {
        channel: Channel::Photometry.name().to_owned(),
        r#where: format!(
            "in all pictures, most of all {name}: farther from what camera.toml says than that is trusted"
        ),
        size: (value * sigma).abs(),
        unit: "1".to_owned(),
        p_value: Some(p_value),
    })
}

fn is_nominal(tolerance: &Tolerance) -> bool {
    named(tolerance).is_some()
}

/// What is off, in words, and one standard deviation of it.
fn named(tolerance: &Tolerance) -> Option<(String, f64)> {
    match *tolerance {
        Tolerance::Offset { group, sigma } if group.channel == Channel::Photometry => {
            let surface = if group.part < 3 { "lines" } else { "carpet" };
            Some((format!("{} of {surface}", COLORS[usize::from(group.part % 3)]), sigma))
        }
        Tolerance::Sheen { sigma, .. } => Some(("carpet seen at a grazing angle".to_owned(), sigma)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tolerance::tolerances;

    #[test]
    fn what_is_within_its_tolerance_is_not_told_and_what_is_far_beyond_is_named() {
        let tolerances = tolerances(&[]);
        let mut fitted = vec![0.5; tolerances.len()];
        assert_eq!(strained(&tolerances, &fitted), None);
        // The carpet's red, see the order of the common tolerances.
        fitted[3] = 5.0;
        let told = strained(&tolerances, &fitted).unwrap();
        assert!(told.r#where.contains("red of carpet"), "{}", told.r#where);
        assert!((told.size - 0.35).abs() < 1e-9 && told.p_value.unwrap() < ALPHA);
    }

    #[test]
    fn strain_on_sharpness_is_not_brightness() {
        let tolerances = tolerances(&[]);
        let fitted: Vec<f64> =
            tolerances.iter().map(|tolerance| if is_nominal(tolerance) { 0.0 } else { 9.0 }).collect();
        assert_eq!(strained(&tolerances, &fitted), None);
    }
}
