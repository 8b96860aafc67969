//! Database opened for pictures at any pose: records, index by pose, and the pictures decoded last.

use std::{
    collections::BTreeMap,
    path::Path,
    sync::{Arc, OnceLock},
};

use image::RgbImage;
use rayon::prelude::*;
use reality_sim_core::{
    camera::{Camera, KernelCamera},
    field::FieldDimensions,
    pose::CameraPose,
    sequence::CameraSetup,
    statistics::median,
    warp::{Hall, Picture, Placement, ProxyGeometry, Source},
};
use reality_sim_db::{
    Database, ImageRecord,
    index::{ImageIndex, PoseIndex},
    metric::PixelMetric,
};

use reality_sim_sensor::{Model, ModelError, Shading};

use crate::{
    SynthesisError,
    cache::{PictureCache, PictureKey},
    clean_view::CleanView,
};

/// Recorded images, indexed by pose. Threads share one archive.
#[derive(Debug)]
pub struct Archive {
    database: Database,
    images: Vec<ImageRecord>,
    cameras: BTreeMap<i64, (Camera, KernelCamera)>,
    setup: CameraSetup,
    field: FieldDimensions,
    proxy: ProxyGeometry,
    index: PoseIndex,
    /// Medians over all images, which take long to find among a million.
    usual_pose: CameraPose,
    cache: PictureCache,
    shading: Option<Shading>,
    corrected_by: Option<String>,
    has_clean_stage: bool,
    /// Clean stage, once it was needed.
    clean_view: OnceLock<CleanView>,
}

impl Archive {
    /// Opens a database without decoding any picture. Decoded pictures take at most `cache_bytes`.
    ///
    /// If a database holds recordings of several fields, only the images of the field that most images show are used.
    pub fn open(path: &Path, cache_bytes: usize) -> Result<Self, SynthesisError> {
        let (database, images) = read(path)?;
        let field_id = most_common(images.iter().map(|image| image.field_id)).ok_or_else(|| empty(path))?;
        Self::of_field(database, images, field_id, cache_bytes)
    }

    /// Opens the part of a database that shows a field, as [`Archive::open`] does.
    pub fn open_field(path: &Path, field_id: i64, cache_bytes: usize) -> Result<Self, SynthesisError> {
        let (database, images) = read(path)?;
        Self::of_field(database, images, field_id, cache_bytes)
    }

    fn of_field(
        database: Database,
        mut images: Vec<ImageRecord>,
        field_id: i64,
        cache_bytes: usize,
    ) -> Result<Self, SynthesisError> {
        let empty = || empty(database.path());
        images.retain(|image| image.field_id == field_id);
        let field = database.fields()?.remove(&field_id).ok_or_else(empty)?;
        let mut setups = database.cameras()?;
        let cameras = setups
            .iter()
            .map(|(&id, CameraSetup { camera, .. })| (id, (camera.clone(), KernelCamera::new(camera))));
        let cameras = cameras.collect();
        let camera_id = most_common(images.iter().map(|image| image.camera_id)).ok_or_else(empty)?;
        let setup = setups.remove(&camera_id).ok_or_else(empty)?;
        let corrected_by = database.models()?.remove(&camera_id);
        let poses: Vec<CameraPose> = images.iter().map(|image| image.pose).collect();
        let usual_pose = usual_pose(&poses);
        let metric = PixelMetric::new(&setup.camera, usual_pose, &field)
            .ok_or_else(|| SynthesisError::BlindCamera { database: database.path().display().to_string() })?;
        let hall = database.halls()?.remove(&field_id).unwrap_or_else(|| Hall::usual(&field));
        let proxy = ProxyGeometry::new(&hall, &field);
        let proxy = poses.iter().fold(proxy, |proxy, pose| proxy.holding(*pose));
        let index = PoseIndex::new(metric, poses);
        let cache = PictureCache::new(cache_bytes);
        let (shading, clean_view) = (None, OnceLock::new());
        let has_clean_stage = database.has_ground(field_id)?;
        Ok(Self {
            database,
            images,
            cameras,
            setup,
            field,
            proxy,
            index,
            usual_pose,
            cache,
            shading,
            corrected_by,
            has_clean_stage,
            clean_view,
        })
    }

