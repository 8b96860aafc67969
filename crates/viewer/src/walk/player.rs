//! The filter at work: a thread that plays a recording, does what it is told, and sends what is to be seen.
//!
//! It owns the filter. The window sends commands and never waits; frames come back through a short queue, so that a window
//! that does not draw stops the player and not the other way round.

use std::{
    sync::{Arc, mpsc},
    thread,
    time::{Duration, Instant},
};

use eframe::egui::Context;
use reality_sim_core::{
    backend::{Backend, BackendError, CpuBackend},
    observation::CpuScorer,
    pose::Pose2,
    preprocess::Preprocessor,
    sequence::Sequence,
    tag::{Tagger, recorded},
};

use super::{
    frame::{FrameView, Seen},
    settings::{FilterSettings, Speed, Veil},
};
use crate::device::{Device, by_name};

/// Frames on their way to the window at most.
const QUEUE: usize = 2;
/// Pauses in a recording longer than this are played as this long, seconds.
const LONGEST_PAUSE_S: f64 = 2.0;

/// What the window wants.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    Play,
    Pause,
    /// Shows a frame, by its number.
    GoTo(usize),
    /// Begins again at the first frame, as if nothing had been seen.
    Restart,
    Filter(FilterSettings),
    Speed(Speed),
    Veil(Veil),
    /// Moves all particles to a place.
    Place(Pose2),
}

/// What the window is told.
pub enum Message {
    /// It begins again: what was found before counts no longer.
    Begun,
    Frame(Box<FrameView>),
    /// The player stands still, or plays.
    Playing(bool),
    /// In words. It stands still.
    Problem(String),
}

/// The window's end.
pub struct Player {
    commands: mpsc::Sender<Command>,
    messages: mpsc::Receiver<Message>,
    is_gone: bool,
}

impl Player {
    /// Starts the thread; it shows the first frame and waits. It ends when this is dropped.
    pub fn spawn(
        ctx: &Context,
        sequence: Arc<Sequence>,
        devices: Vec<Device>,
        filter: FilterSettings,
        speed: Speed,
        veil: Veil,
    ) -> Self {
        let (commands, received) = mpsc::channel();
        let (sender, messages) = mpsc::sync_channel(QUEUE);
        let outbox = Outbox { sender, ctx: ctx.clone() };
        thread::spawn(move || Playing::new(sequence, devices, filter, speed, veil, outbox).run(&received));
        Self { commands, messages, is_gone: false }
    }

    /// Tells it what to do next.
    pub fn tell(&self, command: Command) {
        // It is gone only after a fault, which the end of the messages tells.
        let _ = self.commands.send(command);
    }

    /// The next message, if there is one.
    pub fn poll(&mut self) -> Option<Message> {
        match self.messages.try_recv() {
            Ok(message) => Some(message),
            Err(mpsc::TryRecvError::Disconnected) if !self.is_gone => {
                self.is_gone = true;
                let reason = "the filter was stopped by a fault of this program: please report it, and open the recording again";
                Some(Message::Problem(reason.to_owned()))
            }
            Err(_) => None,
        }
    }
}

struct Outbox {
    sender: mpsc::SyncSender<Message>,
    ctx: Context,
}

/// The window was closed.
struct Closed;

impl Outbox {
    fn send(&self, message: Message) -> Result<(), Closed> {
        self.sender.send(message).map_err(|_| Closed)?;
        self.ctx.request_repaint();
        Ok(())
    }
}

/// What is to be done after the commands were heard.
#[derive(Clone, Copy, PartialEq)]
enum Todo {
    Nothing,
    /// Send what was seen last once more: the window wants other layers.
    Show,
    /// Look at the frame shown once more, from where the particles are, or from here.
    LookAgain(Option<Pose2>),
    GoTo(usize),
    Restart,
}

/// The thread's own state.
struct Playing {
    sequence: Arc<Sequence>,
    devices: Vec<Device>,
    settings: FilterSettings,
    speed: Speed,
    veil: Veil,
    outbox: Outbox,
    preprocessor: Preprocessor,
    /// With the name of the device it was opened for.
    backend: Option<(String, Arc<dyn Backend>)>,
    scorer: CpuScorer,
    tagger: Option<Tagger>,
    seen: Option<Seen>,
    /// The poses found so far: where the filter goes on when it is sent back.
    poses: Vec<Option<Pose2>>,
    /// When the next frame is due; `None` while paused.
    due: Option<Instant>,
}

