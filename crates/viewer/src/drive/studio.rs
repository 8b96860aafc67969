//! Makes pictures: scenes by the methods, with things and labels.

use std::{collections::BTreeMap, sync::Arc, time::Instant};

use image::RgbImage;
use reality_sim_core::{
    pose::CameraPose,
    warp::{CpuWarper, Warper},
};
use reality_sim_sensor::{Renderer, SceneColors};
use reality_sim_synthesis::{
    Archive, Reconstruction, SynthesisConfig, Synthesizer,
    quality::{Mask, psnr_db},
};

use super::{
    answer::{Around, Drawn, Facts, Times},
    edges::edges,
    kind::{Aspect, MadeBy, Pane, PictureKind},
    source::{NearProbe, Probes, Source},
    staging::{Staged, Staging, milliseconds_since},
    wish::Wish,
};
use crate::{
    device::Device,
    picture_view::{color_image, gray_image},
};

/// Largest distance at which the true picture is shown, root mean square pixels.
const TRUTH_REACH_PX: f64 = 20.0;
/// Largest distance, in pixels, at which a true picture counts as taken at the same pose, so that pictures are compared with
/// it.
const SAME_POSE_PX: f64 = 0.5;

/// Everything that is needed to make pictures.
pub struct Studio {
    /// Requested device, and what draws on it.
    device: Option<Device>,
    warper: Arc<dyn Warper>,
    is_clean: bool,
    strict: Synthesizer,
    best_effort: Synthesizer,
    renderer: Renderer,
    staging: Staging,
    scenes: Scenes,
    /// True picture decoded last, with its pixels that show the carpet.
    truth: Option<Truth>,
}

struct Truth {
    probes: Probes,
    frame: usize,
    picture: RgbImage,
    mask: Mask,
}

/// Picture without things and labels, with the facts known so far.
struct Scene {
    picture: RgbImage,
    /// Pose that things and labels are drawn for.
    pose: CameraPose,
    reconstruction: Option<Reconstruction>,
    facts: Facts,
}

/// Scenes of one request. They stay while only things and labels change, which takes a fraction of the time.
#[derive(Default)]
struct Scenes {
    wish: Option<Wish>,
    drawn: BTreeMap<PictureKind, Result<Scene, String>>,
}

impl Scenes {
    /// Begins a request, keeping the scenes drawn for the previous one if they are equally valid.
    fn begin(&mut self, wish: &Wish) {
        let before = self.wish.replace(wish.clone());
        if !before.is_some_and(|before| before.has_scenes_of(wish)) {
            self.drawn.clear();
        }
    }
}

impl Studio {
    /// Starts drawing with the processor.
    pub fn new(source: &Source) -> Self {
        let archive = &source.archive;
        let warper: Arc<dyn Warper> = Arc::new(CpuWarper);
        let [strict, best_effort] = synthesizers(archive, &warper, false);
        let setup = archive.setup();
        let colors = SceneColors::new(setup, archive.field());
        Self {
            device: None,
            warper,
            is_clean: false,
            strict,
            best_effort,
            renderer: Renderer::new(setup, archive.field(), colors),
            staging: Staging::new(Arc::new(Synthesizer::new(archive.clone())), source.model.as_ref()),
            scenes: Scenes::default(),
            truth: None,
        }
    }

    /// Opens the device and the stage of a request, if they are different ones. Returns the problem if the device does not open.
    pub fn prepare(&mut self, wish: &Wish) -> Option<String> {
        let is_new_device = self.device != wish.device;
        if !is_new_device && self.is_clean == wish.is_clean {
            return None;
        }
        let mut problem = None;
        if is_new_device {
            self.device = wish.device.clone();
            self.warper = warper(self.device.as_ref()).unwrap_or_else(|reason| {
                problem = Some(format!("{reason}: pictures are drawn by the processor meanwhile"));
                Arc::new(CpuWarper)
            });
        }
        self.is_clean = wish.is_clean;
        let archive = self.strict.archive().clone();
        [self.strict, self.best_effort] = synthesizers(&archive, &self.warper, self.is_clean);
        problem
    }

    /// Returns the data around the pose of a request.
    pub fn around(&self, wish: &Wish) -> Around {
        let index = self.strict.archive().index();
        Around {
            nearest: index.nearest(wish.pose, 1).ok().and_then(|nearest| nearest.first().copied()),
            natural: index.natural(wish.pose).unwrap_or_default(),
            edges: wish.edges_in.map_or_else(Vec::new, |region| edges(index, wish.pose.yaw_rad, region)),
            probe: wish.probes.as_ref().and_then(|probes| probes.nearest(index.metric(), wish.pose)),
        }
    }

