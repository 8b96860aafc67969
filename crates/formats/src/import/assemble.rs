//! Sequence from what was gathered of a log.

use std::{collections::HashSet, f64::consts::TAU};

use reality_sim_core::{
    camera::{Camera, Distortion},
    pose::CameraPose,
    sequence::{CameraSetup, FrameRecord, Sequence, counted, on_one_line},
};

use super::{
    axes::Axes,
    clock::{Clock, lost_frames},
    error::Lack,
    gather::Gathered,
    mount::{AttitudeSource, CameraMount},
    odometry::CameraOdometry,
    options::ImportOptions,
    reference::{Reference, median},
    report::{ImportReport, UsedTopics},
    shot::Shot,
    topics::Choice,
};
use crate::message::{CalibrationFault, ConvertedCamera, seconds};

/// Least height of a camera that is one, metres: below it, tf begins at the camera or close to it.
const LEAST_HEIGHT_M: f64 = 0.02;

/// Height that stands for one that is not known, metres; it is not written.
const ANY_HEIGHT_M: f64 = 0.5;

/// Steps in which numbers are written, metres and radians. A robot's numbers have fewer digits; what conversions between rotations
/// leave behind the twelfth would make two imports of one recording differ.
const STEPS_PER_UNIT: f64 = 1e12;

/// Sequence and report.
pub struct Assembled {
    /// Sequence, whose pictures are not in their place yet.
    pub sequence: Sequence,
    /// Report.
    pub report: ImportReport,
    /// What is known of its camera.
    pub known: KnownCamera,
}

/// What is known of a sequence's camera; the rest of its setup stands for anything.
#[derive(Debug, Clone, Copy)]
pub struct KnownCamera {
    /// The lens.
    pub lens: bool,
    /// The height above the carpet.
    pub height: bool,
}

impl KnownCamera {
    /// Returns what a reader has to do about it.
    fn note(self) -> Option<String> {
        let lacks = match self {
            Self { lens: true, height: true } => return None,
            Self { lens: true, height: false } => "camera.toml lacks the height of the camera",
            Self { lens: false, .. } => "there is no camera.toml",
        };
        Some(format!(
            "{lacks}: `reality-sim calibrate SEQUENCE --out SEQUENCE/camera.toml` finds it in the pictures"
        ))
    }
}

/// Puts a sequence together. Fails with what the log lacks.
pub fn assemble(
    gathered: &Gathered,
    clock: &Clock,
    choice: &Choice,
    options: &ImportOptions,
) -> Result<Assembled, Lack> {
    let (shots, doubled) = in_order(gathered, clock);
    check_pictures(gathered, choice, &shots)?;
    let mut notes = Vec::new();
    let (mut setup, mut known) = camera_or_any(gathered, choice, options, &mut notes)?;
    let mount = CameraMount::find(gathered, &shots, options)?;
    let odometry = CameraOdometry::find(gathered, &mount);
    let by_frames = height_by_frames(&mount, &shots);
    let reference = match &choice.reference_frame {
        Some(frame) => Reference::of_frame(gathered, &mount, frame, &shots),
        None => Reference::of_topic(gathered, &mount, by_frames),
    };
    let height = height(options, by_frames, &reference);
    known.height &= height.is_some();
    if !known.height && !options.allows_uncalibrated {
        return Err(Lack::NoHeight);
    }
    setup.mount_height_m = height.as_ref().map_or(ANY_HEIGHT_M, |(height_m, _)| rounded(*height_m));
    notes.extend(known.note());
    let frames = Matcher { gathered, options, mount: &mount, odometry: &odometry, reference: &reference }
        .frames(&shots)?;

    notes.extend(mount_notes(gathered, &mount));
    notes.extend(reference.words.iter().map(|words| format!("the reference poses are {words}")));
    notes.extend(fault_notes(gathered));
    let times_ns: Vec<i64> = shots.iter().map(|shot| shot.time_ns).collect();
    let report = ImportReport {
        frames: frames.len(),
        unmatched: shots.len() - frames.len(),
        lost: lost_frames(&times_ns),
        attitude_source: mount.source_name(),
        odometry_source: odometry.words(),
        height_m: height.as_ref().map(|(height_m, _)| *height_m),
        height_source: height.map(|(_, source)| source),
        camera_model: known.lens.then(|| setup.camera.distortion.colmap_name()),
        notes,
        ..counted_report(gathered, clock, choice, options, doubled)
    };
    let first_pose = frames.first().and_then(|frame| frame.reference_pose);
    let sequence = Sequence {
        folder: Default::default(),
        files: Vec::new(),
        name: options.name.clone(),
        setup,
        field: options.field.clone(),
        frames,
        poses_between_frames: reference.between(&times_ns),
        start: first_pose.filter(|_| options.start_from_reference).map(CameraPose::planar),
        calibration: None,
        corrected_by: None,
    };
    Ok(Assembled { sequence, report, known })
}

