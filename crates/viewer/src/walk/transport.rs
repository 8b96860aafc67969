//! Transport controls: play, pause, step and scrub.

use eframe::egui::{self, ComboBox, Slider, Ui};
use reality_sim_core::sequence::Sequence;

use super::{
    player::{Command, State},
    settings::Speed,
};
use crate::shortcuts::{self, Action};

/// Shows the controls; returns the command that the user gave.
pub fn ui(ui: &mut Ui, sequence: &Sequence, state: State, speed: &mut Speed) -> Option<Command> {
    let State { at, is_playing, .. } = state;
    let mut asked = None;
    let last = sequence.frames.len() - 1;
    ui.horizontal_wrapped(|ui| {
        let mut button = |ui: &mut Ui, text: &str, action: Action, what: &str| {
            let hover = format!("{what} ({})", shortcuts::name(ui, action));
            if ui.button(text).on_hover_text(hover).clicked() {
                asked = command(action, at, last, is_playing);
            }
        };
        button(ui, "Start", Action::First, "Begin again at the first picture");
        button(ui, "Back", Action::StepBack, "One picture back");
        button(ui, if is_playing { "Pause" } else { "Play" }, Action::PlayPause, "Play or pause");
        button(ui, "Next", Action::StepForward, "One picture on");
        let label = ui.label("Speed");
        let combo = ComboBox::from_id_salt("speed").selected_text(speed.name()).show_ui(ui, |ui| {
            for choice in Speed::ALL {
                ui.selectable_value(speed, choice, choice.name());
            }
        });
        combo.response.labelled_by(label.id).on_hover_text("How fast the recording is played");
        let time_s = sequence.frames[at].timestamp_s - sequence.frames[0].timestamp_s;
        ui.label(format!("picture {} of {}, {time_s:.1} s", at + 1, last + 1));
    });
    asked.or(scrub(ui, at, last))
}

/// Shows the slider on a line of its own, so that nothing beside it moves while it is dragged.
fn scrub(ui: &mut Ui, at: usize, last: usize) -> Option<Command> {
    let mut wanted = at;
    ui.spacing_mut().slider_width = ui.available_width();
    let slider = ui.add(Slider::new(&mut wanted, 0..=last).show_value(false));
    slider.widget_info(|| egui::WidgetInfo::slider(true, wanted as f64, "Picture"));
    (wanted != at).then_some(Command::GoTo(wanted))
}

/// Returns the player's command for an action of a key or a button.
pub fn command(action: Action, at: usize, last: usize, is_playing: bool) -> Option<Command> {
    match action {
        Action::PlayPause if is_playing => Some(Command::Pause),
        Action::PlayPause => Some(Command::Play),
        Action::First => Some(Command::Restart),
        Action::Last => Some(Command::GoTo(last)),
        Action::StepBack => Some(Command::GoTo(at.saturating_sub(1))),
        Action::StepForward if at < last => Some(Command::GoTo(at + 1)),
        _ => None,
    }
}
