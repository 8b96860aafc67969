//! The drawing thread. It receives requests, of which only the newest counts, and answers with the data around the pose and
//! one picture after another.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{Arc, mpsc},
    thread,
    time::Instant,
};

use eframe::egui::Context;

use super::{
    answer::{Answer, Painted},
    kind::Pane,
    rate::FrameRate,
    source::Source,
    studio::Studio,
    wish::Wish,
};
use crate::background::Joined;

/// Handle of the drawing thread. Dropping it waits until the thread has ended, at most as long as drawing a picture or
/// opening a device takes.
pub struct Painter {
    /// Declared before the thread, which ends when this sender is dropped.
    wishes: mpsc::Sender<Wish>,
    answers: mpsc::Receiver<Answer>,
    wished: Option<Wish>,
    has_failed: bool,
    _thread: Joined,
}

impl Painter {
    /// Starts the thread, which opens the devices: that may take a while.
    pub fn spawn(ctx: &Context, source: Arc<Source>) -> Self {
        let (wishes, its_wishes) = mpsc::channel();
        let (its_answers, answers) = mpsc::channel();
        let ctx = ctx.clone();
        let thread = thread::spawn(move || {
            let say = |answer| {
                let is_heard = its_answers.send(answer).is_ok();
                ctx.request_repaint();
                is_heard
            };
            let mut studio = Studio::new(&source);
            let mut wishes = Wishes { coming: its_wishes, newest: None };
            let mut turns = Turns::default();
            while let Some(wish) = wishes.next() {
                if let Some(problem) = studio.prepare(&wish) {
                    say(Answer::Problem(problem));
                }
                if !fulfil(&mut studio, &wish, &mut turns, &mut wishes, &say) {
                    break;
                }
            }
        });
        Self { wishes, answers, wished: None, has_failed: false, _thread: Joined::new(thread) }
    }

    /// Requests pictures, unless they have been requested already.
    pub fn wish(&mut self, wish: Wish) {
        if self.wished.as_ref() != Some(&wish) {
            // A thread that has ended is reported through its answers.
            let _ = self.wishes.send(wish.clone());
            self.wished = Some(wish);
        }
    }

    /// Returns the next answer, if there is one.
    pub fn answer(&mut self) -> Option<Answer> {
        match self.answers.try_recv() {
            Ok(answer) => Some(answer),
            Err(mpsc::TryRecvError::Disconnected) if !self.has_failed => {
                self.has_failed = true;
                Some(Answer::Problem(
                    "Drawing was stopped by a fault of this program: open the file again, and please report it"
                        .to_owned(),
                ))
            }
            Err(_) => None,
        }
    }
}

/// Requests on their way to the thread, of which only the newest counts.
struct Wishes {
    coming: mpsc::Receiver<Wish>,
    newest: Option<Wish>,
}

impl Wishes {
    /// Returns the newest request, waiting for one if there is none; `None` when the sender is gone.
    fn next(&mut self) -> Option<Wish> {
        let wish = self.newest.take().or_else(|| self.coming.recv().ok())?;
        Some(self.coming.try_iter().last().unwrap_or(wish))
    }

    /// Whether a newer request has replaced the last one.
    fn have_changed(&mut self) -> bool {
        match self.coming.try_recv() {
            Ok(wish) => {
                self.newest = Some(wish);
                true
            }
            Err(error) => self.newest.is_some() || error == mpsc::TryRecvError::Disconnected,
        }
    }
}

/// Order of drawing: the pane painted the longest ago comes first, so that each has its turn while requests change faster than
/// all panes can be drawn.
#[derive(Default)]
struct Turns {
    count: u64,
    /// Number of each pane's last turn.
    last: BTreeMap<Pane, u64>,
    /// Last request, and the panes already drawn for it.
    wish: Option<Wish>,
    drawn: BTreeSet<Pane>,
    /// Frames a second of each pane.
    rates: BTreeMap<Pane, FrameRate>,
}

impl Turns {
    /// Begins a request, keeping the panes drawn for the previous one if they are equally valid.
    fn begin(&mut self, wish: &Wish) {
        let before = self.wish.replace(wish.clone());
        if !before.is_some_and(|before| before.has_pictures_of(wish)) {
            self.drawn.clear();
        }
    }

    /// Returns the next pane to draw; `None` when all are drawn.
    fn next(&mut self, wish: &Wish) -> Option<Pane> {
        let left = wish.panes.iter().filter(|pane| !self.drawn.contains(pane));
        let pane = *left.min_by_key(|pane| self.last.get(pane).copied())?;
        self.count += 1;
        self.last.insert(pane, self.count);
        self.drawn.insert(pane);
        Some(pane)
    }

    /// Notes that a pane's picture was finished at a time, and returns its frames a second.
    fn finish(&mut self, pane: Pane, finished: Instant) -> Option<f64> {
        let rate = self.rates.entry(pane).or_default();
        rate.add(finished);
        rate.per_s()
    }
}

/// Draws the requested panes until the request changes, at least one picture. Returns false when the receiver is gone.
fn fulfil(
    studio: &mut Studio,
    wish: &Wish,
    turns: &mut Turns,
    wishes: &mut Wishes,
    say: &impl Fn(Answer) -> bool,
) -> bool {
    let around = studio.around(wish);
    let probe = around.probe;
    if !say(Answer::Around(around)) {
        return false;
    }
    turns.begin(wish);
    while let Some(pane) = turns.next(wish) {
        let mut result = studio.paint(pane, wish, probe);
        if let Ok(drawn) = &mut result {
            drawn.facts.frames_per_s = turns.finish(pane, Instant::now());
        }
        let painted = Painted { pose: wish.pose, things: wish.things.clone(), result };
        if !say(Answer::Painted(pane, painted)) {
            return false;
        }
        if wishes.have_changed() {
            break;
        }
    }
    true
}
