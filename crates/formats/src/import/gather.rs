//! What an import takes from a log in one reading: pictures go to their files, everything else is kept, a few numbers each.

use std::{
    collections::HashMap,
    io::Cursor,
    ops::ControlFlow,
    path::{Path, PathBuf},
    sync::Arc,
};

use image::ImageReader;

use super::{
    error::PictureFault,
    frames::FrameTree,
    series::{Sample, Series},
    shot::Shot,
    topics::{Choice, Chosen},
    urdf,
    writer::{Job, PictureWriter},
};
use crate::{
    log::{Message, Sink, Topic},
    message::{
        Attitude, Calibration, Header, Picture, PictureContent, Rigid, imu, joints, odometry, poses,
        transforms,
    },
    schema::View,
};

/// Everything that was read.
#[derive(Debug, Default)]
pub struct Gathered {
    /// Pictures in the order of the log.
    pub shots: Vec<Shot>,
    /// Ending of the pictures' files, with the path before it.
    pub files: HashMap<usize, PathBuf>,
    /// Size of the pictures, pixels.
    pub picture_size: Option<[u32; 2]>,
    /// Frame of the camera: the given one, else that of the pictures.
    pub camera_frame: String,
    /// First calibration that is not all zeros, else the first.
    pub calibration: Option<Calibration>,
    /// Poses by dead reckoning.
    pub odometry: Series<Rigid>,
    /// Frames of the dead reckoning: its own, and the one whose pose it is.
    pub odometry_frames: (String, String),
    /// Reference poses, and the frame whose poses they are, if a message says so.
    pub reference: Series<Rigid>,
    /// Frame whose poses the reference tells; empty if the messages do not say.
    pub reference_child: String,
    /// Orientations by the IMU.
    pub imu: Series<Attitude>,
    /// Orientations by the IMU's accelerometer.
    pub gravity: Series<Attitude>,
    /// Frame of the IMU.
    pub imu_frame: String,
    /// Frames of the robot.
    pub frames: FrameTree,
    /// Whether the robot's description tells transforms that `tf` does not.
    pub has_urdf: bool,
    /// Counts.
    pub tally: Tally,
}

/// Counts of an import.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    /// Messages with pictures.
    pub pictures: usize,
    /// Frames that are there twice: the same stamp, or the same bytes one after the other.
    pub doubled: usize,
    /// Pictures that cannot be used.
    pub unusable: usize,
    /// What is wrong with the first of these.
    pub first_fault: Option<String>,
    /// Messages whose stamp is zero, which were taken at the time at which they were logged.
    pub without_stamp: usize,
    /// Other messages that are damaged.
    pub damaged: usize,
}

/// Uses of a topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Use {
    Picture,
    Calibration,
    Odometry,
    Reference,
    Imu,
    Joints,
    Transforms,
    Description,
}

/// Sink that gathers.
pub struct Gatherer<'a> {
    choice: &'a Choice,
    writer: &'a PictureWriter,
    progress: &'a mut dyn FnMut(u64),
    uses: HashMap<*const Topic, Vec<(Use, Chosen)>>,
    gathered: Gathered,
    urdf: Option<Vec<urdf::UrdfJoint>>,
    previous: Vec<u8>,
}

impl<'a> Gatherer<'a> {
    /// Makes a sink for the chosen topics; the pictures name the camera's frame unless it is given.
    pub fn new(
        choice: &'a Choice,
        camera_frame: Option<&str>,
        writer: &'a PictureWriter,
        progress: &'a mut dyn FnMut(u64),
    ) -> Self {
        Self {
            choice,
            writer,
            progress,
            uses: HashMap::new(),
            gathered: Gathered {
                camera_frame: camera_frame.unwrap_or_default().to_owned(),
                ..Gathered::default()
            },
            urdf: None,
            previous: Vec::new(),
        }
    }

    /// Returns what was read.
    pub fn finish(mut self) -> Gathered {
        if let Some(joints) = self.urdf {
            self.gathered.has_urdf = self.gathered.frames.add_urdf(joints);
        }
        self.gathered
    }

    fn uses_of(&self, topic: &Topic) -> Vec<(Use, Chosen)> {
        let Choice {
            pictures, calibration, odometry, reference, imu, joints, transforms, description, ..
        } = self.choice;
        let single = [
            (Use::Picture, pictures),
            (Use::Calibration, calibration),
            (Use::Odometry, odometry),
            (Use::Reference, reference),
            (Use::Imu, imu),
            (Use::Joints, joints),
            (Use::Description, description),
        ];
        let single = single.into_iter().filter_map(|(way, chosen)| Some((way, chosen.as_ref()?)));
        let all = single.chain(transforms.iter().map(|chosen| (Use::Transforms, chosen)));
        all.filter(|(_, chosen)| chosen.name == topic.name)
            .map(|(way, chosen)| (way, chosen.clone()))
            .collect()
    }
}