/// Returns the part of the report that counts what was read.
fn counted_report(
    gathered: &Gathered,
    clock: &Clock,
    choice: &Choice,
    options: &ImportOptions,
    doubled: usize,
) -> ImportReport {
    ImportReport {
        frames: 0,
        unmatched: 0,
        salvaged: false,
        bytes_lost: 0,
        clock_jumps: clock.jumps,
        doubled: gathered.tally.doubled + doubled,
        lost: 0,
        unusable: gathered.tally.unusable,
        damaged: gathered.tally.damaged,
        without_stamp: gathered.tally.without_stamp,
        topics: UsedTopics::of(choice),
        attitude_source: String::new(),
        odometry_source: None,
        height_source: None,
        height_m: None,
        camera_model: None,
        tolerance_s: options.tolerance_s,
        notes: Vec::new(),
    }
}

/// Returns the camera, or one that stands for it where that is wanted and there is none.
fn camera_or_any(
    gathered: &Gathered,
    choice: &Choice,
    options: &ImportOptions,
    notes: &mut Vec<String>,
) -> Result<(CameraSetup, KnownCamera), Lack> {
    match camera(gathered, choice, options, notes) {
        Ok(setup) => Ok((setup, KnownCamera { lens: true, height: true })),
        Err(lack) if options.allows_uncalibrated => {
            notes.push(lack.to_string());
            let any = any_camera(gathered.picture_size.unwrap_or_default()).ok_or(lack)?;
            Ok((any, KnownCamera { lens: false, height: false }))
        }
        Err(lack) => Err(lack),
    }
}

/// Returns a camera that stands for one that is not known.
fn any_camera(size: [u32; 2]) -> Option<CameraSetup> {
    let [width, height] = size.map(f64::from);
    let camera = Camera::new(size, [width, width, 0.5 * width, 0.5 * height], Distortion::Pinhole).ok()?;
    Some(CameraSetup { camera, mount_height_m: ANY_HEIGHT_M, photometry: None })
}

/// Returns the pictures in order of time, each time once, and how many were left out for that.
fn in_order(gathered: &Gathered, clock: &Clock) -> (Vec<Shot>, usize) {
    let corrected = |shot: &Shot| Shot { time_ns: clock.corrected(shot.time_ns, shot.log_time_ns), ..*shot };
    let mut shots: Vec<Shot> = gathered.shots.iter().map(corrected).collect();
    shots.sort_by_key(|shot| shot.time_ns);
    let before = shots.len();
    shots.dedup_by(|a, b| seconds(a.time_ns) == seconds(b.time_ns));
    let doubled = before - shots.len();
    (shots, doubled)
}

fn check_pictures(gathered: &Gathered, choice: &Choice, shots: &[Shot]) -> Result<(), Lack> {
    if !shots.is_empty() {
        return Ok(());
    }
    let topic = choice.pictures.as_ref().map_or_else(String::new, |chosen| chosen.name.clone());
    let reason = gathered.tally.first_fault.clone().unwrap_or_else(|| "there are none".to_owned());
    Err(Lack::NoPicture { topic, count: gathered.tally.pictures, reason })
}

/// Returns the camera, with the height still to be filled in.
fn camera(
    gathered: &Gathered,
    choice: &Choice,
    options: &ImportOptions,
    notes: &mut Vec<String>,
) -> Result<CameraSetup, Lack> {
    let pictures = gathered.picture_size.unwrap_or_default();
    let topic = choice.pictures.as_ref().map_or_else(String::new, |chosen| chosen.name.clone());
    let setup = match (&options.camera, &choice.calibration, &gathered.calibration) {
        (Some(setup), _, _) => setup.clone(),
        (None, Some(chosen), Some(calibration)) => {
            let converted = if is_rectified(&topic) {
                notes.push(format!(
                    "the pictures on {} are rectified: the lens is a pinhole",
                    on_one_line(&topic)
                ));
                calibration.rectified_camera(pictures)
            } else {
                calibration.camera(pictures)
            };
            let of_topic = |fault: CalibrationFault| Lack::Calibration { topic: chosen.name.clone(), fault };
            let ConvertedCamera { camera, fit_error_px } = converted.map_err(of_topic)?;
            notes.extend(fit_error_px.map(|error_px| {
                format!("the lens stands for a rational_polynomial one, at most {error_px:.3} px off")
            }));
            CameraSetup { camera, mount_height_m: 0.0, photometry: None }
        }
        _ => return Err(Lack::NoCalibration),
    };
    let calibration = [setup.camera.width, setup.camera.height];
    if calibration != pictures {
        return Err(Lack::OtherSize { calibration, pictures, topic });
    }
    Ok(setup)
}

/// Returns whether pictures are rectified, by the name of their topic: `image_rect`, `image_rect_color`, `rectified_image`.
fn is_rectified(topic: &str) -> bool {
    topic.split(['/', '_']).any(|part| part == "rect" || part.starts_with("rectif"))
}

/// Returns the median height of the camera over the frame that does not tilt.
fn height_by_frames(mount: &CameraMount<'_>, shots: &[Shot]) -> Option<f64> {
    let heights = shots.iter().filter_map(|shot| Some(mount.pose_over_level(shot.time_ns)?.translation.z));
    median(heights).filter(|height_m| *height_m > LEAST_HEIGHT_M)
}

