//! Walk: the particle filter running on a recording.

mod camera;
mod cloud;
mod controls;
mod curves;
mod frame;
mod gathering;
mod history;
mod map;
mod player;
mod settings;
#[cfg(test)]
mod tests;
mod timeline;
mod transport;

use std::sync::Arc;

use eframe::egui::{self, Context, Ui, vec2};
use reality_sim_core::sequence::Sequence;

use self::{
    camera::CameraTextures,
    controls::fact,
    frame::FrameView,
    history::History,
    map::Map,
    player::{Command, Message, Player, State},
    timeline::Timeline,
};
pub use self::{player::Beginning, settings::WalkSettings};
use crate::{
    device::Device,
    picture_view::PictureCanvas,
    problems::Problems,
    shortcuts::{self, Place},
};

/// Width of the settings beside the views, including margins, points.
const SETTINGS_WIDTH: f32 = 234.0;
/// Height of the part along the bottom without the curves, points.
const TRANSPORT_HEIGHT: f32 = 108.0;
/// Range of the curves' height, points; within it, they take the space left by picture and field side by side.
const CURVE_HEIGHTS: std::ops::RangeInclusive<f32> = 72.0..=330.0;
/// Least ratio of width to height at which picture and field are side by side; below it, one is above the other.
const WIDE: f32 = 1.25;

/// Recording, the player that processes it, and what the player has sent.
pub struct WalkPanel {
    sequence: Arc<Sequence>,
    player: Player,
    /// Settings sent to the player last.
    told: WalkSettings,
    /// Number of commands sent to the player, compared with the number it has received.
    commands: u64,
    state: State,
    timeline: Timeline,
    has_truth: bool,
    /// Whether there was a frame, or a problem in its place.
    has_answered: bool,
    frame: Option<Box<FrameView>>,
    history: History,
    map: Map,
    textures: CameraTextures,
}

impl WalkPanel {
    /// Starts a player on a recording.
    pub fn new(
        ctx: &Context,
        sequence: Arc<Sequence>,
        devices: &[Device],
        settings: &WalkSettings,
        beginning: Beginning,
    ) -> Self {
        let player = Player::spawn(ctx, sequence.clone(), devices.to_vec(), settings, beginning);
        Self {
            history: History::default(),
            timeline: Timeline::new(&sequence),
            has_truth: sequence.has_reference_poses(),
            sequence,
            player,
            told: settings.clone(),
            commands: 0,
            has_answered: false,
            state: State::default(),
            frame: None,
            map: Map::default(),
            textures: CameraTextures::default(),
        }
    }

    /// Receives the player's messages; of several frames, the last one is drawn.
    fn listen(&mut self, problems: &mut Problems) {
        while let Some(message) = self.player.poll() {
            match message {
                Message::Begun => self.history = History::default(),
                Message::Frame(frame) => {
                    self.has_answered = true;
                    // What is known of the first picture follows from the start, not from the gathering.
                    if frame.gathering.is_none() {
                        self.history.add(frame.record);
                    }
                    self.frame = Some(frame);
                }
                Message::State(state) => self.state = state,
                Message::Problem(reason) => {
                    self.has_answered = true;
                    problems.add(reason);
                }
            }
        }
    }

    /// Returns commands for settings changed since the player was last told.
    fn new_settings(&mut self, settings: &WalkSettings) -> Vec<Command> {
        let told = std::mem::replace(&mut self.told, settings.clone());
        let changed = [
            (settings.filter != told.filter).then(|| {
                self.history.mark_change(self.state.at);
                Command::Filter(settings.filter.clone())
            }),
            (settings.speed != told.speed).then_some(Command::Speed(settings.speed)),
            (settings.layers.veil != told.layers.veil).then_some(Command::Veil(settings.layers.veil)),
        ];
        changed.into_iter().flatten().collect()
    }

