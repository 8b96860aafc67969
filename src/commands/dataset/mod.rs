//! `reality-sim dataset`: pictures at random poses with labels.

mod options;

use serde::Serialize;

use reality_sim::{
    dataset::{DatasetError, DatasetSource, make},
    sequence::read_camera,
};

pub use self::options::DatasetArgs;
use super::{
    model_file::Use,
    output::{aligned, frame_progress, print, print_json},
    output_folder::OutputFolder,
};

/// Report that `--json` prints.
#[derive(Serialize)]
struct Report {
    pictures: u32,
    /// Number of pictures that this run made.
    written: u32,
    /// Number of pictures that an earlier run had made.
    skipped: u32,
    annotations: usize,
    /// Pictures that this run made a second, with their files.
    pictures_per_second: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    corrections: Option<String>,
    out: String,
}

/// Runs the command.
pub fn run(args: &DatasetArgs) -> anyhow::Result<()> {
    let model = args.model.read()?;
    let archive = args.synthesis.archive(&args.database, model.as_ref())?;
    let lens = match &args.camera {
        Some(file) => read_camera(file)?.camera,
        None => archive.setup().camera.clone(),
    };
    let inputs = [Some(&args.database), args.camera.as_ref(), args.model.model.as_ref()];
    let inputs: Vec<_> = inputs.into_iter().flatten().cloned().collect();
    OutputFolder::check(&args.out, &inputs)?;
    let source = DatasetSource::new(&args.database, args.synthesis.synthesizer(archive.clone(), lens)?)
        .with_model(model.as_ref().map(|model| model.model.clone()))
        .with_device(args.synthesis.backend.device()?.name);
    let settings = args.settings();
    let progress = frame_progress(settings.count as usize)?;
    let made = make(&source, &settings, &args.out, |done| progress.set_position(done.into()));
    progress.finish_and_clear();
    let made = made.map_err(|error| match (error, &model) {
        (DatasetError::Model(error), Some(model)) => error.in_file(model.path()).into(),
        (error, _) => anyhow::Error::from(error),
    })?;
    let purpose = Use::Pictures { is_corrected: archive.corrected_by().is_some() };
    let report = Report {
        pictures: made.pictures,
        written: made.written,
        skipped: made.skipped,
        annotations: made.annotations,
        pictures_per_second: f64::from(made.written) / made.drawing.as_secs_f64().max(f64::MIN_POSITIVE),
        corrections: model.map(|model| model.words(archive.setup(), archive.field(), purpose)),
        out: args.out.display().to_string(),
    };
    if args.json { print_json(&report) } else { print(&report.text()) }
}

impl Report {
    fn text(&self) -> String {
        let Self { pictures, written, skipped, annotations, pictures_per_second, .. } = self;
        let mut lines = vec![
            ("pictures", format!("{pictures}: {written} made, {skipped} there already")),
            ("labels", format!("{annotations} annotations")),
            ("speed", format!("{pictures_per_second:.1} pictures a second")),
        ];
        lines.extend(self.corrections.iter().map(|corrections| ("camera", corrections.clone())));
        lines.push(("folder", self.out.clone()));
        aligned(&lines)
    }
}
