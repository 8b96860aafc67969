//! `reality-sim viewer`: opens recordings, databases and reports in a window.

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args;

use reality_sim_viewer::ViewerOptions;

use super::{device, input::Recording, model_file::ModelArgs};

/// Path of the demonstration, relative to the project's folder.
const DEMONSTRATION: &str = "assets/walk";

/// Options of `viewer`.
#[derive(Debug, Args)]
pub struct ViewerArgs {
    /// Folder of a sequence, robot's log, database, or folder of a report; the demonstration walk if left out
    #[arg(value_name = "SEQUENCE|DATABASE|REPORT")]
    open: Option<PathBuf>,
    /// Field on which a log was recorded: a field.toml, or the name of a preset
    #[arg(long, value_name = "FILE|PRESET")]
    field: Option<PathBuf>,
    #[command(flatten)]
    model: ModelArgs,
}

/// Runs the command.
pub fn run(args: &ViewerArgs) -> anyhow::Result<()> {
    let demonstration = demonstration();
    let open = match (&args.open, &demonstration) {
        (Some(path), _) if !path.exists() => {
            bail!(
                "{}: does not exist: give a recording's folder, a database or a report's folder",
                path.display()
            )
        }
        (Some(path), _) => path.clone(),
        (None, Some(path)) => path.clone(),
        (None, None) => bail!(
            "viewer: the demonstration ({DEMONSTRATION}) is neither here nor beside the program: give a recording's folder, a database or a report's folder"
        ),
    };
    let model = args.model.read()?.map(|file| file.model);
    let recording = Recording::open(&open, args.field.as_deref())?;
    let open = recording.folder().to_path_buf();
    Ok(reality_sim_viewer::run(ViewerOptions { open, demonstration, model, devices: device::all() })?)
}

/// Finds the demonstration: in the current folder, in a folder above the program, or where the program was built.
fn demonstration() -> Option<PathBuf> {
    let program = std::env::current_exe().unwrap_or_default();
    let folders = std::iter::once(Path::new("."))
        .chain(program.ancestors().skip(1))
        .chain([Path::new(env!("CARGO_MANIFEST_DIR"))]);
    folders.map(|folder| folder.join(DEMONSTRATION)).find(|path| path.join("sequence.toml").is_file())
}
