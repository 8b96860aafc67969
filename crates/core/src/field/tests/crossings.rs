use glam::DVec2;

use super::*;

fn count(crossings: &[Crossing], kind: CrossingKind) -> usize {
    crossings.iter().filter(|crossing| crossing.kind == kind).count()
}

#[test]
fn a_field_has_the_crossings_that_its_drawing_shows() {
    // Counted in the rule books' drawings. Corners: 4 of the field and 2 of each area. Ends on other lines: 2 of the halfway
    // line and 2 of each area. Crossings: 2 of the circle with the halfway line.
    for (name, areas) in [("humanoid-kidsize-2010", 2), ("spl", 4), ("humanoid-adultsize", 4), ("msl", 4)] {
        let crossings = FieldDimensions::preset(name).unwrap().crossings();
        assert_eq!(count(&crossings, CrossingKind::L), 4 + 2 * areas, "{name}");
        assert_eq!(count(&crossings, CrossingKind::T), 2 + 2 * areas, "{name}");
        assert_eq!(count(&crossings, CrossingKind::X), 2, "{name}");
        assert_eq!(count(&crossings, CrossingKind::PenaltyMark), 2, "{name}");
        assert_eq!(count(&crossings, CrossingKind::CenterMark), 1, "{name}");
    }
}

#[test]
fn every_crossing_lies_on_two_lines_and_turns_with_the_field() {
    for name in preset_names() {
        let field = FieldDimensions::preset(name).unwrap();
        let crossings = field.crossings();
        for Crossing { kind, point_in_world } in &crossings {
            let is_mark = matches!(kind, CrossingKind::PenaltyMark | CrossingKind::CenterMark);
            let on = field.curves().iter().filter(|curve| curve.distance_m(*point_in_world) < 1e-9).count();
            assert!(is_mark || on >= 2, "{name}: {kind:?} at {point_in_world}");
            let mirrored = |other: &&Crossing| {
                other.kind == *kind && other.point_in_world.distance(-*point_in_world) < 1e-9
            };
            assert_eq!(crossings.iter().filter(mirrored).count(), 1, "{name}: {kind:?} at {point_in_world}");
        }
    }
}

#[test]
fn lines_keep_the_order_of_the_curves() {
    let field = FieldDimensions::preset("spl").unwrap();
    let (kinds, curves): (Vec<_>, Vec<_>) = field.lines().into_iter().unzip();
    assert_eq!(curves, field.curves());
    assert_eq!(kinds.iter().filter(|kind| **kind == LineKind::PenaltyArea).count(), 6);
    let circle = curves[kinds.iter().position(|kind| *kind == LineKind::CenterCircle).unwrap()];
    assert!(matches!(circle, Curve::Circle { center: DVec2::ZERO, .. }));
}
