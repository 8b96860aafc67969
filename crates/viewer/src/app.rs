//! Content of the window: the bars, the current panel, and what is being opened.

use std::{
    fmt,
    path::{Path, PathBuf},
};

use eframe::{
    CreationContext, Frame, Storage,
    egui::{self, Context, ThemePreference, Ui},
};
use reality_sim_sensor::Model;

use crate::{
    ViewerOptions,
    background::{Outcome, Task},
    device::Device,
    drive::DrivePanel,
    frame_times::FrameTimes,
    gap::GapPanel,
    open_window::{Chosen, OpenWindow, Purpose},
    opening::{Opened, open, whole},
    problems::Problems,
    screenshot::Screenshot,
    settings::Settings,
    shortcuts::{self, Action, Place},
    toolbar::{PanelKind, Toolbar},
    walk::{Beginning, WalkPanel},
};

/// Content of the window.
pub struct ViewerApp {
    settings: Settings,
    devices: Vec<Device>,
    model: Option<Model>,
    demonstration: Option<PathBuf>,
    /// Name of the graphics adapter that draws the window.
    adapter: String,
    frame_times: FrameTimes,
    opening: Option<Opening>,
    open_window: OpenWindow,
    screenshot: Screenshot,
    problems: Problems,
    notice: String,
    /// Path shown in Walk and Drive.
    shown_path: Option<PathBuf>,
    /// Path shown in Gap.
    report_path: Option<PathBuf>,
    help_is_open: bool,
    shown: PanelKind,
    walk: Option<WalkPanel>,
    drive: Option<DrivePanel>,
    gap: Option<GapPanel>,
}

/// Path that is being opened in the background.
struct Opening {
    purpose: Purpose,
    path: PathBuf,
    task: Task<Opened>,
}

impl fmt::Debug for ViewerApp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ViewerApp").field("demonstration", &self.demonstration).finish_non_exhaustive()
    }
}

impl ViewerApp {
    /// Makes the window's content, which first opens the path in the options.
    pub fn new(cc: &CreationContext<'_>, options: ViewerOptions) -> Self {
        let settings = Settings::load(cc.storage);
        cc.egui_ctx.set_theme(settings.theme);
        let mut app = Self {
            settings,
            devices: options.devices,
            model: options.model,
            demonstration: options.demonstration.map(|path| whole(&path)),
            adapter: adapter(cc),
            frame_times: FrameTimes::default(),
            opening: None,
            open_window: OpenWindow::default(),
            screenshot: Screenshot::default(),
            problems: Problems::default(),
            notice: String::new(),
            shown_path: None,
            report_path: None,
            help_is_open: false,
            shown: PanelKind::default(),
            walk: None,
            drive: None,
            gap: None,
        };
        app.open(&cc.egui_ctx, Purpose::Open, &options.open);
        app
    }

    /// Opens a path in the background.
    fn open(&mut self, ctx: &Context, purpose: Purpose, path: &Path) {
        let path = whole(path);
        let (title, wanted) = (format!("Opening {} …", path.display()), path.clone());
        let model = self.model.clone();
        let task = Task::spawn(ctx, title, move |_| open(&wanted, model.as_ref()));
        self.opening = Some(Opening { purpose, path, task });
    }

    fn take_opened(&mut self, ctx: &Context) {
        let Some(outcome) = self.opening.as_ref().and_then(|opening| opening.task.poll()) else { return };
        let Some(Opening { purpose, path, .. }) = self.opening.take() else { return };
        match (outcome, purpose) {
            (Outcome::Failed(reason), _) => self.problems.add(reason),
            (Outcome::Cancelled, _) => {}
            (Outcome::Done(opened), Purpose::Open) => self.show_opened(ctx, opened, &path),
            (Outcome::Done(Opened::Recording(sequence)), Purpose::Compare) => {
                if let Some(drive) = &mut self.drive
                    && let Err(reason) = drive.compare_with(&sequence)
                {
                    self.problems.add(reason);
                }
            }
            (Outcome::Done(opened), Purpose::Compare) => {
                let (path, what) = (path.display(), opened.name());
                self.problems
                    .add(format!("{path}: is {what}: to compare with, open the folder of a recording"));
            }
        }
    }

    fn show_opened(&mut self, ctx: &Context, opened: Opened, path: &Path) {
        // The demonstration has its own entry in the list, and greets who sees it for the first time.
        let beginning = if self.demonstration.as_deref() == Some(path) {
            Beginning::Gathering
        } else {
            self.settings.remember(path);
            Beginning::Waiting
        };
        let shown_path = Some(path.to_path_buf());
        match opened {
            Opened::Recording(sequence) => {
                self.leave_drive();
                self.drive = Some(DrivePanel::of_recording(sequence.clone(), self.model.clone()));
                let walk = WalkPanel::new(ctx, sequence, &self.devices, &self.settings.walk, beginning);
                self.walk = Some(walk);
                (self.shown_path, self.shown) = (shown_path, PanelKind::Walk);
            }
            Opened::Database(archive) => {
                self.leave_drive();
                // Walk shows a different recording, which is closed.
                self.walk = None;
                self.drive = Some(DrivePanel::of_database(archive, self.model.clone()));
                (self.shown_path, self.shown) = (shown_path, PanelKind::Drive);
            }
            Opened::Report(mut loaded) => {
                loaded.problems.drain(..).for_each(|problem| self.problems.add(problem));
                self.gap = Some(GapPanel::new(*loaded));
                (self.report_path, self.shown) = (shown_path, PanelKind::Gap);
            }
        }
    }