    /// Takes what a model says of the lens's falloff and of gains out of the recorded pictures, so that neighbours meet
    /// without seams, and puts the falloff into those that are made. Fails where the model leaves no valid camera.
    pub fn with_model(self, model: &Model) -> Result<Self, ModelError> {
        let rest = self.missing_of(model).corrected(&self.setup, &self.field)?;
        let cache = PictureCache::new(self.cache.limit_bytes());
        Ok(Self { shading: Shading::new(rest.chain()), cache, ..self })
    }

    /// Returns the part of a model that the archive does not contain yet: all of it, or, where the recordings were corrected
    /// before they were stored, what it says of light and simulated pictures.
    pub fn missing_of(&self, model: &Model) -> Model {
        match self.corrected_by {
            Some(_) => model.without_corrected(&self.setup, &self.field),
            None => model.clone(),
        }
    }

    /// Returns the shading that is taken out of pictures of a camera, if there is one.
    pub(crate) fn shading_of(&self, camera: &Camera) -> Option<&Shading> {
        self.shading.as_ref().filter(|shading| shading.size() == [camera.width, camera.height])
    }

    /// Returns the text of the model by which the recordings of [`Archive::setup`] were corrected before they were stored, if
    /// there was one.
    pub fn corrected_by(&self) -> Option<&str> {
        self.corrected_by.as_deref()
    }

    /// Returns the database that was opened.
    pub fn database(&self) -> &Database {
        &self.database
    }

    /// Returns the records of the images, in the order of [`ImageIndex`].
    pub fn images(&self) -> &[ImageRecord] {
        &self.images
    }

    /// Returns the camera that took most of the images.
    pub fn setup(&self) -> &CameraSetup {
        &self.setup
    }

    /// Returns the field that the images show.
    pub fn field(&self) -> &FieldDimensions {
        &self.field
    }

    /// Returns the geometry that stands for the world around the field.
    pub fn proxy_geometry(&self) -> &ProxyGeometry {
        &self.proxy
    }

    /// Returns the index of images by pose.
    pub fn index(&self) -> &PoseIndex {
        &self.index
    }

    /// Size of the decoded pictures that are held, bytes.
    pub fn cached_bytes(&self) -> usize {
        self.cache.bytes()
    }

    /// Returns a pose with the camera's usual height, pitch and roll: the medians over all images.
    pub fn usual_pose(&self) -> CameraPose {
        self.usual_pose
    }

    /// Returns whether the database holds what pictures without people, robots and balls need, see
    /// [`crate::Synthesizer::with_clean`].
    pub fn has_clean_stage(&self) -> bool {
        self.has_clean_stage
    }

    /// Returns the clean stage, and reads it if necessary.
    pub(crate) fn clean_view(&self) -> Result<&CleanView, SynthesisError> {
        if let Some(view) = self.clean_view.get() {
            return Ok(view);
        }
        let none = || SynthesisError::NoCleanStage { database: self.database.path().display().to_string() };
        let field_id = self.images.first().map(|image| image.field_id).ok_or_else(none)?;
        let view = CleanView::read(&self.database, field_id, &self.images)?.ok_or_else(none)?;
        Ok(self.clean_view.get_or_init(|| view))
    }

    /// Returns a picture, decoding it if necessary.
    ///
    /// # Panics
    ///
    /// Panics if there is no such image: indices come from [`Archive::index`].
    pub fn picture(&self, image: ImageIndex) -> Result<Arc<Picture>, SynthesisError> {
        let decode = || Ok(Picture::from(&self.decoded(image)?));
        self.cache.get(PictureKey { image, is_masked: false }, decode)
    }

