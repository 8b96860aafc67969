//! Window for choosing what to open: a path to type, the system's file dialogs, and recent paths.

use std::path::{Path, PathBuf};

use eframe::egui::{self, Key, Ui};

use crate::background::{Outcome, Task};

/// Purpose of the chosen path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Purpose {
    /// Opening it in a panel.
    #[default]
    Open,
    /// Using its pictures as the truth that Drive compares with.
    Compare,
}

/// State of the window.
#[derive(Default)]
pub struct OpenWindow {
    is_open: bool,
    /// Whether the window was opened in this frame, so that the path's field takes the focus.
    wants_focus: bool,
    purpose: Purpose,
    path: String,
    /// System dialog, and the purpose of its answer.
    dialog: Option<(Purpose, Task<Option<PathBuf>>)>,
    /// Whether the last dialog gave no path: it was cancelled or never appeared, which cannot be told apart.
    dialog_gave_nothing: bool,
}

/// Chosen path with its purpose.
pub struct Chosen {
    pub purpose: Purpose,
    pub path: PathBuf,
}

impl OpenWindow {
    /// Opens the window to ask for a path.
    pub fn ask(&mut self, purpose: Purpose) {
        (self.is_open, self.wants_focus, self.purpose) = (true, true, purpose);
    }

    /// Shows the window while it is open; returns the chosen path.
    pub fn ui(&mut self, ui: &Ui, recent: &[PathBuf], demonstration: Option<&Path>) -> Option<Chosen> {
        // The answer counts even if this window has been closed meanwhile.
        if let Some(chosen) = self.take_from_dialog() {
            self.is_open = false;
            return Some(chosen);
        }
        if !self.is_open {
            return None;
        }
        let mut is_open = true;
        let title = match self.purpose {
            Purpose::Open => "Open a recording, a database or a report",
            Purpose::Compare => "Compare with the pictures of a recording",
        };
        let window = egui::Window::new(title).open(&mut is_open).collapsible(false).default_width(520.0);
        let shown = window.show(ui.ctx(), |ui| self.content(ui, recent, demonstration));
        self.is_open = is_open && !ui.input(|input| input.key_pressed(Key::Escape));
        let path = shown?.inner.flatten()?;
        self.is_open = false;
        Some(Chosen { purpose: self.purpose, path })
    }

    fn content(&mut self, ui: &mut Ui, recent: &[PathBuf], demonstration: Option<&Path>) -> Option<PathBuf> {
        ui.label(match self.purpose {
            Purpose::Open => "A recording is a folder with sequence.toml; a database is a file that `reality-sim build` made; a report is a folder that `reality-sim gap` wrote. Each can be dropped onto the window, too.",
            Purpose::Compare => "A recording is a folder with sequence.toml, here one with ground truth.",
        });
        let mut chosen = None;
        ui.horizontal(|ui| {
            let text = egui::TextEdit::singleline(&mut self.path).hint_text("path").desired_width(360.0);
            let typed = ui.add(text);
            if std::mem::take(&mut self.wants_focus) {
                typed.request_focus();
            }
            let is_entered = typed.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            let is_clicked =
                ui.add_enabled(!self.path.trim().is_empty(), egui::Button::new("Open")).clicked();
            if (is_entered || is_clicked) && !self.path.trim().is_empty() {
                chosen = Some(PathBuf::from(self.path.trim()));
            }
        });
        ui.horizontal(|ui| {
            if self.dialog.is_some() {
                ui.disable();
            }
            if ui.button("Choose a folder…").clicked() {
                self.dialog = Some((self.purpose, dialog(ui.ctx(), Kind::Folder)));
            }
            if self.purpose == Purpose::Open && ui.button("Choose a database…").clicked() {
                self.dialog = Some((self.purpose, dialog(ui.ctx(), Kind::File)));
            }
        });
        if self.dialog_gave_nothing {
            ui.weak("Should no dialog come up: type the path, or drop the folder or file onto the window.");
        }
        if self.purpose == Purpose::Open {
            if let Some(path) = demonstration {
                ui.separator();
                if ui.link("The demonstration walk").clicked() {
                    chosen = Some(path.to_path_buf());
                }
            }
            for path in recent {
                if ui.link(path.display().to_string()).clicked() {
                    chosen = Some(path.clone());
                }
            }
        }
        chosen
    }

    fn take_from_dialog(&mut self) -> Option<Chosen> {
        let (_, task) = self.dialog.as_ref()?;
        let outcome = task.poll()?;
        let (purpose, _) = self.dialog.take()?;
        let path = match outcome {
            Outcome::Done(path) => path,
            Outcome::Failed(_) | Outcome::Cancelled => None,
        };
        self.dialog_gave_nothing = path.is_none();
        path.map(|path| Chosen { purpose, path })
    }
}

#[derive(Clone, Copy)]
enum Kind {
    Folder,
    File,
}

/// Opens a system dialog: created here, since some systems require the window's thread, and awaited in another thread.
fn dialog(ctx: &egui::Context, kind: Kind) -> Task<Option<PathBuf>> {
    let dialog = rfd::AsyncFileDialog::new().set_title("Open in Reality Sim");
    let path = |file: Option<rfd::FileHandle>| file.map(|file| file.path().to_path_buf());
    match kind {
        Kind::Folder => {
            let answer = dialog.pick_folder();
            Task::spawn(ctx, "", move |_| Ok(path(pollster::block_on(answer))))
        }
        Kind::File => {
            let answer = dialog.pick_file();
            Task::spawn(ctx, "", move |_| Ok(path(pollster::block_on(answer))))
        }
    }
}

#[cfg(test)]
mod tests {
    use egui_kittest::{Harness, kittest::Queryable};

    use super::*;

    /// Returns an open window whose dialog answers.
    fn after_dialog(answer: Option<PathBuf>) -> Harness<'static, (OpenWindow, Option<PathBuf>)> {
        let mut window = OpenWindow::default();
        window.ask(Purpose::Open);
        let task = Task::spawn(&egui::Context::default(), "", |_| Ok(answer));
        window.dialog = Some((Purpose::Open, task));
        let show = |ui: &mut Ui, (window, chosen): &mut (OpenWindow, Option<PathBuf>)| {
            if let Some(Chosen { path, .. }) = window.ui(ui, &[], None) {
                *chosen = Some(path);
            }
        };
        let mut harness = Harness::builder().build_ui_state(show, (window, None));
        let started = std::time::Instant::now();
        while harness.state().0.dialog.is_some() {
            assert!(started.elapsed().as_secs() < 60, "the dialog does not end");
            harness.step();
        }
        harness.run();
        harness
    }

    #[test]
    fn what_a_dialog_gives_is_opened_and_the_window_closes() {
        let harness = after_dialog(Some("/walk".into()));
        assert_eq!(harness.state().1.as_deref(), Some(Path::new("/walk")));
        assert!(harness.query_by_label("Choose a folder…").is_none());
    }

    #[test]
    fn where_no_dialog_comes_up_there_is_a_word_of_what_else_can_be_done() {
        let harness = after_dialog(None);
        assert_eq!(harness.state().1, None);
        harness.get_by_label("Choose a folder…");
        harness.get_by_label_contains("Should no dialog come up: type the path");
    }
}