impl Sink for Gatherer<'_> {
    fn wants(&mut self, topic: &Arc<Topic>) -> bool {
        let uses = self.uses_of(topic);
        let is_wanted = !uses.is_empty();
        self.uses.insert(Arc::as_ptr(topic), uses);
        is_wanted
    }

    fn take(&mut self, message: Message<'_>) -> ControlFlow<()> {
        let uses = self.uses.remove(&Arc::as_ptr(message.topic)).unwrap_or_default();
        let mut flow = ControlFlow::Continue(());
        for (way, chosen) in &uses {
            let view = chosen.role.open(message.topic, message.data);
            if *way == Use::Picture {
                flow = self.picture(view.as_ref(), message);
            } else if view.and_then(|view| self.gathered.take(*way, &view, message, &mut self.urdf)).is_none()
            {
                self.gathered.tally.damaged += 1;
            }
        }
        self.uses.insert(Arc::as_ptr(message.topic), uses);
        if self.gathered.frames.is_large() && !self.gathered.camera_frame.is_empty() {
            self.gathered.forget_other_frames(self.choice.reference_frame.as_deref());
        }
        flow
    }

    fn read_so_far(&mut self, bytes: u64) {
        (self.progress)(bytes);
    }
}

impl Gatherer<'_> {
    fn picture(&mut self, view: Option<&View<'_>>, message: Message<'_>) -> ControlFlow<()> {
        let tally = &mut self.gathered.tally;
        tally.pictures += 1;
        let usable = view.and_then(Picture::read).ok_or(PictureFault::Damaged).and_then(|picture| {
            let size = size_of(&picture)?;
            let usual = *self.gathered.picture_size.get_or_insert(size);
            if size == usual { Ok(picture) } else { Err(PictureFault::Size { found: size, usual }) }
        });
        let picture = match usable {
            Ok(picture) => picture,
            Err(fault) => {
                tally.unusable += 1;
                tally.first_fault.get_or_insert_with(|| fault.to_string());
                return ControlFlow::Continue(());
            }
        };
        let time_ns = stamp(&picture.header, message, tally);
        let last = self.gathered.shots.last();
        let (number, is_same_time) =
            last.map_or((0, false), |last| (last.number + 1, last.time_ns == time_ns));
        let is_same_picture = number > 0 && self.previous == message_bytes(&picture);
        tally.doubled += usize::from(is_same_time || is_same_picture);
        if is_same_time {
            return ControlFlow::Continue(());
        }
        if self.gathered.camera_frame.is_empty() {
            self.gathered.camera_frame.clone_from(&picture.header.frame);
        }
        self.previous.clear();
        self.previous.extend_from_slice(message_bytes(&picture));
        let job = match picture.content {
            PictureContent::Raw(raw) => Job::Raw(raw.into_owned()),
            PictureContent::Jpeg(bytes) | PictureContent::Png(bytes) => Job::File(bytes.into_owned()),
            PictureContent::Other(_) => return ControlFlow::Continue(()),
        };
        let Some(file) = self.writer.write(number, job) else { return ControlFlow::Break(()) };
        self.gathered.files.insert(number, file);
        self.gathered.shots.push(Shot { time_ns, log_time_ns: message.log_time_ns, number });
        ControlFlow::Continue(())
    }
}

/// Returns the size of a picture, pixels. Fails if it cannot be used.
fn size_of(picture: &Picture<'_>) -> Result<[u32; 2], PictureFault> {
    match &picture.content {
        PictureContent::Raw(raw) => {
            raw.check()?;
            Ok([raw.width, raw.height].map(|side| side as u32))
        }
        PictureContent::Jpeg(bytes) | PictureContent::Png(bytes) => {
            let reader = ImageReader::new(Cursor::new(&**bytes)).with_guessed_format();
            let size = reader.ok().and_then(|reader| reader.into_dimensions().ok());
            size.map(|(width, height)| [width, height]).ok_or(PictureFault::Damaged)
        }
        PictureContent::Other(format) => Err(PictureFault::Format(format.clone())),
    }
}

