//! `reality-sim calibrate`: finds the camera's lens and mount from the lines of the field.

mod options;
mod report;
mod start;

use std::path::PathBuf;

use anyhow::Context;
use reality_sim::{
    StampedPose,
    calibration::{Calibration, Stage, calibrate},
    sequence::{CameraSetup, camera_with_uncertainty, write_atomically},
    write_tum,
};

pub use self::options::CalibrateArgs;
use self::{report::Report, start::Start};
use super::output::{StageProgress, check_distinct, check_output_file, print, print_json};

/// Runs the command.
pub fn run(args: &CalibrateArgs) -> anyhow::Result<()> {
    let start = Start::read(args)?;
    let sequence = &start.sequence;
    let mut inputs = sequence.files.clone();
    inputs.extend(sequence.frames.iter().map(|frame| sequence.folder.join(&frame.image)));
    // The sequence's own camera.toml may be replaced by the new one: its lens is what is looked for.
    let old_camera = reality_sim::Sequence::camera_file(&args.sequence)?;
    let others: Vec<PathBuf> = inputs.iter().filter(|input| **input != old_camera).cloned().collect();
    check_output_file(&args.out, &others)?;
    let files: Vec<&PathBuf> = [&args.poses, &args.uncertainty].into_iter().flatten().collect();
    files.iter().try_for_each(|file| check_output_file(file, &inputs))?;
    check_distinct(&[vec![&args.out], files].concat())?;
    sequence.check_pictures()?;

    let mut progress = Progress::default();
    let calibration = calibrate(sequence, start.trusted, &mut |stage| progress.show(stage));
    progress.bar.finish();
    let calibration = calibration.with_context(|| args.sequence.display().to_string())?;

    write(args, &start, &calibration)?;
    let report = Report::new(args, &start, &calibration);
    if args.json { print_json(&report) } else { print(&report.text(&calibration)) }
}

fn write(args: &CalibrateArgs, start: &Start, calibration: &Calibration) -> anyhow::Result<()> {
    let camera = CameraSetup {
        camera: calibration.camera.clone(),
        mount_height_m: calibration.height_m,
        photometry: start.sequence.setup.photometry,
    };
    let mounting = start.mounting.then(calibration.mounting);
    let text = camera.to_toml_with(&args.out, mounting)?;
    let uncertainty = calibration.uncertainty_for_file();
    let uncertainty = uncertainty.with_context(|| format!("{}: its covariance", args.out.display()))?;
    let text = camera_with_uncertainty(&text, &calibration.camera, &uncertainty);
    let header = format!(
        "# As found by `reality-sim calibrate` in {} pictures of {}; takes the place of the file there.\n",
        calibration.poses.len(),
        reality_sim::sequence::one_line(&start.sequence.name)
    );
    write_atomically(&args.out, (header + &text).as_bytes())?;
    if let Some(file) = &args.uncertainty {
        let title = format!("{}: uncertainty of the projection", start.sequence.name);
        write_atomically(file, calibration.uncertainty_svg(&title).as_bytes())?;
    }
    if let Some(file) = &args.poses {
        let stamped = |&(frame, pose): &(usize, _)| StampedPose {
            timestamp_s: start.sequence.frames[frame].timestamp_s,
            pose,
        };
        write_tum(file, &calibration.poses.iter().map(stamped).collect::<Vec<_>>())?;
    }
    Ok(())
}

/// Progress on a terminal: the pictures that are placed; the other stages have no number.
#[derive(Default)]
struct Progress {
    bar: StageProgress,
    placing: bool,
}

impl Progress {
    fn show(&mut self, stage: Stage) {
        match stage {
            Stage::Placing(done, of) => {
                if !self.placing {
                    // Without a bar the work goes on.
                    let _ = self.bar.begin(of);
                }
                self.bar.set(done);
                self.placing = done < of;
            }
            Stage::Guessing | Stage::Adjusting | Stage::CrossValidating => {
                self.bar.finish();
                self.placing = false;
            }
        }
    }
}
