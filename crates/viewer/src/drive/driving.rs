//! Driving the robot on the field, and the pictures at its pose.

use std::{collections::BTreeMap, sync::Arc};

use eframe::egui::{self, DragValue, Ui, vec2};
use reality_sim_core::{
    camera::Camera,
    field::FieldDimensions,
    pose::{CameraPose, wrap_angle},
    sequence::Sequence,
};

use super::{
    answer::{Answer, Around, Painted},
    kind::{Pane, PictureKind},
    layout::Layout,
    map::{Map, MapContent},
    painter::Painter,
    pictures::{Asked, Gallery, Pictures},
    robot::Robot,
    settings::DriveSettings,
    source::{Probes, Source},
    things::{Eye, Things},
    things_ui::things_ui,
    widgets::{counted, device_ui},
    wish::Wish,
};
use crate::{
    device::{Device, by_name},
    problems::Problems,
    shortcuts::{self, Action, Place},
};

/// Longest time step of the robot, seconds, when a frame took longer.
const LONGEST_STEP_S: f64 = 0.1;
/// Height of the controls below the field, points.
const CONTROLS: f32 = 306.0;

/// State of the panel once there is a database.
pub struct Driving {
    source: Arc<Source>,
    probes: Option<Probes>,
    painter: Option<Painter>,
    robot: Robot,
    things: Things,
    map: Map,
    pictures: Pictures,
    around: Option<Around>,
    painted: BTreeMap<Pane, Painted>,
    /// Width of the panel in the last frame, points.
    width: f32,
    /// Width of the field's panel in the last frame, points.
    map_width: f32,
}

impl Driving {
    /// Places the robot at the pose of the first picture, a ball and another robot before its camera.
    pub fn new(source: Source) -> Self {
        let archive = &source.archive;
        let first = archive.images().first().map(|image| image.pose.planar()).unwrap_or_default();
        let robot = Robot::new(archive.usual_pose().with_planar(first), archive.field());
        let things = Things::before(Self::eye(&source, robot.pose()), archive.field());
        Self {
            probes: source.probes.clone(),
            source: Arc::new(source),
            painter: None,
            robot,
            things,
            map: Map::default(),
            pictures: Pictures::default(),
            around: None,
            painted: BTreeMap::new(),
            width: 0.0,
            map_width: 0.0,
        }
    }

    /// Takes the true pictures of another recording to compare with.
    pub fn compare_with(&mut self, sequence: &Arc<Sequence>) -> Result<(), String> {
        let folder = sequence.folder.display();
        let archive = &self.source.archive;
        if let Some(difference) = camera_difference(&archive.setup().camera, &sequence.setup.camera) {
            return Err(format!("{folder}: {difference}: choose a recording of the same camera"));
        }
        if !is_same_field(archive.field(), &sequence.field) {
            return Err(format!(
                "{folder}: its field has other dimensions or colours than the database's: choose a recording on the same field"
            ));
        }
        let probes = Probes::of_recording(sequence).ok_or_else(|| {
            format!("{folder}: has no ground truth, so where its pictures were taken is not known: choose a recording that has one")
        })?;
        self.probes = Some(probes);
        Ok(())
    }