    /// Makes the picture of a pane.
    pub fn paint(&mut self, pane: Pane, wish: &Wish, probe: Option<NearProbe>) -> Result<Drawn, String> {
        self.scenes.begin(wish);
        let start = Instant::now();
        let kept = self.scenes.drawn.remove(&pane.kind);
        let is_new = kept.is_none();
        let scene = kept.unwrap_or_else(|| self.scene(pane.kind, wish, probe));
        let drawing_ms = is_new.then(|| milliseconds_since(start));
        let result = match &scene {
            Ok(scene) => self.finish(scene, pane, wish, drawing_ms),
            Err(reason) => Err(reason.clone()),
        };
        self.scenes.drawn.insert(pane.kind, scene);
        result
    }

    /// Puts things and labels into a scene, or shows where its pixels come from.
    fn finish(
        &mut self,
        scene: &Scene,
        pane: Pane,
        wish: &Wish,
        drawing_ms: Option<f64>,
    ) -> Result<Drawn, String> {
        let mut facts = Facts { times: Times { drawing_ms, ..Times::default() }, ..scene.facts.clone() };
        let plain = |picture, facts| Ok(Drawn { picture, facts, things: Vec::new(), marks: None });
        match (pane.aspect, &scene.reconstruction) {
            (Aspect::Picture, _) => {
                // What was really there stays as it was.
                let things = if pane.kind == PictureKind::Truth { &[] } else { &wish.things[..] };
                let scene_picture = scene.picture.clone();
                let Staged { picture, things, marks, things_ms, labels_ms } =
                    self.staging.stage(scene_picture, scene.pose, things, wish.is_labelled);
                facts.times = Times { things_ms, labels_ms, ..facts.times };
                Ok(Drawn { picture: color_image(&picture), facts, things, marks: marks.map(Arc::new) })
            }
            (Aspect::Origins, Some(reconstruction)) => {
                plain(color_image(&reconstruction.origin_picture()), facts)
            }
            (Aspect::Trust, Some(reconstruction)) => {
                plain(gray_image(&reconstruction.trust_picture()), facts)
            }
            (_, None) => {
                let words = "This picture is not made of recorded ones: choose another method, or show the picture itself.";
                Err(words.to_owned())
            }
        }
    }

    fn scene(&mut self, kind: PictureKind, wish: &Wish, probe: Option<NearProbe>) -> Result<Scene, String> {
        let mut scene = match kind.made_by() {
            MadeBy::Method(method) => {
                let synthesizer = if wish.is_best_effort { &self.best_effort } else { &self.strict };
                let reconstruction =
                    synthesizer.image_at(wish.pose, &method).map_err(|error| error.to_string())?;
                Scene::of(reconstruction, wish.pose)
            }
            MadeBy::Camera => self.true_picture(wish, probe)?,
            MadeBy::Renderer => {
                let picture = self.renderer.draw(wish.pose).map_err(|error| error.to_string())?;
                let facts = Facts { method: kind.name(), ..Facts::default() };
                Scene { picture, pose: wish.pose, reconstruction: None, facts }
            }
        };
        if kind != PictureKind::Truth {
            scene.facts.likeness_db = self.likeness_db(&scene.picture, wish, probe);
        }
        Ok(scene)
    }

    fn true_picture(&mut self, wish: &Wish, probe: Option<NearProbe>) -> Result<Scene, String> {
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
        Ok(Scene { picture, pose: near.pose, reconstruction: None, facts })
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

impl Scene {
    fn of(reconstruction: Reconstruction, pose: CameraPose) -> Self {
        let facts = Facts {
            method: reconstruction.method,
            covered: Some(reconstruction.covered()),
            used: reconstruction.used.clone(),
            ..Facts::default()
        };
        Self { picture: reconstruction.picture.clone(), pose, reconstruction: Some(reconstruction), facts }
    }
}

/// Returns the strict synthesizer and the best-effort one.
fn synthesizers(archive: &Arc<Archive>, warper: &Arc<dyn Warper>, is_clean: bool) -> [Synthesizer; 2] {
    let config = SynthesisConfig::new(archive);
    let camera = &archive.setup().camera;
    [config, config.best_effort()].map(|config| {
        let synthesizer = Synthesizer::with(archive.clone(), camera.clone(), warper.clone(), config);
        synthesizer.with_clean(is_clean)
    })
}

fn warper(device: Option<&Device>) -> Result<Arc<dyn Warper>, String> {
    let Some(device) = device else { return Ok(Arc::new(CpuWarper)) };
    let opened = device.open().and_then(|backend| backend.warper());
    opened.map_err(|error| format!("{}: {error}", device.name()))
}
