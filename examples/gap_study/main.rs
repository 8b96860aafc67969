//! Hidden-effect study of `docs/gap.md`. A ray caster that shares no code with the fitted model makes recordings, with an
//! effect, or none, hidden in each by seed. The workflow's verdict is compared with the truth only afterwards.
//!
//! `cargo run --release --example gap_study -- --out FOLDER` appends its runs to `FOLDER/runs.jsonl`, skipping those that
//! are already there, and writes `FOLDER/study.md`. `--page docs/gap.md` also puts the tables between the page's marks.
//! `--draw N` makes other recordings.
//! `--part nulls|singles|pairs|removed|foreign|full`, `--effect ID` and `--runs N` select a part of the study.

mod limits;
mod page;
mod plan;
mod run;
mod sight;
mod summary;
mod truth;

use std::{
    collections::BTreeSet,
    error::Error,
    fs::{self, OpenOptions},
    io::Write,
    path::PathBuf,
};

use clap::Parser;

use limits::Limits;
use plan::Part;
use run::Outcome;

/// Makes recordings with hidden effects and lets the workflow find them.
#[derive(Debug, Parser)]
struct Args {
    /// Folder for runs.jsonl and study.md
    #[arg(long)]
    out: PathBuf,
    /// Which draw of recordings and effects: the rules were made on draws 0 to 2
    #[arg(long, default_value_t = 3)]
    draw: u64,
    /// Only these parts
    #[arg(long, value_enum)]
    part: Vec<Part>,
    /// Only runs in which one of these effects is hidden
    #[arg(long)]
    effect: Vec<String>,
    /// At most so many runs of each part
    #[arg(long)]
    runs: Option<usize>,
    /// A page that is to have the tables between its marks
    #[arg(long)]
    page: Option<PathBuf>,
    /// Only write study.md from the runs that are there
    #[arg(long)]
    summary: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let args = Args::parse();
    fs::create_dir_all(&args.out)?;
    let file = args.out.join("runs.jsonl");
    let mut outcomes = read(&file)?;
    if !args.summary {
        let parts = if args.part.is_empty() { Part::ALL.to_vec() } else { args.part.clone() };
        let done: BTreeSet<String> = outcomes.iter().map(|outcome| outcome.task.key()).collect();
        let mut log = OpenOptions::new().create(true).append(true).open(&file)?;
        let mut limits = Limits::default();
        for part in parts {
            let mut tasks = plan::tasks(part, args.draw);
            if !args.effect.is_empty() {
                tasks.retain(|task| task.effects.iter().any(|id| args.effect.contains(id)));
            }
            tasks.truncate(args.runs.unwrap_or(usize::MAX));
            for task in tasks.into_iter().filter(|task| !done.contains(&task.key())) {
                let Some(chosen) = task.chosen(&mut limits)? else {
                    eprintln!("{}: cannot be seen in this recording", task.key());
                    continue;
                };
                let outcome = run::run(&task, &chosen)?;
                eprintln!("{}", outcome.line());
                writeln!(log, "{}", serde_json::to_string(&outcome)?)?;
                outcomes.push(outcome);
            }
        }
    }
    let tables = summary::text(&outcomes);
    fs::write(args.out.join("study.md"), &tables)?;
    if let Some(page) = &args.page {
        page::put(page, &tables)?;
    }
    Ok(())
}

fn read(file: &PathBuf) -> Result<Vec<Outcome>, Box<dyn Error>> {
    if !file.exists() {
        return Ok(Vec::new());
    }
    Ok(fs::read_to_string(file)?.lines().map(serde_json::from_str).collect::<Result<_, _>>()?)
}
