//! The drawing thread. It receives requests, of which only the newest counts, and answers with the data around the pose and
//! one picture after another.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{Arc, mpsc},
    thread,
    time::Instant,
};

use eframe::egui::{ColorImage, Context};
use image::RgbImage;
use reality_sim_core::{
    pose::CameraPose,
    warp::{CpuWarper, Warper},
};
use reality_sim_db::index::Neighbour;
use reality_sim_sensor::{Renderer, SceneColors};
use reality_sim_synthesis::{
    Archive, Reconstruction, SynthesisConfig, Synthesizer, UsedImage,
    quality::{Mask, psnr_db},
};

use super::{
    edges::{Edges, Region, edges},
    kind::{Aspect, MadeBy, Pane, PictureKind},
    source::{NearProbe, Probes, Source},
};
use crate::{
    background::Joined,
    device::Device,
    picture_view::{color_image, gray_image},
};

/// Largest distance at which the true picture is shown, root mean square pixels.
pub const TRUTH_REACH_PX: f64 = 20.0;
/// Largest distance, in pixels, at which a true picture counts as taken at the same pose, so that pictures are compared with
/// it.
const SAME_POSE_PX: f64 = 0.5;

/// Request for pictures at a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Wish {
    pub pose: CameraPose,
    pub panes: Vec<Pane>,
    /// Whether pictures are also drawn where little was recorded.
    pub is_best_effort: bool,
    /// Region in which the triangulation's edges are requested.
    pub edges_in: Option<Region>,
    pub probes: Option<Probes>,
    /// Device that draws; the processor if there is none.
    pub device: Option<Device>,
}

impl Wish {
    /// Whether the pictures of another request are equally valid.
    fn has_pictures_of(&self, other: &Self) -> bool {
        let Self { pose, is_best_effort, probes, device, panes: _, edges_in: _ } = self;
        *pose == other.pose
            && *is_best_effort == other.is_best_effort
            && *probes == other.probes
            && *device == other.device
    }
}

/// Data around a pose.
#[derive(Debug, Clone)]
pub struct Around {
    /// The nearest recorded image.
    pub nearest: Option<Neighbour>,
    /// The natural neighbours with their weights.
    pub natural: Vec<Neighbour>,
    /// Edges of the triangulation, if they were requested.
    pub edges: Vec<Edges>,
    /// The nearest true picture.
    pub probe: Option<NearProbe>,
}

/// Drawn picture.
#[derive(Debug, Clone)]
pub struct Drawn {
    pub picture: Arc<ColorImage>,
    pub facts: Facts,
}

/// Facts about a picture.
#[derive(Debug, Clone, Default)]
pub struct Facts {
    /// Method that was actually used.
    pub method: &'static str,
    /// Time for drawing, including decoding, milliseconds.
    pub milliseconds: f64,
    /// Fraction of the pixels that some recorded image covers; `None` for pictures not made from such images.
    pub covered: Option<f64>,
    /// Images from which the picture was made.
    pub used: Vec<UsedImage>,
    /// PSNR in dB over the carpet against the true picture, if there is one at the pose.
    pub likeness_db: Option<f64>,
    /// The frame shown, for a true picture.
    pub probe: Option<NearProbe>,
}

/// Picture of a pane at a pose, or the reason why there is none.
#[derive(Debug, Clone)]
pub struct Painted {
    pub pose: CameraPose,
    pub result: Result<Drawn, String>,
}

/// Answer of the drawing thread.
pub enum Answer {
    Around(Around),
    Painted(Pane, Painted),
    /// Problem to show to the user.
    Problem(String),
}

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
                studio.choose_warper(wish.device.as_ref(), &say);
                if !studio.fulfil(&wish, &mut turns, &mut wishes, &say) {
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
}

/// Everything that the thread needs for drawing.
struct Studio {
    /// Requested device.
    device: Option<Device>,
    strict: Synthesizer,
    best_effort: Synthesizer,
    renderer: Renderer,
    /// True picture decoded last, with its pixels that show the carpet.
    truth: Option<Truth>,
}

struct Truth {
    probes: Probes,
    frame: usize,
    picture: RgbImage,
    mask: Mask,
}

/// Picture with the facts known so far.
struct Made {
    picture: RgbImage,
    reconstruction: Option<Reconstruction>,
    facts: Facts,
}

impl Studio {
    /// Starts drawing with the processor.
    fn new(source: &Source) -> Self {
        let archive = &source.archive;
        let [strict, best_effort] = synthesizers(archive, &(Arc::new(CpuWarper) as Arc<dyn Warper>));
        let setup = archive.setup();
        let colors = SceneColors::new(setup, archive.field());
        Self {
            device: None,
            strict,
            best_effort,
            renderer: Renderer::new(setup, archive.field(), colors),
            truth: None,
        }
    }

    /// Opens the requested device, if it is a different one.
    fn choose_warper(&mut self, device: Option<&Device>, say: &impl Fn(Answer) -> bool) {
        if self.device.as_ref() == device {
            return;
        }
        self.device = device.cloned();
        let warper = warper(device).unwrap_or_else(|problem| {
            say(Answer::Problem(format!("{problem}: pictures are drawn by the processor meanwhile")));
            Arc::new(CpuWarper)
        });
        [self.strict, self.best_effort] = synthesizers(self.strict.archive(), &warper);
    }