impl Playing {
    fn new(
        sequence: Arc<Sequence>,
        devices: Vec<Device>,
        settings: FilterSettings,
        speed: Speed,
        veil: Veil,
        outbox: Outbox,
    ) -> Self {
        let (camera, field) = (&sequence.setup.camera, &sequence.field);
        Self {
            preprocessor: Preprocessor::new(camera, field.line_width_m),
            scorer: CpuScorer::new(camera, field, settings.observation),
            poses: vec![None; sequence.frames.len()],
            sequence,
            devices,
            settings,
            speed,
            veil,
            outbox,
            backend: None,
            tagger: None,
            seen: None,
            due: None,
        }
    }

    fn run(mut self, commands: &mpsc::Receiver<Command>) {
        let mut todo = Todo::Restart;
        loop {
            let done = self.work(todo);
            if done.is_err() {
                return;
            }
            todo = match self.wait(commands) {
                Ok(Some(command)) => self.hear(command, commands),
                Ok(None) => self.advance(),
                Err(Closed) => return,
            };
        }
    }

    /// The next command, or none when the next frame is due.
    fn wait(&self, commands: &mpsc::Receiver<Command>) -> Result<Option<Command>, Closed> {
        let Some(due) = self.due else { return commands.recv().map(Some).map_err(|_| Closed) };
        match commands.recv_timeout(due.saturating_duration_since(Instant::now())) {
            Ok(command) => Ok(Some(command)),
            Err(mpsc::RecvTimeoutError::Timeout) => Ok(None),
            Err(mpsc::RecvTimeoutError::Disconnected) => Err(Closed),
        }
    }

    /// Hears a command and all that wait behind it: of several places to go to, the last one counts.
    fn hear(&mut self, first: Command, commands: &mpsc::Receiver<Command>) -> Todo {
        let mut todo = Todo::Nothing;
        for command in std::iter::once(first).chain(commands.try_iter()) {
            todo = self.obey(command, todo);
        }
        todo
    }

    fn obey(&mut self, command: Command, todo: Todo) -> Todo {
        match command {
            Command::Play => {
                self.due = Some(Instant::now());
                if self.at() + 1 == self.sequence.frames.len() { Todo::Restart } else { todo }
            }
            Command::Pause => {
                self.due = None;
                todo
            }
            Command::GoTo(index) => Todo::GoTo(index.min(self.sequence.frames.len() - 1)),
            Command::Restart => Todo::Restart,
            Command::Speed(speed) => {
                self.speed = speed;
                self.due = self.due.map(|_| Instant::now());
                todo
            }
            Command::Veil(veil) => {
                self.veil = veil;
                if todo == Todo::Nothing { Todo::Show } else { todo }
            }
            Command::Filter(settings) => {
                self.settings = settings;
                let Sequence { setup, field, .. } = &*self.sequence;
                self.scorer = CpuScorer::new(&setup.camera, field, self.settings.observation);
                if matches!(todo, Todo::Nothing | Todo::Show) { Todo::LookAgain(None) } else { todo }
            }
            Command::Place(pose) => Todo::LookAgain(Some(pose)),
        }
    }

    /// The next frame, or the end.
    fn advance(&mut self) -> Todo {
        let next = self.at() + 1;
        if next < self.sequence.frames.len() {
            return Todo::GoTo(next);
        }
        self.due = None;
        Todo::Nothing
    }

    fn at(&self) -> usize {
        self.seen.as_ref().map_or(0, |seen| seen.index)
    }

    /// Does it, and sends what came of it.
    fn work(&mut self, todo: Todo) -> Result<(), Closed> {
        let worked = match todo {
            Todo::Nothing => Ok(false),
            Todo::Show => Ok(true),
            Todo::Restart => {
                self.outbox.send(Message::Begun)?;
                self.restart().map(|()| true)
            }
            Todo::LookAgain(place) => self.look_again(place).map(|()| true),
            Todo::GoTo(index) => self.go_to(index).map(|()| true),
        };
        match worked {
            Ok(true) => self.show()?,
            Ok(false) => {}
            Err(reason) => {
                self.due = None;
                // What the filter believed may be worth nothing now: it begins anew from what is known.
                self.tagger = None;
                self.outbox.send(Message::Problem(reason))?;
            }
        }
        self.outbox.send(Message::Playing(self.due.is_some()))
    }

