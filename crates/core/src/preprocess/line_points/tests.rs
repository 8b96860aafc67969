use super::*;
use crate::{mount::MountPose, preprocess::Preprocessor, test_scene};

#[test]
fn points_lie_on_the_centres_of_lines() {
    let (camera, field) = (test_scene::fisheye(), test_scene::field());
    for pose in test_scene::poses() {
        let picture = test_scene::render(&camera, pose, &field);
        let prepared = Preprocessor::new(&camera, field.line_width_m).prepare(picture, MountPose::of(pose));
        let found = prepared.line_points();
        assert!(found.points.len() > 40, "{}", found.points.len());
        let off = found.points.iter().filter(|point| {
            let ground = camera.unproject_to_ground(pose, **point).unwrap();
            let nearest =
                field.curves().iter().map(|curve| curve.distance_m(ground)).fold(f64::MAX, f64::min);
            // What a pixel covers of the ground at that distance, sideways or along the ray.
            let away = (ground - pose.position_in_world().truncate()).length().hypot(pose.height_m);
            nearest > 1.5 * away * away / (pose.height_m * camera.fx)
        });
        let off = off.count();
        assert!(20 * off < found.points.len(), "{off} of {} are off", found.points.len());
    }
}

/// Prepares a picture of a camera that looks straight down from a metre: 300 pixels are a metre.
fn from_above(color: impl Fn(u32, u32) -> [u8; 3]) -> LinePoints {
    use crate::camera::{Camera, Distortion};
    let camera = Camera::new([320, 240], [300.0, 300.0, 159.5, 119.5], Distortion::Pinhole).unwrap();
    let picture = RgbImage::from_fn(320, 240, |u, v| image::Rgb(color(u, v)));
    let mount = MountPose { height_m: 1.0, pitch_rad: std::f64::consts::FRAC_PI_2, roll_rad: 0.0 };
    Preprocessor::new(&camera, 0.05).prepare(picture, mount).line_points()
}

const GREEN: [u8; 3] = [60, 150, 70];
const WHITE: [u8; 3] = [230; 3];

#[test]
fn a_bar_has_its_middle_however_broad_it_is() {
    for width in [3, 9, 15, 21] {
        let found = from_above(|u, _| if (100..100 + width).contains(&u) { WHITE } else { GREEN });
        assert!(found.points.len() >= 35, "{width}: {}", found.points.len());
        let middle = 100.0 + 0.5 * f64::from(width - 1);
        assert!(found.points.iter().all(|point| (point.x - middle).abs() < 0.51), "{width}");
        let lying = from_above(|_, v| if (100..100 + width).contains(&v) { WHITE } else { GREEN });
        assert!(lying.points.len() >= 45, "{width}: {}", lying.points.len());
        assert!(lying.points.iter().all(|point| (point.y - middle).abs() < 0.51), "{width}");
    }
}

#[test]
fn what_has_no_carpet_on_both_sides_is_no_line() {
    let beside_a_robot = from_above(|u, _| match u {
        100..115 => WHITE,
        115..200 => [40; 3],
        _ => GREEN,
    });
    assert!(beside_a_robot.points.is_empty(), "{:?}", beside_a_robot.points);
    assert!(from_above(|_, _| GREEN).points.is_empty());
    // The picture's edge cuts it: its middle is not known.
    assert!(from_above(|u, _| if u < 12 { WHITE } else { GREEN }).points.is_empty());
    // A speck.
    assert!(
        from_above(|u, v| if u.abs_diff(99) < 3 && v.abs_diff(99) < 3 { WHITE } else { GREEN }).points.len()
            < 3
    );
}

#[test]
fn noise_gives_no_more_points_than_a_picture_full_of_lines() {
    let noise =
        |u: u32, v: u32| (u.wrapping_mul(2_654_435_761) ^ v.wrapping_mul(40_503)).wrapping_mul(97) >> 13;
    let found = from_above(|u, v| if noise(u, v).is_multiple_of(3) { WHITE } else { GREEN });
    assert!(found.points.len() <= MOST_POINTS);
}
