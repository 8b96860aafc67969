//! Folder of a data set: what is in it, and what is done.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::Mutex,
};

use reality_sim_core::sequence::write_atomically;

use super::{
    DatasetError, DatasetSettings,
    manifest::{MANIFEST, Manifest},
};

/// Start of the names of files that a run was killed over.
const UNFINISHED: &str = ".unfinished-";

/// Files that there are for every picture, each kind in a folder of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    Image,
    Mask,
    Depth,
    Instances,
    Trust,
    /// Records of the picture and of its annotations, a line each: written last, when the picture is done.
    Records,
}

/// Folder of a data set.
pub struct DatasetFolder {
    path: PathBuf,
    manifest: String,
    image_ending: &'static str,
    parts: Vec<Part>,
    /// Whether the folders are there.
    is_begun: Mutex<bool>,
}

impl DatasetFolder {
    /// Checks that a data set can be written into a folder: a new one, or the rest of one with the same manifest. Nothing is
    /// created yet.
    pub fn check(
        path: PathBuf,
        settings: &DatasetSettings,
        manifest: &Manifest,
    ) -> Result<Self, DatasetError> {
        let optional = [
            (settings.depth, Part::Depth),
            (settings.instances, Part::Instances),
            (settings.trust, Part::Trust),
        ];
        let optional = optional.into_iter().filter_map(|(is_wanted, part)| is_wanted.then_some(part));
        let parts = [Part::Image, Part::Mask].into_iter().chain(optional).chain([Part::Records]);
        let file = path.join(MANIFEST);
        let no_manifest = |cause| DatasetError::Manifest { file: file.clone(), cause };
        let folder = Self {
            manifest: manifest.text().map_err(no_manifest)?,
            image_ending: settings.format.ending(),
            parts: parts.collect(),
            is_begun: Mutex::new(false),
            path,
        };
        match fs::read_to_string(&file) {
            Ok(found) => {
                folder.check_same(manifest.differences(&found).map_err(no_manifest)?, settings.count)?;
            }
            Err(_) => folder.check_empty()?,
        }
        Ok(folder)
    }

    fn check_same(&self, different: Vec<String>, count: u32) -> Result<(), DatasetError> {
        let folder = self.path.clone();
        if !different.is_empty() {
            return Err(DatasetError::OtherSettings { folder, keys: different });
        }
        if self.file(Part::Records, count).exists() {
            return Err(DatasetError::MorePictures { folder, count });
        }
        Ok(())
    }

    /// Refuses a folder that holds something else.
    fn check_empty(&self) -> Result<(), DatasetError> {
        let Ok(entries) = fs::read_dir(&self.path) else { return Ok(()) };
        let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        if names.into_iter().any(|name| !name.starts_with(UNFINISHED)) {
            return Err(DatasetError::OtherFiles { folder: self.path.clone() });
        }
        Ok(())
    }

    /// Creates the folders and writes the manifest, if that is not done yet. Threads may call it at once.
    pub fn begin(&self) -> Result<(), DatasetError> {
        let mut is_begun = self.is_begun.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if *is_begun {
            return Ok(());
        }
        create(&self.path)?;
        if !self.path.join(MANIFEST).exists() {
            write_atomically(&self.path.join(MANIFEST), self.manifest.as_bytes())?;
        }
        for part in &self.parts {
            create(&self.path.join(part.folder()))?;
        }
        *is_begun = true;
        Ok(())
    }

    /// Returns whether all files of a picture are there.
    pub fn is_done(&self, picture: u32) -> bool {
        self.parts.iter().all(|part| self.file(*part, picture).exists())
    }

    /// Returns the path of a picture's file.
    pub fn file(&self, part: Part, picture: u32) -> PathBuf {
        self.path.join(part.folder()).join(self.name(part, picture))
    }

    /// Returns the name of a picture's file, without its folder.
    pub fn name(&self, part: Part, picture: u32) -> String {
        let ending = match part {
            Part::Image => self.image_ending,
            Part::Mask | Part::Depth | Part::Instances | Part::Trust => "png",
            Part::Records => "jsonl",
        };
        format!("{picture:06}.{ending}")
    }

    /// Returns whether every picture has a file of this kind.
    pub fn has(&self, part: Part) -> bool {
        self.parts.contains(&part)
    }

    /// Returns the path of the file with all annotations.
    pub fn annotations(&self) -> PathBuf {
        self.path.join("annotations.json")
    }
}

impl Part {
    fn folder(self) -> &'static str {
        match self {
            Self::Image => "images",
            Self::Mask => "masks",
            Self::Depth => "depth",
            Self::Instances => "instances",
            Self::Trust => "trust",
            Self::Records => "annotations",
        }
    }
}

fn create(folder: &Path) -> Result<(), DatasetError> {
    fs::create_dir_all(folder).map_err(|cause| DatasetError::Folder { folder: folder.to_path_buf(), cause })
}
