//! Pictures reconstructed at true poses, compared with those that were taken there.

use std::{collections::BTreeMap, path::Path, sync::Arc};

use anyhow::Context;
use image::RgbImage;
use reality_sim::{
    Archive, CameraPose, Localizer, LocalizerConfig, Observation, Sequence, Synthesizer,
    evaluation::{ErrorStatistics, PoseError},
    montage::grid,
    pose::Motion2,
    probing::{MethodReport, ProbeResult, compare_methods, names},
    sensor::{Renderer, SceneColors},
    sequence::save_image,
};

use crate::{databases::Built, recording::Recordings};

/// Memory for decoded pictures, bytes.
const CACHE_BYTES: usize = 256 << 20;
/// Where the filter starts, against the true pose.
const START_OFF: Motion2 = Motion2 { forward_m: 0.04, left_m: -0.03, turn_rad: 0.05 };
/// Number of pictures of a route that are shown.
const SHOWN: usize = 6;
/// Width of a picture that is shown, pixels.
const WIDTH: u32 = 240;
/// Methods in whose pictures the filter looks for the pose: the paper's and the best.
const LOCALIZED: [&str; 2] = ["quadratic", METHOD];
/// Method that is shown.
const METHOD: &str = "blend";

/// Figures of a route's pictures made from one database.
pub struct Route {
    pub name: &'static str,
    pub pictures: usize,
    pub methods: BTreeMap<&'static str, Figures>,
    /// Errors of the poses found in the true pictures.
    pub true_error: Error,
    /// Pictures to show: made by [`METHOD`], and drawn.
    shown: [Vec<RgbImage>; 2],
}

/// Means over the pictures of one method.
pub struct Figures {
    pub psnr_field_db: f64,
    pub psnr_db: f64,
    pub error: Option<Error>,
}

/// Errors of poses.
pub struct Error(ErrorStatistics);

impl Error {
    fn new(errors: &[PoseError]) -> anyhow::Result<Self> {
        Ok(Self(ErrorStatistics::new(errors).context("a route has no pictures")?))
    }

    pub fn words(&self) -> String {
        format!("{:.3} cm, {:.3} cm", 100.0 * self.0.mean_m, 100.0 * self.0.median_m)
    }
}

/// Reconstructs both routes from a database.
pub fn measure(recordings: &Recordings, built: &Built) -> anyhow::Result<[Route; 2]> {
    let synthesizer = Synthesizer::new(Arc::new(Archive::open(&built.path, CACHE_BYTES)?));
    Ok([
        route("A grid of 30 cm", &recordings.grid, &synthesizer)?,
        route("A straight crossing", &recordings.crossing, &synthesizer)?,
    ])
}

fn route(name: &'static str, truth: &Sequence, synthesizer: &Synthesizer) -> anyhow::Result<Route> {
    let renderer = Renderer::new(&truth.setup, &truth.field, SceneColors::new(&truth.setup, &truth.field));
    let mut finder = Finder::new(truth)?;
    let mut probes: Vec<ProbeResult> = Vec::new();
    let mut errors: BTreeMap<&'static str, Vec<PoseError>> = BTreeMap::new();
    let mut true_errors = Vec::new();
    let mut shown = [Vec::new(), Vec::new()];
    let chosen = chosen(truth.frames.len());
    for (index, pose) in truth.reference_poses().enumerate() {
        let pose = pose.context("a picture of a route has no true pose")?;
        let mut probe = compare_methods(synthesizer, &renderer, index, pose, truth.load_image(index)?)?;
        true_errors.push(finder.error(index, pose, &probe.truth)?);
        for (method, outcome) in probe.outcomes.iter().filter(|(method, _)| LOCALIZED.contains(method)) {
            errors.entry(method).or_default().push(finder.error(index, pose, &outcome.picture)?);
        }
        if chosen.contains(&index) {
            for (method, shown) in [METHOD, Renderer::NAME].into_iter().zip(&mut shown) {
                shown.extend(probe.outcomes.get(method).map(|outcome| outcome.picture.clone()));
            }
        }
        // Only the figures are needed from here on: the pictures of a route are a gigabyte.
        probe.truth = RgbImage::default();
        probe.outcomes.values_mut().for_each(|outcome| outcome.picture = RgbImage::default());
        probes.push(probe);
    }
    let mut methods = BTreeMap::new();
    for method in names() {
        let report = MethodReport::new(method, &probes);
        let Some(psnr_db) = report.psnr_db else { continue };
        let error = errors.get(method).map(|errors| Error::new(errors)).transpose()?;
        let psnr_field_db = report.psnr_field_db.unwrap_or(f64::NAN);
        methods.insert(method, Figures { psnr_field_db, psnr_db, error });
    }
    Ok(Route { name, pictures: probes.len(), methods, true_error: Error::new(&true_errors)?, shown })
}

/// Filter that is started near the true pose of each picture.
struct Finder<'a> {
    route: &'a Sequence,
    localizer: Localizer,
}

impl<'a> Finder<'a> {
    fn new(route: &'a Sequence) -> anyhow::Result<Self> {
        let config = LocalizerConfig::default().with_relocalization(false);
        let builder = Localizer::builder(&route.setup.camera, &route.field).config(config);
        Ok(Self { route, localizer: builder.build()? })
    }

    /// Returns the error of the pose that is found in a picture taken or made at a pose of the route.
    fn error(&mut self, index: usize, pose: CameraPose, picture: &RgbImage) -> anyhow::Result<PoseError> {
        self.localizer.reset(Some(pose.planar().moved(START_OFF)));
        let observation = Observation::of_frame(self.route, index, Arc::new(picture.clone()));
        Ok(PoseError::new(self.localizer.update(&observation)?.pose, pose))
    }
}

/// Returns the numbers of the pictures that are shown.
fn chosen(pictures: usize) -> Vec<usize> {
    (0..SHOWN).map(|number| number * pictures.saturating_sub(1) / (SHOWN - 1)).collect()
}

/// Puts true pictures, those made from both databases, and drawn ones below each other.
pub fn show(route: &Sequence, tags: &Route, truth: &Route, file: &Path) -> anyhow::Result<()> {
    let taken = chosen(route.frames.len()).into_iter().map(|index| route.load_image(index));
    let taken = taken.collect::<Result<Vec<_>, _>>()?;
    let [by_tags, drawn] = &tags.shown;
    Ok(save_image(file, &grid(&[&taken, by_tags, &truth.shown[0], drawn], WIDTH))?)
}
