use glam::DVec2;

use super::*;

/// Returns a field whose goal area reaches right across, so that lines lie on one another, with or without a circle.
fn crowded(center_circle_diameter_m: f64) -> FieldDimensions {
    let field = FieldDimensions::preset("spl").unwrap();
    FieldDimensions { goal_area_width_m: field.width_m, center_circle_diameter_m, ..field }
}

fn any_field() -> impl Strategy<Value = FieldDimensions> {
    prop_oneof![any_preset(), Just(crowded(0.0)), Just(crowded(6.0))]
}

fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn samples_stand_for_the_whole_length(field in any_field(), spacing_m in 0.02..3.0) {
        let samples = sample_lines(&field, spacing_m);
        for (index, curve) in field.curves().iter().enumerate() {
            let length_m: f64 = samples.iter().filter(|s| s.curve == index).map(|s| s.length_m).sum();
            prop_assert!(is_near(length_m, curve.length_m()));
        }
    }

    #[test]
    fn neighbours_are_no_farther_apart_than_asked(field in any_field(), spacing_m in 0.02..3.0) {
        let samples = sample_lines(&field, spacing_m);
        prop_assert!(samples.iter().all(|s| s.length_m <= spacing_m + 1e-9));
        for pair in samples.windows(2).filter(|pair| pair[0].curve == pair[1].curve) {
            prop_assert!(pair[0].point_in_world.distance(pair[1].point_in_world) <= spacing_m + 1e-9);
        }
    }

    #[test]
    fn samples_lie_on_their_line_and_on_no_end(field in any_field(), spacing_m in 0.02..3.0) {
        let curves = field.curves();
        for sample in sample_lines(&field, spacing_m) {
            prop_assert!(curves[sample.curve].distance_m(sample.point_in_world) < 1e-9);
            if let Curve::Segment { from, to } = curves[sample.curve] {
                let to_end_m = sample.point_in_world.distance(from).min(sample.point_in_world.distance(to));
                prop_assert!(to_end_m > 0.49 * sample.length_m);
            }
        }
    }

    #[test]
    fn tangents_are_unit_vectors_along_the_line(field in any_field(), spacing_m in 0.02..3.0) {
        let curves = field.curves();
        for sample in sample_lines(&field, spacing_m) {
            prop_assert!(is_near(sample.tangent_in_world.length(), 1.0));
            prop_assert!(is_near(sample.tangent_in_world.dot(sample.normal_in_world()), 0.0));
            let beside = sample.point_in_world + 1e-5 * sample.tangent_in_world;
            prop_assert!(curves[sample.curve].distance_m(beside) < 1e-9);
            let across = sample.point_in_world + 1e-5 * sample.normal_in_world();
            prop_assert!(is_near(curves[sample.curve].distance_m(across), 1e-5));
        }
    }

    #[test]
    fn clearance_is_the_distance_to_the_nearest_other_line(field in any_field(), spacing_m in 0.2..3.0) {
        let dense = sample_lines(&field, 0.01);
        for sample in sample_lines(&field, spacing_m) {
            let nearest_m = dense
                .iter()
                .filter(|other| other.curve != sample.curve)
                .map(|other| other.point_in_world.distance(sample.point_in_world))
                .fold(f64::INFINITY, f64::min);
            prop_assert!(sample.clearance_m <= nearest_m + 1e-9);
            prop_assert!(nearest_m <= sample.clearance_m + 0.01);
        }
    }
}

#[test]
fn a_hostile_spacing_neither_fails_nor_fills_the_memory() {
    let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
    let curves = field.curves();
    let length_m: f64 = curves.iter().map(Curve::length_m).sum();
    for spacing_m in [f64::NAN, 0.0, -1.0, f64::NEG_INFINITY, 1e-300] {
        let samples = sample_lines(&field, spacing_m);
        assert!(samples.len() as f64 <= length_m / 1e-3 + curves.len() as f64, "{spacing_m}");
    }
    assert_eq!(sample_lines(&field, f64::INFINITY).len(), curves.len());
}

#[test]
fn distance_from_a_line_of_no_length_is_that_from_its_point() {
    let point = Curve::Segment { from: DVec2::X, to: DVec2::X };
    assert!(is_near(point.distance_m(DVec2::new(1.0, 2.0)), 2.0));
}
