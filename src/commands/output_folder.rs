//! Folder for the files of one run: checked before the work, created with the first file.

use std::{
    cell::OnceCell,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, bail};

use super::output::check_writable_folder;

/// Folder in which a command writes one file after the other. Nothing is created before the first, so that a command that
/// fails or is interrupted leaves no empty folder behind.
pub struct OutputFolder {
    path: PathBuf,
    /// First file.
    first: OnceCell<PathBuf>,
}

impl OutputFolder {
    /// Checks that files can be written into a folder, or that it can be created, and that none of `inputs` lies in it.
    pub fn check(path: &Path, inputs: &[PathBuf]) -> anyhow::Result<Self> {
        let name = path.display();
        // A path without parents is relative to the folder in which the program runs.
        let existing = path.ancestors().find(|folder| folder.exists()).unwrap_or(Path::new("."));
        check_writable_folder(existing).with_context(|| format!("{name}: cannot be created"))?;
        if let Ok(folder) = path.canonicalize() {
            let holds =
                |input: &&PathBuf| input.canonicalize().is_ok_and(|input| input.parent() == Some(&folder));
            if let Some(input) = inputs.iter().find(holds) {
                bail!("{name}: holds the input {}: give another folder for the output", input.display());
            }
        }
        Ok(Self { path: path.to_path_buf(), first: OnceCell::new() })
    }

    /// Returns the path of a file in the folder, which is there afterwards. Fails if the folder cannot be created, or if the first
    /// file is gone: the folder was removed meanwhile, and those so far with it.
    pub fn file(&self, name: impl AsRef<Path>) -> anyhow::Result<PathBuf> {
        let (file, folder) = (self.path.join(name), self.path.display());
        match self.first.get() {
            Some(first) if !first.exists() => bail!(
                "{folder}: the folder was removed while files were written into it: run the command again"
            ),
            Some(_) => {}
            None => {
                fs::create_dir_all(&self.path)
                    .with_context(|| format!("{folder}: cannot be created: check the path"))?;
                self.first.get_or_init(|| file.clone());
            }
        }
        Ok(file)
    }
}
