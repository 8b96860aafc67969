//! What a data set was made with, so that a later run goes on only with the same.

use reality_sim_core::sequence::CameraSetup;
use reality_sim_db::DbError;
use reality_sim_sensor::Model;
use reality_sim_synthesis::Archive;
use serde::Serialize;
use serde_json::{Map, Value};

use super::{DatasetError, DatasetSettings, DatasetSource};

/// Name of the file in the data set's folder.
pub const MANIFEST: &str = "dataset.json";

/// Version of the data set's files. A change of what the same options make is a new one.
const VERSION: u32 = 1;

/// What a data set was made with. Its pictures depend on nothing else, and on the number of pictures not at all.
#[derive(Debug, Serialize)]
pub struct Manifest {
    version: u32,
    program: &'static str,
    /// Name of the database's file, number of its images, and a hash of their records.
    database: String,
    images: usize,
    records: String,
    seed: u64,
    method: &'static str,
    backend: &'static str,
    neighbours: usize,
    within_px: f64,
    best_effort: bool,
    clean: bool,
    balls: String,
    robots: String,
    camera: String,
    model: Option<String>,
    format: &'static str,
    depth: bool,
    instances: bool,
    trust: bool,
}

impl Manifest {
    /// Notes settings, database, camera and model.
    pub fn new(source: &DatasetSource, settings: &DatasetSettings) -> Result<Self, DatasetError> {
        let synthesizer = source.synthesizer();
        let (archive, config) = (synthesizer.archive(), synthesizer.config());
        let setup = CameraSetup { camera: synthesizer.camera().clone(), ..archive.setup().clone() };
        Ok(Self {
            version: VERSION,
            program: env!("CARGO_PKG_VERSION"),
            database: source.name(),
            images: archive.images().len(),
            records: format!("{:016x}", hash_of_records(archive)?),
            seed: settings.seed,
            method: settings.method.name(),
            backend: source.device(),
            neighbours: config.sources,
            within_px: settings.within,
            best_effort: config.is_best_effort(),
            clean: synthesizer.is_clean(),
            balls: settings.balls.to_string(),
            robots: settings.robots.to_string(),
            camera: setup.to_toml(source.database())?,
            model: source.model().map(Model::to_toml),
            format: settings.format.ending(),
            depth: settings.depth,
            instances: settings.instances,
            trust: settings.trust,
        })
    }

    /// Returns the manifest as the text of its file.
    pub fn text(&self) -> serde_json::Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// Returns the keys in which another manifest's text differs.
    pub fn differences(&self, other: &str) -> serde_json::Result<Vec<String>> {
        let other: Map<String, Value> = serde_json::from_str(other)?;
        let own: Map<String, Value> = serde_json::from_str(&self.text()?)?;
        let keys = own.keys().chain(other.keys().filter(|key| !own.contains_key(*key)));
        Ok(keys.filter(|key| own.get(*key) != other.get(*key)).cloned().collect())
    }
}

/// Returns a hash of what is known of the images: their files' names and lengths, and their poses (FNV-1a, 64 bits: a fingerprint
/// that stays the same in all versions, not a defence).
fn hash_of_records(archive: &Archive) -> Result<u64, DbError> {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |bytes: &[u8]| {
        for byte in bytes {
            hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    // An archive has the images of one field only.
    let field_id = archive.images().first().map(|image| image.field_id);
    archive.database().each_image(|image, details| {
        if Some(image.field_id) != field_id {
            return;
        }
        add(details.file_name.as_bytes());
        add(&details.byte_length.to_le_bytes());
        let pose = image.pose;
        for value in [pose.x_m, pose.y_m, pose.yaw_rad, pose.height_m, pose.pitch_rad, pose.roll_rad] {
            add(&value.to_le_bytes());
        }
    })?;
    Ok(hash)
}
