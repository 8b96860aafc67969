use std::f64::consts::TAU;

use super::*;

const TOLERANCE_PX: f64 = 1e-6;

/// Returns the tolerance. If a polynomial grows without end, its rim lies millions of pixels outside the picture, and
/// rounding errors grow with the distance.
fn tolerance_px(pixel: DVec2) -> f64 {
    TOLERANCE_PX.max(1e-12 * pixel.length())
}

fn again(camera: &Camera, pixel: DVec2) -> DVec2 {
    camera.project_unbounded(camera.unproject(pixel).unwrap()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn from_the_axis_to_the_rim(camera in any_camera(), fraction in 0.0..=1.0, around_rad in 0.0..TAU) {
        let ray = direction(fraction * camera.max_angle_rad(), around_rad);
        let pixel = camera.project_unbounded(ray).unwrap();
        prop_assert!(again(&camera, pixel).distance(pixel) < tolerance_px(pixel));
    }

    #[test]
    fn within_a_hair_of_the_rim(camera in any_camera(), exponent in -17.0..-3.0, around_rad in 0.0..TAU) {
        let angle_rad = camera.max_angle_rad() * (1.0 - 10_f64.powf(exponent));
        let pixel = camera.project_unbounded(direction(angle_rad, around_rad)).unwrap();
        prop_assert!(again(&camera, pixel).distance(pixel) < tolerance_px(pixel));
    }

    #[test]
    fn ray_to_pixel_to_ray(camera in any_camera(), fraction in 0.0..0.98, around_rad in 0.0..TAU) {
        let ray = direction(fraction * camera.max_angle_rad(), around_rad);
        let back = camera.unproject(camera.project_unbounded(ray).unwrap()).unwrap();
        prop_assert!(back.distance(ray) < 1e-9, "{back} is not {ray}");
    }

    #[test]
    fn every_pixel_of_the_picture(camera in any_camera(), u in 0.0..1.0, v in 0.0..1.0) {
        let pixel = DVec2::new(u * f64::from(camera.width - 1), v * f64::from(camera.height - 1));
        if camera.unproject(pixel).is_ok() {
            prop_assert!(again(&camera, pixel).distance(pixel) < TOLERANCE_PX);
        }
    }

    #[test]
    fn beyond_the_image_of_the_rim_is_no_ray(camera in any_camera(), around_rad in 0.0..TAU) {
        let rim = camera.project_unbounded(direction(camera.max_angle_rad(), around_rad)).unwrap();
        let centre = DVec2::new(camera.cx, camera.cy);
        prop_assert_eq!(camera.unproject(centre + 1.001 * (rim - centre)), Err(NoRay::BeyondMaxAngle));
    }

    #[test]
    fn a_narrower_camera_keeps_its_pixels(camera in any_camera(), limit in 0.1..1.0, fraction in 0.0..1.3_f64, around_rad in 0.0..TAU) {
        let narrow = camera.clone().with_max_angle_rad(limit * camera.max_angle_rad()).unwrap();
        let angle_rad = (fraction * narrow.max_angle_rad()).min(camera.max_angle_rad());
        prop_assume!((angle_rad - narrow.max_angle_rad()).abs() > 1e-6);
        let pixel = camera.project_unbounded(direction(angle_rad, around_rad)).unwrap();
        if angle_rad < narrow.max_angle_rad() {
            prop_assert!(again(&narrow, pixel).distance(pixel) < tolerance_px(pixel));
        } else {
            prop_assert_eq!(narrow.unproject(pixel), Err(NoRay::BeyondMaxAngle));
        }
    }
}

#[test]
fn the_optical_axis_is_the_principal_point() {
    for camera in cameras() {
        let centre = DVec2::new(camera.cx, camera.cy);
        assert_eq!(camera.project(DVec3::Z), Ok(centre));
        assert_eq!(camera.unproject(centre), Ok(DVec3::Z));
    }
}

#[test]
fn a_wide_lens_sees_beside_and_behind_itself() {
    let camera = all_round();
    for angle_deg in [89.999, 90.0, 90.001, 120.0, 179.0] {
        let ray = direction(f64::to_radians(angle_deg), 0.3);
        let pixel = camera.project_unbounded(ray).unwrap();
        assert!(again(&camera, pixel).distance(pixel) < TOLERANCE_PX, "{angle_deg}°");
        assert!(camera.unproject(pixel).unwrap().distance(ray) < 1e-9, "{angle_deg}°");
    }
}
