//! The filter's thread: plays a recording, follows commands, and sends everything to be shown.
//!
//! It owns the filter. The window sends commands and never waits; frames come back through a short queue, so that a window
//! that does not draw stops the player and not the other way round.

use std::{
    sync::{Arc, mpsc},
    thread,
    time::{Duration, Instant},
};

use eframe::egui::Context;
use image::RgbImage;
use reality_sim_core::{
    backend::{Backend, BackendError, CpuBackend},
    localization::{LocalizationError, Localizer, Observation},
    observation::CpuScorer,
    pose::Pose2,
    preprocess::Preprocessor,
    sequence::Sequence,
};

use super::{
    frame::{Found, FrameView, Record, Seen},
    gathering::Gathering,
    settings::{FilterSettings, Speed, Veil, WalkSettings},
    timeline::Timeline,
};
use crate::device::{Device, by_name};

/// Largest number of frames on their way to the window.
const QUEUE: usize = 2;

/// How a recording begins when it is opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beginning {
    /// The first picture is shown, and the player waits.
    Waiting,
    /// It is played at once, and whenever it starts at the first picture, particles gather from all over the field.
    Gathering,
}

/// Command of the window.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    Play,
    Pause,
    /// Shows the frame with this number.
    GoTo(usize),
    /// Starts again at the first frame and forgets everything seen.
    Restart,
    Filter(FilterSettings),
    Speed(Speed),
    Veil(Veil),
    /// Moves all particles to a pose.
    Place(Pose2),
}

/// Message to the window.
pub enum Message {
    /// The player starts again: earlier results are no longer valid.
    Begun,
    Frame(Box<FrameView>),
    /// State, sent after every piece of work.
    State(State),
    /// Problem, in words.
    Problem(String),
}

/// State of the player.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct State {
    /// Current frame; the last [`Message::Frame`] is of another one if this frame's picture cannot be read.
    pub at: usize,
    pub is_playing: bool,
    /// Number of commands received so far.
    pub heard: u64,
}

/// The window's handle of the player.
pub struct Player {
    commands: mpsc::Sender<Command>,
    messages: mpsc::Receiver<Message>,
    is_gone: bool,
}

impl Player {
    /// Starts the thread. It ends when the handle is dropped.
    pub fn spawn(
        ctx: &Context,
        sequence: Arc<Sequence>,
        devices: Vec<Device>,
        settings: &WalkSettings,
        beginning: Beginning,
    ) -> Self {
        let (commands, received) = mpsc::channel();
        let (sender, messages) = mpsc::sync_channel(QUEUE);
        let outbox = Outbox { sender, ctx: ctx.clone() };
        let settings = settings.clone();
        thread::spawn(move || Playing::new(sequence, devices, settings, beginning, outbox).run(&received));
        Self { commands, messages, is_gone: false }
    }

    /// Sends a command.
    pub fn tell(&self, command: Command) {
        // The thread is gone only after a fault, which the end of its messages reports.
        let _ = self.commands.send(command);
    }

