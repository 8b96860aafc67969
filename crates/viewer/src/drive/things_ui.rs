//! Controls for the ball and the other robots.

use eframe::egui::{Button, Ui};

use super::things::{Eye, MOST_ROBOTS, PlacedThing, Thing, Things};
use crate::shortcuts::{self, Action};

/// Shows the controls for things; new ones are put before the camera.
pub fn things_ui(ui: &mut Ui, things: &mut Things, eye: Eye) {
    ui.horizontal_wrapped(|ui| {
        let mut is_shown = things.is_shown();
        if ui
            .checkbox(&mut is_shown, "Ball and robots")
            .on_hover_text("Draw them into all pictures but the true one: drag them there or on the field")
            .changed()
        {
            things.show(is_shown);
        }
        if button(ui, true, "Ball here", Action::PutBall, "Put the ball before the camera", "") {
            things.put_ball(eye);
        }
        let enough = format!("There are {MOST_ROBOTS} of them");
        let what = "Put another robot before the camera";
        if button(ui, things.has_room(), "Add robot", Action::AddRobot, what, &enough) {
            things.add_robot(eye);
        }
        let (what, nothing) = ("Remove the ball or robot touched last", "Click the ball or a robot first");
        if button(ui, things.chosen().is_some(), "Remove", Action::RemoveThing, what, nothing) {
            things.remove_chosen();
        }
    });
    ui.weak(match things.chosen() {
        Some(chosen) => in_words(chosen),
        None => "Drag the ball or a robot, here or in the picture.".to_owned(),
    });
}

/// Shows a button that does the same as a key; returns true if it is clicked.
fn button(ui: &mut Ui, is_enabled: bool, text: &str, action: Action, what: &str, why_not: &str) -> bool {
    let hover = format!("{what} ({})", shortcuts::name(ui, action));
    let button = ui.add_enabled(is_enabled, Button::new(text));
    button.on_hover_text(hover).on_disabled_hover_text(why_not).clicked()
}

fn in_words(PlacedThing { thing, place }: PlacedThing) -> String {
    let at = format!("{} at x {:.2} m, y {:.2} m", thing.name(), place.x_m, place.y_m);
    match thing {
        Thing::Ball => at,
        Thing::Robot(_) => format!("{at}, heading {:.0}°", place.yaw_rad.to_degrees()),
    }
}
