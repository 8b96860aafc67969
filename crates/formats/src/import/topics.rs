//! Which topics are imported: those that options name, else the one of each kind that there is.

use super::{error::Lack, options::ImportOptions};
use crate::{
    log::TopicSummary,
    message::{MessageKind, Role},
};

/// Parts of names of topics whose poses are references.
const TRUTH: [&str; 8] =
    ["truth", "groundtruth", "mocap", "vicon", "optitrack", "reference", "qualisys", "motion_capture"];

/// Parts of names of topics whose poses are wishes.
const WISHES: [&str; 5] = ["goal", "initialpose", "target", "cmd", "command"];

/// Topic with what its messages are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chosen {
    /// Name of the topic.
    pub name: String,
    /// What its messages are.
    pub role: Role,
}

/// Topics of an import.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Choice {
    /// Pictures.
    pub pictures: Option<Chosen>,
    /// Calibration.
    pub calibration: Option<Chosen>,
    /// Odometry.
    pub odometry: Option<Chosen>,
    /// Reference poses.
    pub reference: Option<Chosen>,
    /// Frame whose pose by `tf` is the reference.
    pub reference_frame: Option<String>,
    /// IMU.
    pub imu: Option<Chosen>,
    /// Joints.
    pub joints: Option<Chosen>,
    /// All topics of transforms.
    pub transforms: Vec<Chosen>,
    /// Description of the robot.
    pub description: Option<Chosen>,
}

impl Choice {
    /// Chooses among a log's topics. Fails if there are no pictures, if an option names a topic that is not there, or if several
    /// may be meant.
    pub fn of(topics: &[TopicSummary], options: &ImportOptions) -> Result<Self, Lack> {
        let all = Topics::of(topics);
        let pictures = all.pictures(options.image.as_deref())?;
        let reference_frame = options.reference.clone().filter(|name| !all.has(name));
        let reference = match &reference_frame {
            Some(_) => None,
            None => all.reference(options.reference.as_deref())?,
        };
        let is_free =
            |chosen: &Candidate| reference.as_ref().is_none_or(|taken| taken.name != chosen.chosen.name);
        let odometry = all.of_kinds(&[MessageKind::Odometry]).into_iter().filter(is_free).collect();
        let named = |name: &Option<String>| name.clone();
        Ok(Self {
            calibration: match options.camera {
                Some(_) => None,
                None => all.calibration(options.camera_info.as_deref(), &pictures.name)?,
            },
            odometry: pick(odometry, named(&options.odometry), "odometry", "--odometry")?,
            imu: pick(all.of_kinds(&[MessageKind::Imu]), named(&options.imu), "IMU", "--imu")?,
            joints: pick(all.of_kinds(&[MessageKind::Joints]), named(&options.joints), "joints", "--joints")?,
            transforms: all.of_kinds(&[MessageKind::Transforms]).into_iter().map(|one| one.chosen).collect(),
            description: all.of_kinds(&[MessageKind::Description]).into_iter().map(|one| one.chosen).next(),
            pictures: Some(pictures),
            reference,
            reference_frame,
        })
    }
}

#[derive(Debug, Clone)]
struct Candidate {
    chosen: Chosen,
    count: u64,
}

struct Topics {
    topics: Vec<Candidate>,
}

impl Topics {
    fn of(topics: &[TopicSummary]) -> Self {
        let candidate = |summary: &TopicSummary| {
            let role = Role::of(&summary.topic).filter(|_| summary.count > 0)?;
            Some(Candidate {
                chosen: Chosen { name: summary.topic.name.clone(), role },
                count: summary.count,
            })
        };
        Self { topics: topics.iter().filter_map(candidate).collect() }
    }

    fn has(&self, name: &str) -> bool {
        self.topics.iter().any(|topic| topic.chosen.name == name)
    }

    fn of_kinds(&self, kinds: &[MessageKind]) -> Vec<Candidate> {
        self.topics.iter().filter(|topic| kinds.contains(&topic.chosen.role.kind)).cloned().collect()
    }

