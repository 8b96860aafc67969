//! Tasks that take longer than a frame: each runs in its own thread, reports its progress and can be cancelled.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
        mpsc,
    },
    thread,
};

use eframe::egui;

/// State shared between a task and the window: the task's progress and the window's request to stop.
pub struct Progress {
    done: AtomicUsize,
    total: AtomicUsize,
    /// Current phase of the task, if it has phases.
    phase: Mutex<Option<&'static str>>,
    is_cancelled: AtomicBool,
    ctx: egui::Context,
}

impl Progress {
    /// Begins another phase, which is shown in place of the title. Its duration is unknown at first.
    pub fn begin(&self, phase: &'static str) {
        *self.phase.lock().unwrap_or_else(PoisonError::into_inner) = Some(phase);
        self.set(0, 0);
    }

    /// Sets the number of steps done and their total.
    pub fn set(&self, done: usize, total: usize) {
        self.done.store(done, Ordering::Relaxed);
        self.total.store(total, Ordering::Relaxed);
        self.ctx.request_repaint();
    }

    /// Whether the task should stop as soon as it can.
    pub fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }

    fn phase(&self) -> Option<&'static str> {
        *self.phase.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the fraction done; `None` while it is unknown.
    fn share(&self) -> Option<f32> {
        let total = self.total.load(Ordering::Relaxed);
        (total > 0).then(|| self.done.load(Ordering::Relaxed) as f32 / total as f32)
    }
}

/// Result of a task.
pub enum Outcome<T> {
    Done(T),
    /// Reason of the failure, in words.
    Failed(String),
    Cancelled,
}

/// Task running in the background. Dropping it asks it to stop.
pub struct Task<T> {
    /// Description of the task, for the window.
    pub title: String,
    progress: Arc<Progress>,
    result: mpsc::Receiver<Result<T, String>>,
    thread: Option<thread::JoinHandle<()>>,
}

impl<T: Send + 'static> Task<T> {
    /// Starts a task.
    pub fn spawn(
        ctx: &egui::Context,
        title: impl Into<String>,
        work: impl FnOnce(&Progress) -> Result<T, String> + Send + 'static,
    ) -> Self {
        let progress = Arc::new(Progress {
            done: AtomicUsize::new(0),
            total: AtomicUsize::new(0),
            phase: Mutex::new(None),
            is_cancelled: AtomicBool::new(false),
            ctx: ctx.clone(),
        });
        let (sender, result) = mpsc::channel();
        let (its_progress, ctx) = (progress.clone(), ctx.clone());
        let thread = thread::spawn(move || {
            // Locals are dropped in reverse order, after a panic too: when the window wakes up, the channel is closed.
            let _wake = Wake(ctx);
            let sender = sender;
            // The receiver is gone once the task has been dropped.
            let _ = sender.send(work(&its_progress));
        });
        Self { title: title.into(), progress, result, thread: Some(thread) }
    }

    /// Returns the task's outcome, once.
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

    /// Whether the task was asked to stop.
    pub fn is_cancelled(&self) -> bool {
        self.progress.is_cancelled()
    }

    /// Asks the task to stop, and waits until it has stopped.
    pub fn finish(mut self) {
        self.progress.is_cancelled.store(true, Ordering::Relaxed);
        // `poll` reports a panic, and it is no longer called here.
        self.thread.take().map(thread::JoinHandle::join);
    }

    /// Shows a button that cancels the task, the description, and the progress.
    pub fn ui(&self, ui: &mut egui::Ui) {
        ui.horizontal(|ui| {
            // First, so that it does not move from under the mouse where another phase has another width.
            if self.progress.is_cancelled() {
                ui.weak("stopping …");
            } else if ui.button("Cancel").clicked() {
                self.progress.is_cancelled.store(true, Ordering::Relaxed);
            }
            ui.label(self.progress.phase().unwrap_or(&self.title));
            match self.progress.share() {
                Some(share) => {
                    ui.add(egui::ProgressBar::new(share).desired_width(160.0).show_percentage());
                }
                None => {
                    ui.spinner();
                }
            }
        });
    }
}

impl<T> Drop for Task<T> {
    fn drop(&mut self) {
        self.progress.is_cancelled.store(true, Ordering::Relaxed);
    }
}

/// Thread that is joined when this is dropped.
pub struct Joined(Option<thread::JoinHandle<()>>);

impl Joined {
    /// Joins this thread when dropped.
    pub fn new(thread: thread::JoinHandle<()>) -> Self {
        Self(Some(thread))
    }
}

impl Drop for Joined {
    fn drop(&mut self) {
        // A panic shows in the messages that are no longer sent.
        self.0.take().map(thread::JoinHandle::join);
    }
}

/// Requests a repaint when it is dropped.
struct Wake(egui::Context);

