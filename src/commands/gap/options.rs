//! Options of `gap`.

use std::{ops::Range, path::PathBuf};

use clap::Args;

use crate::commands::device::BackendArgs;

/// Options of `gap`.
#[derive(Debug, Args)]
pub struct GapArgs {
    /// Folder of the sequence: the one that holds sequence.toml
    pub sequence: PathBuf,
    /// The effects that the simulation has already: a model.toml, as this command writes it
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Folder for report.json, report.html, the extended model.toml and pictures
    #[arg(long, value_name = "FOLDER")]
    pub out: PathBuf,
    /// Only these frames, from 0, the last one not included
    #[arg(long, value_name = "A..B", value_parser = frames)]
    pub frames: Option<Range<usize>>,
    /// Seed: chooses which quarter of the frames is kept for judging (0 to 3, then again)
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Poses that were found in the pictures, as `tag --out` writes them, in place of the sequence's own
    #[arg(long, value_name = "FILE", conflicts_with = "tag")]
    pub poses: Option<PathBuf>,
    /// Tag the pictures with the particle filter even where the sequence has reference poses
    #[arg(long)]
    pub tag: bool,
    /// Leave an effect out of the library, for controls: it is then never named; may be given more than once
    #[arg(long, value_name = "ID", value_parser = effect_id)]
    pub without: Vec<String>,
    #[command(flatten)]
    pub backend: BackendArgs,
    /// Print report.json on standard output, too
    #[arg(long)]
    pub json: bool,
}

impl GapArgs {
    /// Refuses options that contradict each other.
    pub fn check_usage(&self) -> Result<(), String> {
        self.backend.check_usage()
    }
}

fn frames(text: &str) -> Result<Range<usize>, String> {
    let range = text
        .split_once("..")
        .and_then(|(from, to)| Some(from.trim().parse::<usize>().ok()?..to.trim().parse::<usize>().ok()?));
    let range = range.filter(|range| !range.is_empty());
    range.ok_or_else(|| "give two numbers, the first the smaller one: 0..60".to_owned())
}

fn effect_id(text: &str) -> Result<String, String> {
    if reality_sim::sensor::effect(text).is_some() {
        return Ok(text.to_owned());
    }
    let ids: Vec<_> = reality_sim::sensor::library().iter().map(|effect| effect.id()).collect();
    Err(format!("there is no such effect: {}", ids.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_a_range_that_holds_some() {
        assert_eq!(frames("3..20"), Ok(3..20));
        for text in ["", "3", "3..", "..4", "5..5", "6..5", "-1..4", "a..b", "1...4"] {
            assert!(frames(text).is_err(), "{text}");
        }
    }
}
