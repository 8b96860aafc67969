use super::*;

/// Returns the intrinsic parameters in the order of [`Camera::intrinsic_gradients`].
fn parameters(camera: &Camera) -> Vec<f64> {
    let mut parameters = vec![camera.fx, camera.fy, camera.cx, camera.cy];
    parameters.extend(camera.distortion.parameters());
    parameters
}

fn with_parameters(camera: &Camera, p: &[f64]) -> Camera {
    let distortion = match camera.distortion {
        Distortion::Pinhole => Distortion::Pinhole,
        Distortion::Opencv(_) => {
            Distortion::Opencv(Opencv { k1: p[4], k2: p[5], p1: p[6], p2: p[7], k3: p[8] })
        }
        Distortion::OpencvFisheye(_) => {
            Distortion::OpencvFisheye(OpencvFisheye { k: [p[4], p[5], p[6], p[7]] })
        }
    };
    Camera::new([camera.width, camera.height], [p[0], p[1], p[2], p[3]], distortion).unwrap()
}

/// Returns a point seen in the picture, away from the rim, which a finite difference would step over.
fn seen_point(camera: &Camera, u: f64, v: f64, distance_m: f64) -> Option<DVec3> {
    let pixel = DVec2::new(u * f64::from(camera.width - 1), v * f64::from(camera.height - 1));
    let ray = camera.unproject(pixel).ok()?;
    (angle_from_axis_rad(ray) < 0.95 * camera.max_angle_rad()).then_some(ray * distance_m)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn of_the_point(camera in any_camera(), u in 0.0..1.0, v in 0.0..1.0, distance_m in 0.05..20.0) {
        let Some(point) = seen_point(&camera, u, v, distance_m) else { return Ok(()) };
        let (pixel, [du, dv]) = camera.project_with_gradients(point).unwrap();
        prop_assert_eq!(Ok(pixel), camera.project(point));
        let step = 1e-6 * distance_m;
        for axis in DVec3::AXES {
            let project = |sign: f64| camera.project_unbounded(point + sign * step * axis).unwrap();
            let difference = (project(1.0) - project(-1.0)) / (2.0 * step);
            let gradient = DVec2::new(du.dot(axis), dv.dot(axis));
            prop_assert!((difference - gradient).length() * distance_m < 1e-3, "{difference} is not {gradient}");
        }
    }

    #[test]
    fn of_the_intrinsics(camera in any_camera(), u in 0.0..1.0, v in 0.0..1.0) {
        let Some(point) = seen_point(&camera, u, v, 1.0) else { return Ok(()) };
        let gradients = camera.intrinsic_gradients(point).unwrap();
        let original = parameters(&camera);
        prop_assert_eq!(gradients.len(), original.len());
        for (index, gradient) in gradients.into_iter().enumerate() {
            let step = 1e-6 * original[index].abs().max(0.01);
            let project = |sign: f64| {
                let mut moved = original.clone();
                moved[index] += sign * step;
                with_parameters(&camera, &moved).project_unbounded(point).unwrap()
            };
            let difference = (project(1.0) - project(-1.0)) / (2.0 * step);
            prop_assert!(
                (difference - gradient).length() < 1e-3 + 1e-6 * gradient.length(),
                "parameter {index}: {difference} is not {gradient}"
            );
        }
    }
}

#[test]
fn on_and_beside_the_axis() {
    for camera in cameras() {
        for beside in [0.0, 1e-300, 1e-15, 1e-9, 2e-9, 1e-6] {
            let (_, [du, dv]) = camera.project_with_gradients(DVec3::new(beside, beside, 2.0)).unwrap();
            assert!((du - DVec3::X * camera.fx / 2.0).length() < 1e-3, "{beside}: {du}");
            assert!((dv - DVec3::Y * camera.fy / 2.0).length() < 1e-3, "{beside}: {dv}");
        }
    }
}

#[test]
fn sideways_of_a_wide_lens() {
    let camera = all_round();
    let (_, [du, _]) = camera.project_with_gradients(DVec3::X).unwrap();
    let step = 1e-6;
    let project = |z: f64| camera.project_unbounded(DVec3::new(1.0, 0.0, z)).unwrap().x;
    assert!((du.z - (project(step) - project(-step)) / (2.0 * step)).abs() < 1e-3);
}