    /// Shows the panel. Returns true when the user asks for a recording to compare with.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        settings: &mut DriveSettings,
        devices: &[Device],
        problems: &mut Problems,
    ) -> bool {
        self.listen(problems);
        self.act_on_keys(ui, settings);
        self.map.poll(ui, &self.source, &mut settings.layers, problems);
        let is_asked = self.map_panel(ui, settings, devices);
        egui::CentralPanel::default().show(ui, |ui| {
            Pictures::choice_ui(ui, settings, self.source.archive.has_clean_stage());
            ui.separator();
            let probe = self.around.as_ref().and_then(|around| around.probe);
            let (archive, painted) = (&*self.source.archive, &self.painted);
            let gallery = Gallery { archive, painted, probe, pose: self.robot.pose(), things: &self.things };
            match self.pictures.ui(ui, settings, &gallery) {
                Some(Asked::Pose(there)) => self.robot.take(there),
                Some(Asked::Change(gesture)) => self.things.obey(gesture),
                None => {}
            }
        });
        self.wish(ui, settings, devices);
        is_asked
    }

    /// Receives the painter's answers.
    fn listen(&mut self, problems: &mut Problems) {
        while let Some(answer) = self.painter.as_mut().and_then(Painter::answer) {
            match answer {
                Answer::Around(around) => self.around = Some(around),
                Answer::Painted(pane, painted) => {
                    self.painted.insert(pane, painted);
                }
                Answer::Problem(problem) => problems.add(problem),
            }
        }
    }

    fn wish(&mut self, ui: &Ui, settings: &DriveSettings, devices: &[Device]) {
        let painter = self.painter.get_or_insert_with(|| Painter::spawn(ui.ctx(), self.source.clone()));
        painter.wish(Wish {
            pose: self.robot.pose(),
            panes: settings.panes(),
            is_best_effort: settings.is_best_effort,
            is_clean: settings.is_clean && self.source.archive.has_clean_stage(),
            things: self.things.shown().to_vec(),
            is_labelled: settings.is_labelled,
            edges_in: settings.layers.triangulation.then(|| self.map.seen()),
            probes: self.probes.clone(),
            device: by_name(devices, &settings.device).cloned(),
        });
    }

    /// Returns the camera where it stands.
    fn eye(source: &Source, pose: CameraPose) -> Eye<'_> {
        Eye { camera: &source.archive.setup().camera, pose }
    }

    /// Does what keys ask for, and moves the robot along its path.
    fn act_on_keys(&mut self, ui: &Ui, settings: &mut DriveSettings) {
        for action in shortcuts::pressed(ui, Place::Drive) {
            let eye = Self::eye(&self.source, self.robot.pose());
            match action {
                Action::PlayPause => self.map.follow_or_stop(&mut self.robot),
                Action::PutBall => self.things.put_ball(eye),
                Action::AddRobot => self.things.add_robot(eye),
                Action::RemoveThing => self.things.remove_chosen(),
                Action::Labels => settings.is_labelled = !settings.is_labelled,
                _ => {}
            }
        }
        let seconds = f64::from(ui.input(|input| input.stable_dt)).min(LONGEST_STEP_S);
        let walks = self.robot.walk(&shortcuts::held(ui, Place::Drive), seconds);
        if walks || self.robot.follow(seconds) {
            ui.request_repaint();
        }
    }

    /// Shows the field in a panel at the right whose share of the width is remembered, for windows of any width.
    fn map_panel(&mut self, ui: &mut Ui, settings: &mut DriveSettings, devices: &[Device]) -> bool {
        let width = ui.available_width();
        let panel = egui::Panel::right("drive map")
            .default_size(settings.map_share * width)
            .size_range(260.0..=(0.55 * width).max(270.0));
        let is_new = std::mem::replace(&mut self.width, width) != width;
        if is_new {
            // egui remembers the width in points.
            let id = ui.scope_id().with("drive map");
            ui.data_mut(|data| data.remove::<egui::PanelState>(id));
        }
        let shown = panel.show(ui, |ui| self.map_ui(ui, settings, devices));
        let map_width = shown.response.rect.width();
        let is_changed = std::mem::replace(&mut self.map_width, map_width) != map_width;
        if is_changed && !is_new && ui.input(|input| input.pointer.any_down()) {
            settings.map_share = map_width / width;
        }
        shown.inner
    }

    /// Shows the field, and its controls below.
    fn map_ui(&mut self, ui: &mut Ui, settings: &mut DriveSettings, devices: &[Device]) -> bool {
        self.pose_ui(ui);
        let made = match settings.layout {
            Layout::All => Pane::picture(PictureKind::Blend),
            _ => Pane { kind: settings.left, aspect: settings.aspect },
        };
        let drawn = self.painted.get(&made).and_then(|painted| painted.result.as_ref().ok());
        let used_by = made.kind.name();
        let content = MapContent {
            source: &self.source,
            layers: settings.layers,
            around: self.around.as_ref(),
            used: drawn.map_or(&[], |drawn| &drawn.facts.used),
            used_by,
            probes: self.probes.as_ref(),
        };
        let room = vec2(ui.available_width(), (ui.available_height() - CONTROLS).max(160.0));
        self.map.ui(ui, room, &content, &mut self.robot, &mut self.things);
        egui::ScrollArea::vertical()
            .show(ui, |ui| {
                self.map.path_ui(ui, &mut self.robot);
                ui.separator();
                things_ui(ui, &mut self.things, Self::eye(&self.source, self.robot.pose()));
                ui.separator();
                self.map.layers_ui(ui, &content, &mut settings.layers);
                ui.separator();
                near_ui(ui, &self.source, self.around.as_ref());
                device_ui(ui, &mut settings.device, devices);
                compare_ui(ui, self.probes.as_ref())
            })
            .inner
    }

    /// Shows the robot's pose, with fields to edit it.
    fn pose_ui(&mut self, ui: &mut Ui) {
        let pose = self.robot.pose();
        let mut wanted = pose;
        ui.horizontal(|ui| {
            number(ui, "x", &mut wanted.x_m, Unit::Metre);
            number(ui, "y", &mut wanted.y_m, Unit::Metre);
            number(ui, "yaw", &mut wanted.yaw_rad, Unit::Degree);
        });
        ui.horizontal(|ui| {
            number(ui, "height", &mut wanted.height_m, Unit::Height);
            number(ui, "pitch", &mut wanted.pitch_rad, Unit::Degree);
            number(ui, "roll", &mut wanted.roll_rad, Unit::Degree);
        });
        ui.weak("Drag the arrow's tail to move, its tip to turn; or walk by W A S D and turn by Q E.");
        if wanted != pose {
            self.robot.take(CameraPose { yaw_rad: wrap_angle(wanted.yaw_rad), ..wanted });
        }
    }
}

