//! The loop: the world shows pictures to the robot, and the robot tells the world how it walks.

use std::sync::Arc;

use reality_sim::{Archive, LocalizationError, simulator::LookError};

use crate::{
    noise::Noise,
    report::{Errors, Report},
    robot::{Robot, Thought},
    senses::Senses,
    world::{BALL_RADIUS_M, Truth, World},
};

/// Pictures a second.
pub const RATE_HZ: f64 = 10.0;

/// Reason why the loop ended early.
#[derive(Debug)]
pub enum LoopError {
    /// The recordings of the database lead nowhere, so that nothing can be followed.
    NoWay,
    /// The robot came to where too little was recorded, or pictures cannot be read.
    Look {
        /// Time at which it did, seconds.
        time_s: f64,
        /// Reason.
        source: LookError,
    },
    /// The localization failed.
    Localization(LocalizationError),
}

impl std::fmt::Display for LoopError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoWay => {
                write!(f, "the database holds no recording of a robot that moves; build one of a walk")
            }
            Self::Look { time_s, source } => write!(f, "after {time_s:.1} s: {source}"),
            Self::Localization(source) => source.fmt(f),
        }
    }
}

impl std::error::Error for LoopError {}

impl From<LocalizationError> for LoopError {
    fn from(source: LocalizationError) -> Self {
        Self::Localization(source)
    }
}

/// What there is to show of one picture.
#[derive(Debug)]
pub struct Moment<'a> {
    /// What the robot sensed.
    pub senses: &'a Senses,
    /// What it made of it.
    pub thought: &'a Thought,
    /// What is so.
    pub truth: &'a Truth,
    /// How far apart the two are.
    pub errors: Errors,
}

/// Runs the loop for some seconds of the simulation, and shows each moment.
pub fn run(
    archive: &Arc<Archive>,
    seed: u64,
    seconds: f64,
    mut show: impl FnMut(&Moment<'_>),
) -> Result<Report, LoopError> {
    let mut world = World::new(archive.clone(), Noise::new(seed)).ok_or(LoopError::NoWay)?;
    let mut robot = Robot::new(archive, world.placed(), BALL_RADIUS_M)?;
    let mut report = Report::default();
    for _ in 0..(seconds * RATE_HZ).round() as usize {
        let truth = world.truth();
        let senses = world.sense().map_err(|source| LoopError::Look { time_s: truth.time_s, source })?;
        let thought = robot.think(&senses)?;
        let errors = Errors::new(&thought, &truth);
        show(&Moment { senses: &senses, thought: &thought, truth: &truth, errors });
        report.errors.push(errors);
        report.covered += world.covered();
        report.localized_s += thought.localized_s;
        world.go_on(thought.command, 1.0 / RATE_HZ);
        report.way_m += truth.camera.planar().motion_to(world.truth().camera.planar()).distance_m();
    }
    report.looked_s = world.looked_s();
    Ok(report)
}
