//! Straight line or arc on the ground along which points lie evenly.

use glam::DVec2;

/// Largest distance of a point from its place, metres: rounding in the field's dimensions.
const EVEN_M: f64 = 1e-6;
/// Smallest angle between neighbouring pieces of an arc, radians: below it, rounding may bend a straight line.
const LEAST_TURN_RAD: f64 = 1e-6;

/// Path that is followed from its first point by even steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Path {
    Straight { first: DVec2, step: DVec2 },
    Arc { centre: DVec2, first_from_centre: DVec2, turn_rad: f64 },
}

impl Path {
    /// Returns the path on which points lie evenly; `None` if there is none, or no point.
    pub fn through(points: &[DVec2]) -> Option<Self> {
        let path = match points {
            [] => return None,
            [only] => Self::Straight { first: *only, step: DVec2::ZERO },
            [first, second] => Self::Straight { first: *first, step: second - first },
            [first, second, third, ..] => Self::of_three(*first, *second, *third),
        };
        let is_even = points.iter().enumerate().all(|(i, point)| point.distance(path.at(i as f64)) <= EVEN_M);
        is_even.then_some(path)
    }

    fn of_three(first: DVec2, second: DVec2, third: DVec2) -> Self {
        let step = second - first;
        let turn_rad = step.angle_to(third - second);
        if turn_rad.abs() < LEAST_TURN_RAD {
            return Self::Straight { first, step };
        }
        // The centre lies on the middle normal of two neighbours, left of a path that turns left.
        let centre = first.midpoint(second) + step.perp() / (2.0 * (0.5 * turn_rad).tan());
        Self::Arc { centre, first_from_centre: first - centre, turn_rad }
    }

    /// Returns the point so many steps after the first.
    pub fn at(&self, steps: f64) -> DVec2 {
        match *self {
            Self::Straight { first, step } => first + steps * step,
            Self::Arc { centre, first_from_centre, turn_rad } => {
                centre + DVec2::from_angle(steps * turn_rad).rotate(first_from_centre)
            }
        }
    }

    /// Returns the length of so many steps, metres, and the angle by which the path turns between them, radians.
    pub fn step(&self, steps: f64) -> [f64; 2] {
        match *self {
            Self::Straight { step, .. } => [steps * step.length(), 0.0],
            Self::Arc { first_from_centre, turn_rad, .. } => {
                let angle_rad = steps * turn_rad.abs();
                [angle_rad * first_from_centre.length(), angle_rad]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn even_points_on_a_circle_are_on_the_arc_through_them(
            centre in prop::array::uniform2(-5.0..5.0_f64), radius_m in 0.3..10.0_f64, from_rad in -3.0..3.0_f64,
            turn_rad in prop_oneof![-0.5..-0.001_f64, 0.001..0.5_f64], count in 3..16_usize,
        ) {
            let at = |i: f64| DVec2::from(centre) + radius_m * DVec2::from_angle(from_rad + i * turn_rad);
            let points: Vec<DVec2> = (0..count).map(|i| at(i as f64)).collect();
            let path = Path::through(&points).expect("they are even");
            for steps in [-3.0, 0.4, 15.0] {
                prop_assert!(path.at(steps).distance(at(steps)) < 1e-6);
            }
            let [length_m, angle_rad] = path.step(5.0);
            prop_assert!((angle_rad - 5.0 * turn_rad.abs()).abs() < 1e-6 && (length_m - radius_m * angle_rad).abs() < 1e-5);
        }
    }

    #[test]
    fn a_missing_point_leaves_no_path() {
        let straight = |i: usize| DVec2::new(0.3 + 0.02 * i as f64, 1.0);
        let bent = |i: usize| DVec2::from_angle(0.05 * i as f64);
        for line in [straight as fn(usize) -> DVec2, bent] {
            let points: Vec<DVec2> = (0..16).map(line).collect();
            assert!(Path::through(&points).is_some());
            for missing in 1..15 {
                let points = [&points[..missing], &points[missing + 1..]].concat();
                assert_eq!(Path::through(&points), None, "{missing}");
            }
        }
        assert_eq!(Path::through(&[]), None);
    }

    #[test]
    fn one_point_and_two_are_a_path() {
        let [a, b] = [DVec2::new(1.0, 2.0), DVec2::new(1.0, 2.1)];
        assert_eq!(Path::through(&[a]).map(|path| path.at(7.0)), Some(a));
        assert!(
            Path::through(&[a, b]).is_some_and(|path| path.at(2.0).distance(DVec2::new(1.0, 2.2)) < 1e-12)
        );
    }
}
