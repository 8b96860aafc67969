//! Import of robots' logs as sequences.
//!
//! A log is read once. Pictures become files as they come; of everything else a few numbers are kept. When all is known,
//! every picture gets what the robot knew at its time.

mod assemble;
mod axes;
mod clock;
mod error;
mod frames;
mod gather;
mod mount;
mod odometry;
mod options;
mod reference;
mod report;
mod series;
mod shot;
mod topics;
mod urdf;
mod writer;

use std::{fs, io, path::Path};

use reality_sim_core::sequence::{Fault, SequenceError, write_atomically};

use self::{
    assemble::{KnownCamera, assemble},
    clock::Clock,
    gather::Gatherer,
    topics::Choice,
    writer::PictureWriter,
};
pub use self::{
    error::{ImportError, Lack, PictureFault},
    options::{ImportOptions, TOLERANCE_S},
    report::{ImportReport, UsedTopics},
};
use crate::log::{Log, TopicSet};

/// Imports a log as a sequence into a folder, which is created if it is missing. `progress` learns how many bytes of the log have
/// been read. Fails if the log cannot be read, lacks what a sequence needs, or if a file cannot be written.
pub fn import_log(
    log: &Log,
    options: &ImportOptions,
    out: &Path,
    progress: &mut dyn FnMut(u64),
) -> Result<ImportReport, ImportError> {
    let lack = |lack: Lack| ImportError::Lack { path: log.path().to_path_buf(), lack };
    let unwritable = |error| unwritable(out, error);
    let mut topics = TopicSet::default();
    let choice = Choice::of(&log.topics(&mut topics)?, options).map_err(lack)?;
    let writer = PictureWriter::start(out).map_err(unwritable)?;
    let mut gatherer = Gatherer::new(&choice, options.camera_frame.as_deref(), &writer, progress);
    let ending = log.read(&mut topics, &mut gatherer)?;
    let mut gathered = gatherer.finish();
    let pictures = writer.finish().map_err(unwritable)?;

    let clock = Clock::of(&gathered.shots);
    gathered.frames.finish(&clock);
    gathered.odometry.finish(&clock);
    gathered.reference.finish(&clock);
    gathered.imu.finish(&clock);
    gathered.gravity.finish(&clock);
    let mut assembled = assemble(&gathered, &clock, &choice, options).map_err(lack)?;
    assembled.report.salvaged = ending.is_cut;
    assembled.report.bytes_lost = ending.bytes_lost;

    let sequence = &mut assembled.sequence;
    sequence.folder = out.to_path_buf();
    pictures.keep(out, sequence.frames.iter().map(|frame| frame.image.as_path())).map_err(unwritable)?;
    sequence.write(out)?;
    leave_out_unknown(&out.join(CAMERA_FILE), assembled.known)?;
    Ok(assembled.report)
}

/// Name of the camera's file in a sequence.
const CAMERA_FILE: &str = "camera.toml";

/// Takes out of a camera's file what is not known of the camera: the height, or everything.
fn leave_out_unknown(camera: &Path, known: KnownCamera) -> Result<(), ImportError> {
    let unwritable = |error| unwritable(camera, error);
    match known {
        KnownCamera { lens: true, height: true } => Ok(()),
        KnownCamera { lens: false, .. } => fs::remove_file(camera).map_err(unwritable),
        KnownCamera { lens: true, height: false } => {
            let text = fs::read_to_string(camera).map_err(unwritable)?;
            let is_of_mount = |line: &&str| line.starts_with("[mount]") || line.starts_with("height_m");
            let lens: Vec<&str> = text.lines().filter(|line| !is_of_mount(line)).collect();
            let header = "# The height of the camera above the carpet is not known yet.\n";
            write_atomically(camera, (header.to_owned() + &lens.join("\n") + "\n").as_bytes())
                .map_err(ImportError::from)
        }
    }
}

fn unwritable(path: &Path, error: io::Error) -> ImportError {
    SequenceError { path: path.to_path_buf(), line: None, fault: Fault::Unwritable(error) }.into()
}
