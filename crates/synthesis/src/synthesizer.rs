//! Pictures at any pose: finds the neighbours, decodes their pictures and calls the method.

use std::{fmt, sync::Arc};

use reality_sim_core::{
    camera::Camera,
    pose::CameraPose,
    warp::{
        BlendWeights, CpuWarper, Look, MAX_SOURCES, Origin, Picture, Placement, ProxyGeometry, RayTable,
        Source, Target, Warper, complete,
    },
};
use reality_sim_db::index::{ImageIndex, Neighbour};

use crate::{
    Archive, Provenance, SynthesisError,
    clean_view::CleanView,
    gain::gains,
    memory::{Choice, Memory},
    select::{all_costs, least_costly},
};

/// Settings of the synthesis.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SynthesisConfig {
    /// Number of neighbours that are mixed, at most [`reality_sim_core::warp::MAX_SOURCES`].
    pub sources: usize,
    /// Number of nearest images among which they are chosen.
    pub candidates: usize,
    /// Weights of the sources in a blend.
    pub weights: BlendWeights,
    /// Largest distance of the nearest image, root mean square pixels; beyond it a pose is refused.
    pub reach_px: f64,
    /// Smallest share of the pixels that recorded images must show, 0 to 1; otherwise a picture is refused.
    pub least_covered: f64,
}

impl SynthesisConfig {
    /// Default settings for an archive: recorded images must show at least two fifths of a picture.
    pub fn new(archive: &Archive) -> Self {
        let reach_px = archive.index().metric().diagonal_px();
        Self { sources: 6, candidates: 120, weights: BlendWeights::default(), reach_px, least_covered: 0.4 }
    }

    /// Sets the largest number of neighbours that are mixed.
    pub fn with_sources(self, sources: usize) -> Self {
        Self { sources, ..self }
    }

    /// Sets the number of nearest images among which neighbours are chosen.
    pub fn with_candidates(self, candidates: usize) -> Self {
        Self { candidates, ..self }
    }

    /// Sets the weights of a blend.
    pub fn with_weights(self, weights: BlendWeights) -> Self {
        Self { weights, ..self }
    }

    /// Sets the largest distance of the nearest image, root mean square pixels; beyond it a pose is refused.
    pub fn with_reach_px(self, reach_px: f64) -> Self {
        Self { reach_px, ..self }
    }

    /// Sets the smallest share of a picture that recorded images must show, 0 to 1.
    pub fn with_least_covered(self, least_covered: f64) -> Self {
        Self { least_covered, ..self }
    }

    /// Allows pictures wherever there is any image at all.
    pub fn best_effort(self) -> Self {
        Self { reach_px: f64::INFINITY, least_covered: 0.0, ..self }
    }

    /// Returns whether there are pictures wherever there is any image at all.
    pub fn is_best_effort(&self) -> bool {
        self.reach_px.is_infinite() && self.least_covered <= 0.0
    }
}

/// Source of pictures at any pose. Threads share one.
pub struct Synthesizer {
    archive: Arc<Archive>,
    camera: Camera,
    rays: RayTable,
    warper: Arc<dyn Warper>,
    config: SynthesisConfig,
    is_clean: bool,
}

impl fmt::Debug for Synthesizer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Synthesizer")
            .field("camera", &self.camera)
            .field("config", &self.config)
            .field("is_clean", &self.is_clean)
            .finish_non_exhaustive()
    }
}

impl Synthesizer {
    /// Makes pictures of the camera that took the archive's images, drawn on the processor.
    pub fn new(archive: Arc<Archive>) -> Self {
        let camera = archive.setup().camera.clone();
        let config = SynthesisConfig::new(&archive);
        Self::with(archive, camera, Arc::new(CpuWarper), config)
    }

    /// Makes pictures of another camera, on another device, or with other settings.
    pub fn with(
        archive: Arc<Archive>,
        camera: Camera,
        warper: Arc<dyn Warper>,
        config: SynthesisConfig,
    ) -> Self {
        let rays = RayTable::new(&camera);
        Self { archive, camera, rays, warper, config, is_clean: false }
    }

    /// Sets whether pictures are made without the people, robots and balls that stood there while the archive was recorded. Pictures
    /// then fail with [`SynthesisError::NoCleanStage`] where [`Archive::has_clean_stage`] returns false. Ground that no picture of the
    /// archive shows empty is filled from around it, without trust.
    pub fn with_clean(self, is_clean: bool) -> Self {
        Self { is_clean, ..self }
    }