    fn show(&mut self) -> Result<(), Closed> {
        let Some(seen) = &self.seen else { return Ok(()) };
        let blur_sigma_px = self.settings.observation.blur_sigma_px;
        let view = seen.view(&self.sequence, &mut self.scorer, blur_sigma_px, self.veil);
        self.outbox.send(Message::Frame(Box::new(view)))
    }

    fn restart(&mut self) -> Result<(), String> {
        self.poses.fill(None);
        self.begin(self.sequence.start)?;
        self.look(0)
    }

    fn look_again(&mut self, place: Option<Pose2>) -> Result<(), String> {
        let index = self.at();
        let start = place.or(self.poses[index]).or(self.sequence.start.filter(|_| index == 0));
        self.begin(start)?;
        self.look(index)
    }

    fn go_to(&mut self, index: usize) -> Result<(), String> {
        let is_next = self.seen.as_ref().is_some_and(|seen| seen.index + 1 == index);
        // The frame before was seen just now: the filter follows. Where it has been, it begins where it was; elsewhere it
        // is carried on by the odometry, and searches the field where that is not enough.
        if self.tagger.is_none() || (!is_next && self.poses[index].is_some()) {
            self.begin(self.poses[index].or(self.nearest_known(index)))?;
        }
        self.look(index)
    }

    /// The pose of the last frame before that was seen, carried on by the odometry.
    fn nearest_known(&self, index: usize) -> Option<Pose2> {
        let (known, pose) = (0..index).rev().find_map(|known| Some((known, self.poses[known]?)))?;
        let odometry = |index: usize| self.sequence.frames[index].odometry;
        Some(pose.moved(odometry(known)?.motion_to(odometry(index)?)))
    }

    /// A new filter around a pose, or all over the field.
    fn begin(&mut self, start: Option<Pose2>) -> Result<(), String> {
        let words = |error: BackendError| error.to_string();
        let backend = self.backend().map_err(words)?;
        let Sequence { setup, field, .. } = &*self.sequence;
        let tagger = Tagger::with_backend(&setup.camera, field, start, self.settings.config(), backend);
        self.tagger = Some(tagger.map_err(words)?);
        Ok(())
    }

    fn backend(&mut self) -> Result<Arc<dyn Backend>, BackendError> {
        let Some(device) = by_name(&self.devices, &self.settings.device) else {
            return Ok(Arc::new(CpuBackend));
        };
        if let Some((_, backend)) = self.backend.as_ref().filter(|(name, _)| *name == device.name) {
            return Ok(backend.clone());
        }
        let backend = (device.open)()?;
        self.backend = Some((device.name.clone(), backend.clone()));
        Ok(backend)
    }

    /// Looks at a frame.
    fn look(&mut self, index: usize) -> Result<(), String> {
        let Some(tagger) = &mut self.tagger else { return Ok(()) };
        let picture = Arc::new(self.sequence.load_image(index).map_err(|error| error.to_string())?);
        let recorded = recorded(&self.sequence, index, &picture);
        let tagged = tagger.tag(&recorded).map_err(|error| error.to_string())?;
        let particles = tagger.particles();
        let prepared = self.preprocessor.prepare(picture, recorded.attitude);
        self.poses[index] = Some(tagged.pose.planar());
        self.schedule(index);
        self.seen = Some(Seen::new(index, prepared, recorded.attitude, tagged, particles));
        Ok(())
    }

    /// Says when the frame after this one is due, while playing.
    fn schedule(&mut self, index: usize) {
        let Some(due) = self.due else { return };
        let time_s = |index: usize| self.sequence.frames.get(index).map(|frame| frame.timestamp_s);
        let pause_s = match (time_s(index), time_s(index + 1)) {
            (Some(now), Some(next)) => (next - now).clamp(0.0, LONGEST_PAUSE_S) / self.speed.factor(),
            _ => 0.0,
        };
        // A player that lags behind does not hurry to make up for it.
        self.due = Some((due + Duration::from_secs_f64(pause_s)).max(Instant::now()));
    }
}