    /// Returns the next message, if there is one.
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

/// The window has been closed.
struct Closed;

impl Outbox {
    fn send(&self, message: Message) -> Result<(), Closed> {
        self.sender.send(message).map_err(|_| Closed)?;
        self.ctx.request_repaint();
        Ok(())
    }
}

/// Work that follows from the commands received: of several poses and frames, the last ones count.
#[derive(Default)]
struct Todo {
    /// Whether to forget everything first.
    restart: bool,
    go_to: Option<usize>,
    place: Option<Pose2>,
    /// Whether to update the gathering particles.
    gather: bool,
    /// Whether to send the last frame once more, because the window wants other layers.
    show: bool,
}

/// Fault during the work.
enum Fault {
    /// Fault of one picture; the next one may be readable.
    Picture(String),
    /// Fault of the device.
    Device(String),
}

impl From<BackendError> for Fault {
    fn from(error: BackendError) -> Self {
        Self::Device(error.to_string())
    }
}

impl From<LocalizationError> for Fault {
    fn from(error: LocalizationError) -> Self {
        match error {
            LocalizationError::Backend(error) => error.into(),
            error => Self::Picture(error.to_string()),
        }
    }
}

/// What the player does.
enum Phase {
    /// Particles are about to be spread over the field.
    Spreading,
    Gathering(Box<Gathering>),
    /// The recording is followed.
    Following,
}

/// State of the thread.
struct Playing {
    sequence: Arc<Sequence>,
    devices: Vec<Device>,
    settings: FilterSettings,
    speed: Speed,
    veil: Veil,
    outbox: Outbox,
    preprocessor: Preprocessor,
    /// Backend with the name of the device for which it was opened.
    backend: Option<(String, Arc<dyn Backend>)>,
    scorer: CpuScorer,
    /// `None` before the first frame, after a change of settings that it has not taken yet, and after a fault.
    localizer: Option<Localizer>,
    /// Whether the localizer has to start again, forgetting what it has seen.
    begins_anew: bool,
    beginning: Beginning,
    phase: Phase,
    state: State,
    seen: Option<Seen>,
    timeline: Timeline,
    /// Poses estimated so far, from which the filter continues when it is sent back.
    poses: Vec<Option<Pose2>>,
    /// Time when the next frame is due; `None` while paused.
    due: Option<Instant>,
}

impl Playing {
    fn new(
        sequence: Arc<Sequence>,
        devices: Vec<Device>,
        settings: WalkSettings,
        beginning: Beginning,
        outbox: Outbox,
    ) -> Self {
        let WalkSettings { filter: settings, speed, layers } = settings;
        let (camera, field) = (&sequence.setup.camera, &sequence.field);
        Self {
            preprocessor: Preprocessor::new(camera, field.line_width_m),
            scorer: CpuScorer::new(camera, field, settings.observation),
            timeline: Timeline::new(&sequence),
            poses: vec![None; sequence.frames.len()],
            sequence,
            devices,
            settings,
            speed,
            veil: layers.veil,
            outbox,
            backend: None,
            localizer: None,
            begins_anew: true,
            beginning,
            phase: Phase::Following,
            state: State::default(),
            seen: None,
            due: (beginning == Beginning::Gathering).then(Instant::now),
        }
    }

    fn run(mut self, commands: &mpsc::Receiver<Command>) {
        let mut todo = Todo { restart: true, ..Todo::default() };
        while self.work(&todo).is_ok() {
            todo = match self.wait(commands) {
                Ok(Some(command)) => self.hear(command, commands),
                Ok(None) => self.advance(),
                Err(Closed) => return,
            };
        }
    }

    /// Waits for the next command; returns `None` when the next frame is due.
    fn wait(&self, commands: &mpsc::Receiver<Command>) -> Result<Option<Command>, Closed> {
        let Some(due) = self.due else { return commands.recv().map(Some).map_err(|_| Closed) };
        match commands.recv_timeout(due.saturating_duration_since(Instant::now())) {
            Ok(command) => Ok(Some(command)),
            Err(mpsc::RecvTimeoutError::Timeout) => Ok(None),
            Err(mpsc::RecvTimeoutError::Disconnected) => Err(Closed),
        }
    }

    /// Receives a command and all that are queued behind it.
    fn hear(&mut self, first: Command, commands: &mpsc::Receiver<Command>) -> Todo {
        let mut todo = Todo::default();
        for command in std::iter::once(first).chain(commands.try_iter()) {
            self.state.heard += 1;
            self.obey(command, &mut todo);
        }
        todo
    }

    fn obey(&mut self, command: Command, todo: &mut Todo) {
        match command {
            Command::Play => {
                self.due = Some(Instant::now());
                todo.restart |= todo.go_to.unwrap_or(self.state.at) == self.last();
            }
            Command::Pause => self.due = None,
            Command::GoTo(index) => todo.go_to = Some(index.min(self.last())),
            Command::Restart => *todo = Todo { restart: true, ..Todo::default() },
            Command::Speed(speed) => {
                self.speed = speed;
                self.due = self.due.map(|_| Instant::now());
            }
            Command::Veil(veil) => {
                self.veil = veil;
                todo.show = true;
            }
            Command::Filter(settings) => {
                self.settings = settings;
                let Sequence { setup, field, .. } = &*self.sequence;
                self.scorer = CpuScorer::new(&setup.camera, field, self.settings.observation);
                self.localizer = None;
                if let Phase::Gathering(_) = self.phase {
                    self.phase = Phase::Spreading;
                }
            }
            Command::Place(pose) => todo.place = Some(pose),
        }
    }