fn message_bytes<'a>(picture: &'a Picture<'_>) -> &'a [u8] {
    match &picture.content {
        PictureContent::Raw(raw) => &raw.data,
        PictureContent::Jpeg(bytes) | PictureContent::Png(bytes) => bytes,
        PictureContent::Other(_) => &[],
    }
}

/// Returns the time of a message: its stamp, else the time at which it was logged.
fn stamp(header: &Header, message: Message<'_>, tally: &mut Tally) -> i64 {
    tally.without_stamp += usize::from(header.stamp_ns.is_none());
    header.stamp_ns.unwrap_or(message.log_time_ns)
}

impl Gathered {
    /// Returns the path of a picture's file within the sequence.
    pub fn file_of(&self, shot: &Shot) -> &Path {
        self.files.get(&shot.number).map_or(Path::new(""), PathBuf::as_path)
    }

    fn take(
        &mut self,
        way: Use,
        view: &View<'_>,
        message: Message<'_>,
        urdf: &mut Option<Vec<urdf::UrdfJoint>>,
    ) -> Option<()> {
        match way {
            Use::Picture => {}
            Use::Calibration => {
                let calibration = Calibration::read(view)?;
                if self.calibration.as_ref().is_none_or(Calibration::is_all_zeros) {
                    self.calibration = Some(calibration);
                }
            }
            Use::Odometry => {
                let read = odometry(view)?;
                let sample = self.sample(&read.header, message, read.odometry_from_child);
                self.odometry.push(sample);
                self.odometry_frames = (read.header.frame, read.child);
            }
            Use::Reference => self.take_reference(view, message)?,
            Use::Imu => self.take_imu(view, message)?,
            Use::Joints => {
                let (header, joints) = joints(view)?;
                for joint in joints {
                    let sample = self.sample(&header, message, joint.position);
                    self.frames.add_joint_position(&joint.name, sample);
                }
            }
            Use::Transforms => self.take_transforms(view, message)?,
            Use::Description => {
                let text = view.field("data")?.text()?;
                if urdf.is_none() {
                    *urdf = Some(urdf::joints(&text)?);
                }
            }
        }
        Some(())
    }

    /// Forgets the frames that are on no way that an import goes.
    fn forget_other_frames(&mut self, reference: Option<&str>) {
        let Self { camera_frame, imu_frame, odometry_frames, reference_child, .. } = &*self;
        let (camera, imu, base) = (camera_frame.clone(), imu_frame.clone(), odometry_frames.1.clone());
        let (child, reference) = (reference_child.clone(), reference.unwrap_or_default());
        self.frames.keep_between(&[&camera, &imu, &base, &child, reference]);
    }

    fn sample<T>(&mut self, header: &Header, message: Message<'_>, value: T) -> Sample<T> {
        let time_ns = stamp(header, message, &mut self.tally);
        Sample { time_ns, log_time_ns: message.log_time_ns, value }
    }

    fn take_reference(&mut self, view: &View<'_>, message: Message<'_>) -> Option<()> {
        if let Some(child) = view.field("child_frame_id").and_then(|child| child.text()) {
            self.reference_child = child.trim_start_matches('/').to_owned();
        }
        let poses = poses(view)?;
        // A path repeats what earlier ones told.
        let known_ns = self.reference.samples().last().map(|last| last.time_ns).filter(|_| poses.len() > 1);
        for (header, pose) in poses {
            let sample = self.sample(&header, message, pose);
            if known_ns.is_none_or(|known_ns| sample.time_ns > known_ns) {
                self.reference.push(sample);
            }
        }
        Some(())
    }

    fn take_imu(&mut self, view: &View<'_>, message: Message<'_>) -> Option<()> {
        let read = imu(view)?;
        if let Some(orientation) = read.orientation {
            let sample = self.sample(&read.header, message, orientation);
            self.imu.push(sample);
        } else if let Some(gravity) = read.gravity {
            let sample = self.sample(&read.header, message, gravity);
            self.gravity.push(sample);
        }
        self.imu_frame = read.header.frame;
        Some(())
    }

    fn take_transforms(&mut self, view: &View<'_>, message: Message<'_>) -> Option<()> {
        let is_static = message.topic.name.ends_with("tf_static");
        for one in transforms(view)? {
            if is_static {
                self.frames.add_fixed(&one.header.frame, &one.child, one.parent_from_child);
            } else {
                let sample = self.sample(&one.header, message, one.parent_from_child);
                self.frames.add_moving(&one.header.frame, &one.child, sample);
            }
        }
        Some(())
    }
}
