//! A picture at any pose: the neighbours are found, their pictures decoded, the method draws.

use std::{fmt, sync::Arc};

use image::RgbImage;
use reality_sim_core::{
    camera::Camera,
    pose::CameraPose,
    warp::{
        BlendWeights, CpuWarper, MAX_SOURCES, Placement, ProxyGeometry, RayTable, Source, Target, Warper,
    },
};
use reality_sim_db::index::{ImageIndex, Neighbour};

use crate::{Archive, Reconstruction, SynthesisError, gain::gains, select::select};

/// How pictures are made.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SynthesisConfig {
    /// Neighbours that are mixed, at most [`reality_sim_core::warp::MAX_SOURCES`].
    pub sources: usize,
    /// Nearest images among which they are chosen.
    pub candidates: usize,
    /// How they are weighed against each other.
    pub weights: BlendWeights,
    /// No picture is given where the nearest image is farther, root mean square pixels.
    pub reach_px: f64,
    /// No picture is drawn of which recorded images show a smaller share, 0 to 1.
    pub least_covered: f64,
}

impl SynthesisConfig {
    /// For an archive: pictures are given where recorded images show at least two fifths of them.
    pub fn new(archive: &Archive) -> Self {
        let reach_px = archive.index().metric().diagonal_px();
        Self { sources: 6, candidates: 120, weights: BlendWeights::default(), reach_px, least_covered: 0.4 }
    }

    /// The same, mixing at most so many neighbours.
    pub fn with_sources(self, sources: usize) -> Self {
        Self { sources, ..self }
    }

    /// The same, choosing among so many of the nearest images.
    pub fn with_candidates(self, candidates: usize) -> Self {
        Self { candidates, ..self }
    }

    /// The same, with neighbours weighed otherwise.
    pub fn with_weights(self, weights: BlendWeights) -> Self {
        Self { weights, ..self }
    }

    /// The same, refusing poses whose nearest image is farther, root mean square pixels.
    pub fn with_reach_px(self, reach_px: f64) -> Self {
        Self { reach_px, ..self }
    }

    /// The same, refusing pictures of which recorded images show a smaller share, 0 to 1.
    pub fn with_least_covered(self, least_covered: f64) -> Self {
        Self { least_covered, ..self }
    }

    /// The same, with pictures wherever there is any image at all.
    pub fn best_effort(self) -> Self {
        Self { reach_px: f64::INFINITY, least_covered: 0.0, ..self }
    }
}

/// Gives pictures at any pose. Threads share one.
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
    /// Pictures of the camera that took the archive's images, drawn by the processor.
    pub fn new(archive: Arc<Archive>) -> Self {
        let camera = archive.setup().camera.clone();
        let config = SynthesisConfig::new(&archive);
        Self::with(archive, camera, Arc::new(CpuWarper), config)
    }

    /// Pictures of another camera, drawn on another device, or with other settings.
    pub fn with(
        archive: Arc<Archive>,
        camera: Camera,
        warper: Arc<dyn Warper>,
        config: SynthesisConfig,
    ) -> Self {
        let rays = RayTable::new(&camera);
        Self { archive, camera, rays, warper, config }
    }

    /// What was recorded.
    pub fn archive(&self) -> &Arc<Archive> {
        &self.archive
    }

    /// The camera whose pictures are drawn.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Its pixels' rays.
    pub(crate) fn rays(&self) -> &RayTable {
        &self.rays
    }

    /// The settings.
    pub fn config(&self) -> &SynthesisConfig {
        &self.config
    }

    /// Decodes the pictures that a picture at this pose is made from, by whichever method, so that it is drawn without
    /// delay later.
    pub fn prepare(&self, pose: CameraPose) -> Result<(), SynthesisError> {
        let proxy = self.archive.proxy_geometry().holding(pose);
        let images = self.chosen(&self.target(pose, &proxy), pose, self.config.sources)?;
        let mut images: Vec<ImageIndex> = images.iter().map(|neighbour| neighbour.image).collect();
        images.extend(self.nearest_of_size(pose).ok().map(|nearest| nearest.image));
        images.sort_unstable();
        images.dedup();
        self.archive.pictures(&images).map(drop)
    }

    /// The nearest images.
    pub fn nearest(&self, pose: CameraPose, count: usize) -> Result<Vec<Neighbour>, SynthesisError> {
        let found = self.archive.index().nearest(pose, count);
        found.map_err(|reason| SynthesisError::NoNeighbours { pose, reason })
    }

    /// The nearest image in the size of the camera whose pictures are drawn; its lens may be another.
    pub(crate) fn nearest_of_size(&self, pose: CameraPose) -> Result<Neighbour, SynthesisError> {
        let size = |camera: &Camera| [camera.width, camera.height];
        let is_of_size =
            |neighbour: &Neighbour| size(self.archive.camera_of(neighbour.image)) == size(&self.camera);
        let found = self.nearest(pose, self.config.candidates)?.into_iter().find(is_of_size);
        let [width, height] = size(&self.camera);
        found.ok_or(SynthesisError::OtherSize { pose, width, height })
    }

    /// The picture drawn from so many neighbours through the proxy geometry.
    pub(crate) fn warped(
        &self,
        method: &'static str,
        pose: CameraPose,
        count: usize,
    ) -> Result<Reconstruction, SynthesisError> {
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
        let warped = self.warper.blend(&target, &sources, &self.config.weights)?;
        let picture = picture_of(&self.camera, warped.colors);
        let images = chosen.iter().map(|neighbour| (neighbour.image, neighbour.distance_px));
        let reconstruction = Reconstruction::new(picture, method, images, warped.origins, &self.rays);
        let (covered, needed) = (reconstruction.covered(), self.config.least_covered);
        if covered < needed {
            return Err(SynthesisError::TooLittleSeen { pose, covered, needed });
        }
        Ok(reconstruction)
    }

    fn target<'a>(&'a self, pose: CameraPose, proxy: &'a ProxyGeometry) -> Target<'a> {
        Target { rays: &self.rays, placement: Placement::new(pose), proxy }
    }

    /// The neighbours to draw from: of the nearest and the natural ones those that together show most.
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
        // Where an image was taken decides whether it is chosen, not what it shows.
        let nothing = Archive::no_picture();
        let sources: Vec<Source> =
            candidates.iter().map(|candidate| self.archive.source(candidate.image, &nothing)).collect();
        let chosen = select(target, &sources, &self.config.weights, count.clamp(1, MAX_SOURCES));
        Ok(chosen.into_iter().map(|index| candidates[index]).collect())
    }
}

/// Colours as a picture of a camera.
pub(crate) fn picture_of(camera: &Camera, colors: Vec<[u8; 3]>) -> RgbImage {
    // A colour a pixel of the camera: there are as many as the picture holds.
    RgbImage::from_raw(camera.width, camera.height, colors.into_flattened()).unwrap_or_default()
}