    /// Returns the work for the gathering's next step, for the next frame, or for the end of the recording.
    fn advance(&mut self) -> Todo {
        if let Phase::Gathering(gathering) = &self.phase {
            let is_over = gathering.is_over();
            return Todo { gather: !is_over, go_to: is_over.then_some(self.state.at), ..Todo::default() };
        }
        if self.state.at < self.last() {
            return Todo { go_to: Some(self.state.at + 1), ..Todo::default() };
        }
        self.due = None;
        Todo::default()
    }

    fn last(&self) -> usize {
        self.sequence.frames.len() - 1
    }

    /// Does the work and sends its result.
    fn work(&mut self, todo: &Todo) -> Result<(), Closed> {
        if todo.restart {
            self.outbox.send(Message::Begun)?;
            self.poses.fill(None);
            self.begins_anew = true;
            self.phase = match self.beginning {
                Beginning::Waiting => Phase::Following,
                Beginning::Gathering => Phase::Spreading,
            };
        }
        if todo.go_to.is_some() || todo.place.is_some() {
            self.phase = Phase::Following;
        }
        let worked = self.process(todo);
        if worked.is_err() {
            self.phase = Phase::Following;
        }
        match worked {
            Ok(is_new) if is_new || todo.show => self.show()?,
            Ok(_) => {}
            Err(Fault::Picture(reason)) => self.outbox.send(Message::Problem(reason))?,
            Err(Fault::Device(reason)) => {
                self.due = None;
                self.outbox.send(Message::Problem(reason))?;
            }
        }
        self.state.is_playing = self.due.is_some();
        self.outbox.send(Message::State(self.state))
    }

    /// Does the work of the phase; returns whether there is something new to show.
    fn process(&mut self, todo: &Todo) -> Result<bool, Fault> {
        match &mut self.phase {
            Phase::Spreading => self.spread()?,
            Phase::Gathering(gathering) if todo.gather => {
                // A device that has failed is opened again the next time.
                gathering.advance().inspect_err(|_| self.backend = None)?;
                let pause_s = gathering.pause_s();
                self.schedule(pause_s);
            }
            Phase::Gathering(_) => return Ok(false),
            Phase::Following => {
                let asks = todo.restart || todo.go_to.is_some() || todo.place.is_some();
                if !asks && self.localizer.is_some() {
                    return Ok(false);
                }
                self.look(todo)?;
            }
        }
        Ok(true)
    }

    /// Spreads particles over the field, for the first picture.
    fn spread(&mut self) -> Result<(), Fault> {
        self.state.at = 0;
        let picture = Arc::new(self.load(0)?);
        let backend = self.backend()?;
        let Self { sequence, preprocessor, settings, .. } = self;
        let gathering = Gathering::new(sequence, &picture, preprocessor, settings, &*backend);
        let gathering = gathering.inspect_err(|_| self.backend = None)?;
        // Opening a device takes time, and the spread particles are to be seen.
        self.due = self.due.map(|_| Instant::now());
        self.schedule(gathering.pause_s());
        self.phase = Phase::Gathering(Box::new(gathering));
        Ok(())
    }

    fn show(&mut self) -> Result<(), Closed> {
        let (seen, scorer) = match &mut self.phase {
            Phase::Gathering(gathering) => (Some(&gathering.seen), &mut gathering.scorer),
            Phase::Spreading | Phase::Following => (self.seen.as_ref(), &mut self.scorer),
        };
        let Some(seen) = seen else { return Ok(()) };
        let blur_sigma_px = self.settings.observation.blur_sigma_px;
        let view = seen.view(&self.sequence, scorer, blur_sigma_px, self.veil);
        self.outbox.send(Message::Frame(Box::new(view)))
    }