    fn leave_drive(&mut self) {
        if let Some(left) = self.drive.take() {
            // Dropping waits for its threads, so the window leaves that to another thread.
            std::thread::spawn(move || drop(left));
        }
    }

    fn act(&mut self, ctx: &Context, action: Action) {
        match action {
            Action::OpenPath => self.open_window.ask(Purpose::Open),
            Action::Walk if self.walk.is_some() => self.shown = PanelKind::Walk,
            Action::Drive if self.drive.is_some() => self.shown = PanelKind::Drive,
            Action::Gap if self.gap.is_some() => self.shown = PanelKind::Gap,
            Action::Theme => {
                self.settings.theme = match self.settings.theme {
                    ThemePreference::System => ThemePreference::Light,
                    ThemePreference::Light => ThemePreference::Dark,
                    ThemePreference::Dark => ThemePreference::System,
                };
                ctx.set_theme(self.settings.theme);
            }
            Action::Screenshot => self.screenshot.take(ctx),
            Action::Help => self.help_is_open = !self.help_is_open,
            Action::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            _ => {}
        }
    }

    fn take_dropped(&mut self, ctx: &Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        if let Some(file) = dropped.first() {
            self.open(ctx, Purpose::Open, file.path());
        }
        if dropped.len() > 1 {
            self.problems.add(
                "only the first of the things dropped is opened: drop one recording, database or report at a time",
            );
        }
    }

    fn take_screenshot(&mut self) {
        match self.screenshot.poll() {
            Some(Ok(path)) => self.notice = format!("saved {}", path.display()),
            Some(Err(reason)) => self.problems.add(reason),
            None => {}
        }
    }

    fn bars(&mut self, ui: &mut Ui) {
        let has = [
            (PanelKind::Walk, self.walk.is_some()),
            (PanelKind::Drive, self.drive.is_some()),
            (PanelKind::Gap, self.gap.is_some()),
        ];
        let panels: Vec<PanelKind> =
            has.into_iter().filter(|(_, has)| *has).map(|(panel, _)| panel).collect();
        let open = if self.shown == PanelKind::Gap { &self.report_path } else { &self.shown_path };
        let open = open.as_deref();
        let toolbar = Toolbar { panels: &panels, shown: self.shown, open, theme: self.settings.theme };
        if let Some(action) = toolbar.ui(ui) {
            self.act(ui.ctx(), action);
        }
        self.problems.ui(ui);
        egui::Panel::bottom("status").show(ui, |ui| {
            ui.horizontal(|ui| {
                if let Some(opening) = &self.opening {
                    opening.task.ui(ui);
                    // Opening leaves nothing half done, so the window need not wait for a cancelled one to end.
                    if opening.task.is_cancelled() {
                        self.opening = None;
                    }
                }
                ui.label(&self.notice);
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    if let Some(milliseconds) = self.frame_times.last() {
                        ui.weak(format!("frame {milliseconds:.1} ms")).on_hover_ui(|ui| {
                            ui.label(self.frame_times.summary());
                        });
                        ui.separator();
                    }
                    ui.add(egui::Label::new(egui::RichText::new(&self.adapter).weak()).truncate());
                });
            });
        });
    }

    fn panel(&mut self, ui: &mut Ui) {
        let Self { settings, devices, problems, .. } = self;
        match (self.shown, &mut self.walk, &mut self.drive, &mut self.gap) {
            (PanelKind::Walk, Some(walk), ..) => walk.ui(ui, &mut settings.walk, devices, problems),
            (PanelKind::Drive, _, Some(drive), _) => {
                if drive.ui(ui, &mut settings.drive, devices, problems) {
                    self.open_window.ask(Purpose::Compare);
                }
            }
            (PanelKind::Gap, .., Some(gap)) => gap.ui(ui, &mut settings.gap),
            _ => {
                egui::CentralPanel::default().show(ui, |ui| {
                    ui.centered_and_justified(|ui| {
                        if self.opening.is_some() {
                            ui.spinner();
                        } else {
                            ui.label("Nothing is open. Press Open…, or drop a recording's folder, a database or a report's folder here.");
                        }
                    });
                });
            }
        }
    }
}

