use glam::DVec2;

use super::*;

fn fields() -> impl Iterator<Item = FieldDimensions> {
    preset_names().map(|name| FieldDimensions::preset(name).unwrap())
}

#[test]
fn all_are_valid_and_know_their_name() {
    assert!(preset_names().count() >= 5);
    for name in preset_names() {
        let field = FieldDimensions::preset(name).unwrap();
        assert_eq!(field.name, name);
        assert_eq!(field.validate(), Ok(()));
    }
    assert_eq!(FieldDimensions::preset("futsal"), None);
}

#[test]
fn areas_marks_and_circle_lie_within_the_lines() {
    for field in fields() {
        if let (Some(length_m), Some(width_m)) = (field.penalty_area_length_m, field.penalty_area_width_m) {
            assert!(field.goal_area_length_m < length_m && field.goal_area_width_m < width_m);
            assert!(width_m < field.width_m);
        }
        assert!(field.goal_width_m + 2.0 * field.goal_post_diameter_m < field.goal_area_width_m);
        assert!(field.penalty_mark_distance_m > field.goal_area_length_m);
    }
}

#[test]
fn lines_look_the_same_after_half_a_turn_and_in_a_mirror() {
    for field in fields() {
        let curves = field.curves();
        for sample in sample_lines(&field, 0.05) {
            let point = sample.point_in_world;
            for image in [-point, DVec2::new(point.x, -point.y), DVec2::new(-point.x, point.y)] {
                let nearest_m =
                    curves.iter().map(|curve| curve.distance_m(image)).fold(f64::INFINITY, f64::min);
                assert!(nearest_m < 1e-12, "{}: {image} lies on no line", field.name);
            }
        }
    }
}

#[test]
fn the_papers_field_has_goals_of_two_colours() {
    let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
    assert_eq!((field.length_m, field.width_m), (6.0, 4.0));
    let ([red, _, blue], [other_red, _, other_blue]) =
        (field.goal_srgb_positive_x.unwrap(), field.goal_srgb_negative_x.unwrap());
    assert!(red > blue && other_red < other_blue, "yellow at +x, blue at −x");
}

#[test]
fn outer_edges_measure_what_the_rule_books_say() {
    let outer = |name: &str| {
        let field = FieldDimensions::preset(name).unwrap();
        DVec2::new(field.length_m, field.width_m) + field.line_width_m
    };
    assert!(outer("humanoid-kidsize").distance(DVec2::new(9.0, 6.0)) < 1e-12);
    assert!(outer("humanoid-adultsize").distance(DVec2::new(14.0, 9.0)) < 1e-12);
    assert!(outer("msl").distance(DVec2::new(22.0, 14.0)) < 1e-12);
    let carpet = 2.0 * FieldDimensions::preset("spl").unwrap().carpet_half_extent_m();
    assert!(carpet.distance(DVec2::new(10.4, 7.4)) < 1e-12, "the carpet of the SPL is 10.4 by 7.4 m");
}