    /// Shows the panel.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        settings: &mut WalkSettings,
        devices: &[Device],
        problems: &mut Problems,
    ) {
        self.listen(problems);
        let frame = self.frame.take();
        let mut commands = self.content(ui, frame.as_deref(), settings, devices);
        self.frame = frame;
        commands.extend(self.new_settings(settings));
        self.commands += commands.len() as u64;
        commands.into_iter().for_each(|command| self.player.tell(command));
    }

    /// Whether the player still works on a command.
    fn is_working(&self) -> bool {
        !self.has_answered || self.state.heard < self.commands
    }

    fn content(
        &mut self,
        ui: &mut Ui,
        frame: Option<&FrameView>,
        settings: &mut WalkSettings,
        devices: &[Device],
    ) -> Vec<Command> {
        let State { at, is_playing, .. } = self.state;
        let last = self.sequence.frames.len() - 1;
        let mut commands: Vec<Command> = shortcuts::pressed(ui, Place::Walk)
            .into_iter()
            .filter_map(|action| transport::command(action, at, last, is_playing))
            .collect();
        egui::Panel::right("walk settings").resizable(false).exact_size(SETTINGS_WIDTH).show(ui, |ui| {
            egui::ScrollArea::vertical().show(ui, |ui| {
                facts(ui, frame, self.is_working());
                ui.separator();
                controls::layers(ui, &mut settings.layers, self.has_truth);
                ui.separator();
                controls::filter(ui, &mut settings.filter, devices);
            });
        });
        // The curves take the space left by picture and field side by side.
        let views_height = height_within(ui.available_width(), &self.sequence);
        let left = ui.available_height() - TRANSPORT_HEIGHT - views_height;
        let curve_height = left.clamp(*CURVE_HEIGHTS.start(), *CURVE_HEIGHTS.end());
        egui::Panel::bottom("time").show(ui, |ui| commands.extend(self.time_ui(ui, settings, curve_height)));
        egui::CentralPanel::default().show(ui, |ui| commands.extend(self.views(ui, frame, settings)));
        commands
    }

    /// Shows the curves and the transport controls along the bottom.
    fn time_ui(&self, ui: &mut Ui, settings: &mut WalkSettings, curve_height: f32) -> Vec<Command> {
        let Self { sequence, timeline, history, state, has_truth, .. } = self;
        ui.add_space(4.0);
        let asked = transport::ui(ui, sequence, *state, &mut settings.speed);
        let clicked = curves::ui(ui, timeline, history, state.at, *has_truth, curve_height);
        asked.into_iter().chain(clicked.map(Command::GoTo)).collect()
    }

    /// Shows the camera's picture and the field, side by side or one above the other.
    fn views(
        &mut self,
        ui: &mut Ui,
        frame: Option<&FrameView>,
        settings: &mut WalkSettings,
    ) -> Option<Command> {
        let room = ui.available_size();
        let is_wide = room.x > WIDE * room.y;
        let camera = &self.sequence.setup.camera;
        let aspect = camera.width as f32 / camera.height as f32;
        let (picture, field) = if is_wide {
            // Both have the height at which they fit side by side; the field takes the rest of the width.
            let height = height_within(room.x, &self.sequence).min(room.y);
            let width = (aspect * height).min(0.7 * room.x);
            (vec2(width, height), vec2(room.x - width - ui.spacing().item_spacing.x, height))
        } else {
            let height = 0.5 * (room.y - ui.spacing().item_spacing.y);
            (vec2(room.x, height), vec2(room.x, height))
        };
        let layout = if is_wide { egui::Layout::left_to_right(egui::Align::Min) } else { *ui.layout() };
        let at = self.state.at;
        let words = match frame {
            _ if self.is_working() => None,
            Some(frame) if frame.record.index == at => None,
            _ => Some(format!("picture {} cannot be shown", at + 1)),
        };
        let dropped = ui.with_layout(layout, |ui| {
            let size = [camera.width as usize, camera.height as usize];
            let canvas = PictureCanvas::allocate(ui, size, picture, "Camera picture");
            frame.into_iter().for_each(|frame| self.textures.draw(ui, &canvas, frame, &settings.layers));
            words.into_iter().for_each(|words| canvas.words(&words));
            self.map.ui(ui, &self.sequence, frame, &self.history, &mut settings.layers, field)
        });
        dropped.inner.map(Command::Place)
    }
}

/// Returns the height at which picture and field side by side fill the width.
fn height_within(width: f32, sequence: &Sequence) -> f32 {
    let (camera, half) = (&sequence.setup.camera, sequence.field.carpet_half_extent_m());
    width / (camera.width as f32 / camera.height as f32 + (half.x / half.y) as f32)
}

/// Shows the results for the current picture.
fn facts(ui: &mut Ui, frame: Option<&FrameView>, is_working: bool) {
    let Some(frame) = frame else {
        ui.weak(if is_working { "working …" } else { "nothing seen yet" });
        return;
    };
    let record = &frame.record;
    let state = match (frame.gathering, record.sure, record.searched) {
        _ if is_working => "working …".to_owned(),
        (Some(step), ..) => format!("gathering, {} of {}", step.number, step.of),
        (None, true, false) => "sure".to_owned(),
        (None, true, true) => "sure, after a search".to_owned(),
        (None, false, false) => "not sure".to_owned(),
        (None, false, true) => "not sure, after a search".to_owned(),
    };
    let pose = record.pose;
    let known = |text: String| if frame.has_pose() { text } else { "–".to_owned() };
    let angles = format!("{:.2}°, {:.2}°", pose.pitch_rad.to_degrees(), pose.roll_rad.to_degrees());
    egui::Grid::new("facts").num_columns(2).spacing([8.0, 2.0]).show(ui, |ui| {
        fact(ui, "Pose", state);
        fact(ui, "x, y", known(format!("{:.3} m, {:.3} m", pose.x_m, pose.y_m)));
        fact(ui, "heading", known(format!("{:.2}°", pose.yaw_rad.to_degrees())));
        fact(ui, "height", known(format!("{:.3} m", pose.height_m)));
        fact(ui, "pitch, roll", known(angles));
        if let (Some(error_m), Some(error_yaw_rad)) = (record.error_m, record.error_yaw_rad) {
            let text = format!("{:.2} cm, {:.2}°", 100.0 * error_m, error_yaw_rad.to_degrees());
            fact(ui, "error", known(text));
        }
        let verb = if frame.has_pose() { "weighed" } else { "spread" };
        fact(ui, "particles", format!("{} {verb}", record.particles));
    });
}
