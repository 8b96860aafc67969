use std::f64::consts::TAU;

use super::*;

/// Returns the smallest determinant of the Jacobian all around a circle, from the gradients themselves.
fn least_determinant(model: Opencv, angle_rad: f64) -> f64 {
    (0..3600)
        .map(|i| {
            let place = angle_rad.tan() * DVec2::from_angle(TAU * f64::from(i) / 3600.0);
            let [dx, dy] = model.distort_gradients(place);
            dx.perp_dot(dy)
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn fisheye_stops_where_its_polynomial_does() {
    // d/dθ (θ − 0.1 θ³) = 0 at θ = √(1/0.3).
    let camera = fisheye([640, 480], [200.0, 200.0, 320.0, 240.0], [-0.1, 0.0, 0.0, 0.0]);
    assert!((camera.max_angle_rad() - (1.0_f64 / 0.3).sqrt()).abs() < 1e-9);
}

#[test]
fn opencv_stops_where_its_polynomial_does() {
    // d/dr (r − 0.4 r³) = 0 at r = √(1/1.2).
    let tangent = turning_barrel().max_angle_rad().tan();
    assert!((tangent - (1.0_f64 / 1.2).sqrt()).abs() < 1e-9);
}

#[test]
fn growing_polynomials_reach_the_models_own_limits() {
    assert!((all_round().max_angle_rad().to_degrees() - 179.9).abs() < 1e-9);
    let grows = opencv([600.0, 600.0, 320.0, 240.0], [0.1, 0.0, 0.0, 0.0, 0.0]);
    assert!((grows.max_angle_rad().to_degrees() - 89.0).abs() < 1e-9);
}

#[test]
fn the_pictures_radius_grows_up_to_the_rim_and_not_beyond() {
    for camera in cameras() {
        let Distortion::OpencvFisheye(lens) = camera.distortion else { continue };
        let max_rad = camera.max_angle_rad();
        let radii: Vec<f64> = (0..=1000).map(|i| lens.radius(max_rad * f64::from(i) / 1000.0)).collect();
        assert!(radii.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(max_rad > 3.13 || lens.radius(max_rad + 1e-3) < lens.radius(max_rad));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn opencv_stops_where_two_places_would_become_one(
        k1 in -0.5..0.5, k2 in -0.2..0.2, k3 in -0.1..0.1, p1 in -0.05..0.05, p2 in -0.05..0.05,
    ) {
        let model = Opencv { k1, k2, p1, p2, k3 };
        let max_rad = model.max_angle_rad();
        prop_assert!(least_determinant(model, 0.999 * max_rad) > 0.0);
        prop_assert!(max_rad > 1.553 || least_determinant(model, 1.001 * max_rad) < 1e-6);
    }
}
