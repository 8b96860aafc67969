//! Parameters of a camera in words.

/// Formats a parameter's value and its standard deviation with the unit that its name ends in.
pub fn of_parameter(name: &str, value: f64, sigma: f64) -> String {
    let plain = name.trim_end_matches("_m").trim_end_matches("_rad").replace('_', " ");
    if name.ends_with("_rad") {
        format!("{plain} {:.2}° ± {:.2}°", value.to_degrees(), sigma.to_degrees())
    } else if name.ends_with("_m") {
        format!("{plain} {:.2} cm ± {:.2} cm", 100.0 * value, 100.0 * sigma)
    } else if name.starts_with(['f', 'c']) {
        format!("{plain} {value:.2} px ± {sigma:.2} px")
    } else {
        format!("{plain} {value:.4} ± {sigma:.4}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_the_unit_of_their_name() {
        assert_eq!(of_parameter("mount_pitch_rad", 0.1_f64.to_radians(), 0.0), "mount pitch 0.10° ± 0.00°");
        assert_eq!(of_parameter("height_m", 0.5, 0.01), "height 50.00 cm ± 1.00 cm");
        assert_eq!(of_parameter("fx", 214.906, 0.03), "fx 214.91 px ± 0.03 px");
        assert_eq!(of_parameter("k1", -0.05, 0.001), "k1 -0.0500 ± 0.0010");
    }
}
