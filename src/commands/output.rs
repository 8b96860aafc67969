//! Output of all commands: checked before long work, complete once it has its name, with progress and JSON.

use std::{
    fs,
    io::{self, IsTerminal, Write},
    path::{Path, PathBuf},
    time::Duration,
};

use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

/// Smallest width of the column with the names of values.
const NAME: usize = 10;

/// Checks that a file can be written under this name later, and that it is not one of `inputs`.
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

/// Creates a folder for pictures if it is missing (its parent must exist), and checks that files can be written into it
/// and that none of `inputs` lies in it.
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

/// Checks a picture file that will be written, as [`check_output_file`] does; its name must give the format.
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

/// Refuses two outputs with the same name.
pub fn check_distinct(outputs: &[&PathBuf]) -> anyhow::Result<()> {
    for (index, output) in outputs.iter().enumerate() {
        if outputs[..index].contains(output) {
            bail!("{}: is given for two outputs: give each a name of its own", output.display());
        }
    }
    Ok(())
}

/// Formats lines of one name and one value each, with the values aligned.
pub fn aligned(lines: &[(&str, String)]) -> String {
    let width = lines.iter().map(|(name, _)| name.len() + 1).fold(NAME, usize::max);
    lines.iter().map(|(name, value)| format!("{name:width$}{value}\n")).collect()
}

/// Prints one JSON object on standard output.
pub fn print_json(report: &impl Serialize) -> anyhow::Result<()> {
    print(&format!("{}\n", serde_json::to_string_pretty(report)?))
}

/// Prints text on standard output. It is not an error if the reader has closed the pipe.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut output = io::stdout().lock();
    match output.write_all(text.as_bytes()).and_then(|()| output.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(error).context("standard output: cannot be written")
        }
        _ => Ok(()),
    }
}

/// Makes a progress bar over frames on standard error, shown only in a terminal.
pub fn frame_progress(frames: usize) -> anyhow::Result<ProgressBar> {
    if !io::stderr().is_terminal() {
        return Ok(ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden()));
    }
    let style = ProgressStyle::with_template("{bar:32} {pos}/{len} frames, {per_sec}, {eta} left  {msg}")?;
    let bar = ProgressBar::new(frames as u64).with_style(style);
    bar.enable_steady_tick(Duration::from_millis(250));
    Ok(bar)
}

/// Progress bars of successive stages, one after the other.
#[derive(Default)]
pub struct StageProgress(Option<ProgressBar>);

impl StageProgress {
    /// Starts a stage with this many frames.
    pub fn begin(&mut self, frames: usize) -> anyhow::Result<()> {
        self.finish();
        self.0 = Some(frame_progress(frames)?);
        Ok(())
    }

    /// Sets the number of frames of the stage that are done.
    pub fn set(&self, done: usize) {
        if let Some(bar) = &self.0 {
            bar.set_position(done as u64);
        }
    }

    /// Ends the stage.
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

/// Checks that a folder can be written to, which only an attempt can tell; nothing is left behind.
fn check_writable_folder(folder: &Path) -> anyhow::Result<()> {
    let name = folder.display();
    match fs::metadata(folder) {
        Ok(metadata) if metadata.is_dir() => {}
        Ok(_) => bail!("{name}: is not a folder: give the name of an existing one"),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            bail!("{name}: there is no such folder: create it first, or give another one")
        }
        Err(error) => {
            return Err(error).with_context(|| format!("{name}: cannot be read: check the path"));
        }
    }
    tempfile::tempfile_in(folder).map(drop).with_context(|| {
        format!("{name}: cannot be written to: check its permissions, or give another folder")
    })
}
