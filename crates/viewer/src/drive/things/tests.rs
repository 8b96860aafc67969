use std::collections::BTreeSet;

use reality_sim_core::camera::Distortion;

use super::*;

fn field() -> FieldDimensions {
    FieldDimensions::preset("humanoid-kidsize-2010").unwrap()
}

fn camera() -> Camera {
    Camera::new([640, 480], [215.0, 215.0, 319.5, 239.5], Distortion::Pinhole).unwrap()
}

fn pose(pitch_rad: f64) -> CameraPose {
    CameraPose::new(Pose2::new(-1.5, 0.4, 0.6), 0.5, pitch_rad, 0.0)
}

fn place_of(things: &Things, thing: Thing) -> DVec2 {
    let placed = things.shown().iter().find(|placed| placed.thing == thing);
    placed.unwrap().place.position_in_world()
}

#[test]
fn ball_and_robot_stand_in_view_wherever_the_camera_looks() {
    let camera = camera();
    for pitch_rad in [0.0, 0.3, 0.8, 1.5] {
        let eye = Eye { camera: &camera, pose: pose(pitch_rad) };
        let things = Things::before(eye, &field());
        assert_eq!(things.shown().len(), 2);
        for placed in things.shown() {
            let point_in_world = placed.place.position_in_world().extend(0.0);
            let is_seen = camera.project(eye.pose.camera_from_world(point_in_world)).is_ok();
            assert!(is_seen || placed.thing != Thing::Ball, "{pitch_rad} {placed:?}");
            if placed.thing != Thing::Ball {
                let back = eye.pose.planar().position_in_world() - placed.place.position_in_world();
                assert!(
                    wrap_angle(back.to_angle() - placed.place.yaw_rad).abs() < 1e-9,
                    "it faces the camera"
                );
            }
        }
    }
}

#[test]
fn a_thing_that_is_moved_stays_where_it_is_put_and_within_reach() {
    let camera = camera();
    let mut things = Things::before(Eye { camera: &camera, pose: pose(0.3) }, &field());
    things.obey(Gesture::MoveTo(Thing::Ball, DVec2::new(0.25, -1.5)));
    assert_eq!(place_of(&things, Thing::Ball), DVec2::new(0.25, -1.5));
    let reach_m = field().carpet_half_extent_m() + 1.0;
    things.obey(Gesture::MoveTo(Thing::Ball, DVec2::new(70.0, -90.0)));
    assert_eq!(place_of(&things, Thing::Ball), DVec2::new(reach_m.x, -reach_m.y));
    for nowhere in [DVec2::new(f64::NAN, 0.0), DVec2::new(0.0, f64::NAN)] {
        things.obey(Gesture::MoveTo(Thing::Ball, nowhere));
    }
    assert_eq!(place_of(&things, Thing::Ball), DVec2::new(reach_m.x, -reach_m.y));
}

#[test]
fn robots_turn_and_stay_at_their_places() {
    let camera = camera();
    let mut things = Things::before(Eye { camera: &camera, pose: pose(0.3) }, &field());
    let robot = things.shown()[1];
    things.obey(Gesture::TurnTo(robot.thing, 7.0));
    let turned = things.shown()[1].place;
    assert!((turned.yaw_rad - wrap_angle(7.0)).abs() < 1e-12);
    things.obey(Gesture::TurnBy(robot.thing, -0.5));
    things.obey(Gesture::TurnBy(robot.thing, f64::INFINITY));
    let turned = things.shown()[1].place;
    assert!((turned.yaw_rad - wrap_angle(6.5)).abs() < 1e-12, "{turned:?}");
    assert_eq!(turned.position_in_world(), robot.place.position_in_world());
}

#[test]
fn robots_are_added_apart_from_each_other_until_there_are_enough() {
    let camera = camera();
    let eye = Eye { camera: &camera, pose: pose(0.3) };
    let mut things = Things::before(eye, &field());
    for _ in 0..5 {
        things.add_robot(eye);
    }
    for (number, one) in things.shown().iter().enumerate() {
        for other in &things.shown()[..number] {
            let apart_m = one.place.position_in_world().distance(other.place.position_in_world());
            assert!(apart_m >= ROOM_M, "{one:?} {other:?}");
        }
    }
    for _ in 0..20 {
        things.add_robot(eye);
    }
    assert_eq!(things.shown().len(), MOST_ROBOTS + 1);
    assert!(!things.has_room());
    let names: BTreeSet<String> = things.shown().iter().map(|placed| placed.thing.name()).collect();
    assert_eq!(names.len(), MOST_ROBOTS + 1);
}

#[test]
fn the_thing_touched_last_is_removed_and_the_others_keep_their_names() {
    let camera = camera();
    let eye = Eye { camera: &camera, pose: pose(0.3) };
    let mut things = Things::before(eye, &field());
    things.remove_chosen();
    assert_eq!(things.shown().len(), 2, "nothing was touched so far");
    let first = things.shown()[1].thing;
    things.add_robot(eye);
    assert_eq!(things.chosen().unwrap().thing.name(), "robot_2");
    things.obey(Gesture::Choose(first));
    things.remove_chosen();
    things.remove_chosen();
    let names: Vec<String> = things.shown().iter().map(|placed| placed.thing.name()).collect();
    assert_eq!(names, ["ball", "robot_2"]);
    things.add_robot(eye);
    assert_eq!(things.chosen().unwrap().thing.name(), "robot_3");
}

#[test]
fn what_is_hidden_is_neither_shown_nor_removed_and_comes_back_with_a_new_ball() {
    let camera = camera();
    let eye = Eye { camera: &camera, pose: pose(0.3) };
    let mut things = Things::before(eye, &field());
    things.obey(Gesture::Choose(Thing::Ball));
    things.show(false);
    assert!(things.shown().is_empty() && things.chosen().is_none());
    things.remove_chosen();
    things.show(true);
    assert_eq!(things.shown().len(), 2);
    things.remove_chosen();
    assert_eq!(things.shown().len(), 1);
    things.show(false);
    things.put_ball(eye);
    assert_eq!(things.shown().len(), 2, "it is seen at once");
}

#[test]
fn on_the_way_out_of_reach_things_stop_at_the_edge() {
    let camera = camera();
    let things = Things::before(Eye { camera: &camera, pose: pose(0.3) }, &field());
    let reach_m = field().carpet_half_extent_m() + 1.0;
    let from = DVec2::new(-1.0, 0.5);
    assert_eq!(things.within_reach(from, DVec2::new(1.5, -0.5)), DVec2::new(1.5, -0.5));
    for to in [DVec2::new(80.0, 3.0), DVec2::new(-9.0, -70.0), DVec2::new(-1.0, 700.0)] {
        let place = things.within_reach(from, to);
        assert!((place - from).perp_dot(to - from).abs() < 1e-9, "{place} is on the way to {to}");
        assert!((place - from).dot(to - from) > 0.0);
        let beyond = place.abs() / reach_m;
        assert!((beyond.max_element() - 1.0).abs() < 1e-12, "{place} is at the edge");
    }
}
