//! Layers through the whole camera, on the demonstration walk.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail like tests")]

mod common;

use glam::{DVec2, DVec3, Vec3};
use image::RgbImage;
use reality_sim_core::pose::{CameraPose, Pose2};
use reality_sim_simulator::{
    Ball, Camera, Class, Frame, Humanoid, Layer, LayerPixel, LayerSettings, NO_OBJECT, PictureLayer,
};

use self::common::{camera, usual_pose};

#[test]
fn a_picture_without_layers_is_the_recorded_one_and_layers_change_it_only_around_them() {
    let mut camera = camera();
    let pose = usual_pose(&camera);
    let (mut empty, mut full) = (Frame::default(), Frame::default());
    camera.look(pose, &[], &mut empty).unwrap();
    assert!(empty.object_of.iter().all(|object| *object == NO_OBJECT) && empty.objects.is_empty());
    let place = DVec2::new(-2.3, 0.2) + 1.2 * DVec2::from_angle(1.2);
    let ball = Ball::on_ground(place.x, place.y, 0.065, Vec3::new(0.9, 0.3, 0.05));
    let beside = place + DVec2::new(0.3, 0.3);
    let robot = Humanoid::standing(Pose2::new(beside.x, beside.y, -1.0), 0.58, Vec3::new(0.1, 0.2, 0.8));
    let layers: [&dyn Layer; 2] = [&ball, &robot];
    camera.look(pose, &layers, &mut full).unwrap();
    let [seen_ball, seen_robot] = full.objects.as_slice() else { panic!("{:?}", full.objects) };
    assert_eq!([seen_ball.class, seen_robot.class], [Class::Ball, Class::Robot]);
    assert!(seen_ball.visible_pixels > 100 && seen_ball.visibility() > 0.99, "{seen_ball:?}");
    assert!(seen_robot.visible_pixels > 500, "{seen_robot:?}");
    let far = full.object_of.iter().zip(empty.picture.pixels().zip(full.picture.pixels()));
    let changed = far.filter(|(object, (a, b))| **object == NO_OBJECT && a != b).count();
    assert!(changed > 100 && changed < 60_000, "{changed}");
}

fn ball(place: DVec2) -> Ball {
    Ball::on_ground(place.x, place.y, 0.065, Vec3::new(0.9, 0.3, 0.05))
}

/// Returns a frame with layers over a plain grey picture.
fn over_grey(camera: &mut Camera, pose: CameraPose, layers: &[&dyn Layer]) -> Frame {
    camera.compose(pose, layers, RgbImage::from_pixel(640, 480, image::Rgb([120; 3])))
}

fn looking_from(camera: &Camera, place: DVec2, at: DVec2) -> CameraPose {
    let yaw_rad = (at - place).to_angle();
    CameraPose { pitch_rad: 0.2, ..camera.synthesizer().archive().usual_pose() }
        .with_planar(Pose2::new(place.x, place.y, yaw_rad))
}

#[test]
fn things_hide_each_other_by_their_distances() {
    let mut camera = camera();
    let (from, to) = (DVec2::new(-1.0, 0.3), DVec2::new(1.0, 0.3));
    let pose = looking_from(&camera, from, to);
    let robot = Humanoid::standing(Pose2::new(0.2, 0.3, 0.0), 0.58, Vec3::new(0.1, 0.2, 0.8));
    let [near, far] = [DVec2::new(-0.1, 0.3), DVec2::new(0.5, 0.33)].map(ball);
    for order in [0, 1] {
        let mut layers: Vec<&dyn Layer> = vec![&near, &robot, &far];
        layers.rotate_left(order);
        let frame = over_grey(&mut camera, pose, &layers);
        let seen = |number: usize| &frame.objects[(number + 3 - order) % 3];
        assert!(seen(0).visibility() > 0.99, "{:?}", seen(0));
        assert!((0.5..0.99).contains(&seen(1).visibility()), "{:?}", seen(1));
        assert!(seen(2).visibility() < 0.6, "{:?}", seen(2));
        assert!(seen(2).whole_pixels > 100);
        for (index, object) in frame.object_of.iter().enumerate() {
            assert_eq!(*object == NO_OBJECT, frame.distance_m[index].is_infinite());
        }
        let count = |number: usize| {
            let number = ((number + 3 - order) % 3) as u16;
            frame.object_of.iter().filter(|object| **object == number).count() as u32
        };
        for number in 0..3 {
            assert_eq!(count(number), seen(number).visible_pixels);
        }
    }
}

#[test]
fn a_goal_hides_what_is_behind_its_posts_and_not_what_is_before_them() {
    let mut camera = camera();
    let goal = camera.synthesizer().archive().field().goals()[1];
    let post = goal.posts[0].center;
    let from = post - DVec2::new(1.5, 0.2);
    let away = (post - from).normalize_or_zero();
    let pose = looking_from(&camera, from, post);
    let visibility = |camera: &mut Camera, beyond_m: f64| {
        let frame = over_grey(camera, pose, &[&ball(post + beyond_m * away)]);
        assert!(frame.objects[0].whole_pixels > 50, "{:?}", frame.objects[0]);
        frame.objects[0].visibility()
    };
    assert!(visibility(&mut camera, -0.2) > 0.99);
    // The post is as wide as two thirds of the ball.
    assert!(visibility(&mut camera, 0.3) < 0.5);
    let below = Ball { center_in_world: (from + away).extend(-0.4), ..ball(DVec2::ZERO) };
    assert_eq!(over_grey(&mut camera, pose, &[&below]).objects[0].visible_pixels, 0);
}

