//! The thread that draws. It gets wishes, of which only the newest counts, and sends back what it knows of the pose and
//! one picture after the other.

use std::{
    collections::BTreeMap,
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
use reality_sim_db::index::{Neighbour, SectorTriangulation};
use reality_sim_sensor::{Renderer, SceneColors};
use reality_sim_synthesis::{
    Reconstruction, SynthesisConfig, Synthesizer, Used,
    quality::{Mask, psnr_db},
};

use super::{
    kind::{PictureKind, Shown, View},
    source::{NearProbe, Probes, Source},
};
use crate::{
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
    /// The edges of the triangulation, too.
    pub wants_triangulation: bool,
    pub probes: Option<Probes>,
}

/// What is known around a pose.
#[derive(Debug, Clone)]
pub struct Around {
    /// The nearest recorded image.
    pub nearest: Option<Neighbour>,
    /// The natural neighbours with their weights.
    pub natural: Vec<Neighbour>,
    /// What they are found in, where it was wished for.
    pub triangulations: Vec<SectorTriangulation>,
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
    pub used: Vec<Used>,
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

/// The thread, seen from the window. It ends when this is dropped.
pub struct Painter {
    wishes: mpsc::Sender<Wish>,
    answers: mpsc::Receiver<Answer>,
    wished: Option<Wish>,
    has_failed: bool,
}

impl Painter {
    /// Starts the thread. The device is opened there: that may take a while.
    pub fn spawn(ctx: &Context, source: Arc<Source>, device: Option<Device>) -> Self {
        let (wishes, its_wishes) = mpsc::channel();
        let (its_answers, answers) = mpsc::channel();
        let ctx = ctx.clone();
        thread::spawn(move || {
            let say = |answer| {
                let is_heard = its_answers.send(answer).is_ok();
                ctx.request_repaint();
                is_heard
            };
            let mut studio = Studio::new(&source, device.as_ref(), |problem| {
                say(Answer::Problem(problem));
            });
            while let Ok(wish) = its_wishes.recv() {
                let wish = its_wishes.try_iter().last().unwrap_or(wish);
                if !studio.fulfil(&wish, &say) {
                    break;
                }
            }
        });
        Self { wishes, answers, wished: None, has_failed: false }
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

/// Everything that draws.
struct Studio {
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
    fn new(source: &Source, device: Option<&Device>, tell: impl Fn(String)) -> Self {
        let archive = &source.archive;
        let warper = warper(device).unwrap_or_else(|problem| {
            tell(format!("{problem}: pictures are drawn by the processor meanwhile"));
            Arc::new(CpuWarper)
        });
        let config = SynthesisConfig::new(archive);
        let setup = archive.setup();
        let synthesizer =
            |config| Synthesizer::with(archive.clone(), setup.camera.clone(), warper.clone(), config);
        let colors = SceneColors::new(setup, archive.field());
        Self {
            strict: synthesizer(config),
            best_effort: synthesizer(config.best_effort()),
            renderer: Renderer::new(setup, archive.field(), colors),
            truth: None,
        }
    }

    /// Draws all that is wished for; false where nobody listens any more.
    fn fulfil(&mut self, wish: &Wish, say: &impl Fn(Answer) -> bool) -> bool {
        let around = self.around(wish);
        let probe = around.probe;
        if !say(Answer::Around(around)) {
            return false;
        }
        let mut made: BTreeMap<PictureKind, Result<Made, String>> = BTreeMap::new();
        for &view in &wish.views {
            let made = made.entry(view.kind).or_insert_with(|| self.make(view.kind, wish, probe));
            let result = match made {
                Ok(made) => drawn(made, view),
                Err(reason) => Err(reason.clone()),
            };
            if !say(Answer::Painted(view, Painted { pose: wish.pose, result })) {
                return false;
            }
        }
        true
    }

    fn around(&self, wish: &Wish) -> Around {
        let index = self.strict.archive().index();
        let triangulations =
            if wish.wants_triangulation { index.triangulations(wish.pose.yaw_rad) } else { Vec::new() };
        Around {
            nearest: index.nearest(wish.pose, 1).ok().and_then(|nearest| nearest.first().copied()),
            natural: index.natural(wish.pose).unwrap_or_default(),
            triangulations,
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

fn warper(device: Option<&Device>) -> Result<Arc<dyn Warper>, String> {
    let Some(device) = device else { return Ok(Arc::new(CpuWarper)) };
    let opened = (device.open)().and_then(|backend| backend.warper());
    opened.map_err(|error| format!("{}: {error}", device.name))
}
