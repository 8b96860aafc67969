//! What effects are called where their sign matters, and the sizes from which they would be found.

use reality_sim_sensor::Effect;

use super::number::{Quantity, digits};

/// An effect whose name and signature in the library are those of positive values, with those of negative ones.
struct Opposite {
    id: &'static str,
    name: &'static str,
    because: &'static str,
}

const OPPOSITES: [Opposite; 6] = [
    Opposite {
        id: "mount_pitch",
        name: "the camera looks higher than the robot believes",
        because: "lines lie too low in every picture, by the same angle near and far",
    },
    Opposite {
        id: "camera_height",
        name: "the camera is lower above the carpet than the robot believes",
        because: "near lines lie too high in every picture and far ones do not",
    },
    Opposite {
        id: "focal_length",
        name: "the picture is magnified less than calibrated",
        because: "lines are shifted towards the image centre in proportion to their distance from it",
    },
    Opposite {
        id: "time_offset",
        name: "images and odometry are taken earlier than their time stamps say",
        because: "the whole picture is shifted against how fast the camera turns and moves, and the odometry with it",
    },
    Opposite {
        id: "black_level",
        name: "dark places are darker than they should be",
        because: "dark places are darker by the same amount of light everywhere, and bright ones hardly are",
    },
    Opposite {
        id: "sensor_noise",
        name: "the sensor is quieter than written down",
        because: "pixel values scatter less than they should around their mean, in dark and bright places",
    },
];

/// An effect's name and signature with the direction of the first of its values that stands out: "the camera looks higher
/// than the robot believes" where the library's "lower" is negative. Values come with their parameters and standard
/// deviations.
pub(crate) fn directed(
    effect: &dyn Effect,
    values: &[(&'static str, f64, f64)],
) -> (&'static str, &'static str) {
    let stands_out =
        |(_, value, sigma): &&(&str, f64, f64)| Quantity { value: *value, sigma: *sigma }.stands_out();
    let decides =
        values.iter().find(stands_out).or_else(|| values.iter().find(|(_, value, _)| *value != 0.0));
    let negative = decides.is_some_and(|(_, value, _)| *value < 0.0);
    let opposite = OPPOSITES.iter().find(|opposite| negative && opposite.id == effect.id());
    opposite.map_or((effect.name(), effect.because()), |opposite| (opposite.name, opposite.because))
}

/// What would have been found, in the order in which it is worth saying, with whether its size is said in percent.
const NOUNS: [(&str, &str, bool); 22] = [
    ("vignetting", "a loss of light at the corners", true),
    ("mount_pitch", "a mount that looks up or down", false),
    ("rolling_shutter", "a rolling shutter", false),
    ("radial_distortion", "a bent picture", false),
    ("time_offset", "a clock that is off", false),
    ("exposure_drift", "a change of the exposure", false),
    ("defocus", "a blur", false),
    ("motion_blur", "a long exposure", false),
    ("field_dimensions", "a field of another size", false),
    ("mount_roll", "a mount that is tilted sideways", false),
    ("focal_length", "another magnification", true),
    ("camera_height", "another height of the camera", false),
    ("principal_point", "a shifted picture", false),
    ("white_balance", "another white balance", true),
    ("chromatic_aberration", "fringes of colour", true),
    ("uneven_illumination", "uneven light", true),
    ("black_level", "another black", true),
    ("tone_curve", "another tone curve", false),
    ("sensor_noise", "another noise", false),
    ("odometry_scale", "an odometry of another scale", true),
    ("odometry_yaw_drift", "a turning odometry", false),
    ("odometry_lateral_slip", "a slipping odometry", true),
];

/// How an effect is called in a list of what would have been found, and how soon it comes in it.
pub(super) fn noun(id: &str) -> Option<(usize, &'static str)> {
    NOUNS.iter().enumerate().find(|(_, (known, ..))| *known == id).map(|(rank, (_, noun, _))| (rank, *noun))
}

/// The size from which an effect would be found, in the unit in which a person says it: "0.08°", "4 ms", "3 %"; where
/// there is none, with the parameter's name: "k1 = 0.003".
pub(crate) fn limit_in_words(id: &str, parameter: &str, value: f64, unit: &str) -> String {
    let percent = NOUNS.iter().any(|(known, _, percent)| *known == id && *percent);
    let text = |factor: f64| digits(factor * value, 2);
    match unit {
        "rad" => format!("{}°", text(1f64.to_degrees())),
        "rad/s" => format!("{}°/s", text(1f64.to_degrees())),
        "s" => format!("{} ms", text(1e3)),
        "m" => format!("{} cm", text(100.0)),
        "1" if percent => format!("{} %", text(100.0)),
        "1" | "" => format!("{parameter} = {}", text(1.0)),
        _ => format!("{} {unit}", text(1.0)),
    }
}

#[cfg(test)]
mod tests {
    use reality_sim_sensor::{effect, library};

    use super::*;

    #[test]
    fn every_effect_of_the_library_has_a_noun() {
        for effect in library() {
            assert!(noun(effect.id()).is_some(), "{}", effect.id());
        }
    }

    #[test]
    fn names_follow_the_sign() {
        let pitch = effect("mount_pitch").unwrap();
        assert_eq!(directed(pitch, &[("pitch_rad", 0.01, 0.001)]), (pitch.name(), pitch.because()));
        assert_eq!(
            directed(pitch, &[("pitch_rad", -0.01, 0.001)]).0,
            "the camera looks higher than the robot believes"
        );
        assert!(directed(pitch, &[("pitch_rad", -0.01, 0.001)]).1.starts_with("lines lie too low"));
        let roll = effect("mount_roll").unwrap();
        assert_eq!(directed(roll, &[("roll_rad", -0.01, 0.001)]).0, roll.name());
    }

    #[test]
    fn opposites_are_of_effects_in_the_library() {
        assert!(OPPOSITES.iter().all(|opposite| effect(opposite.id).is_some()));
    }

    #[test]
    fn limits_are_in_the_units_of_people() {
        assert_eq!(limit_in_words("mount_pitch", "pitch_rad", 0.0014, "rad"), "0.080°");
        assert_eq!(limit_in_words("rolling_shutter", "readout_s", 0.0042, "s"), "4.2 ms");
        assert_eq!(limit_in_words("vignetting", "strength", 0.031, "1"), "3.1 %");
        assert_eq!(limit_in_words("radial_distortion", "k1", 0.0031, "1"), "k1 = 0.0031");
        assert_eq!(limit_in_words("defocus", "sigma_px", 0.31, "px"), "0.31 px");
    }
}
