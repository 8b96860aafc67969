//! The thread that draws. It gets wishes, of which only the newest counts, and sends back what it knows of the pose and
//! one picture after the other.

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
    kind::{PictureKind, Shown, View},
    source::{NearProbe, Probes, Source},
};
use crate::{
    background::Joined,
    device::Device,
    picture_view::{color_image, gray_image},
};

/// The true picture is shown where it was taken this near, root mean square pixels.
pub const TRUTH_REACH_PX: f64 = 20.0;
/// Pictures are compared with one that was taken at their pose, to half a pixel.
const SAME_POSE_PX: f64 = 0.5;

/// What is to be drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Wish {
    pub pose: CameraPose,
    pub views: Vec<View>,
    /// Pictures also where little was recorded.
    pub is_best_effort: bool,
    /// The edges of the triangulation there, too.
    pub edges_in: Option<Region>,
    pub probes: Option<Probes>,
    /// What draws; the processor where there is none.
    pub device: Option<Device>,
}

impl Wish {
    /// Whether the pictures of another wish are as good.
    fn has_pictures_of(&self, other: &Self) -> bool {
        let Self { pose, is_best_effort, probes, device, views: _, edges_in: _ } = self;
        *pose == other.pose
            && *is_best_effort == other.is_best_effort
            && *probes == other.probes
            && *device == other.device
    }
}

/// What is known around a pose.
#[derive(Debug, Clone)]
pub struct Around {
    /// The nearest recorded image.
    pub nearest: Option<Neighbour>,
    /// The natural neighbours with their weights.
    pub natural: Vec<Neighbour>,
    /// What they are found in, where it was wished for.
    pub edges: Vec<Edges>,
    /// The nearest true picture.
    pub probe: Option<NearProbe>,
}

/// A picture that was drawn.
#[derive(Debug, Clone)]
pub struct Drawn {
    pub picture: Arc<ColorImage>,
    pub facts: Facts,
}

/// What is known of a picture.
#[derive(Debug, Clone, Default)]
pub struct Facts {
    /// The method that was used in the end.
    pub method: &'static str,
    /// How long it took, with decoding.
    pub milliseconds: f64,
    /// The share of the pixels that some recorded image shows; `None` where it is not made of such.
    pub covered: Option<f64>,
    /// The images that it was made of.
    pub used: Vec<UsedImage>,
    /// How like the true picture it is over the carpet, PSNR, dB, where there is one at the pose.
    pub likeness_db: Option<f64>,
    /// The frame that it is, where it is a true one.
    pub probe: Option<NearProbe>,
}

/// A view at a pose, or why there is none.
#[derive(Debug, Clone)]
pub struct Painted {
    pub pose: CameraPose,
    pub result: Result<Drawn, String>,
}

/// What the thread says.
pub enum Answer {
    Around(Around),
    Painted(View, Painted),
    /// Something that a person should know.
    Problem(String),
}

/// The thread, seen from the window. Dropping this waits until it has ended: at most as long as a picture takes, or a device to open.
pub struct Painter {
    /// Before the thread: that ends when nobody can wish any more.
    wishes: mpsc::Sender<Wish>,
    answers: mpsc::Receiver<Answer>,
    wished: Option<Wish>,
    has_failed: bool,
    _thread: Joined,
}

impl Painter {
    /// Starts the thread. Devices are opened there: that may take a while.
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

    /// Asks for pictures, unless they have been asked for.
    pub fn wish(&mut self, wish: Wish) {
        if self.wished.as_ref() != Some(&wish) {
            // A thread that has ended says so through its answers.
            let _ = self.wishes.send(wish.clone());
            self.wished = Some(wish);
        }
    }

    /// The next answer, if there is one.
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

/// Wishes on their way to the thread, of which only the newest counts.
struct Wishes {
    coming: mpsc::Receiver<Wish>,
    newest: Option<Wish>,
}

impl Wishes {
    /// The newest, waiting for one where there is none; `None` where nobody wishes any more.
    fn next(&mut self) -> Option<Wish> {
        let wish = self.newest.take().or_else(|| self.coming.recv().ok())?;
        Some(self.coming.try_iter().last().unwrap_or(wish))
    }

