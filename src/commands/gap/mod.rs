//! `reality-sim gap`: finds the effect that a model of the camera lacks, and measures what adding it brings.

mod control;
mod corrected_files;
mod earlier;
mod inject;
mod options;
mod poses;
mod text;

use std::path::Path;

use anyhow::bail;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use reality_sim::{
    Sequence,
    gap::{Analysis, MeasureError, Options, Pictures, Progress, Recording, analyse, html},
    sensor::{Chain, Model},
    sequence::{save_image, write_atomically},
};

use self::control::Control;
use self::corrected_files::corrected_files;
use self::earlier::{Earlier, SinceReport};
use self::inject::{ControlReport, Controls};
pub use self::options::GapArgs;
use super::{
    output::{print, print_json, shows_progress},
    output_folder::OutputFolder,
};

/// Runs the command.
pub fn run(args: &GapArgs) -> anyhow::Result<()> {
    let input = super::input::Recording::open(&args.sequence, args.field.as_deref())?;
    let mut sequence = Sequence::open(input.folder())?;
    let mut given = args.model.as_deref().map_or_else(|| Ok(Model::default()), Model::read)?;
    // The model may lie in the output folder, so it is read before anything is written there.
    refuse_held(args, &given)?;
    if let Some(path) = &args.model {
        Chain::new(&sequence.setup, &sequence.field, &given).map_err(|error| error.in_file(path))?;
    }
    let pictures = sequence.frames.first().map(|_| sequence.image_path(0)).transpose()?;
    let earlier = args.reference.as_deref().map(Sequence::open).transpose()?;
    let of_earlier = earlier.as_ref().map_or_else(Vec::new, |earlier| earlier.files.clone());
    let inputs = [sequence.files.clone(), of_earlier, Vec::from_iter(pictures)].concat();
    let out = &OutputFolder::check(&args.out, &inputs)?;
    let frames = args.frames_among(sequence.frames.len());
    // Before the filter fails for want of them.
    Recording::check_pictures(&sequence, frames.clone())?;
    let poses = poses::reference(args, &sequence).map_err(|error| poses::true_cause(&sequence, error))?;
    let progress = stages()?;
    progress.set_message("reading the pictures");
    let options = Options { seed: args.seed, without: args.without.clone() };
    let earlier = earlier.map(|sequence| Earlier::new(args, &sequence, &options)).transpose()?;
    if let Some(earlier) = &earlier {
        given.clone_from(&earlier.model);
        sequence.setup.photometry = Some(earlier.photometry);
    }
    let recording = Recording::new(&sequence, &poses.poses, poses.source, frames)?;
    let run =
        Run { args, out, folder: input.folder(), given: &given, options: &options, progress: &progress };
    let controls = Controls { recording: &recording, source: poses.source, args, options: &options };
    if let Some(Control::One(id, size)) = &args.inject {
        return controls.with_hidden(id, *size, |recording, hidden| run.control(recording, &hidden));
    }
    let analysis = run.analysed(&recording)?;
    let since = earlier.as_ref().map(|earlier| &earlier.told);
    let report = SinceReport { report: &analysis.report, reference: since };
    write((args, out, input.folder()), &recording, &given, (&analysis, &report))?;
    if args.inject.is_some() {
        let rows = controls.all(&analysis.report, |recording| run.analysed(recording))?;
        inject::write(out, &rows)?;
        return if args.json { print_json(&rows) } else { print(&inject::table(&rows)) };
    }
    if args.json {
        return print_json(&report);
    }
    let before = since.map_or_else(String::new, |told| format!("{}\n", told.sentence()));
    print(&format!("{before}{}", text::text(&analysis.report, &args.out)))
}

/// What one run needs, for several recordings.
struct Run<'a> {
    args: &'a GapArgs,
    out: &'a OutputFolder,
    /// Folder of the sequence, also where an effect is hidden in it.
    folder: &'a Path,
    given: &'a Model,
    options: &'a Options,
    progress: &'a ProgressBar,
}

impl Run<'_> {
    fn analysed(&self, recording: &Recording<'_>) -> Result<Analysis, MeasureError> {
        let show = |stage| self.progress.set_message(words(stage));
        let analysis = analyse(recording, self.given, self.options, &show);
        self.progress.finish_and_clear();
        analysis
    }

    /// Analyses a recording in which an effect is hidden, and says whether it was named.
    fn control(&self, recording: &Recording<'_>, hidden: &inject::Hidden) -> anyhow::Result<()> {
        let analysis = self.analysed(recording)?;
        let control = ControlReport::new(&analysis.report, hidden);
        write((self.args, self.out, self.folder), recording, self.given, (&analysis, &control))?;
        if self.args.json {
            return print_json(&control);
        }
        print(&format!("{}\n{}", control.sentence(), text::text(&analysis.report, &self.args.out)))
    }
}

/// Refuses effects that are both in the model and left out of the library.
fn refuse_held(args: &GapArgs, given: &Model) -> anyhow::Result<()> {
    match args.without.iter().find(|id| given.values(id).is_some()) {
        Some(id) => bail!("--without {id}: the file of --model contains this effect: remove it there"),
        None => Ok(()),
    }
}

/// Writes the report's files. `report.json`, by which other commands recognise the folder, comes last; `report` is what goes into
/// it.
fn write(
    (args, out, folder): (&GapArgs, &OutputFolder, &Path),
    recording: &Recording<'_>,
    given: &Model,
    (analysis, report): (&Analysis, &impl Serialize),
) -> anyhow::Result<()> {
    let pictures = &Pictures::new(recording, given, analysis)?;
    let corrected = corrected_files(args, (recording.sequence(), folder), analysis)?;
    for (name, picture) in
        [("measured", &pictures.measured), ("before", &pictures.before), ("after", &pictures.after)]
    {
        save_image(&out.file(format!("pictures/{name}.png"))?, picture)?;
    }
    let json = serde_json::to_string_pretty(report)?;
    let page = html::page(&analysis.report, pictures);
    let files = [("model.toml", analysis.model.to_toml()), ("report.html", page), ("report.json", json)];
    for (name, text) in corrected.into_iter().chain(files) {
        write_atomically(&out.file(name)?, text.as_bytes())?;
    }
    Ok(())
}

/// Returns a progress display; it is visible on a terminal only.
fn stages() -> anyhow::Result<ProgressBar> {
    if !shows_progress() {
        return Ok(ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden()));
    }
    let spinner =
        ProgressBar::new_spinner().with_style(ProgressStyle::with_template("{spinner} {elapsed}  {msg}")?);
    spinner.enable_steady_tick(std::time::Duration::from_millis(250));
    Ok(spinner)
}

fn words(stage: Progress) -> &'static str {
    match stage {
        Progress::Measuring => "measuring lines and carpet in the pictures",
        Progress::Testing => "testing every effect",
        Progress::Fitting => "fitting the extended model",
        Progress::Evaluating => "measuring the gap on held-out frames",
    }
}
