use std::f64::consts::FRAC_PI_2;

use super::*;

fn beyond(result: Result<DVec2, NoPixel>) -> bool {
    matches!(result, Err(NoPixel::BeyondMaxAngle { .. }))
}

#[test]
fn no_direction() {
    for camera in cameras() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for point in [DVec3::new(bad, 0.0, 1.0), DVec3::new(0.0, bad, 1.0), DVec3::new(0.0, 0.0, bad)] {
                assert_eq!(camera.project(point), Err(NoPixel::NoDirection));
                assert_eq!(camera.project_with_gradients(point), Err(NoPixel::NoDirection));
                assert_eq!(camera.intrinsic_gradients(point), Err(NoPixel::NoDirection));
            }
        }
        assert_eq!(camera.project_unbounded(DVec3::ZERO), Err(NoPixel::NoDirection));
        assert_eq!(camera.project_unbounded(-DVec3::ZERO), Err(NoPixel::NoDirection));
    }
}

#[test]
fn behind_the_camera() {
    for camera in cameras() {
        assert!(beyond(camera.project_unbounded(DVec3::NEG_Z)));
        assert!(beyond(camera.project_unbounded(DVec3::new(1e-20, 0.0, -1.0))));
        assert!(beyond(camera.project_unbounded(DVec3::new(0.0, 1e-5, -1.0))));
    }
}

#[test]
fn sideways_is_too_far_for_a_perspective_camera() {
    for camera in [turning_barrel(), tangential(), cameras()[4].clone()] {
        assert!(beyond(camera.project_unbounded(DVec3::X)));
        assert!(beyond(camera.project_unbounded(direction(FRAC_PI_2 - 1e-9, 1.0))));
    }
}

#[test]
fn pixels_that_are_no_numbers() {
    for camera in cameras() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            assert_eq!(camera.unproject(DVec2::new(bad, 10.0)), Err(NoRay::BeyondMaxAngle));
            assert_eq!(camera.unproject(DVec2::new(10.0, bad)), Err(NoRay::BeyondMaxAngle));
            assert!(camera.check_inside(DVec2::new(bad, 10.0)).is_err());
        }
    }
}

#[test]
fn the_picture_ends_at_the_centres_of_its_last_pixels() {
    let camera = walk();
    for inside in [DVec2::ZERO, DVec2::new(639.0, 479.0)] {
        assert_eq!(camera.check_inside(inside), Ok(()));
    }
    for outside in [DVec2::new(-0.01, 0.0), DVec2::new(639.01, 0.0), DVec2::new(0.0, 479.01)] {
        assert_eq!(camera.check_inside(outside), Err(NoPixel::OutsideImage { pixel: outside }));
    }
}

#[test]
fn the_image_circle_is_black_outside() {
    let camera = walk().with_image_circle(Some(ImageCircle { cx: 300.0, cy: 200.0, radius: 50.0 }));
    let (edge, outside) = (DVec2::new(350.0, 200.0), DVec2::new(351.0, 200.0));
    assert_eq!(camera.check_inside(edge), Ok(()));
    assert_eq!(camera.check_inside(outside), Err(NoPixel::OutsideImageCircle { pixel: outside }));
    let ray = camera.unproject(outside).unwrap();
    assert!(matches!(camera.project(ray), Err(NoPixel::OutsideImageCircle { .. })));
}

#[test]
fn invalid_cameras_are_refused() {
    let good = [100.0, 100.0, 50.0, 50.0];
    let new = |size, intrinsics, k| {
        Camera::new(size, intrinsics, Distortion::OpencvFisheye(OpencvFisheye { k })).unwrap_err()
    };
    assert_eq!(new([0, 10], good, [0.0; 4]), InvalidCamera::Size { width: 0, height: 10 });
    assert_eq!(new([10, 40000], good, [0.0; 4]), InvalidCamera::Size { width: 10, height: 40000 });
    let flat = [100.0, 0.0, 50.0, 50.0];
    assert_eq!(new([10, 10], flat, [0.0; 4]), InvalidCamera::FocalLength { fx: 100.0, fy: 0.0 });
    let nan = [f64::NAN, 100.0, 50.0, 50.0];
    assert_eq!(new([10, 10], nan, [0.0; 4]), InvalidCamera::NotFinite { name: "fx" });
    let k = [0.0, f64::INFINITY, 0.0, 0.0];
    assert_eq!(new([10, 10], good, k), InvalidCamera::NotFinite { name: "distortion" });
    for falling in [-1e9, -1e300] {
        assert!(matches!(new([10, 10], good, [falling, 0.0, 0.0, 0.0]), InvalidCamera::MaxAngle { .. }));
    }
}

#[test]
fn a_largest_angle_must_be_one_that_the_lens_can_take() {
    let natural_rad = walk().max_angle_rad();
    for max_angle_rad in [0.0, -1.0, f64::NAN, f64::INFINITY, natural_rad * 1.01] {
        assert!(walk().with_max_angle_rad(max_angle_rad).is_err(), "{max_angle_rad}");
    }
    assert!(beyond(walk().with_max_angle_rad(0.5).unwrap().project(direction(0.51, 2.0))));
}

fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![-2.0..2.0, any::<f64>(), Just(0.0), Just(1e-320), Just(1e200), Just(-1e308)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn no_pixel_is_ever_not_a_number(
        camera in any_camera(), x in any_number(), y in any_number(), z in any_number(),
    ) {
        let point = DVec3::new(x, y, z);
        if let Ok(pixel) = camera.project_unbounded(point) {
            prop_assert!(pixel.is_finite());
        }
        if let Ok(ray) = camera.unproject(DVec2::new(x, y)) {
            prop_assert!((ray.length() - 1.0).abs() < 1e-9);
        }
        if let Ok(gradients) = camera.intrinsic_gradients(point) {
            prop_assert!(gradients.iter().all(|gradient| gradient.is_finite()));
        }
    }

    #[test]
    fn any_camera_that_is_accepted_works(
        fx in any_number(), cx in any_number(), d in proptest::array::uniform5(any_number()),
        x in any_number(), y in any_number(), z in any_number(),
    ) {
        let [k1, k2, p1, p2, k3] = d;
        for distortion in [
            Distortion::Opencv(Opencv { k1, k2, p1, p2, k3 }),
            Distortion::OpencvFisheye(OpencvFisheye { k: [k1, k2, p1, p2] }),
        ] {
            let Ok(camera) = Camera::new([64, 48], [fx, 10.0, cx, 3.0], distortion) else { continue };
            prop_assert!(camera.max_angle_rad() > 0.0);
            if let Ok(pixel) = camera.project_unbounded(DVec3::new(x, y, z)) {
                prop_assert!(pixel.is_finite());
            }
            if let Ok(ray) = camera.unproject(DVec2::new(x, y)) {
                prop_assert!((ray.length() - 1.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn only_the_direction_counts(camera in any_camera(), fraction in 0.0..0.9, around_rad in 0.0..6.3) {
        let ray = direction(fraction * camera.max_angle_rad(), around_rad);
        let pixel = camera.project_unbounded(ray).unwrap();
        for length_m in [1e-200, 1e-9, 1e9, 1e200] {
            prop_assert!(camera.project_unbounded(ray * length_m).unwrap().distance(pixel) < 1e-6);
        }
    }
}