#[test]
fn a_picture_of_the_simulators_own_is_mixed_by_its_opacity() {
    let mut camera = camera().with_layer_settings(LayerSettings::default().with_noise_seed(None));
    let pose = usual_pose(&camera);
    let alpha = |u: u32| match u {
        200..220 => 1.0,
        220..240 => 0.5,
        _ => 0.0,
    };
    let pixel = |index: u32| {
        let alpha = if (300..320).contains(&(index / 640)) { alpha(index % 640) } else { 0.0 };
        LayerPixel { color: Vec3::splat(0.2 * alpha), alpha, distance_m: 0.2, object: 0 }
    };
    let pixels: Vec<LayerPixel> = (0..640 * 480).map(pixel).collect();
    assert!(PictureLayer::new([640, 479], pixels.clone(), Vec::new()).is_none());
    let layer = PictureLayer::new([640, 480], pixels, vec![(Class::Robot, "own".to_owned())]).unwrap();
    let frame = over_grey(&mut camera, pose, &[&layer]);
    let value = |u: u32, v: u32| frame.picture.get_pixel(u, v).0[1];
    let linear = |value: u8| (f64::from(value) / 255.0).powf(2.2);
    // Opaque: the layer's own light; half: the mean of both; outside: nothing changes.
    let (own, mixed) = (linear(value(210, 310)), linear(value(230, 310)));
    assert!((mixed - 0.5 * (own + linear(120))).abs() < 0.01, "{own} {mixed}");
    assert!([value(199, 310), value(240, 310), value(210, 299), value(210, 320)].iter().all(|v| *v == 120));
    let [seen] = frame.objects.as_slice() else { panic!("{:?}", frame.objects) };
    let area = seen.visible.unwrap();
    assert_eq!([area.left, area.top, area.right, area.bottom], [200, 300, 240, 320]);
    assert_eq!(
        (seen.name.as_str(), seen.visible_pixels, frame.distance_m[310 * 640 + 210]),
        ("own", 800, 0.2)
    );
}

#[test]
fn a_darker_place_makes_things_darker_and_a_shadow_lies_below_them() {
    let mut camera = camera().with_layer_settings(LayerSettings::default().with_noise_seed(None));
    let pose = usual_pose(&camera);
    let place = DVec2::new(-2.3, 0.2) + 1.2 * DVec2::from_angle(1.2);
    let mut frame = Frame::default();
    camera.look(pose, &[], &mut frame).unwrap();
    let scene = frame.picture;
    let dim =
        RgbImage::from_fn(640, 480, |u, v| image::Rgb(scene.get_pixel(u, v).0.map(|value| value / 4 * 3)));
    let [bright, dark] = [&scene, &dim].map(|picture| camera.compose(pose, &[&ball(place)], picture.clone()));
    let center =
        camera.chain().camera().project(pose.camera_from_world(place.extend(0.065))).unwrap().round();
    let red = |frame: &Frame| frame.picture.get_pixel(center.x as u32, center.y as u32).0[0];
    assert!(red(&dark) + 8 < red(&bright), "{} {}", red(&dark), red(&bright));
    let near = (place + DVec2::new(0.0, -0.08)).extend(0.0);
    let shade = camera.chain().camera().project(pose.camera_from_world(near)).unwrap().round();
    let green = |picture: &RgbImage| picture.get_pixel(shade.x as u32, shade.y as u32).0[1];
    assert!(green(&bright.picture) + 5 < green(&scene), "{} {}", green(&bright.picture), green(&scene));
    let settings = LayerSettings::default().with_shadows(false).with_noise_seed(None);
    let mut without = camera.with_layer_settings(settings);
    assert_eq!(green(&without.compose(pose, &[&ball(place)], scene.clone()).picture), green(&scene));
}

#[test]
fn hostile_layers_and_pictures_change_nothing() {
    let mut camera = camera();
    let pose = usual_pose(&camera);
    let nowhere = Ball { center_in_world: DVec3::NAN, ..ball(DVec2::ZERO) };
    let robot = Humanoid::standing(Pose2::new(f64::NAN, 0.0, 0.0), 0.5, Vec3::ONE);
    let frame = over_grey(&mut camera, pose, &[&nowhere, &robot]);
    assert!(frame.picture.pixels().all(|pixel| pixel.0 == [120; 3]));
    assert!(frame.objects.iter().all(|object| object.visible.is_none() && object.visibility() == 0.0));
    let small = camera.compose(pose, &[&ball(DVec2::ZERO)], RgbImage::new(10, 10));
    assert!(small.objects.is_empty());
    let lost = CameraPose { x_m: f64::NAN, ..pose };
    assert!(over_grey(&mut camera, lost, &[&ball(DVec2::ZERO)]).objects.is_empty());
    assert!(camera.look(lost, &[], &mut Frame::default()).is_err());
}
