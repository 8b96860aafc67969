//! Folder of a data set: what is in it, and what is done.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::Mutex,
};

use anyhow::{Context, bail};

use reality_sim::sequence::write_atomically;

use super::{
    manifest::{MANIFEST, Manifest},
    options::DatasetArgs,
};
use crate::commands::{output::check_writable_folder, output_folder::OutputFolder};

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
    pub fn check(args: &DatasetArgs, inputs: &[PathBuf], manifest: &Manifest) -> anyhow::Result<Self> {
        let path = &args.out;
        OutputFolder::check(path, inputs)?;
        let optional =
            [(args.depth, Part::Depth), (args.instances, Part::Instances), (args.trust, Part::Trust)];
        let optional = optional.into_iter().filter_map(|(is_wanted, part)| is_wanted.then_some(part));
        let parts = [Part::Image, Part::Mask].into_iter().chain(optional).chain([Part::Records]);
        let folder = Self {
            path: path.clone(),
            manifest: manifest.text()?,
            image_ending: args.format.ending(),
            parts: parts.collect(),
            is_begun: Mutex::new(false),
        };
        match fs::read_to_string(path.join(MANIFEST)) {
            Ok(found) => folder.check_same(manifest, &found, args.count)?,
            Err(_) => check_empty(path)?,
        }
        Ok(folder)
    }

    fn check_same(&self, manifest: &Manifest, found: &str, count: u32) -> anyhow::Result<()> {
        let path = self.path.display();
        let different = manifest.differences(found).with_context(|| format!("{path}/{MANIFEST}"))?;
        if !different.is_empty() {
            bail!(
                "{path}: holds a data set that was made with another {}: give the same options, or another folder",
                different.join(", ")
            );
        }
        let beyond = self.file(Part::Records, count);
        if beyond.exists() {
            bail!(
                "{path}: holds more than {count} pictures already: give a larger --count, or another folder"
            );
        }
        Ok(())
    }

    /// Creates the folders and writes the manifest, if that is not done yet. Threads may call it at once.
    pub fn begin(&self) -> anyhow::Result<()> {
        let mut is_begun = self.is_begun.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if *is_begun {
            return Ok(());
        }
        let create = |folder: &Path| {
            fs::create_dir_all(folder)
                .with_context(|| format!("{}: cannot be created: check the path", folder.display()))
        };
        create(&self.path)?;
        if !self.path.join(MANIFEST).exists() {
            write_atomically(&self.path.join(MANIFEST), self.manifest.as_bytes())?;
        }
        for part in &self.parts {
            let folder = self.path.join(part.folder());
            create(&folder)?;
            check_writable_folder(&folder)?;
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

/// Refuses a folder that holds something else.
fn check_empty(path: &Path) -> anyhow::Result<()> {
    let Ok(entries) = fs::read_dir(path) else { return Ok(()) };
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    if names.into_iter().any(|name| !name.starts_with(UNFINISHED)) {
        bail!(
            "{}: holds other files and no {MANIFEST}: give a new folder, or that of a data set to be completed",
            path.display()
        );
    }
    Ok(())
}
