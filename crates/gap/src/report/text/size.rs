//! How large an effect is.

use super::number::{Quantity, digits, rounded, with_sigma};

/// Parameter, value, standard deviation.
type Values<'a> = &'a [(&'static str, f64, f64)];

/// Points along each axis at which a field's light is looked at.
const LIGHT_STEPS: i32 = 20;

/// An effect's size as a person says it, from its parameters' names, values and standard deviations, with 95 %
/// intervals: "at the corner 42 % of the light is lost (± 1 %)". Of an unknown effect, "name = value ± sigma". Errors of two
/// of its values are correlated as `correlation` says.
pub(crate) fn size_in_words(
    id: &str,
    values: &[(&'static str, f64, f64)],
    correlation: &dyn Fn(&str, &str) -> f64,
) -> String {
    let known = match id {
        "sensor_noise" => sensor_noise(values, correlation("shot", "read_variance")),
        _ => known(id, values),
    };
    known.unwrap_or_else(|| listed(values))
}

/// None for an unknown effect, or where one of its numbers is missing.
fn known(id: &str, values: Values<'_>) -> Option<String> {
    match id {
        "mount_pitch" => turned(values, "pitch_rad", ["too low", "too high"]),
        "mount_roll" => turned(
            values,
            "roll_rad",
            ["clockwise, seen from behind the camera", "counter-clockwise, seen from behind the camera"],
        ),
        "camera_height" => {
            Some(one_of(get(values, "height_m")?.scaled(100.0), "cm", ["too high", "too low"]))
        }
        "focal_length" => {
            let words = ["larger than calibrated", "smaller than calibrated"];
            Some(one_of(get(values, "scale")?.scaled(100.0), "%", words))
        }
        "principal_point" => principal_point(values),
        "radial_distortion" => radial_distortion(values),
        "chromatic_aberration" => red_and_blue(values, ["red_scale", "blue_scale"], ["larger", "smaller"]),
        "white_balance" => red_and_blue(values, ["red_gain", "blue_gain"], ["brighter", "darker"]),
        "vignetting" => {
            let lost = get(values, "strength")?.scaled(100.0);
            Some(format!("at the corner {} of the light is lost{}", lost.signed("%"), lost.interval("%")))
        }
        "rolling_shutter" => rolling_shutter(values),
        "time_offset" => Some(one_of(get(values, "offset_s")?.scaled(1e3), "ms", ["late", "early"])),
        "motion_blur" => plain(get(values, "exposure_s")?.scaled(1e3), "ms", "the light is gathered for"),
        "defocus" => plain(get(values, "sigma_px")?, "px", "edges are blurred with a standard deviation of"),
        "black_level" => {
            let offset = get(values, "offset")?.scaled(100.0);
            let text = one_of(offset, "% of full scale", ["brighter", "darker"]);
            Some(format!("black is {text}"))
        }
        "tone_curve" => tone_curve(values),
        "exposure_drift" => exposure_drift(values),
        "uneven_illumination" => uneven_illumination(values),
        "field_dimensions" => field_dimensions(values),
        "odometry_scale" => Some(one_of(get(values, "scale")?.scaled(100.0), "%", ["too long", "too short"])),
        "odometry_yaw_drift" => {
            let rate = get(values, "rad_per_s")?.scaled(1f64.to_degrees());
            Some(one_of(rate, "°/s", ["to the left", "to the right"]))
        }
        "odometry_lateral_slip" => {
            let slip = get(values, "m_per_m")?.scaled(100.0);
            let text = one_of(slip, "cm", ["to the left", "to the right"]);
            Some(format!("for each metre ahead the odometry reports another {text}"))
        }
        _ => None,
    }
}

/// A number that is known.
fn get(values: Values<'_>, name: &str) -> Option<Quantity> {
    let &(_, value, sigma) = values.iter().find(|(parameter, ..)| *parameter == name)?;
    value.is_finite().then_some(Quantity { value, sigma })
}

/// "pitch_rad = 0.0178 ± 0.0004" of each.
fn listed(values: Values<'_>) -> String {
    let texts: Vec<String> = values
        .iter()
        .map(|(name, value, sigma)| format!("{name} = {}", with_sigma(*value, *sigma)))
        .collect();
    if texts.is_empty() { "of unknown size".to_owned() } else { texts.join(", ") }
}

/// "1.02° too low (± 0.05°)": the first word where it is positive, else the second.
fn one_of(quantity: Quantity, unit: &str, words: [&str; 2]) -> String {
    let word = words[usize::from(quantity.value < 0.0)];
    // What a unit is part of needs no repeating.
    let short = unit.split(" of ").next().unwrap_or(unit);
    format!("{} {word}{}", quantity.size(unit), quantity.interval(short))
}

/// "edges are blurred with a standard deviation of 1.2 px (± 0.1 px)".
fn plain(quantity: Quantity, unit: &str, words: &str) -> Option<String> {
    Some(format!("{words} {}{}", quantity.signed(unit), quantity.interval(unit)))
}

fn turned(values: Values<'_>, name: &str, words: [&str; 2]) -> Option<String> {
    Some(one_of(get(values, name)?.scaled(1f64.to_degrees()), "°", words))
}

/// Those that stand out, or all where none does.
fn outstanding<T: Copy>(all: &[(T, Quantity)]) -> Vec<(T, Quantity)> {
    let found: Vec<(T, Quantity)> =
        all.iter().copied().filter(|(_, quantity)| quantity.stands_out()).collect();
    if found.is_empty() { all.to_vec() } else { found }
}

fn principal_point(values: Values<'_>) -> Option<String> {
    let x = (["farther right", "farther left"], get(values, "x_px")?);
    let y = (["lower", "higher"], get(values, "y_px")?);
    let texts: Vec<String> =
        outstanding(&[x, y]).into_iter().map(|(words, shift)| one_of(shift, "px", words)).collect();
    Some(format!("the picture's centre is {}", texts.join(" and ")))
}

/// The numbers of the lens, and which way they move points, where that is the same near and far from the middle: in
/// units of the focal length by k₁r³ + k₂r⁵ + …, for small changes of either lens model.
fn radial_distortion(values: Values<'_>) -> Option<String> {
    let names = ["k1", "k2", "k3", "k4"];
    let known: Vec<(&str, Quantity)> =
        names.into_iter().filter_map(|name| Some((name, get(values, name)?))).collect();
    let shift = |radius: f64| {
        let terms = known.iter().zip([3, 5, 7, 9]).map(|((_, k), power)| k.value * radius.powi(power));
        terms.sum::<f64>()
    };
    let way = match [0.4, 0.6, 0.8, 1.0].map(shift) {
        shifts if shifts.iter().all(|shift| *shift > 0.0) => {
            ", which moves points far from the middle outwards"
        }
        shifts if shifts.iter().all(|shift| *shift < 0.0) => {
            ", which moves points far from the middle inwards"
        }
        _ => "",
    };
    let text = |(name, k): (&str, Quantity)| format!("{name} = {}{}", k.signed(""), k.interval(""));
    let texts: Vec<String> = outstanding(&known).into_iter().map(text).collect();
    (!known.is_empty()).then(|| format!("{}{way}", texts.join(", ")))
}

fn red_and_blue(values: Values<'_>, names: [&str; 2], words: [&str; 2]) -> Option<String> {
    let colors = [("red", get(values, names[0])?), ("blue", get(values, names[1])?)];
    let text = |(color, change): (&str, Quantity)| {
        format!("{color} is {}", one_of(change.scaled(100.0), "%", words))
    };
    let texts: Vec<String> = outstanding(&colors).into_iter().map(text).collect();
    Some(format!("{} than green", texts.join(" and ")))
}

fn rolling_shutter(values: Values<'_>) -> Option<String> {
    let readout = get(values, "readout_s")?.scaled(1e3);
    let way = if readout.value < 0.0 { "from the bottom to the top" } else { "from the top to the bottom" };
    let stamp = get(values, "reference_s").filter(|reference| reference.stands_out() && readout.value != 0.0);
    // The row without delay.
    let row = stamp
        .map(|reference| 0.5 - 1e3 * reference.value / readout.value)
        .filter(|row| (-0.1..=1.1).contains(row));
    let stamp = row.map_or_else(String::new, |row| {
        let place = ["the top", "an upper", "the middle", "a lower", "the bottom"]
            [(5.0 * row).clamp(0.0, 4.0) as usize];
        format!("; the time stamp is that of {place} row")
    });
    Some(format!("{way} within {}{}{stamp}", readout.size("ms"), readout.interval("ms")))
}

/// Where it shows best: what a sensor adds in the dark and what it adds to light may be hard to tell apart, not their sum.
fn sensor_noise(values: Values<'_>, correlation: f64) -> Option<String> {
    let (shot, read) = (get(values, "shot")?, get(values, "read_variance")?);
    let at = |tenths: i32| {
        let light = f64::from(tenths) / 10.0;
        let (of_light, both) = (light * shot.sigma, 2.0 * correlation * light * shot.sigma * read.sigma);
        let variance = (of_light.powi(2) + read.sigma.powi(2) + both).max(0.0);
        (tenths, Quantity { value: light * shot.value + read.value, sigma: variance.sqrt() })
    };
    let surely = |quantity: &Quantity| quantity.value.abs() / quantity.sigma.max(f64::MIN_POSITIVE);
    let (tenths, variance) = (0..=10).map(at).max_by(|a, b| surely(&a.1).total_cmp(&surely(&b.1)))?;
    let place = match tenths {
        0 => "where it is black".to_owned(),
        10 => "where it is white".to_owned(),
        _ => format!("at {} % of full light", 10 * tenths),
    };
    let size = variance.value.abs().sqrt();
    let noise = Quantity { value: 100.0 * size, sigma: 100.0 * variance.sigma / (2.0 * size) };
    let word = if variance.value < 0.0 { "is too much" } else { "is missing" };
    Some(format!("{place}, {} {word}{}", noise.signed("% of full scale"), noise.interval("%")))
}

fn tone_curve(values: Values<'_>) -> Option<String> {
    let changes = [
        (["higher", "lower"], "gamma is", get(values, "gamma_change")?),
        (["steeper", "flatter"], "the curve's middle is", get(values, "contrast")?),
    ];
    let found = outstanding(&changes.map(|(words, what, change)| ((words, what), change)));
    let text = |((words, what), change): (([&str; 2], &str), Quantity)| {
        format!("{what} {}", one_of(change, "", words))
    };
    Some(found.into_iter().map(text).collect::<Vec<String>>().join(", "))
}

/// From the darkest knot to the brightest.
fn exposure_drift(values: Values<'_>) -> Option<String> {
    let knots: Vec<Quantity> = values
        .iter()
        .filter(|(name, value, _)| name.starts_with("ev_") && value.is_finite())
        .map(|&(_, value, sigma)| Quantity { value, sigma })
        .collect();
    let by_value = |a: &&Quantity, b: &&Quantity| a.value.total_cmp(&b.value);
    let (darkest, brightest) = (knots.iter().min_by(by_value)?, knots.iter().max_by(by_value)?);
    let range =
        Quantity { value: brightest.value - darkest.value, sigma: brightest.sigma.hypot(darkest.sigma) };
    Some(format!(
        "the brightest moment has {} % more light than the darkest, {}{}",
        rounded(100.0 * (range.value.exp2() - 1.0), 0),
        range.signed("EV"),
        range.interval("EV")
    ))
}

/// The brightest and the darkest place of the polynomial over the field. The coefficients depend on each other in a way
/// that their standard deviations do not tell: there is no interval.
fn uneven_illumination(values: Values<'_>) -> Option<String> {
    let names = ["x", "y", "xx", "xy", "yy", "xxx", "xxy", "xyy", "yyy"];
    let factors: Vec<f64> =
        names.into_iter().map(|name| Some(get(values, name)?.value)).collect::<Option<_>>()?;
    let exponent = |x: f64, y: f64| {
        let terms = [x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y];
        factors.iter().zip(terms).map(|(factor, term)| factor * term).sum::<f64>()
    };
    let steps = || (-LIGHT_STEPS..=LIGHT_STEPS).map(|step| f64::from(step) / f64::from(LIGHT_STEPS));
    let places = || steps().flat_map(|x| steps().map(move |y| (exponent(x, y), x, y)));
    let brightest = places().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let darkest = places().min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!(
        "the light is brightest {} and darkest {}, by a factor of {}",
        part_of_field(brightest.1, brightest.2),
        part_of_field(darkest.1, darkest.2),
        digits((brightest.0 - darkest.0).exp(), 2)
    ))
}

/// A place on the field in units of half its length and width.
fn part_of_field(x: f64, y: f64) -> &'static str {
    let third = |value: f64| (1.5 * (value + 1.0)).clamp(0.0, 2.0) as usize;
    [
        ["in the corner at −x and −y", "at the end at −x", "in the corner at −x and +y"],
        ["at the side at −y", "in the middle of the field", "at the side at +y"],
        ["in the corner at +x and −y", "at the end at +x", "in the corner at +x and +y"],
    ][third(x)][third(y)]
}

fn field_dimensions(values: Values<'_>) -> Option<String> {
    let parts = [
        ("length_m", "the field is", ["longer", "shorter"]),
        ("width_m", "the field is", ["wider", "narrower"]),
        ("goal_area_length_m", "the goal areas are", ["deeper", "less deep"]),
        ("goal_area_width_m", "the goal areas are", ["wider", "narrower"]),
        ("center_circle_diameter_m", "the centre circle is", ["wider", "narrower"]),
    ];
    let known: Vec<((&str, [&str; 2]), Quantity)> = parts
        .into_iter()
        .filter_map(|(name, what, words)| Some(((what, words), get(values, name)?)))
        .collect();
    let text = |((what, words), change): ((&str, [&str; 2]), Quantity)| {
        format!("{what} {}", one_of(change.scaled(100.0), "cm", words))
    };
    (!known.is_empty()).then(|| outstanding(&known).into_iter().map(text).collect::<Vec<String>>().join(", "))
}

#[cfg(test)]
mod tests {
    use reality_sim_sensor::library;

    use super::*;

    fn independent(id: &str, values: Values<'_>) -> String {
        size_in_words(id, values, &|_, _| 0.0)
    }

    #[test]
    fn effects_with_one_number_are_said_in_the_units_of_people() {
        let degree = 1f64.to_radians();
        let cases: [(&str, (&'static str, f64, f64), &str); 15] = [
            ("vignetting", ("strength", 0.421, 0.0051), "at the corner 42 % of the light is lost (± 1 %)"),
            ("mount_pitch", ("pitch_rad", 1.02 * degree, 0.0255 * degree), "1.02° too low (± 0.05°)"),
            ("mount_pitch", ("pitch_rad", -1.02 * degree, 0.0255 * degree), "1.02° too high (± 0.05°)"),
            (
                "mount_roll",
                ("roll_rad", -0.5 * degree, 0.1 * degree),
                "0.5° counter-clockwise, seen from behind the camera (± 0.2°)",
            ),
            ("camera_height", ("height_m", 0.021, 0.001), "2.1 cm too high (± 0.2 cm)"),
            ("focal_length", ("scale", -0.021, 0.001), "2.1 % smaller than calibrated (± 0.2 %)"),
            (
                "rolling_shutter",
                ("readout_s", 0.02, 0.000_51),
                "from the top to the bottom within 20 ms (± 1 ms)",
            ),
            ("time_offset", ("offset_s", -0.07, 0.001), "70 ms early (± 2 ms)"),
            ("motion_blur", ("exposure_s", 0.012, 0.0004), "the light is gathered for 12.0 ms (± 0.8 ms)"),
            (
                "defocus",
                ("sigma_px", 1.21, 0.05),
                "edges are blurred with a standard deviation of 1.2 px (± 0.1 px)",
            ),
            ("black_level", ("offset", 0.031, 0.001), "black is 3.1 % of full scale brighter (± 0.2 %)"),
            ("odometry_scale", ("scale", 0.05, 0.0051), "5 % too long (± 1 %)"),
            (
                "odometry_yaw_drift",
                ("rad_per_s", -0.6 * degree, 0.051 * degree),
                "0.6°/s to the right (± 0.1°/s)",
            ),
            (
                "odometry_lateral_slip",
                ("m_per_m", 0.04, 0.001),
                "for each metre ahead the odometry reports another 4.0 cm to the left (± 0.2 cm)",
            ),
            ("no_such_effect", ("strength", 0.52, 0.01), "strength = 0.52 ± 0.01"),
        ];
        for (id, value, text) in cases {
            assert_eq!(independent(id, &[value]), text);
        }
    }

    #[test]
    fn colours_are_compared_with_green() {
        let size = independent("white_balance", &[("red_gain", 0.12, 0.0051), ("blue_gain", -0.08, 0.0051)]);
        assert_eq!(size, "red is 12 % brighter (± 1 %) and blue is 8 % darker (± 1 %) than green");
        let size =
            independent("chromatic_aberration", &[("red_scale", 0.002, 0.0001), ("blue_scale", 0.0, 0.0001)]);
        assert_eq!(size, "red is 0.20 % larger (± 0.02 %) than green");
    }

    #[test]
    fn the_lens_bends_in_or_out_only_where_all_its_numbers_agree() {
        let inwards = [("k1", -0.067, 0.002), ("k2", 0.001, 0.002), ("k3", 0.0, 0.001), ("k4", 0.0, 0.001)];
        let text = independent("radial_distortion", &inwards);
        assert_eq!(text, "k1 = −0.067 (± 0.004), which moves points far from the middle inwards");
        let both_ways = [("k1", -0.05, 0.002), ("k2", 0.09, 0.002), ("k3", 0.0, 0.001), ("k4", 0.0, 0.001)];
        let text = independent("radial_distortion", &both_ways);
        assert_eq!(text, "k1 = −0.050 (± 0.004), k2 = 0.090 (± 0.004)");
    }

    #[test]
    fn the_row_of_the_time_stamp_is_named_where_it_is_known() {
        let values = [("readout_s", 0.02, 0.000_51), ("reference_s", 0.01, 0.0005)];
        let text = independent("rolling_shutter", &values);
        assert_eq!(
            text,
            "from the top to the bottom within 20 ms (± 1 ms); the time stamp is that of the top row"
        );
    }

    #[test]
    fn a_drift_is_from_the_darkest_moment_to_the_brightest() {
        let values =
            [("from_s", 5.0, 0.0), ("ev_01", -0.3, 0.01), ("ev_02", 0.5, 0.01), ("ev_03", f64::NAN, 0.0)];
        assert_eq!(
            independent("exposure_drift", &values),
            "the brightest moment has 74 % more light than the darkest, 0.800 EV (± 0.028 EV)"
        );
    }

    #[test]
    fn uneven_light_has_a_brightest_and_a_darkest_place() {
        let names = ["x", "y", "xx", "xy", "yy", "xxx", "xxy", "xyy", "yyy"];
        let values = names.map(|name| {
            (
                name,
                if name == "x" {
                    0.3
                } else if name == "yy" {
                    -0.2
                } else {
                    0.0
                },
                0.01,
            )
        });
        assert_eq!(
            independent("uneven_illumination", &values),
            "the light is brightest at the end at +x and darkest in the corner at −x and −y, by a factor of 2.2"
        );
    }

    #[test]
    fn only_dimensions_that_differ_are_named() {
        let values =
            [("length_m", 0.121, 0.01), ("width_m", 0.005, 0.01), ("center_circle_diameter_m", -0.05, 0.01)];
        assert_eq!(
            independent("field_dimensions", &values),
            "the field is 12 cm longer (± 2 cm), the centre circle is 5 cm narrower (± 2 cm)"
        );
    }

    #[test]
    fn noise_is_a_part_of_full_scale() {
        let values = [("shot", 0.0009, 0.000_15), ("read_variance", -1e-7, 1e-6)];
        let text = independent("sensor_noise", &values);
        assert_eq!(text, "where it is white, 3.0 % of full scale is missing (± 0.5 %)");
    }

    #[test]
    fn noise_is_told_where_it_is_best_known() {
        // 0.0004 where the light is 0.4, and which part of it comes with light is not known.
        let values = [("shot", 0.0005, 0.0005), ("read_variance", 0.0002, 0.0002)];
        let text = size_in_words("sensor_noise", &values, &|_, _| -0.99);
        assert_eq!(text, "at 40 % of full light, 2.00 % of full scale is missing (± 0.14 %)");
    }

    #[test]
    fn every_effect_has_words_of_its_own() {
        for effect in library() {
            let values: Vec<(&'static str, f64, f64)> =
                effect.parameters().iter().map(|parameter| (parameter.name, 0.01, 0.001)).collect();
            assert!(!independent(effect.id(), &values).contains(" ± 0.001"), "{}", effect.id());
        }
    }

    #[test]
    fn numbers_that_are_none_do_no_harm() {
        for effect in library() {
            let parameters = effect.parameters();
            for (value, sigma) in [(f64::NAN, f64::NAN), (0.0, f64::NAN), (f64::INFINITY, 1.0), (0.0, 0.0)] {
                let values: Vec<(&'static str, f64, f64)> =
                    parameters.iter().map(|parameter| (parameter.name, value, sigma)).collect();
                let text = independent(effect.id(), &values);
                assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
            }
            assert_eq!(independent(effect.id(), &[]), "of unknown size");
        }
    }
}