/// Returns the difference between a recording's camera and the database's in words; `None` where there is none.
fn camera_difference(own: &Camera, other: &Camera) -> Option<String> {
    let sizes = [other, own].map(|camera| format!("{} x {} pixels", camera.width, camera.height));
    let [theirs, ours] = &sizes;
    match () {
        () if own == other => None,
        () if theirs != ours => Some(format!("its pictures have {theirs}, those of the database {ours}")),
        () if own.image_circle != other.image_circle => {
            Some("its pictures show another part of the lens's image than those of the database".to_owned())
        }
        () => Some("its pictures were taken through another lens than those of the database".to_owned()),
    }
}

/// Whether two fields have the same dimensions and colours, whatever their names.
fn is_same_field(own: &FieldDimensions, other: &FieldDimensions) -> bool {
    *own == FieldDimensions { name: own.name.clone(), ..other.clone() }
}

#[derive(Clone, Copy)]
enum Unit {
    Metre,
    Height,
    Degree,
}

/// Shows a number that can be dragged or typed.
fn number(ui: &mut Ui, name: &str, value: &mut f64, unit: Unit) {
    let label = ui.weak(name);
    let degrees = value.to_degrees();
    let mut shown = if matches!(unit, Unit::Degree) { degrees } else { *value };
    let drag = match unit {
        Unit::Metre => DragValue::new(&mut shown).speed(0.01).fixed_decimals(2).suffix(" m"),
        Unit::Height => {
            DragValue::new(&mut shown).speed(0.005).fixed_decimals(2).suffix(" m").range(0.05..=5.0)
        }
        Unit::Degree => DragValue::new(&mut shown).speed(0.5).fixed_decimals(1).suffix("°"),
    };
    if ui.add(drag).labelled_by(label.id).changed() {
        *value = if matches!(unit, Unit::Degree) { shown.to_radians() } else { shown };
    }
}

/// Shows the distance to the nearest recorded picture.
fn near_ui(ui: &mut Ui, source: &Source, around: Option<&Around>) {
    let pictures = counted(source.archive.images().len(), "picture");
    let nearest = around.and_then(|around| around.nearest);
    ui.label(match nearest {
        Some(nearest) => {
            let frame = source.archive.images()[nearest.image as usize].frame_index;
            format!(
                "{pictures} in the database. The nearest, frame {frame}, is {:.0} px away.",
                nearest.distance_px
            )
        }
        None => format!("{pictures} in the database."),
    })
    .on_hover_text("By so many pixels the picture moves from there to here (root mean square)");
}

/// Shows the true pictures' recording. Returns true when the user asks for another one.
fn compare_ui(ui: &mut Ui, probes: Option<&Probes>) -> bool {
    ui.horizontal_wrapped(|ui| {
        if let Some(probes) = probes {
            let pictures = counted(probes.poses().len(), "true picture");
            ui.label(format!("{pictures} to compare with, of “{}”.", probes.name()));
        }
        ui.button("Compare with a recording…")
            .on_hover_text("Take the pictures of another recording as the true ones")
            .clicked()
    })
    .inner
}