    /// Returns whether pictures are made without what stood there.
    pub fn is_clean(&self) -> bool {
        self.is_clean
    }

    /// Returns the clean stage, if pictures are made with it.
    pub(crate) fn clean_view(&self) -> Result<Option<&CleanView>, SynthesisError> {
        self.is_clean.then(|| self.archive.clean_view()).transpose()
    }

    /// Returns a picture to draw from.
    pub(crate) fn picture(&self, image: ImageIndex) -> Result<Arc<Picture>, SynthesisError> {
        if self.is_clean { self.archive.masked_picture(image) } else { self.archive.picture(image) }
    }

    /// Fills what a picture seen from this pose does not show because something stood in front of it.
    pub(crate) fn fill_hidden(
        &self,
        pose: CameraPose,
        colors: &mut [[u8; 3]],
        origins: &mut [Origin],
    ) -> Result<(), SynthesisError> {
        let Some(view) = self.clean_view()? else { return Ok(()) };
        complete(&self.rays, colors, origins);
        let proxy = self.archive.proxy_geometry().holding(pose);
        view.fill(&self.target(pose, &proxy), colors, origins);
        Ok(())
    }

    /// Returns pictures to draw from.
    fn pictures(&self, images: &[ImageIndex]) -> Result<Vec<Arc<Picture>>, SynthesisError> {
        if self.is_clean { self.archive.masked_pictures(images) } else { self.archive.pictures(images) }
    }

    /// Returns the archive.
    pub fn archive(&self) -> &Arc<Archive> {
        &self.archive
    }

    /// Returns the camera whose pictures are drawn.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Returns the rays of its pixels.
    pub(crate) fn rays(&self) -> &RayTable {
        &self.rays
    }

    /// Returns the settings.
    pub fn config(&self) -> &SynthesisConfig {
        &self.config
    }

    /// Decodes the pictures that any method needs at this pose, so that a later call draws without delay.
    pub fn prepare(&self, pose: CameraPose) -> Result<(), SynthesisError> {
        let proxy = self.archive.proxy_geometry().holding(pose);
        let mut images = self.chosen(&Look::new(&self.target(pose, &proxy)), pose, self.config.sources)?;
        images.extend(self.nearest_of_size(pose).ok().map(|nearest| nearest.image));
        images.sort_unstable();
        images.dedup();
        self.pictures(&images).map(drop)
    }

    /// Returns the nearest images.
    pub fn nearest(&self, pose: CameraPose, count: usize) -> Result<Vec<Neighbour>, SynthesisError> {
        let found = self.archive.index().nearest(pose, count);
        found.map_err(|reason| SynthesisError::NoNeighbours { pose, reason })
    }

    /// Returns the nearest image in the size of the camera whose pictures are drawn; its lens may differ.
    pub(crate) fn nearest_of_size(&self, pose: CameraPose) -> Result<Neighbour, SynthesisError> {
        let size = |camera: &Camera| [camera.width, camera.height];
        let is_of_size =
            |neighbour: &Neighbour| size(self.archive.camera_of(neighbour.image)) == size(&self.camera);
        let found = self.nearest(pose, self.config.candidates)?.into_iter().find(is_of_size);
        let [width, height] = size(&self.camera);
        found.ok_or(SynthesisError::OtherSize { pose, width, height })
    }

    /// Draws the picture from at most this many neighbours through the proxy geometry.
    pub(crate) fn warped(
        &self,
        method: &'static str,
        pose: CameraPose,
        count: usize,
        memory: &mut Memory,
        colors: &mut [[u8; 3]],
    ) -> Result<Provenance, SynthesisError> {
        let proxy = self.archive.proxy_geometry().holding(pose);
        let target = self.target(pose, &proxy);
        let metric = self.archive.index().metric();
        let is_kept = memory.kept(metric, pose, count).is_some();
        let (Choice { images, gains, .. }, pictures) = self.choice(&target, pose, count, memory)?;
        let sources = self.sources(&images, &pictures, &gains);
        let mut origins = self.warper.blend_into(&target, &sources, &self.config.weights, colors)?;
        if let Some(view) = self.clean_view()? {
            view.fill(&target, colors, &mut origins);
        }
        let distance_px =
            |image: ImageIndex| metric.distance_px(self.archive.images()[image as usize].pose, pose);
        let used = images.iter().map(|&image| (image, distance_px(image)));
        let provenance = Provenance::new(method, used, origins, &self.rays);
        let (covered, needed) = (provenance.covered(), self.config.least_covered);
        if covered >= needed {
            return Ok(provenance);
        }
        if is_kept {
            // Others may show more.
            memory.forget();
            return self.warped(method, pose, count, memory, colors);
        }
        Err(SynthesisError::TooLittleSeen { pose, covered, needed })
    }