impl Drop for Wake {
    fn drop(&mut self) {
        self.0.request_repaint();
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    /// Waits until a task ends.
    fn end_of<T: Send + 'static>(task: &Task<T>) -> Outcome<T> {
        let started = Instant::now();
        loop {
            if let Some(outcome) = task.poll() {
                return outcome;
            }
            assert!(started.elapsed() < Duration::from_secs(60), "{} does not end", task.title);
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// Returns a context that counts its repaint requests.
    fn counting_context() -> (egui::Context, Arc<AtomicUsize>) {
        let (ctx, repaints) = (egui::Context::default(), Arc::new(AtomicUsize::new(0)));
        let count = repaints.clone();
        ctx.set_request_repaint_callback(move |_| {
            count.fetch_add(1, Ordering::SeqCst);
        });
        (ctx, repaints)
    }

    #[test]
    fn the_result_of_the_work_arrives_once_and_wakes_the_window() {
        let (ctx, repaints) = counting_context();
        let task = Task::spawn(&ctx, "adding", |_| Ok(2 + 3));
        assert!(matches!(end_of(&task), Outcome::Done(5)));
        wait_until(|| repaints.load(Ordering::SeqCst) > 0);
    }

    #[test]
    fn the_reason_of_a_failure_arrives_as_it_was_given() {
        let task = Task::<()>::spawn(&egui::Context::default(), "", |_| Err("no such file".to_owned()));
        assert!(matches!(end_of(&task), Outcome::Failed(reason) if reason == "no such file"));
    }

    #[test]
    fn work_that_panics_fails_and_wakes_the_window() {
        let (ctx, repaints) = counting_context();
        let task = Task::<()>::spawn(&ctx, "Counting sheep", |_| panic!("meant to: part of a test"));
        wait_until(|| repaints.load(Ordering::SeqCst) > 0);
        let Some(Outcome::Failed(reason)) = task.poll() else { panic!("no failure when the window woke up") };
        assert!(reason.contains("Counting sheep") && reason.contains("report"), "{reason}");
    }

    #[test]
    fn dropping_a_task_asks_its_work_to_stop() {
        let (sender, stopped) = mpsc::channel();
        let task = Task::spawn(&egui::Context::default(), "", move |progress| {
            while !progress.is_cancelled() {
                thread::sleep(Duration::from_millis(1));
            }
            sender.send(()).map_err(|error| error.to_string())
        });
        assert!(task.poll().is_none(), "it ended by itself");
        drop(task);
        stopped.recv_timeout(Duration::from_secs(60)).unwrap();
    }

    #[test]
    fn finishing_a_task_waits_until_all_that_it_held_is_dropped() {
        let (held, progress_seen) = (Arc::new(()), Arc::new(AtomicBool::new(false)));
        let (its, seen) = (held.clone(), progress_seen.clone());
        let task = Task::spawn(&egui::Context::default(), "", move |progress| {
            while !progress.is_cancelled() {
                thread::sleep(Duration::from_millis(1));
            }
            seen.store(true, Ordering::SeqCst);
            Ok(its)
        });
        task.finish();
        assert!(progress_seen.load(Ordering::SeqCst));
        assert_eq!(Arc::strong_count(&held), 1, "the result is not kept either");
    }

    #[test]
    fn a_part_that_begins_is_shown_in_place_of_the_title() {
        let (told, wait) = (mpsc::channel::<()>(), mpsc::channel::<()>());
        let task = Task::spawn(&egui::Context::default(), "Cooking", move |progress| {
            progress.set(3, 4);
            progress.begin("Washing up");
            told.0.send(()).map_err(|error| error.to_string())?;
            wait.1.recv().map_err(|error| error.to_string())
        });
        told.1.recv_timeout(Duration::from_secs(60)).unwrap();
        assert_eq!((task.progress.phase(), task.progress.share()), (Some("Washing up"), None));
        wait.0.send(()).unwrap();
    }

    #[test]
    fn a_result_after_cancelling_is_not_delivered() {
        let (go, wait) = mpsc::channel::<()>();
        let task = Task::spawn(&egui::Context::default(), "", move |_| Ok(wait.recv().is_ok()));
        task.progress.is_cancelled.store(true, Ordering::Relaxed);
        go.send(()).unwrap();
        assert!(matches!(end_of(&task), Outcome::Cancelled));
    }

    #[test]
    fn the_share_is_unknown_until_the_work_tells_its_steps() {
        let (tell, told) = mpsc::channel::<()>();
        let (go, wait) = mpsc::channel::<()>();
        let task = Task::spawn(&egui::Context::default(), "", move |progress| {
            wait.recv().map_err(|error| error.to_string())?;
            progress.set(1, 4);
            tell.send(()).map_err(|error| error.to_string())
        });
        assert_eq!(task.progress.share(), None);
        go.send(()).unwrap();
        told.recv_timeout(Duration::from_secs(60)).unwrap();
        assert_eq!(task.progress.share(), Some(0.25));
    }

    fn wait_until(holds: impl Fn() -> bool) {
        let started = Instant::now();
        while !holds() {
            assert!(started.elapsed() < Duration::from_secs(60), "it never happens");
            thread::sleep(Duration::from_millis(1));
        }
    }
}
