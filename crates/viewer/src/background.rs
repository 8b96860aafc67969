//! Work that takes longer than a frame: in a thread of its own, with progress and a way to stop it.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
        mpsc,
    },
    thread,
};

use eframe::egui;

/// What a piece of work tells the window while it goes on, and what the window tells it.
pub struct Progress {
    done: AtomicUsize,
    total: AtomicUsize,
    is_cancelled: AtomicBool,
    ctx: egui::Context,
}

impl Progress {
    /// So many of so many steps are done.
    pub fn set(&self, done: usize, total: usize) {
        self.done.store(done, Ordering::Relaxed);
        self.total.store(total, Ordering::Relaxed);
        self.ctx.request_repaint();
    }

    /// Whether the work should stop as soon as it can.
    pub fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }

    /// The share that is done; `None` while that is not known.
    fn share(&self) -> Option<f32> {
        let total = self.total.load(Ordering::Relaxed);
        (total > 0).then(|| self.done.load(Ordering::Relaxed) as f32 / total as f32)
    }
}

/// How a piece of work ended.
pub enum Outcome<T> {
    Done(T),
    /// Why not, in words.
    Failed(String),
    Cancelled,
}

/// A piece of work under way. Dropping it asks it to stop.
pub struct Task<T> {
    /// What is being done, for the window.
    pub title: String,
    progress: Arc<Progress>,
    result: mpsc::Receiver<Result<T, String>>,
}

impl<T: Send + 'static> Task<T> {
    /// Starts the work.
    pub fn spawn(
        ctx: &egui::Context,
        title: impl Into<String>,
        work: impl FnOnce(&Progress) -> Result<T, String> + Send + 'static,
    ) -> Self {
        let progress = Arc::new(Progress {
            done: AtomicUsize::new(0),
            total: AtomicUsize::new(0),
            is_cancelled: AtomicBool::new(false),
            ctx: ctx.clone(),
        });
        let (sender, result) = mpsc::channel();
        let (its_progress, ctx) = (progress.clone(), ctx.clone());
        thread::spawn(move || {
            // Nobody listens any more once the task was dropped.
            let _ = sender.send(work(&its_progress));
            // The sender goes first: should the work panic, the window finds the channel closed.
            drop(sender);
            ctx.request_repaint();
        });
        Self { title: title.into(), progress, result }
    }

    /// The end of it, once.
    pub fn poll(&self) -> Option<Outcome<T>> {
        let outcome = match self.result.try_recv() {
            Ok(_) if self.progress.is_cancelled() => Outcome::Cancelled,
            Ok(Ok(value)) => Outcome::Done(value),
            Ok(Err(reason)) => Outcome::Failed(reason),
            Err(mpsc::TryRecvError::Empty) => return None,
            Err(mpsc::TryRecvError::Disconnected) => Outcome::Failed(format!(
                "{}: stopped by a fault of this program: please report it",
                self.title
            )),
        };
        Some(outcome)
    }

    /// What is being done, how much of it is, and a button that stops it.
    pub fn ui(&self, ui: &mut egui::Ui) {
        ui.horizontal(|ui| {
            ui.label(&self.title);
            match self.progress.share() {
                Some(share) => {
                    ui.add(egui::ProgressBar::new(share).desired_width(160.0).show_percentage());
                }
                None => {
                    ui.spinner();
                }
            }
            if self.progress.is_cancelled() {
                ui.weak("stopping …");
            } else if ui.button("Cancel").clicked() {
                self.progress.is_cancelled.store(true, Ordering::Relaxed);
            }
        });
    }
}

impl<T> Drop for Task<T> {
    fn drop(&mut self) {
        self.progress.is_cancelled.store(true, Ordering::Relaxed);
    }
}
