//! Database opened for pictures at any pose: records, index by pose, and the pictures decoded last.

use std::{collections::BTreeMap, path::Path, sync::Arc};

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

use crate::{SynthesisError, cache::PictureCache};

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
    cache: PictureCache,
}

impl Archive {
    /// Opens a database without decoding any picture. Decoded pictures take at most `cache_bytes`.
    ///
    /// If a database holds recordings of several fields, only the images of the field that most images show are used.
    pub fn open(path: &Path, cache_bytes: usize) -> Result<Self, SynthesisError> {
        let database = Database::open(path)?;
        let mut images = database.images()?;
        let empty = || SynthesisError::Empty { database: path.display().to_string() };
        let field_id = most_common(images.iter().map(|image| image.field_id)).ok_or_else(empty)?;
        images.retain(|image| image.field_id == field_id);
        let field = database.fields()?.remove(&field_id).ok_or_else(empty)?;
        let mut setups = database.cameras()?;
        let cameras = setups
            .iter()
            .map(|(&id, CameraSetup { camera, .. })| (id, (camera.clone(), KernelCamera::new(camera))));
        let cameras = cameras.collect();
        let camera_id = most_common(images.iter().map(|image| image.camera_id)).ok_or_else(empty)?;
        let setup = setups.remove(&camera_id).ok_or_else(empty)?;
        let poses: Vec<CameraPose> = images.iter().map(|image| image.pose).collect();
        let metric = PixelMetric::new(&setup.camera, usual_pose(&poses), &field)
            .ok_or_else(|| SynthesisError::BlindCamera { database: path.display().to_string() })?;
        let hall = database.halls()?.remove(&field_id).unwrap_or_else(|| Hall::usual(&field));
        let proxy = ProxyGeometry::new(&hall, &field);
        let proxy = poses.iter().fold(proxy, |proxy, pose| proxy.holding(*pose));
        let index = PoseIndex::new(metric, poses);
        let cache = PictureCache::new(cache_bytes);
        Ok(Self { database, images, cameras, setup, field, proxy, index, cache })
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
        usual_pose(self.index.poses())
    }

    /// Returns a picture, decoding it if necessary.
    ///
    /// # Panics
    ///
    /// Panics if there is no such image: indices come from [`Archive::index`].
    pub fn picture(&self, image: ImageIndex) -> Result<Arc<Picture>, SynthesisError> {
        let decode = || Ok(Picture::from(&self.database.picture(self.images[image as usize].id)?));
        self.cache.get(image, decode)
    }

    /// Returns several pictures; those that are not held are decoded in parallel.
    pub fn pictures(&self, images: &[ImageIndex]) -> Result<Vec<Arc<Picture>>, SynthesisError> {
        images.par_iter().with_max_len(1).map(|&image| self.picture(image)).collect()
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
