//! What all commands share: output that is checked before long work and complete when it has its name, progress, JSON.

use std::{
    fs,
    io::{self, IsTerminal, Write},
    path::{Path, PathBuf},
    time::Duration,
};

use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

/// Names of values have this much room at least.
const NAME: usize = 10;

/// Checks that a file can be written under this name later, and that it is none of `inputs`.
pub fn check_output_file(path: &Path, inputs: &[PathBuf]) -> anyhow::Result<()> {
    let name = path.display();
    if path.is_dir() {
        bail!("{name}: is a folder: give the name of a file");
    }
    check_writable_folder(&parent(path)).with_context(|| format!("{name}: cannot be written"))?;
    if let Ok(existing) = path.canonicalize()
        && inputs.iter().any(|input| input.canonicalize().is_ok_and(|input| input == existing))
    {
        bail!("{name}: is an input of this command: give another name for the output");
    }
    Ok(())
}

/// Creates a folder for pictures where it is missing (its parent must be there), and checks that files can be written
/// into it and that none of `inputs` lies in it.
pub fn create_output_folder(path: &Path, inputs: &[PathBuf]) -> anyhow::Result<()> {
    let name = path.display();
    if !path.exists() {
        check_writable_folder(&parent(path)).with_context(|| format!("{name}: cannot be created"))?;
        fs::create_dir(path).with_context(|| format!("{name}: cannot be created: check the path"))?;
    }
    check_writable_folder(path)?;
    let folder = path.canonicalize().with_context(|| format!("{name}: cannot be read"))?;
    let holds = |input: &PathBuf| input.canonicalize().is_ok_and(|input| input.parent() == Some(&folder));
    if let Some(input) = inputs.iter().find(|input| holds(input)) {
        bail!("{name}: holds the input {}: give another folder for the output", input.display());
    }
    Ok(())
}

/// Checks, as [`check_output_file`], a file that a picture will be written to: its name says in which format.
pub fn check_output_picture(path: &Path, inputs: &[PathBuf]) -> anyhow::Result<()> {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if !["png", "jpg", "jpeg"].contains(&ending.as_str()) {
        bail!(
            "{}: is not the name of a PNG or JPEG picture: give one that ends in .png or .jpg",
            path.display()
        );
    }
    check_output_file(path, inputs)
}

/// Refuses two outputs of one name.
pub fn check_distinct(outputs: &[&PathBuf]) -> anyhow::Result<()> {
    for (index, output) in outputs.iter().enumerate() {
        if outputs[..index].contains(output) {
            bail!("{}: is given for two outputs: give each a name of its own", output.display());
        }
    }
    Ok(())
}

/// Lines of a name and a value each, the values below each other.
pub fn aligned(lines: &[(&str, String)]) -> String {
    let width = lines.iter().map(|(name, _)| name.len() + 1).fold(NAME, usize::max);
    lines.iter().map(|(name, value)| format!("{name:width$}{value}\n")).collect()
}

/// Prints one JSON object on standard output.
pub fn print_json(report: &impl Serialize) -> anyhow::Result<()> {
    print(&format!("{}\n", serde_json::to_string_pretty(report)?))
}

/// Prints text on standard output. A reader that has seen enough is no error.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut output = io::stdout().lock();
    match output.write_all(text.as_bytes()).and_then(|()| output.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(error).context("standard output: cannot be written")
        }
        _ => Ok(()),
    }
}

/// A progress bar over frames on standard error: on a terminal only.
pub fn frame_progress(frames: usize) -> anyhow::Result<ProgressBar> {
    if !io::stderr().is_terminal() {
        return Ok(ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden()));
    }
    let style = ProgressStyle::with_template("{bar:32} {pos}/{len} frames, {per_sec}, {eta} left  {msg}")?;
    let bar = ProgressBar::new(frames as u64).with_style(style);
    bar.enable_steady_tick(Duration::from_millis(250));
    Ok(bar)
}

/// One progress bar after the other, for work in stages.
#[derive(Default)]
pub struct StageProgress(Option<ProgressBar>);

impl StageProgress {
    /// A stage of so many frames begins.
    pub fn begin(&mut self, frames: usize) -> anyhow::Result<()> {
        self.finish();
        self.0 = Some(frame_progress(frames)?);
        Ok(())
    }

    /// So many frames of the stage are done.
    pub fn set(&self, done: usize) {
        if let Some(bar) = &self.0 {
            bar.set_position(done as u64);
        }
    }

    /// The stage is over.
    pub fn finish(&self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

fn parent(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// Only an attempt tells whether a folder can be written to; nothing stays behind.
fn check_writable_folder(folder: &Path) -> anyhow::Result<()> {
    let name = folder.display();
    match fs::metadata(folder) {
        Ok(metadata) if metadata.is_dir() => {}
        Ok(_) => bail!("{name}: is not a folder: give the name of one that is there"),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            bail!("{name}: there is no such folder: create it first, or give another")
        }
        Err(error) => {
            return Err(error).with_context(|| format!("{name}: cannot be read: check the path"));
        }
    }
    tempfile::tempfile_in(folder)
        .map(drop)
        .with_context(|| format!("{name}: cannot be written to: check its permissions, or give another"))
}
