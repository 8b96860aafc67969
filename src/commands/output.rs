//! Output of all commands: checked before long work, complete once it has its name, with progress and JSON.

use std::{
    fs,
    io::{self, IsTerminal, Write},
    path::{Path, PathBuf},
    sync::atomic::{AtomicBool, Ordering},
    time::Duration,
};

use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use reality_sim::sequence::{for_terminal, on_one_line};

/// Whether reports in words and progress are left out: an option of the whole program.
static IS_QUIET: AtomicBool = AtomicBool::new(false);

/// Smallest width of the column with the names of values.
const NAME: usize = 10;

/// Leaves out reports in words and progress from now on.
pub fn be_quiet() {
    IS_QUIET.store(true, Ordering::Relaxed);
}

fn is_quiet() -> bool {
    IS_QUIET.load(Ordering::Relaxed)
}

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

/// Refuses two outputs that are one file, also if their paths differ.
pub fn check_distinct(outputs: &[&PathBuf]) -> anyhow::Result<()> {
    let places: Vec<PathBuf> = outputs.iter().map(|output| place(output)).collect();
    for (index, output) in outputs.iter().enumerate() {
        if places[..index].contains(&places[index]) {
            bail!("{}: is given for two outputs: give each a name of its own", output.display());
        }
    }
    Ok(())
}

/// Formats lines of one name and one value each, with the values aligned. Line breaks in values are escaped: what a file says
/// cannot look like a line of the program's own.
pub fn aligned(lines: &[(&str, String)]) -> String {
    let width = lines.iter().map(|(name, _)| name.len() + 1).fold(NAME, usize::max);
    lines.iter().map(|(name, value)| format!("{name:width$}{}\n", on_one_line(value))).collect()
}

/// Prints one JSON object on standard output. Control characters beyond ASCII, which JSON allows, are escaped, too.
pub fn print_json(report: &impl Serialize) -> anyhow::Result<()> {
    let json = serde_json::to_string_pretty(report)?;
    let escape = |letter: char| {
        let is_control = letter != '\n' && letter.is_control();
        if is_control { format!("\\u{:04x}", letter as u32) } else { letter.to_string() }
    };
    print_all(format!("{}\n", json.chars().map(escape).collect::<String>()).as_bytes())
}

/// Prints text on standard output, without control characters that a terminal would obey, unless the program is quiet.
pub fn print(text: &str) -> anyhow::Result<()> {
    if is_quiet() { Ok(()) } else { print_all(for_terminal(text).as_bytes()) }
}

/// Prints a line on standard error, beside what the command reports, unless the program is quiet.
pub fn notify(line: &str) {
    if !is_quiet() {
        eprintln!("{}", on_one_line(line));
    }
}

/// Prints bytes on standard output as they are. It is not an error if the reader has closed the pipe.
pub fn print_all(bytes: &[u8]) -> anyhow::Result<()> {
    let mut output = io::stdout().lock();
    match output.write_all(bytes).and_then(|()| output.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(error).context("standard output: cannot be written")
        }
        _ => Ok(()),
    }
}

/// Whether progress is shown: in a terminal, unless the program is quiet.
pub fn shows_progress() -> bool {
    !is_quiet() && io::stderr().is_terminal()
}

/// Makes a progress bar over frames on standard error.
pub fn frame_progress(frames: usize) -> anyhow::Result<ProgressBar> {
    if !shows_progress() {
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

/// Returns the one path of a file that may not be there yet; its folder is.
fn place(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| {
        let folder = parent(path).canonicalize().unwrap_or_else(|_| parent(path));
        folder.join(path.file_name().unwrap_or_default())
    })
}

fn parent(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// Checks that a folder can be written to, which only an attempt can tell; nothing is left behind.
pub fn check_writable_folder(folder: &Path) -> anyhow::Result<()> {
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
