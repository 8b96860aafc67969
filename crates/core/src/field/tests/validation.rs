use super::*;

/// Generates numbers such as a careless or hostile file may contain.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => 0.0..20.0_f64,
        1 => 0.0..0.5_f64,
        1 => any::<f64>(),
        1 => proptest::sample::select(vec![
            f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.0, -1.0, 5e-324, 1e-300, 1e300, 200.0, 0.05,
        ]),
    ]
}

fn hostile_field() -> impl Strategy<Value = FieldDimensions> {
    let penalty_area = (proptest::option::of(any_number()), proptest::option::of(any_number()));
    (any_preset(), proptest::collection::vec((0..11_usize, any_number()), 0..6), penalty_area).prop_map(
        |(mut field, changes, (length_m, width_m))| {
            for (index, value) in changes {
                *number(&mut field, index) = value;
            }
            FieldDimensions { penalty_area_length_m: length_m, penalty_area_width_m: width_m, ..field }
        },
    )
}

fn number(field: &mut FieldDimensions, index: usize) -> &mut f64 {
    match index {
        0 => &mut field.length_m,
        1 => &mut field.width_m,
        2 => &mut field.line_width_m,
        3 => &mut field.border_strip_m,
        4 => &mut field.goal_area_length_m,
        5 => &mut field.goal_area_width_m,
        6 => &mut field.penalty_mark_distance_m,
        7 => &mut field.center_circle_diameter_m,
        8 => &mut field.goal_width_m,
        9 => &mut field.goal_height_m,
        _ => &mut field.goal_post_diameter_m,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn what_is_accepted_has_finite_samples_of_bounded_number(field in hostile_field()) {
        if field.validate().is_err() {
            return Ok(());
        }
        let samples = sample_lines(&field, 0.5);
        prop_assert!((5..20_000).contains(&samples.len()));
        for sample in samples {
            prop_assert!(sample.point_in_world.is_finite() && sample.tangent_in_world.is_finite());
            prop_assert!(sample.length_m.is_finite() && sample.clearance_m.is_finite());
        }
        prop_assert!(field.carpet_half_extent_m().is_finite());
        prop_assert!(field.marks().iter().all(|mark| mark.is_finite()));
        for post in field.goals().iter().flat_map(|goal| goal.posts) {
            prop_assert!(post.center.is_finite() && post.radius_m >= 0.0 && post.height_m >= 0.0);
        }
    }

    #[test]
    fn what_is_no_finite_number_is_refused_by_name(field in any_preset(), index in 0..11_usize, infinite in any::<bool>()) {
        let mut field = field;
        *number(&mut field, index) = if infinite { f64::INFINITY } else { f64::NAN };
        let error = field.validate().unwrap_err();
        prop_assert!(!error.value.is_finite() && error.to_string().starts_with(error.name));
    }
}

#[test]
fn a_penalty_area_has_both_dimensions_or_none() {
    let field = FieldDimensions::preset("spl").unwrap();
    let long = FieldDimensions { penalty_area_width_m: None, ..field.clone() };
    assert_eq!(long.validate().unwrap_err().name, "penalty_area_length_m");
    let wide = FieldDimensions { penalty_area_length_m: None, ..field };
    assert_eq!(wide.validate().unwrap_err().name, "penalty_area_width_m");
}

#[test]
fn a_field_survives_its_file() {
    for name in preset_names() {
        let field = FieldDimensions::preset(name).unwrap();
        let text = toml::to_string(&field).unwrap();
        assert_eq!(toml::from_str::<FieldDimensions>(&text), Ok(field));
    }
}
