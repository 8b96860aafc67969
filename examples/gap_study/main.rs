//! Hidden-effect study of `docs/gap.md`. A ray caster that shares no code with the fitted model draws a world for each walk,
//! and hides effects there, or none. The workflow's verdict is compared with the truth only afterwards.
//!
//! `cargo run --release --example gap_study -- --out FOLDER` appends its runs to `FOLDER/runs.jsonl`, skipping those that
//! are already there, and writes `FOLDER/study.md`. `--page docs/gap.md` also puts the tables between the page's marks.
//! `--purpose development|validation|final` chooses worlds that the others do not have; the final ones need code that has
//! not been changed since the last commit. Runs of different states of the code are not mixed.
//! `--workflow` runs simpler workflows on the same recordings, too.
//! `--part nulls|singles|removed|pairs|triples|foreign|unmeasured`, `--effect ID`, `--walks N` and `--budget-min N` select a
//! part of the study: worlds come in turn over the effects, so that any part of it is a smaller study.

mod code;
mod limits;
mod memory;
mod page;
mod plan;
mod run;
mod studio;
mod summary;
mod truth;
mod workflow;

use std::{
    collections::BTreeMap,
    error::Error,
    fs::{self, File, OpenOptions},
    io::Write,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use clap::Parser;

use plan::{Chosen, Part, Purpose, Task};
use run::Outcome;
use studio::Studio;
use workflow::Workflow;

/// Makes recordings with hidden effects and lets the workflow find them.
#[derive(Debug, Parser)]
struct Args {
    /// Folder for runs.jsonl and study.md
    #[arg(long)]
    out: PathBuf,
    /// What the worlds are for: rules are made on the first, checked on the second, reported on the last
    #[arg(long, value_enum, default_value = "development")]
    purpose: Purpose,
    /// Only these parts
    #[arg(long, value_enum)]
    part: Vec<Part>,
    /// Only runs in which one of these effects is hidden
    #[arg(long)]
    effect: Vec<String>,
    /// Workflows that are run on every recording; sizes are in detection limits of `gap` itself
    #[arg(long, value_enum, default_value = "gap")]
    workflow: Vec<Workflow>,
    /// Number of worlds of each effect
    #[arg(long, default_value_t = plan::WALKS)]
    walks: u64,
    /// Stops after these minutes, at the end of a run
    #[arg(long)]
    budget_min: Option<f64>,
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
    let code = code::fingerprint()?;
    if args.purpose == Purpose::Final && !args.summary && code::is_changed(&code) {
        return Err("the code has been changed: commit it before the final draw".into());
    }
    let mut study = Study::resume(&file, code)?;
    if !args.summary {
        study.run(&args)?;
    }
    let outcomes: Vec<&Outcome> = study.outcomes.values().collect();
    let tables = summary::text(&outcomes);
    fs::write(args.out.join("study.md"), &tables)?;
    if let Some(page) = &args.page {
        page::put(page, &tables)?;
    }
    Ok(())
}

/// Runs done, by the key of their task, and the file in which they are kept.
struct Study {
    outcomes: BTreeMap<(String, Workflow), Outcome>,
    code: String,
    log: File,
    studio: Studio,
}

impl Study {
    /// Reads the runs that are there. Fails if they are of another state of the code.
    fn resume(file: &Path, code: String) -> Result<Self, Box<dyn Error>> {
        let log = OpenOptions::new().create(true).append(true).open(file)?;
        let text = fs::read_to_string(file)?;
        let outcomes = text.lines().map(serde_json::from_str).collect::<Result<Vec<Outcome>, _>>()?;
        if let Some(other) = outcomes.iter().find(|outcome| outcome.code != code) {
            return Err(format!(
                "{} has runs of the code {}, and this is {code}: use another folder, or go back to that code",
                file.display(),
                other.code
            )
            .into());
        }
        let outcomes = outcomes.into_iter().map(|outcome| (outcome.key(), outcome)).collect();
        Ok(Self { outcomes, code, log, studio: Studio::default() })
    }

    fn run(&mut self, args: &Args) -> Result<(), Box<dyn Error>> {
        let start = Instant::now();
        let budget = args.budget_min.map(|minutes| Duration::from_secs_f64(60.0 * minutes));
        let parts = if args.part.is_empty() { Part::ALL.to_vec() } else { args.part.clone() };
        let mut tasks = plan::tasks(args.purpose, &parts, args.walks);
        if !args.effect.is_empty() {
            tasks.retain(|task| task.effects.iter().any(|id| args.effect.contains(id)));
        }
        for (done, task) in tasks.iter().enumerate() {
            if budget.is_some_and(|budget| start.elapsed() > budget) {
                eprintln!("{done} of {} runs are done: the time is over", tasks.len());
                break;
            }
            let is_new = |workflow: &Workflow| !self.outcomes.contains_key(&(task.key(), *workflow));
            let workflows: Vec<Workflow> = args.workflow.iter().copied().filter(is_new).collect();
            if workflows.is_empty() {
                continue;
            }
            match self.chosen(task)? {
                Some(chosen) => self.add(task, &chosen, &workflows)?,
                None => eprintln!("{}: cannot be seen in this recording", task.key()),
            }
        }
        Ok(())
    }

    fn add(&mut self, task: &Task, hidden: &[Chosen], workflows: &[Workflow]) -> Result<(), Box<dyn Error>> {
        for outcome in run::run(&mut self.studio, task, hidden, workflows, &self.code)? {
            eprintln!("{}", outcome.line());
            writeln!(self.log, "{}", serde_json::to_string(&outcome)?)?;
            self.outcomes.insert(outcome.key(), outcome);
        }
        Ok(())
    }

    /// Returns the effects to hide with their sizes. None if one of them cannot be seen in the recording, or if the wanted
    /// size is not plausible.
    fn chosen(&mut self, task: &Task) -> Result<Option<Vec<Chosen>>, Box<dyn Error>> {
        let mut all = Vec::with_capacity(task.effects.len());
        if task.part == Part::Foreign {
            for id in &task.effects {
                let multiple = plan::foreign_multiple(id);
                all.push(Chosen { id: id.clone(), multiple, in_limits: 0.0 });
            }
            let effects = studio::effects(task, &all)?;
            return Ok(self.studio.is_in_sight(task, &effects)?.then_some(all));
        }
        if task.effects.is_empty() {
            return Ok(Some(all));
        }
        let nothing = task.with_nothing_hidden();
        let of_nothing = (nothing.key(), Workflow::Gap);
        if !self.outcomes.contains_key(&of_nothing) {
            self.add(&nothing, &[], &[Workflow::Gap])?;
        }
        for id in &task.effects {
            let limits = &self.outcomes[&of_nothing].limits;
            let Some(chosen) = limits::chosen(task, id, task.size, limits)? else { return Ok(None) };
            all.push(chosen);
        }
        Ok(Some(all))
    }
}
