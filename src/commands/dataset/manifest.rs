//! What a data set was made with, so that a later run goes on only with the same.

use anyhow::Context;
use serde::Serialize;
use serde_json::{Map, Value};

use reality_sim::{Archive, Camera, sequence::CameraSetup};

use super::options::DatasetArgs;
use crate::commands::model_file::ModelFile;

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
    neighbours: u8,
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
    /// Notes options, database, camera and model.
    pub fn new(
        args: &DatasetArgs,
        archive: &Archive,
        camera: &Camera,
        model: Option<&ModelFile>,
    ) -> anyhow::Result<Self> {
        let setup = CameraSetup { camera: camera.clone(), ..archive.setup().clone() };
        let origin = args.camera.as_ref().unwrap_or(&args.database);
        Ok(Self {
            version: VERSION,
            program: env!("CARGO_PKG_VERSION"),
            database: name_of(args),
            images: archive.images().len(),
            records: format!("{:016x}", hash_of_records(archive)),
            seed: args.seed,
            method: args.method.name(),
            backend: args.synthesis.backend.device()?.name,
            neighbours: args.synthesis.neighbours(),
            within_px: args.within,
            best_effort: args.synthesis.is_best_effort(),
            clean: args.synthesis.is_clean(),
            balls: args.balls.to_string(),
            robots: args.robots.to_string(),
            camera: setup.to_toml(origin)?,
            model: model.map(|model| model.model.to_toml()),
            format: args.format.ending(),
            depth: args.depth,
            instances: args.instances,
            trust: args.trust,
        })
    }

    /// Returns the manifest as the text of its file.
    pub fn text(&self) -> anyhow::Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// Returns the keys in which another manifest's text differs.
    pub fn differences(&self, other: &str) -> anyhow::Result<Vec<String>> {
        let other: Map<String, Value> =
            serde_json::from_str(other).context("is not the manifest of a data set")?;
        let own: Map<String, Value> = serde_json::from_str(&self.text()?)?;
        let keys = own.keys().chain(other.keys().filter(|key| !own.contains_key(*key)));
        Ok(keys.filter(|key| own.get(*key) != other.get(*key)).cloned().collect())
    }
}

/// Returns the name of the database's file: the data set stays the same where the file lies elsewhere.
pub fn name_of(args: &DatasetArgs) -> String {
    args.database.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Returns a hash of what is known of the images: their files' names and lengths, and their poses (FNV-1a, 64 bits: a fingerprint
/// that stays the same in all versions, not a defence).
fn hash_of_records(archive: &Archive) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |bytes: &[u8]| {
        for byte in bytes {
            hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    for image in archive.images() {
        add(image.file_name.as_bytes());
        add(&image.byte_length.to_le_bytes());
        let pose = image.pose;
        for value in [pose.x_m, pose.y_m, pose.yaw_rad, pose.height_m, pose.pitch_rad, pose.roll_rad] {
            add(&value.to_le_bytes());
        }
    }
    hash
}