/// Returns the height of the camera, and where it is from.
fn height(options: &ImportOptions, by_frames: Option<f64>, reference: &Reference) -> Option<(f64, String)> {
    let given = options.height_m.map(|height_m| (height_m, "given".to_owned()));
    let of_camera =
        options.camera.as_ref().map(|setup| (setup.mount_height_m, "the given camera".to_owned()));
    let of_frames = by_frames.map(|height_m| (height_m, "tf".to_owned()));
    let of_reference = reference.height_m().filter(|height_m| *height_m > LEAST_HEIGHT_M);
    let of_reference = of_reference.map(|height_m| (height_m, "the reference poses".to_owned()));
    given.or(of_camera).or(of_frames).or(of_reference)
}

/// Returns what a reader should know of the source of pitch and roll.
fn mount_notes(gathered: &Gathered, mount: &CameraMount<'_>) -> Vec<String> {
    let mut notes = Vec::new();
    let imu_frame = on_one_line(&gathered.imu_frame);
    if mount.is_on_camera() {
        let axes = mount.axes().name();
        notes.push(format!(
            "the IMU's frame `{imu_frame}` is taken for the camera's, in {axes} axes: no tf links them"
        ));
    }
    if mount.source == AttitudeSource::ImuOnBase {
        let base = on_one_line(mount.level.as_deref().unwrap_or_default());
        notes.push(format!("no tf knows the IMU's frame `{imu_frame}`: it is taken for that of `{base}`"));
    }
    if mount.source == AttitudeSource::Reference {
        notes.push("nothing but the reference poses tells pitch and roll: they are theirs".to_owned());
    }
    if !gathered.gravity.is_empty() && mount.source_name().starts_with("accelerometer") {
        notes.push(
            "the IMU has no orientation: pitch and roll are those of its accelerometer at rest".to_owned(),
        );
    }
    notes
}

/// Returns what is wrong with pictures that cannot be used.
fn fault_notes(gathered: &Gathered) -> Option<String> {
    let fault = gathered.tally.first_fault.as_ref()?;
    Some(format!("{} could not be used; the first: {fault}", counted(gathered.tally.unusable, "picture")))
}

/// What the robot knew at the times of pictures.
struct Matcher<'a> {
    gathered: &'a Gathered,
    options: &'a ImportOptions,
    mount: &'a CameraMount<'a>,
    odometry: &'a CameraOdometry<'a>,
    reference: &'a Reference,
}

impl Matcher<'_> {
    /// Returns the frames of all pictures of which enough is known. Fails if there is none.
    fn frames(&self, shots: &[Shot]) -> Result<Vec<FrameRecord>, Lack> {
        let mut missing = HashSet::new();
        let frames: Vec<FrameRecord> = shots
            .iter()
            .filter_map(|shot| match self.frame(shot) {
                Ok(frame) => Some(frame),
                Err(what) => {
                    missing.insert(what);
                    None
                }
            })
            .collect();
        if frames.is_empty() {
            let what = missing.into_iter().min().unwrap_or("a match");
            return Err(Lack::NothingMatched {
                frames: shots.len(),
                what,
                tolerance_s: self.options.tolerance_s,
            });
        }
        Ok(with_turns_counted(frames))
    }

    fn frame(&self, shot: &Shot) -> Result<FrameRecord, &'static str> {
        let (time_ns, tolerance_ns) = (shot.time_ns, self.options.tolerance_ns());
        let level_from_camera = self.mount.level_from_camera(time_ns).ok_or("pitch and roll")?;
        let level = CameraPose::from_world_from_camera(glam::DVec3::ZERO, level_from_camera);
        let odometry = self.odometry.at(self.mount, time_ns, tolerance_ns);
        if odometry.is_none() && self.odometry.is_there() {
            return Err("odometry");
        }
        let reference_pose =
            self.reference.at(time_ns, tolerance_ns).map(|pose| Axes::Optical.camera_pose(pose));
        Ok(FrameRecord {
            timestamp_s: seconds(time_ns),
            image: self.gathered.file_of(shot).to_path_buf(),
            odometry,
            pitch_rad: rounded(level.pitch_rad),
            roll_rad: rounded(level.roll_rad),
            reference_pose,
        })
    }
}

/// Rounds a length or an angle to what is written of it.
fn rounded(value: f64) -> f64 {
    (value * STEPS_PER_UNIT).round() / STEPS_PER_UNIT
}

/// Lets the headings of the odometry count turns, as dead reckoning does: no heading is more than half a turn from the one
/// before.
fn with_turns_counted(mut frames: Vec<FrameRecord>) -> Vec<FrameRecord> {
    let mut before: Option<f64> = None;
    for odometry in frames.iter_mut().filter_map(|frame| frame.odometry.as_mut()) {
        let turns = before.map_or(0.0, |before| ((before - odometry.yaw_rad) / TAU).round());
        odometry.yaw_rad = rounded(odometry.yaw_rad + turns * TAU);
        [odometry.x_m, odometry.y_m] = [odometry.x_m, odometry.y_m].map(rounded);
        before = Some(odometry.yaw_rad);
    }
    frames
}