    fn pictures(&self, named: Option<&str>) -> Result<Chosen, Lack> {
        let mut candidates = self.of_kinds(&[MessageKind::Picture, MessageKind::CompressedPicture]);
        if candidates.is_empty() {
            return Err(Lack::NoPictureTopic);
        }
        if named.is_none() && candidates.len() > 1 {
            let color: Vec<Candidate> = candidates
                .iter()
                .filter(|one| !one.chosen.name.to_ascii_lowercase().contains("depth"))
                .cloned()
                .collect();
            candidates = if color.is_empty() { candidates } else { color };
            // The same pictures, sent twice: files as they are need no more work.
            let is_copy = |one: &Candidate| {
                candidates.iter().any(|other| {
                    other.chosen.name != one.chosen.name
                        && base(&other.chosen.name) == base(&one.chosen.name)
                        && (other.count, &other.chosen.name) > (one.count, &one.chosen.name)
                })
            };
            let single: Vec<Candidate> = candidates.iter().filter(|one| !is_copy(one)).cloned().collect();
            candidates = single;
        }
        pick(candidates, named.map(str::to_owned), "pictures", "--image")?.ok_or(Lack::NoPictureTopic)
    }

    /// Chooses the calibration: that beside the pictures, by the custom of ROS, if there are several.
    fn calibration(&self, named: Option<&str>, pictures: &str) -> Result<Option<Chosen>, Lack> {
        let candidates = self.of_kinds(&[MessageKind::Calibration]);
        if named.is_none() && candidates.len() > 1 {
            let folder = |name: &str| name.rsplit_once('/').map_or("", |(folder, _)| folder).to_owned();
            let beside = folder(base(pictures));
            if let Some(one) = candidates.iter().find(|one| folder(&one.chosen.name) == beside) {
                return Ok(Some(one.chosen.clone()));
            }
        }
        pick(candidates, named.map(str::to_owned), "calibration", "--camera-info")
    }

    /// Chooses the reference: a topic of poses, or odometry whose name says that it is true.
    fn reference(&self, named: Option<&str>) -> Result<Option<Chosen>, Lack> {
        let kinds = [MessageKind::Pose, MessageKind::Path, MessageKind::Odometry];
        let candidates = self.of_kinds(&kinds);
        if named.is_some() {
            return pick(candidates, named.map(str::to_owned), "reference", "--reference");
        }
        let says = |one: &Candidate, words: &[&str]| {
            let name = one.chosen.name.to_ascii_lowercase();
            words.iter().any(|word| name.contains(word))
        };
        let (true_ones, others): (Vec<_>, Vec<_>) = candidates.into_iter().partition(|one| says(one, &TRUTH));
        let poses = others
            .into_iter()
            .filter(|one| one.chosen.role.kind != MessageKind::Odometry && !says(one, &WISHES));
        let candidates = if true_ones.is_empty() { poses.collect() } else { true_ones };
        pick(candidates, None, "reference", "--reference")
    }
}

/// Returns the topic of the pictures that another one sends compressed: `image_transport` adds a part to the name.
fn base(name: &str) -> &str {
    ["/compressed", "/ffmpeg", "/theora"].iter().find_map(|ending| name.strip_suffix(ending)).unwrap_or(name)
}

/// Chooses the named candidate, else the only one.
fn pick(
    candidates: Vec<Candidate>,
    named: Option<String>,
    what: &'static str,
    flag: &'static str,
) -> Result<Option<Chosen>, Lack> {
    let names = || candidates.iter().map(|one| one.chosen.name.clone()).collect();
    match named {
        Some(topic) => match candidates.iter().find(|one| one.chosen.name == topic) {
            Some(one) => Ok(Some(one.chosen.clone())),
            None => Err(Lack::NoSuchTopic { flag, topic, candidates: names() }),
        },
        None if candidates.len() > 1 => Err(Lack::Ambiguous { what, flag, candidates: names() }),
        None => Ok(candidates.into_iter().next().map(|one| one.chosen)),
    }
}
