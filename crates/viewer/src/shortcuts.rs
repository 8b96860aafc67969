//! Keyboard shortcuts: one table for their actions and for the list shown.

use eframe::egui::{self, Event, InputState, Key, KeyboardShortcut, Modifiers, Ui};

/// Action of a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    OpenPath,
    Walk,
    Drive,
    Gap,
    Theme,
    Screenshot,
    Help,
    Quit,
    PlayPause,
    StepBack,
    StepForward,
    First,
    Last,
    Forward,
    Backward,
    Left,
    Right,
    TurnLeft,
    TurnRight,
    PutBall,
    AddRobot,
    RemoveThing,
    Labels,
    OtherModel,
    Difference,
    ChannelBefore,
    ChannelAfter,
    EffectAbove,
    EffectBelow,
}

/// Part of the window in which a key acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    Everywhere,
    Walk,
    Drive,
    Gap,
}

const fn plain(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::NONE, key)
}

const fn command(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}

/// All shortcuts, in the order of the list.
const TABLE: &[(Place, KeyboardShortcut, Action, &str)] = &[
    (Place::Everywhere, command(Key::O), Action::OpenPath, "open a recording, a database or a report"),
    (Place::Everywhere, command(Key::Num1), Action::Walk, "show Walk"),
    (Place::Everywhere, command(Key::Num2), Action::Drive, "show Drive"),
    (Place::Everywhere, command(Key::Num3), Action::Gap, "show Gap"),
    (Place::Everywhere, command(Key::T), Action::Theme, "light or dark"),
    (Place::Everywhere, command(Key::P), Action::Screenshot, "save a screenshot"),
    (Place::Everywhere, plain(Key::F1), Action::Help, "this list"),
    (Place::Everywhere, plain(Key::Questionmark), Action::Help, "this list"),
    (Place::Everywhere, command(Key::Q), Action::Quit, "quit"),
    (Place::Walk, plain(Key::Space), Action::PlayPause, "play or pause"),
    (Place::Walk, plain(Key::ArrowLeft), Action::StepBack, "one picture back"),
    (Place::Walk, plain(Key::ArrowRight), Action::StepForward, "one picture on"),
    (Place::Walk, plain(Key::Home), Action::First, "to the first picture"),
    (Place::Walk, plain(Key::End), Action::Last, "to the last picture"),
    (Place::Drive, plain(Key::W), Action::Forward, "walk forwards"),
    (Place::Drive, plain(Key::S), Action::Backward, "walk backwards"),
    (Place::Drive, plain(Key::A), Action::Left, "walk to the left"),
    (Place::Drive, plain(Key::D), Action::Right, "walk to the right"),
    (Place::Drive, plain(Key::Q), Action::TurnLeft, "turn to the left"),
    (Place::Drive, plain(Key::E), Action::TurnRight, "turn to the right"),
    (Place::Drive, plain(Key::Space), Action::PlayPause, "follow the drawn path, or stop"),
    (Place::Drive, plain(Key::B), Action::PutBall, "put the ball before the camera"),
    (Place::Drive, plain(Key::R), Action::AddRobot, "add a robot before the camera"),
    (Place::Drive, plain(Key::Delete), Action::RemoveThing, "remove the ball or robot touched last"),
    (Place::Drive, plain(Key::L), Action::Labels, "labels over the pictures, or none"),
    (Place::Gap, plain(Key::Space), Action::OtherModel, "without or with what was found"),
    (Place::Gap, plain(Key::D), Action::Difference, "wipe or difference"),
    (Place::Gap, plain(Key::ArrowLeft), Action::ChannelBefore, "the channel before"),
    (Place::Gap, plain(Key::ArrowRight), Action::ChannelAfter, "the next channel"),
    (Place::Gap, plain(Key::ArrowUp), Action::EffectAbove, "the effect above"),
    (Place::Gap, plain(Key::ArrowDown), Action::EffectBelow, "the effect below"),
];