    /// Whether what was wished for last no longer counts.
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

/// Whose turn it is: the view's that was drawn the longest ago, so that each gets its turn while wishes change faster than
/// all of them are drawn.
#[derive(Default)]
struct Turns {
    count: u64,
    /// Views and the number of their last turn.
    last: BTreeMap<View, u64>,
    /// What was wished for last, and the views that were drawn just so.
    wish: Option<Wish>,
    drawn: BTreeSet<View>,
}

impl Turns {
    /// What was drawn for the wish before stays, where its pictures are as good.
    fn begin(&mut self, wish: &Wish) {
        let before = self.wish.replace(wish.clone());
        if !before.is_some_and(|before| before.has_pictures_of(wish)) {
            self.drawn.clear();
        }
    }

    /// The next view to draw; `None` when all are.
    fn next(&mut self, wish: &Wish) -> Option<View> {
        let left = wish.views.iter().filter(|view| !self.drawn.contains(view));
        let view = *left.min_by_key(|view| self.last.get(view).copied())?;
        self.count += 1;
        self.last.insert(view, self.count);
        self.drawn.insert(view);
        Some(view)
    }
}

/// Everything that draws.
struct Studio {
    /// What it was told to draw by.
    device: Option<Device>,
    strict: Synthesizer,
    best_effort: Synthesizer,
    renderer: Renderer,
    /// The true picture decoded last, and the pixels of it that show the carpet.
    truth: Option<Truth>,
}

struct Truth {
    probes: Probes,
    frame: usize,
    picture: RgbImage,
    mask: Mask,
}

/// A picture in the making.
struct Made {
    picture: RgbImage,
    reconstruction: Option<Reconstruction>,
    facts: Facts,
}

impl Studio {
    /// Draws by the processor at first.
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

    /// Opens another device, where it is another one.
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

    /// Draws what is wished for, until something else is; one picture at least. False where nobody listens any more.
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
        while let Some(view) = turns.next(wish) {
            let made = made.entry(view.kind).or_insert_with(|| self.make(view.kind, wish, probe));
            let result = match made {
                Ok(made) => drawn(made, view),
                Err(reason) => Err(reason.clone()),
            };
            if !say(Answer::Painted(view, Painted { pose: wish.pose, result })) {
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
        let mut made = match (kind, kind.method()) {
            (_, Some(method)) => {
                let synthesizer = if wish.is_best_effort { &self.best_effort } else { &self.strict };
                let reconstruction =
                    synthesizer.image_at(wish.pose, method).map_err(|error| error.to_string())?;
                Made::of(reconstruction)
            }
            (PictureKind::Truth, None) => self.true_picture(wish, probe)?,
            (_, None) => {
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

    /// How like the true picture taken at the very pose, if there is one.
    fn likeness_db(&mut self, picture: &RgbImage, wish: &Wish, probe: Option<NearProbe>) -> Option<f64> {
        let near = probe.filter(|probe| probe.distance_px <= SAME_POSE_PX)?;
        // A true picture that cannot be read says so where it is to be shown.
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

fn drawn(made: &Made, view: View) -> Result<Drawn, String> {
    let picture = match (view.shown, &made.reconstruction) {
        (Shown::Picture, _) => color_image(&made.picture),
        (Shown::Origins, Some(reconstruction)) => color_image(&reconstruction.origin_picture()),
        (Shown::Trust, Some(reconstruction)) => gray_image(&reconstruction.trust_picture()),
        (_, None) => {
            let words = "This picture is not made of recorded ones: choose another method, or show the picture itself.";
            return Err(words.to_owned());
        }
    };
    Ok(Drawn { picture, facts: made.facts.clone() })
}

/// The strict one, and the one of the best effort.
fn synthesizers(archive: &Arc<Archive>, warper: &Arc<dyn Warper>) -> [Synthesizer; 2] {
    let config = SynthesisConfig::new(archive);
    let camera = &archive.setup().camera;
    [config, config.best_effort()]
        .map(|config| Synthesizer::with(archive.clone(), camera.clone(), warper.clone(), config))
}

fn warper(device: Option<&Device>) -> Result<Arc<dyn Warper>, String> {
    let Some(device) = device else { return Ok(Arc::new(CpuWarper)) };
    let opened = (device.open)().and_then(|backend| backend.warper());
    opened.map_err(|error| format!("{}: {error}", device.name))
}