    /// Processes the requested frame. From the previous frame, the filter continues; at a frame seen before, it starts at
    /// the pose found there; elsewhere it starts at a pose from the odometry, and searches the field if that is not enough.
    fn look(&mut self, todo: &Todo) -> Result<(), Fault> {
        let before = self.state.at;
        let index = todo.go_to.unwrap_or(if todo.restart { 0 } else { before });
        self.state.at = index;
        self.schedule(self.timeline.pause_after_s(index));
        let picture = self.load(index)?;
        let follows = todo.place.is_none() && (before + 1 == index || self.poses[index].is_none());
        if self.begins_anew || self.localizer.is_none() || !follows {
            self.begin(todo.place.or(self.poses[index]).or(self.nearest_known(index)))?;
        }
        self.localize(index, &Arc::new(picture))
    }

    fn load(&self, index: usize) -> Result<RgbImage, Fault> {
        self.sequence.load_image(index).map_err(|error| Fault::Picture(error.to_string()))
    }

    /// Returns the pose of the last frame seen before this one, or the recording's start, moved by the odometry since then.
    fn nearest_known(&self, index: usize) -> Option<Pose2> {
        let seen = (0..index).rev().find_map(|known| Some((known, self.poses[known]?)));
        let (known, pose) = seen.or(self.sequence.start.map(|start| (0, start)))?;
        if known == index {
            return Some(pose);
        }
        let odometry = |index: usize| self.sequence.frames[index].odometry;
        Some(pose.moved(odometry(known)?.motion_to(odometry(index)?)))
    }

    /// Initializes the filter around a pose, or over the whole field.
    fn begin(&mut self, start: Option<Pose2>) -> Result<(), Fault> {
        self.begins_anew = false;
        if let Some(localizer) = &mut self.localizer {
            localizer.reset(start);
            return Ok(());
        }
        let backend = self.backend()?;
        let Sequence { setup, field, .. } = &*self.sequence;
        let builder = Localizer::builder(&setup.camera, field).config(self.settings.config());
        self.localizer = Some(builder.start(start).backend(backend).build()?);
        Ok(())
    }

    fn backend(&mut self) -> Result<Arc<dyn Backend>, BackendError> {
        let Some(device) = by_name(&self.devices, &self.settings.device) else {
            return Ok(Arc::new(CpuBackend));
        };
        if let Some((_, backend)) = self.backend.as_ref().filter(|(name, _)| *name == device.name()) {
            return Ok(backend.clone());
        }
        let backend = device.open()?;
        self.backend = Some((device.name().to_owned(), backend.clone()));
        Ok(backend)
    }

    fn localize(&mut self, index: usize, picture: &Arc<RgbImage>) -> Result<(), Fault> {
        let Some(localizer) = &mut self.localizer else { return Ok(()) };
        let observation = Observation::of_frame(&self.sequence, index, picture);
        let found = localizer.update(&observation);
        let found = found.and_then(|frame| Ok((frame, localizer.particles()?)));
        // A device that has failed is opened again the next time.
        let (frame, particles) = found.inspect_err(|_| (self.localizer, self.backend) = (None, None))?;
        let prepared = self.preprocessor.prepare(picture.clone(), observation.mount);
        self.poses[index] = Some(frame.pose.planar());
        let found = Found {
            record: Record::new(index, &frame, self.sequence.frames[index].reference_pose),
            best_particle: frame.filter.pose,
            particles,
            gathering: None,
        };
        self.seen = Some(Seen::new(prepared, observation.mount, found));
        Ok(())
    }

    /// Sets the time when the next step is due, while playing: after a pause at the recording's own speed.
    fn schedule(&mut self, pause_s: f64) {
        let Some(due) = self.due else { return };
        let pause = Duration::from_secs_f64(pause_s / self.speed.factor());
        // A player that lags behind does not catch up.
        self.due = Some((due + pause).max(Instant::now()));
    }
}