    /// Draws the requested panes until the request changes, at least one picture. Returns false when the receiver is gone.
    fn fulfil(
        &mut self,
        wish: &Wish,
        turns: &mut Turns,
        wishes: &mut Wishes,
        say: &impl Fn(Answer) -> bool,
    ) -> bool {
        let around = self.around(wish);
        let probe = around.probe;
        if !say(Answer::Around(around)) {
            return false;
        }
        let mut made: BTreeMap<PictureKind, Result<Made, String>> = BTreeMap::new();
        turns.begin(wish);
        while let Some(pane) = turns.next(wish) {
            let made = made.entry(pane.kind).or_insert_with(|| self.make(pane.kind, wish, probe));
            let result = match made {
                Ok(made) => drawn(made, pane),
                Err(reason) => Err(reason.clone()),
            };
            if !say(Answer::Painted(pane, Painted { pose: wish.pose, result })) {
                return false;
            }
            if wishes.have_changed() {
                break;
            }
        }
        true
    }

    fn around(&self, wish: &Wish) -> Around {
        let index = self.strict.archive().index();
        Around {
            nearest: index.nearest(wish.pose, 1).ok().and_then(|nearest| nearest.first().copied()),
            natural: index.natural(wish.pose).unwrap_or_default(),
            edges: wish.edges_in.map_or_else(Vec::new, |region| edges(index, wish.pose.yaw_rad, region)),
            probe: wish.probes.as_ref().and_then(|probes| probes.nearest(index.metric(), wish.pose)),
        }
    }

    fn make(&mut self, kind: PictureKind, wish: &Wish, probe: Option<NearProbe>) -> Result<Made, String> {
        let start = Instant::now();
        let mut made = match kind.made_by() {
            MadeBy::Method(method) => {
                let synthesizer = if wish.is_best_effort { &self.best_effort } else { &self.strict };
                let reconstruction =
                    synthesizer.image_at(wish.pose, &method).map_err(|error| error.to_string())?;
                Made::of(reconstruction)
            }
            MadeBy::Camera => self.true_picture(wish, probe)?,
            MadeBy::Renderer => {
                let picture = self.renderer.draw(wish.pose).map_err(|error| error.to_string())?;
                let facts = Facts { method: kind.name(), ..Facts::default() };
                Made { picture, reconstruction: None, facts }
            }
        };
        made.facts.milliseconds = 1e3 * start.elapsed().as_secs_f64();
        if kind != PictureKind::Truth {
            made.facts.likeness_db = self.likeness_db(&made.picture, wish, probe);
        }
        Ok(made)
    }

    fn true_picture(&mut self, wish: &Wish, probe: Option<NearProbe>) -> Result<Made, String> {
        let (Some(probes), Some(near)) = (&wish.probes, probe) else {
            return Err("No true picture is known: press “Compare with a recording…”.".to_owned());
        };
        if near.distance_px > TRUTH_REACH_PX {
            return Err(format!(
                "No true picture was taken within {TRUTH_REACH_PX:.0} px of this pose: the nearest is {:.0} px away.",
                near.distance_px
            ));
        }
        let picture = self.truth(probes, near)?.picture.clone();
        let facts = Facts { method: PictureKind::Truth.name(), probe: Some(near), ..Facts::default() };
        Ok(Made { picture, reconstruction: None, facts })
    }

    /// Returns the PSNR against the true picture at the same pose, if there is one.
    fn likeness_db(&mut self, picture: &RgbImage, wish: &Wish, probe: Option<NearProbe>) -> Option<f64> {
        let near = probe.filter(|probe| probe.distance_px <= SAME_POSE_PX)?;
        // An unreadable true picture is reported where it is shown.
        let truth = self.truth(wish.probes.as_ref()?, near).ok()?;
        psnr_db(picture, &truth.picture, Some(&truth.mask))
    }

    fn truth(&mut self, probes: &Probes, near: NearProbe) -> Result<&Truth, String> {
        let is_same = |truth: &Truth| truth.frame == near.frame && truth.probes == *probes;
        let truth = match self.truth.take().filter(is_same) {
            Some(truth) => truth,
            None => {
                let picture = probes.picture(near.frame)?;
                let mask = Mask::carpet(self.strict.camera(), near.pose, self.strict.archive().field());
                Truth { probes: probes.clone(), frame: near.frame, picture, mask }
            }
        };
        Ok(self.truth.insert(truth))
    }
}

impl Made {
    fn of(reconstruction: Reconstruction) -> Self {
        let facts = Facts {
            method: reconstruction.method,
            covered: Some(reconstruction.covered()),
            used: reconstruction.used.clone(),
            ..Facts::default()
        };
        Self { picture: reconstruction.picture.clone(), reconstruction: Some(reconstruction), facts }
    }
}

fn drawn(made: &Made, pane: Pane) -> Result<Drawn, String> {
    let picture = match (pane.aspect, &made.reconstruction) {
        (Aspect::Picture, _) => color_image(&made.picture),
        (Aspect::Origins, Some(reconstruction)) => color_image(&reconstruction.origin_picture()),
        (Aspect::Trust, Some(reconstruction)) => gray_image(&reconstruction.trust_picture()),
        (_, None) => {
            let words = "This picture is not made of recorded ones: choose another method, or show the picture itself.";
            return Err(words.to_owned());
        }
    };
    Ok(Drawn { picture, facts: made.facts.clone() })
}

/// Returns the strict synthesizer and the best-effort one.
fn synthesizers(archive: &Arc<Archive>, warper: &Arc<dyn Warper>) -> [Synthesizer; 2] {
    let config = SynthesisConfig::new(archive);
    let camera = &archive.setup().camera;
    [config, config.best_effort()]
        .map(|config| Synthesizer::with(archive.clone(), camera.clone(), warper.clone(), config))
}

fn warper(device: Option<&Device>) -> Result<Arc<dyn Warper>, String> {
    let Some(device) = device else { return Ok(Arc::new(CpuWarper)) };
    let opened = device.open().and_then(|backend| backend.warper());
    opened.map_err(|error| format!("{}: {error}", device.name()))
}