impl Action {
    /// Whether the action repeats while its key is held down.
    const fn repeats(self) -> bool {
        matches!(self, Self::StepBack | Self::StepForward | Self::ChannelBefore | Self::ChannelAfter)
    }
}

/// Returns the actions pressed since the last frame in a place. While a text field has the focus, only keys with Ctrl (or
/// Command) count.
pub fn pressed(ui: &Ui, place: Place) -> Vec<Action> {
    let types = ui.ctx().text_edit_focused();
    let here = TABLE.iter().filter(|(heard, ..)| *heard == place);
    let heard = here.filter(|(_, shortcut, ..)| !types || shortcut.modifiers.command);
    ui.input_mut(|input| {
        heard
            .filter(|(_, shortcut, action, _)| consume(input, shortcut, action.repeats()))
            .map(|(_, _, action, _)| *action)
            .collect()
    })
}

/// Removes a key from the input, so that nothing else handles it. Shift is ignored: on many keyboards `?` needs it.
fn consume(input: &mut InputState, shortcut: &KeyboardShortcut, repeats: bool) -> bool {
    let mut is_pressed = false;
    input.events.retain(|event| match event {
        Event::Key { key, pressed: true, repeat, modifiers, .. }
            if *key == shortcut.logical_key && modifiers.matches_logically(shortcut.modifiers) =>
        {
            is_pressed |= repeats || !repeat;
            false
        }
        _ => true,
    });
    is_pressed
}

/// Returns the actions whose keys are held down in a place.
pub fn held(ui: &Ui, place: Place) -> Vec<Action> {
    if ui.ctx().text_edit_focused() {
        return Vec::new();
    }
    let here = TABLE.iter().filter(|(heard, ..)| *heard == place);
    ui.input(|input| {
        let plain = !input.modifiers.any();
        here.filter(|(_, shortcut, ..)| plain && input.key_down(shortcut.logical_key))
            .map(|(_, _, action, _)| *action)
            .collect()
    })
}

/// Returns the key of an action, for tooltips.
pub fn name(ui: &Ui, action: Action) -> String {
    let found = TABLE.iter().find(|(_, _, other, _)| *other == action);
    found.map_or_else(String::new, |(_, shortcut, ..)| written(ui, shortcut))
}

/// Returns a shortcut in the platform's notation.
fn written(ui: &Ui, shortcut: &KeyboardShortcut) -> String {
    match shortcut.logical_key {
        Key::Questionmark => "?".to_owned(),
        _ => ui.ctx().format_shortcut(shortcut),
    }
}

/// Shows the list of all keys.
pub fn window(ui: &Ui, is_open: &mut bool) {
    if *is_open && ui.input(|input| input.key_pressed(Key::Escape)) {
        *is_open = false;
    }
    egui::Window::new("Keys and mouse").open(is_open).resizable(false).collapsible(false).vscroll(true).show(
        ui.ctx(),
        |ui| {
            for (title, place) in [
                ("Everywhere", Place::Everywhere),
                ("Walk", Place::Walk),
                ("Drive", Place::Drive),
                ("Gap", Place::Gap),
            ] {
                ui.strong(title);
                egui::Grid::new(title).num_columns(2).spacing([24.0, 2.0]).show(ui, |ui| {
                    for (_, shortcut, _, text) in TABLE.iter().filter(|(heard, ..)| *heard == place) {
                        ui.monospace(written(ui, shortcut));
                        ui.label(*text);
                        ui.end_row();
                    }
                });
                ui.add_space(6.0);
            }
            ui.strong("On the field");
            ui.label("wheel: zoom · secondary button: move the view · double click: all of it");
            ui.label("drag the arrow's tail: move the robot · drag its tip: turn it");
            ui.label("drag the ball or another robot: move it · drag the end of a robot's line: turn it");
            ui.add_space(6.0);
            ui.strong("In the camera's picture");
            ui.label("drag the ball or a robot: move it · wheel over a robot: turn it");
        },
    );
}