impl eframe::App for ViewerApp {
    fn ui(&mut self, ui: &mut Ui, frame: &mut Frame) {
        let ctx = ui.ctx().clone();
        self.take_opened(&ctx);
        self.take_dropped(&ctx);
        self.take_screenshot();
        frame.info().cpu_usage.into_iter().for_each(|seconds| self.frame_times.add(1000.0 * seconds));
        for action in shortcuts::pressed(ui, Place::Everywhere) {
            self.act(&ctx, action);
        }
        self.bars(ui);
        self.panel(ui);
        shortcuts::window(ui, &mut self.help_is_open);
        let chosen = self.open_window.ui(ui, &self.settings.recent, self.demonstration.as_deref());
        if let Some(Chosen { purpose, path }) = chosen {
            self.open(&ctx, purpose, &path);
        }
        drop_hint(&ctx);
    }

    fn save(&mut self, storage: &mut dyn Storage) {
        self.settings.store(storage);
    }
}

/// Shows that a dragged file can be dropped on the window.
fn drop_hint(ctx: &Context) {
    if ctx.input(|input| input.raw.hovered_files.is_empty()) {
        return;
    }
    let layer = egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop"));
    let (painter, rect) = (ctx.layer_painter(layer), ctx.content_rect());
    painter.rect_filled(rect, 0.0, egui::Color32::from_black_alpha(170));
    let font = egui::FontId::proportional(22.0);
    let text = "Drop a recording's folder, a database or a report's folder to open it";
    painter.text(rect.center(), egui::Align2::CENTER_CENTER, text, font, egui::Color32::WHITE);
}

/// Returns the name of the graphics adapter that draws the window.
fn adapter(cc: &CreationContext<'_>) -> String {
    let Some(state) = &cc.wgpu_render_state else { return String::new() };
    let info = state.adapter.get_info();
    match info.device_type {
        wgpu::DeviceType::Cpu => format!("no graphics card: the processor draws this window ({})", info.name),
        _ => format!("drawn by {}", info.name),
    }
}

#[cfg(test)]
mod tests {
    use std::{
        sync::mpsc,
        time::{Duration, Instant},
    };

    use egui_kittest::{Harness, kittest::Queryable};

    use super::*;

    /// Returns a window that is opening something, and the sender whose message ends the opening.
    fn with_endless_opening() -> (Harness<'static, ViewerApp>, mpsc::Sender<()>) {
        let options = ViewerOptions {
            open: "/no/such/walk".into(),
            demonstration: None,
            model: None,
            devices: Vec::new(),
        };
        let mut harness =
            Harness::builder().with_size([1280.0, 820.0]).build_eframe(|cc| ViewerApp::new(cc, options));
        let (go, wait) = mpsc::channel();
        let task = Task::spawn(&harness.ctx, "Opening it …", move |_| {
            wait.recv().map_err(|error| error.to_string())?;
            open(Path::new("/no/such/walk/either"), None)
        });
        harness.state_mut().opening = Some(Opening { purpose: Purpose::Open, path: PathBuf::new(), task });
        harness.run_steps(2);
        harness.get_by_label("Opening it …");
        (harness, go)
    }

    fn until(harness: &mut Harness<'_, ViewerApp>, holds: impl Fn(&Harness<'_, ViewerApp>) -> bool) {
        let started = Instant::now();
        while !holds(harness) {
            assert!(started.elapsed() < Duration::from_secs(60), "it never happens: {:?}", harness.root());
            harness.step();
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    #[test]
    fn a_slow_opening_can_be_cancelled_without_waiting_for_it() {
        let (mut harness, go) = with_endless_opening();
        harness.get_by_label("Cancel").click();
        harness.run_steps(2);
        assert!(harness.query_by_label("Opening it …").is_none());
        assert!(harness.query_by_label("Cancel").is_none());
        go.send(()).unwrap();
        harness.run();
        assert!(harness.query_by_label_contains("either").is_none(), "what was cancelled is no problem");
    }

    #[test]
    fn a_second_opening_replaces_the_one_under_way() {
        let (mut harness, go) = with_endless_opening();
        let walk = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/walk");
        let ctx = harness.ctx.clone();
        harness.state_mut().open(&ctx, Purpose::Open, &walk);
        until(&mut harness, |harness| harness.query_by_label("Drive").is_some());
        go.send(()).unwrap();
        harness.run_steps(3);
        assert!(harness.query_by_label("Opening it …").is_none());
        assert!(harness.query_by_label_contains("either").is_none());
    }

    #[test]
    fn only_a_recording_can_be_compared_with() {
        let (mut harness, _go) = with_endless_opening();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("walk.db");
        drop(reality_sim_db::Database::create_or_open(&path).unwrap());
        let ctx = harness.ctx.clone();
        harness.state_mut().open(&ctx, Purpose::Compare, &path);
        until(&mut harness, |harness| harness.query_by_label_contains("walk.db: ").is_some());
        assert!(harness.state().drive.is_none());
    }
}