    /// Returns a picture in which the things that it shows are hidden, decoding it if necessary.
    pub(crate) fn masked_picture(&self, image: ImageIndex) -> Result<Arc<Picture>, SynthesisError> {
        let Some(mask) = self.clean_view()?.mask(image) else { return self.picture(image) };
        let decode = || {
            let mut picture = Picture::from(&self.decoded(image)?);
            let size = [picture.width, picture.height];
            picture.hide(|pixel| mask.hides([pixel as u32 % size[0], pixel as u32 / size[0]], size));
            Ok(picture)
        };
        self.cache.get(PictureKey { image, is_masked: true }, decode)
    }

    /// Decodes a picture. It does not stay in the cache.
    pub(crate) fn decoded(&self, image: ImageIndex) -> Result<RgbImage, SynthesisError> {
        let (record, camera) = (&self.images[image as usize], self.camera_of(image));
        let mut picture = self.database.picture_of_size(record.id, [camera.width, camera.height])?;
        if let Some(shading) = self.shading_of(camera) {
            let (colors, _) = picture.as_chunks_mut();
            shading.take_out(colors, record.timestamp_s);
        }
        Ok(picture)
    }

    /// Returns several pictures; those that are not held are decoded in parallel.
    pub fn pictures(&self, images: &[ImageIndex]) -> Result<Vec<Arc<Picture>>, SynthesisError> {
        images.par_iter().with_max_len(1).map(|&image| self.picture(image)).collect()
    }

    /// Works like [`Archive::pictures`], with the things that the pictures show hidden.
    pub(crate) fn masked_pictures(&self, images: &[ImageIndex]) -> Result<Vec<Arc<Picture>>, SynthesisError> {
        images.par_iter().with_max_len(1).map(|&image| self.masked_picture(image)).collect()
    }

    /// Returns the camera that took an image.
    ///
    /// # Panics
    ///
    /// Panics if there is no such image, like [`Archive::picture`].
    pub fn camera_of(&self, image: ImageIndex) -> &Camera {
        &self.cameras[&self.images[image as usize].camera_id].0
    }

    /// Makes a placeholder where only the pose of a picture matters.
    pub(crate) fn no_picture() -> Arc<Picture> {
        Arc::new(Picture { width: 0, height: 0, pixels: Vec::new() })
    }

    /// Makes an image a source for a warp.
    pub(crate) fn source<'a>(&'a self, image: ImageIndex, picture: &'a Arc<Picture>) -> Source<'a> {
        let record = &self.images[image as usize];
        Source {
            camera: &self.cameras[&record.camera_id].1,
            placement: Placement::new(record.pose),
            picture,
            gain: [1.0; 3],
        }
    }
}

/// Opens a database, and reads the records of its images.
fn read(path: &Path) -> Result<(Database, Vec<ImageRecord>), SynthesisError> {
    let database = Database::open(path)?;
    let images = database.images()?;
    Ok((database, images))
}

fn empty(path: &Path) -> SynthesisError {
    SynthesisError::Empty { database: path.display().to_string() }
}

fn most_common(ids: impl Iterator<Item = i64>) -> Option<i64> {
    let mut counts: BTreeMap<i64, usize> = BTreeMap::new();
    ids.for_each(|id| *counts.entry(id).or_default() += 1);
    // Among equals the first one wins.
    counts.into_iter().max_by_key(|(id, count)| (*count, std::cmp::Reverse(*id))).map(|(id, _)| id)
}

fn usual_pose(poses: &[CameraPose]) -> CameraPose {
    let median = |of: fn(&CameraPose) -> f64| median(poses.iter().map(of));
    CameraPose {
        height_m: median(|pose| pose.height_m),
        pitch_rad: median(|pose| pose.pitch_rad),
        roll_rad: median(|pose| pose.roll_rad),
        ..Default::default()
    }
}
