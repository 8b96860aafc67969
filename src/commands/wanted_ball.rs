//! Balls as options give them.

use glam::Vec3;

use reality_sim::{pose::FARTHEST_M, sensor::linear_from_srgb, simulator::Ball};

/// Radius of a ball whose radius is not given, metres: that of the small humanoid leagues.
const USUAL_RADIUS_M: f64 = 0.065;
/// Largest radius, metres: larger ones are given in another unit.
const LARGEST_RADIUS_M: f64 = 10.0;
/// Colour of a ball whose colour is not given, sRGB: orange.
const USUAL_SRGB: u32 = 0x00ff_8000;

/// Ball as the option gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WantedBall {
    x_m: f64,
    y_m: f64,
    radius_m: f64,
    reflectance: Vec3,
}

/// Reads a ball: place, radius and colour, of which the last two may be left out.
pub fn wanted_ball(text: &str) -> Result<WantedBall, String> {
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let [x, y, rest @ ..] = parts.as_slice() else {
        return Err("give X,Y[,RADIUS_M[,RRGGBB]]: metres, metres, metres, colour".to_owned());
    };
    let (radius, color) = match rest {
        [] => (None, None),
        [radius] => (Some(radius), None),
        [radius, color] => (Some(radius), Some(color)),
        _ => return Err("give no more than X,Y,RADIUS_M,RRGGBB".to_owned()),
    };
    let place = |name: &str, text: &str| match text.parse::<f64>() {
        Ok(value) if value.abs() <= FARTHEST_M => Ok(value),
        _ => {
            Err(format!("{name} is \"{text}\": give metres from the field's centre, at most {FARTHEST_M:.0}"))
        }
    };
    let radius_m = match radius.map(|text| (text, text.parse::<f64>())) {
        None => USUAL_RADIUS_M,
        Some((_, Ok(radius_m))) if radius_m > 0.0 && radius_m <= LARGEST_RADIUS_M => radius_m,
        Some((text, _)) => {
            return Err(format!(
                "the radius is \"{text}\": give metres, above 0 and at most {LARGEST_RADIUS_M}"
            ));
        }
    };
    let srgb = match color {
        None => USUAL_SRGB,
        Some(text) => hexadecimal(text).ok_or_else(|| {
            format!("the colour is \"{text}\": give six hexadecimal digits, such as FF8000")
        })?,
    };
    Ok(WantedBall { x_m: place("X", x)?, y_m: place("Y", y)?, radius_m, reflectance: reflectance(srgb) })
}

fn hexadecimal(text: &str) -> Option<u32> {
    let is_color = text.len() == 6 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
    u32::from_str_radix(text, 16).ok().filter(|_| is_color)
}

/// Returns the reflectance of what has this colour, sRGB, in white light as bright as full white.
fn reflectance(srgb: u32) -> Vec3 {
    let [_, red, green, blue] = srgb.to_be_bytes();
    Vec3::from_array([red, green, blue].map(linear_from_srgb))
}

impl WantedBall {
    /// Returns the ball as a layer.
    pub fn layer(&self) -> Ball {
        Ball::on_ground(self.x_m, self.y_m, self.radius_m, self.reflectance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_is_a_place_with_or_without_radius_and_colour() {
        let ball = wanted_ball("1, -2.5").unwrap();
        assert_eq!([ball.x_m, ball.y_m, ball.radius_m], [1.0, -2.5, USUAL_RADIUS_M]);
        let ball = wanted_ball("1,2,0.1,ffffff").unwrap();
        assert_eq!((ball.radius_m, ball.reflectance), (0.1, Vec3::ONE));
        assert_eq!(wanted_ball("0,0,0.07").unwrap().reflectance, reflectance(USUAL_SRGB));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let wrong = [
            ("1", "X,Y"),
            ("a,2", "\"a\""),
            ("1,inf", "\"inf\""),
            ("1,NaN", "\"NaN\""),
            ("300,0", "\"300\""),
            ("1,2,0", "radius"),
            ("1,2,-0.1", "radius"),
            ("1,2,65", "radius"),
            ("1,2,0.1,orange", "\"orange\""),
            ("1,2,0.1,+12345", "\"+12345\""),
            ("1,2,0.1,ff8000,3", "no more"),
        ];
        for (text, named) in wrong {
            let error = wanted_ball(text).unwrap_err();
            assert!(error.contains(named), "{text}: {error}");
        }
    }
}
