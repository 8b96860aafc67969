//! `reality-sim summary`: what a team wants to read of a thousand recordings.

mod calibration;
mod findings;
mod next;
mod page;
mod rows;
mod statistics;
mod tagging;
#[cfg(test)]
mod tests;

use std::path::PathBuf;

use clap::Args;

use reality_sim::sequence::write_atomically;

use self::findings::Summary;
use super::output::{aligned, check_output_file, print, print_json};

/// Options of `summary`.
#[derive(Debug, Args)]
pub struct SummaryArgs {
    /// Tables that studies have written: folders, or Parquet files
    #[arg(required = true, value_name = "TABLE")]
    tables: Vec<PathBuf>,
    /// Write the summary to this HTML file, with pictures
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print the summary as one JSON object
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(args: &SummaryArgs) -> anyhow::Result<()> {
    if let Some(file) = &args.out {
        check_output_file(file, &args.tables)?;
    }
    let summary = Summary::new(&rows::read(&args.tables)?);
    if let Some(file) = &args.out {
        write_atomically(file, page::page(&summary).as_bytes())?;
    }
    if args.json {
        return print_json(&summary);
    }
    let page = args.out.as_ref().map(|file| ("page", file.display().to_string()));
    print(&format!(
        "{}\n{}",
        summary.sentence(),
        aligned(&[summary.lines(), page.into_iter().collect()].concat())
    ))
}
