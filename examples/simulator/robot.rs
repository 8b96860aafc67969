//! The robot: it knows its camera, the field, where pictures were recorded, and what it senses. Where it truly is, it never
//! learns: nothing here can read it.

use std::sync::Arc;

use reality_sim::{Archive, CameraPose, LocalizationError, Localizer, Observation, Pose2};

use crate::{
    ball_seeing::BallSeeing,
    ball_track::BallTrack,
    plan::Plan,
    senses::{Command, Senses},
};

/// Robot that follows a ball.
#[derive(Debug)]
pub struct Robot {
    localizer: Localizer,
    seeing: BallSeeing,
    ball: Option<BallTrack>,
    plan: Plan,
}

/// What the robot makes of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thought {
    /// Pose at which it believes its camera to be.
    pub camera: CameraPose,
    /// Whether it is sure of the pose.
    pub is_sure: bool,
    /// Where it believes the ball to be, if it sees one.
    pub ball: Option<BallTrack>,
    /// How it wants to walk now.
    pub command: Command,
    /// Time that the localization took, seconds.
    pub localized_s: f64,
}

impl Robot {
    /// Makes a robot for balls of a radius, that was placed at about this pose.
    pub fn new(archive: &Arc<Archive>, placed: Pose2, ball_radius_m: f64) -> Result<Self, LocalizationError> {
        let camera = &archive.setup().camera;
        Ok(Self {
            localizer: Localizer::builder(camera, archive.field()).start(placed).build()?,
            seeing: BallSeeing::new(camera.clone(), ball_radius_m),
            ball: None,
            plan: Plan::new(archive.clone()),
        })
    }

    /// Finds itself and the ball in a picture, and decides how to walk.
    pub fn think(&mut self, senses: &Senses) -> Result<Thought, LocalizationError> {
        let observation = Observation::new(senses.time_s, senses.picture.clone(), senses.mount)
            .with_odometry(senses.odometry);
        let here = self.localizer.update(&observation)?;
        let seen = self.seeing.find(&senses.picture, here.pose).map(|seen| seen.place_in_world);
        self.ball = match self.ball {
            Some(ball) => Some(ball.followed(senses.time_s, seen)),
            None => seen.map(|place| BallTrack::new(place, senses.time_s)),
        };
        Ok(Thought {
            camera: here.pose,
            is_sure: here.sure,
            ball: self.ball.filter(|_| seen.is_some()),
            command: self.plan.command(here.pose, self.ball.as_ref()),
            localized_s: here.seconds,
        })
    }
}
