use egui_kittest::{Harness, kittest::Queryable};
use reality_sim_core::{
    camera::{Camera, Distortion},
    field::FieldDimensions,
};

use super::*;
use crate::drive::things::Eye;

/// A map, shown or hidden, and its robot.
struct Window {
    map: Map,
    robot: Robot,
    things: Things,
    field: FieldDimensions,
    is_shown: bool,
}

fn window() -> Harness<'static, Window> {
    let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
    let robot = Robot::new(CameraPose::new(Pose2::new(0.0, 0.0, 0.0), 0.5, 0.4, 0.0), &field);
    let camera = Camera::new([640, 480], [215.0, 215.0, 319.5, 239.5], Distortion::Pinhole).unwrap();
    let things = Things::before(Eye { camera: &camera, pose: robot.pose() }, &field);
    let window = Window { map: Map::default(), robot, things, field, is_shown: true };
    let show = |ui: &mut Ui, window: &mut Window| {
        if window.is_shown {
            let canvas = window.map.view.show(ui, &window.field, vec2(600.0, 400.0), "the field");
            window.map.drag(ui, &canvas, &mut window.robot, &mut window.things);
        }
    };
    Harness::builder().with_size([620.0, 420.0]).build_ui_state(show, window)
}

#[test]
fn a_drag_that_ends_where_the_field_is_not_shown_leaves_the_robot_alone_afterwards() {
    let mut window = window();
    window.step();
    let middle = window.get_by_label("the field").rect().center();
    window.hover_at(middle);
    window.step();
    window.drag_at(middle);
    window.step();
    window.hover_at(middle + vec2(40.0, 0.0));
    window.run_steps(2);
    assert!(window.state().map.grip.is_some() && window.state().robot.pose().x_m > 0.1);

    window.state_mut().is_shown = false;
    window.step();
    window.drop_at(middle + vec2(40.0, 0.0));
    window.run_steps(2);
    window.state_mut().is_shown = true;
    window.run_steps(2);
    assert_eq!(window.state().map.grip, None);
}

#[test]
fn following_begins_with_the_drawing_at_an_end_whatever_it_was_begun_by() {
    let mut window = window();
    let Window { map, robot, .. } = window.state_mut();
    map.is_drawing = true;
    robot.draw_to(DVec2::ZERO);
    robot.draw_to(DVec2::X);
    map.follow_or_stop(robot);
    assert!(robot.is_following() && !map.is_drawing);
}
