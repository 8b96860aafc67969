//! Pictures at any pose: finds the neighbours, decodes their pictures and calls the method.

use std::{fmt, sync::Arc};

use reality_sim_core::{
    camera::Camera,
    pose::CameraPose,
    warp::{
        BlendWeights, CpuWarper, MAX_SOURCES, Placement, ProxyGeometry, RayTable, Source, Target, Warper,
    },
};
use reality_sim_db::index::{ImageIndex, Neighbour};

use crate::{Archive, Provenance, SynthesisError, gain::gains, select::select};

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
}

/// Source of pictures at any pose. Threads share one.
pub struct Synthesizer {
    archive: Arc<Archive>,
    camera: Camera,
    rays: RayTable,
    warper: Arc<dyn Warper>,
    config: SynthesisConfig,
}

impl fmt::Debug for Synthesizer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Synthesizer")
            .field("camera", &self.camera)
            .field("config", &self.config)
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
        Self { archive, camera, rays, warper, config }
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
        let images = self.chosen(&self.target(pose, &proxy), pose, self.config.sources)?;
        let mut images: Vec<ImageIndex> = images.iter().map(|neighbour| neighbour.image).collect();
        images.extend(self.nearest_of_size(pose).ok().map(|nearest| nearest.image));
        images.sort_unstable();
        images.dedup();
        self.archive.pictures(&images).map(drop)
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
        colors: &mut [[u8; 3]],
    ) -> Result<Provenance, SynthesisError> {
        let proxy = self.archive.proxy_geometry().holding(pose);
        let target = self.target(pose, &proxy);
        let chosen = self.chosen(&target, pose, count)?;
        let images: Vec<ImageIndex> = chosen.iter().map(|neighbour| neighbour.image).collect();
        let pictures = self.archive.pictures(&images)?;
        let mut sources: Vec<Source> = images
            .iter()
            .zip(&pictures)
            .map(|(&image, picture)| self.archive.source(image, picture))
            .collect();
        if sources.len() > 1 {
            let gains = gains(&target, &sources);
            sources.iter_mut().zip(gains).for_each(|(source, gain)| source.gain = gain);
        }
        let origins = self.warper.blend_into(&target, &sources, &self.config.weights, colors)?;
        let images = chosen.iter().map(|neighbour| (neighbour.image, neighbour.distance_px));
        let provenance = Provenance::new(method, images, origins, &self.rays);
        let (covered, needed) = (provenance.covered(), self.config.least_covered);
        if covered < needed {
            return Err(SynthesisError::TooLittleSeen { pose, covered, needed });
        }
        Ok(provenance)
    }

    fn target<'a>(&'a self, pose: CameraPose, proxy: &'a ProxyGeometry) -> Target<'a> {
        Target { rays: &self.rays, placement: Placement::new(pose), proxy }
    }

    /// Chooses the neighbours to draw from: those of the nearest and the natural ones that together show most.
    fn chosen(
        &self,
        target: &Target,
        pose: CameraPose,
        count: usize,
    ) -> Result<Vec<Neighbour>, SynthesisError> {
        let mut candidates = self.nearest(pose, self.config.candidates)?;
        let natural = self.archive.index().natural(pose);
        for natural in natural.map_err(|reason| SynthesisError::NoNeighbours { pose, reason })? {
            if candidates.iter().all(|candidate| candidate.image != natural.image) {
                candidates.push(natural);
            }
        }
        // The choice depends on where an image was taken, not on what it shows.
        let nothing = Archive::no_picture();
        let sources: Vec<Source> =
            candidates.iter().map(|candidate| self.archive.source(candidate.image, &nothing)).collect();
        let chosen = select(target, &sources, &self.config.weights, count.clamp(1, MAX_SOURCES));
        Ok(chosen.into_iter().map(|index| candidates[index]).collect())
    }
}
