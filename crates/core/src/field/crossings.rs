//! Points of the field that can be told by their looks: where white lines meet, and the marks.

use glam::DVec2;

use super::{Curve, FieldDimensions};

/// Distance within which two points are one, metres: far below a line's width, far above rounding.
const SAME_POINT_M: f64 = 1e-3;

/// Kind of a [`Crossing`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CrossingKind {
    /// Two lines end in each other: a corner.
    L,
    /// A line ends in another one.
    T,
    /// Two lines cross.
    X,
    /// Penalty mark.
    PenaltyMark,
    /// Centre mark.
    CenterMark,
}

impl CrossingKind {
    /// Returns the name of the kind in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::L => "l",
            Self::T => "t",
            Self::X => "x",
            Self::PenaltyMark => "penalty_mark",
            Self::CenterMark => "center_mark",
        }
    }
}

/// Point where white lines meet, or a mark.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Kind of the point.
    pub kind: CrossingKind,
    /// Point on the ground where the lines' centres meet, world axes, metres.
    pub point_in_world: DVec2,
}

impl FieldDimensions {
    /// Returns the points where white lines meet, then the marks. Their order depends on nothing but the dimensions.
    pub fn crossings(&self) -> Vec<Crossing> {
        let curves = self.curves();
        let mut crossings: Vec<Crossing> = Vec::new();
        for (index, a) in curves.iter().enumerate() {
            for crossing in curves[index + 1..].iter().flat_map(|b| meetings(a, b)) {
                let is_known =
                    |known: &Crossing| known.point_in_world.distance(crossing.point_in_world) < SAME_POINT_M;
                if !crossings.iter().any(is_known) {
                    crossings.push(crossing);
                }
            }
        }
        let kinds = [CrossingKind::PenaltyMark, CrossingKind::CenterMark, CrossingKind::PenaltyMark];
        let marks = kinds.into_iter().zip(self.marks());
        crossings.extend(marks.map(|(kind, point_in_world)| Crossing { kind, point_in_world }));
        crossings
    }
}

/// Returns the points where two curves meet.
fn meetings(a: &Curve, b: &Curve) -> Vec<Crossing> {
    match (*a, *b) {
        (Curve::Segment { from, to }, Curve::Segment { from: other_from, to: other_to }) => {
            segments([from, to], [other_from, other_to]).into_iter().collect()
        }
        (Curve::Segment { from, to }, Curve::Circle { center, radius_m })
        | (Curve::Circle { center, radius_m }, Curve::Segment { from, to }) => {
            segment_and_circle([from, to], center, radius_m)
        }
        // A field has one circle.
        (Curve::Circle { .. }, Curve::Circle { .. }) => Vec::new(),
    }
}

fn segments([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> Option<Crossing> {
    let (along, other) = (b - a, d - c);
    let determinant = along.perp_dot(other);
    // Parallel lines do not meet, and lines on top of each other have no single point.
    if determinant.abs() < SAME_POINT_M * SAME_POINT_M {
        return None;
    }
    let (s, t) = ((c - a).perp_dot(other) / determinant, (c - a).perp_dot(along) / determinant);
    let point_in_world = a + s * along;
    let place = |fraction: f64, length_m: f64| {
        let (from_m, to_m) = (fraction * length_m, (1.0 - fraction) * length_m);
        let is_on = from_m.min(to_m) > -SAME_POINT_M;
        is_on.then_some(from_m.min(to_m) < SAME_POINT_M)
    };
    let kind = match (place(s, along.length())?, place(t, other.length())?) {
        (true, true) => CrossingKind::L,
        (false, false) => CrossingKind::X,
        _ => CrossingKind::T,
    };
    Some(Crossing { kind, point_in_world })
}

fn segment_and_circle([from, to]: [DVec2; 2], center: DVec2, radius_m: f64) -> Vec<Crossing> {
    let Some(along) = (to - from).try_normalize() else { return Vec::new() };
    let middle_m = (center - from).dot(along);
    let aside_m = (center - from).perp_dot(along);
    // A line that only touches the circle does not cross it.
    let half_m = match radius_m * radius_m - aside_m * aside_m {
        square if square > SAME_POINT_M * SAME_POINT_M => square.sqrt(),
        _ => return Vec::new(),
    };
    let length_m = from.distance(to);
    let places_m = [middle_m - half_m, middle_m + half_m].into_iter();
    places_m
        .filter(|place_m| (0.0..=length_m).contains(place_m))
        .map(|place_m| Crossing { kind: CrossingKind::X, point_in_world: from + place_m * along })
        .collect()
}
