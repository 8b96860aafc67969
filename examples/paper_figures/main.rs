//! The paper's Table 2 and Fig. 9, and the sweep of the settings of its two models, on sequences with ground truth:
//!
//! `cargo run --release --example paper_figures -- figures FRAMES SEEDS SEQUENCE` writes `tables.md`, `error.svg` and
//! `time.svg` into `docs/figures`;
//! `cargo run --release --example paper_figures -- sweep FRAMES SEEDS SEQUENCE...` writes `sweep.md`.
//!
//! FRAMES is the largest number of pictures used of each sequence. `scripts/paper` makes the figures and their recording, `scripts/figures` the
//! sweep and its recordings.

#[path = "../shared/curves.rs"]
mod curves;
mod figures;
mod recording;
mod sweep;

use std::{fmt::Write, fs, path::Path};

use anyhow::{Context, bail};

use crate::recording::Recording;

const OUT: &str = "docs/figures";
/// Cargo's profile, which changes the times only.
const PROFILE: &str = if cfg!(debug_assertions) { "dev" } else { "release" };
const USAGE: &str = "usage: paper_figures figures|sweep FRAMES SEEDS SEQUENCE...";

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [what, frames, seeds, folders @ ..] = arguments.as_slice() else { bail!(USAGE) };
    let number =
        |text: &String| text.parse::<u32>().with_context(|| format!("{text}: is no number; {USAGE}"));
    let (frames, seeds) = (number(frames)?, number(seeds)?);
    let recordings = folders
        .iter()
        .map(|folder| Recording::open(Path::new(folder), frames as usize))
        .collect::<anyhow::Result<Vec<_>>>()?;
    fs::create_dir_all(OUT).with_context(|| format!("{OUT}: cannot be made"))?;
    let script =
        if what == "figures" { "scripts/paper".to_owned() } else { format!("scripts/figures {PROFILE}") };
    let mut text = header(&script, &arguments.join(" "), &recordings)?;
    let file = match (what.as_str(), recordings.as_slice()) {
        ("figures", [recording]) => {
            figures::write(recording, u64::from(seeds), &mut text)?;
            format!("{OUT}/tables.md")
        }
        ("sweep", [_, ..]) => {
            sweep::write(&recordings, u64::from(seeds), &mut text)?;
            format!("{OUT}/sweep.md")
        }
        _ => bail!(USAGE),
    };
    fs::write(&file, text).with_context(|| format!("{file}: cannot be written"))
}

/// Describes how the file was made.
fn header(script: &str, arguments: &str, recordings: &[Recording]) -> anyhow::Result<String> {
    let mut text = format!(
        "Made by `bash {script}`, which makes the recordings that are not part of the repository, and runs \
         `cargo run --profile {PROFILE} --example paper_figures -- {arguments}`.\n\n| sequence | name | pictures |\n|---|---|---|\n"
    );
    for Recording { sequence, pictures } in recordings {
        writeln!(text, "| `{}` | {} | {} |", sequence.folder.display(), sequence.name, pictures.len())?;
    }
    Ok(text)
}