    /// Hands what a blended picture at a pose is made from to a device of one's own: the camera, the neighbours with their gains,
    /// and their weights. For pictures that stay on a graphics device; whether enough of the picture was recorded is not checked,
    /// and of a clean stage the masks are used, not the ground.
    pub fn draw_with<T>(
        &self,
        pose: CameraPose,
        memory: &mut Memory,
        draw: impl FnOnce(&Target, &[Source], &BlendWeights) -> T,
    ) -> Result<T, SynthesisError> {
        self.check(pose)?;
        let proxy = self.archive.proxy_geometry().holding(pose);
        let target = self.target(pose, &proxy);
        let (Choice { images, gains, .. }, pictures) =
            self.choice(&target, pose, self.config.sources, memory)?;
        Ok(draw(&target, &self.sources(&images, &pictures, &gains), &self.config.weights))
    }

    /// Returns the neighbours that a memory keeps for a pose, or chooses others; with their pictures.
    fn choice(
        &self,
        target: &Target,
        pose: CameraPose,
        count: usize,
        memory: &mut Memory,
    ) -> Result<(Choice, Vec<Arc<Picture>>), SynthesisError> {
        if let Some(kept) = memory.kept(self.archive.index().metric(), pose, count) {
            return Ok((kept.clone(), self.pictures(&kept.images)?));
        }
        let (choice, pictures) = self.choose(target, pose, count)?;
        memory.keep(choice.clone());
        Ok((choice, pictures))
    }

    fn sources<'a>(
        &'a self,
        images: &[ImageIndex],
        pictures: &'a [Arc<Picture>],
        gains: &[[f32; 3]],
    ) -> Vec<Source<'a>> {
        let parts = images.iter().zip(pictures).zip(gains);
        parts
            .map(|((&image, picture), &gain)| Source { gain, ..self.archive.source(image, picture) })
            .collect()
    }

    fn target<'a>(&'a self, pose: CameraPose, proxy: &'a ProxyGeometry) -> Target<'a> {
        Target { rays: &self.rays, placement: Placement::new(pose), proxy }
    }

    /// Chooses the neighbours to draw from, and measures how bright they are.
    fn choose(
        &self,
        target: &Target,
        pose: CameraPose,
        count: usize,
    ) -> Result<(Choice, Vec<Arc<Picture>>), SynthesisError> {
        let look = Look::new(target);
        let images = self.chosen(&look, pose, count)?;
        let pictures = self.pictures(&images)?;
        let sources: Vec<Source> = images
            .iter()
            .zip(&pictures)
            .map(|(&image, picture)| self.archive.source(image, picture))
            .collect();
        let gains = if sources.len() > 1 { gains(&look, &sources) } else { vec![[1.0; 3]; sources.len()] };
        Ok((Choice { pose, count, images, gains }, pictures))
    }

    /// Chooses the neighbours to draw from: those of the nearest and the natural ones that together show most.
    fn chosen(&self, look: &Look, pose: CameraPose, count: usize) -> Result<Vec<ImageIndex>, SynthesisError> {
        let mut candidates = self.nearest(pose, self.config.candidates)?;
        let natural = self.archive.index().natural(pose);
        for natural in natural.map_err(|reason| SynthesisError::NoNeighbours { pose, reason })? {
            if candidates.iter().all(|candidate| candidate.image != natural.image) {
                candidates.push(natural);
            }
        }
        // The choice depends on where an image was taken and on its mask, not on what it shows.
        let nothing = Archive::no_picture();
        let sources: Vec<Source> =
            candidates.iter().map(|candidate| self.archive.source(candidate.image, &nothing)).collect();
        let view = self.clean_view()?;
        let costs = all_costs(look, &sources, &self.config.weights, |index, costs| {
            if let Some(view) = view {
                view.raise_costs(look, &sources[index], candidates[index].image, costs);
            }
        });
        let chosen = least_costly(&costs, count.clamp(1, MAX_SOURCES));
        Ok(chosen.into_iter().map(|index| candidates[index].image).collect())
    }
}
