//! Things on the carpet, in words.

use reality_sim_sensor::text::{digits, percent};

use super::place::field_place;
use crate::diagnostics::object::{Object, ObjectMotion};

/// Returns where a thing is: "standing around x = 1.2 m, y = −0.5 m".
pub fn object_place(object: &Object) -> String {
    match (object.motion, object.place_m) {
        (ObjectMotion::Moving, _) => "moving".to_owned(),
        (ObjectMotion::Standing, Some([x_m, y_m])) => format!("standing {}", field_place(x_m, y_m)),
        (ObjectMotion::Standing, None) => "standing".to_owned(),
    }
}

/// Returns what a thing hides: "3.1 % of the carpet in view, in 40 % of the pictures".
pub fn object_share(object: &Object) -> String {
    format!(
        "{} of the carpet in view, in {} of the pictures",
        hidden_carpet(object),
        percent(object.pictures)
    )
}

/// Returns the share of the carpet that a thing hides: "3.1 %".
pub fn hidden_carpet(object: &Object) -> String {
    format!("{} %", digits(100.0 * object.share, 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thing_that_stands_has_a_place_and_one_that_moves_has_none() {
        let standing = Object {
            motion: ObjectMotion::Standing,
            share: 0.031,
            pictures: 0.4,
            place_m: Some([1.23, -0.5]),
        };
        assert_eq!(object_place(&standing), "standing around x = 1.2 m, y = −0.5 m");
        assert_eq!(object_share(&standing), "3.1 % of the carpet in view, in 40 % of the pictures");
        let moving = Object { motion: ObjectMotion::Moving, place_m: None, ..standing };
        assert_eq!(object_place(&moving), "moving");
    }
}
