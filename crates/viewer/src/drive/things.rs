//! Things on the field: the ball and the other robots, and how they are moved.

use std::f64::consts::PI;

use glam::DVec2;
use reality_sim_core::{
    camera::Camera,
    field::FieldDimensions,
    pose::{CameraPose, Motion2, Pose2, wrap_angle},
};

use super::robot::MARGIN_M;

/// Largest number of other robots: with the one that carries the camera, two teams of six.
pub const MOST_ROBOTS: usize = 11;
/// Place of a ball that is put before the camera, metres forwards and to the left: beside the tip of the robot's arrow.
const BALL_AHEAD_M: [f64; 2] = [0.85, 0.3];
/// Places of robots that are added before the camera, metres forwards and to the left, in the order in which they are taken: a
/// robot that stands on one of them is seen from head to foot, and leaves the ball in view.
const ROBOTS_AHEAD_M: [[f64; 2]; 7] =
    [[1.5, -0.45], [1.9, 0.6], [2.4, -0.2], [1.5, 1.1], [2.1, -1.2], [2.9, 0.9], [3.2, -0.8]];
/// Least distance of a robot that is added from everything else, metres: more than two robots are wide.
const ROOM_M: f64 = 0.45;

/// Something that can be moved on the field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Thing {
    Ball,
    Robot(RobotNumber),
}

/// Number of a robot, from 1; a robot keeps it when others are removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RobotNumber(u32);

impl RobotNumber {
    /// Whether the robot plays in the first team; robots join the teams in turn.
    fn is_of_first_team(self) -> bool {
        self.0 % 2 == 1
    }
}

impl Thing {
    /// Returns the name, as labels have it.
    pub fn name(self) -> String {
        match self {
            Self::Ball => "ball".to_owned(),
            Self::Robot(RobotNumber(number)) => format!("robot_{number}"),
        }
    }

    /// Returns the colour of the ball, or of the robot's team, sRGB: those of the program's data sets.
    pub fn srgb(self) -> [u8; 3] {
        match self {
            Self::Ball => [225, 124, 48],
            Self::Robot(number) if number.is_of_first_team() => [48, 69, 188],
            Self::Robot(_) => [195, 48, 48],
        }
    }
}

/// Thing with its place and heading on the field; the heading of a ball means nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedThing {
    pub thing: Thing,
    pub place: Pose2,
}

/// Change that the user makes to things.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gesture {
    /// Chooses a thing, so that it can be removed.
    Choose(Thing),
    /// Moves a thing to a place in the world, metres.
    MoveTo(Thing, DVec2),
    /// Turns a robot to a heading, radians.
    TurnTo(Thing, f64),
    /// Turns a robot by an angle, radians.
    TurnBy(Thing, f64),
}

/// Camera where it stands: new things are put where it sees them.
#[derive(Debug, Clone, Copy)]
pub struct Eye<'a> {
    pub camera: &'a Camera,
    pub pose: CameraPose,
}

/// All things on the field.
#[derive(Debug, Clone)]
pub struct Things {
    placed: Vec<PlacedThing>,
    chosen: Option<Thing>,
    is_shown: bool,
    /// Largest distance from the field's centre along x and y, metres.
    reach_m: DVec2,
    robots_so_far: u32,
}

impl Things {
    /// Puts a ball and a robot before a camera.
    pub fn before(eye: Eye, field: &FieldDimensions) -> Self {
        let reach_m = field.carpet_half_extent_m() + MARGIN_M;
        let mut things = Self { placed: Vec::new(), chosen: None, is_shown: true, reach_m, robots_so_far: 0 };
        things.put_ball(eye);
        things.add_robot(eye);
        things.chosen = None;
        things
    }

    /// Returns the things that are shown.
    pub fn shown(&self) -> &[PlacedThing] {
        if self.is_shown { &self.placed } else { &[] }
    }

    /// Whether things are shown.
    pub fn is_shown(&self) -> bool {
        self.is_shown
    }

    /// Shows the things, or hides all of them; they keep their places.
    pub fn show(&mut self, is_shown: bool) {
        self.is_shown = is_shown;
    }

    /// Returns the thing that was touched last, if it is shown.
    pub fn chosen(&self) -> Option<PlacedThing> {
        self.shown().iter().find(|placed| Some(placed.thing) == self.chosen).copied()
    }

    /// Whether another robot may be added.
    pub fn has_room(&self) -> bool {
        self.robots().count() < MOST_ROBOTS
    }

    /// Returns the place nearest to `to` on the way there from a place in reach that things can reach, metres.
    pub fn within_reach(&self, from: DVec2, to: DVec2) -> DVec2 {
        let share = |from: f64, to: f64, reach_m: f64| {
            if to.abs() > reach_m { (reach_m.copysign(to) - from) / (to - from) } else { 1.0 }
        };
        let shares = [share(from.x, to.x, self.reach_m.x), share(from.y, to.y, self.reach_m.y)];
        from.lerp(to, shares[0].min(shares[1]).clamp(0.0, 1.0))
    }

    /// Changes a thing as the user does; what is not on the field, and numbers that are not finite, change nothing.
    pub fn obey(&mut self, gesture: Gesture) {
        let (Gesture::Choose(thing)
        | Gesture::MoveTo(thing, _)
        | Gesture::TurnTo(thing, _)
        | Gesture::TurnBy(thing, _)) = gesture;
        let reach_m = self.reach_m;
        let Some(placed) = self.placed.iter_mut().find(|placed| placed.thing == thing) else { return };
        let Pose2 { x_m, y_m, yaw_rad } = placed.place;
        let place = match gesture {
            Gesture::Choose(_) => placed.place,
            Gesture::MoveTo(_, to) if !to.is_finite() => return,
            Gesture::MoveTo(_, to) => {
                let to = to.clamp(-reach_m, reach_m);
                Pose2::new(to.x, to.y, yaw_rad)
            }
            Gesture::TurnTo(_, yaw_rad) => Pose2::new(x_m, y_m, wrap_angle(yaw_rad)),
            Gesture::TurnBy(_, by_rad) => Pose2::new(x_m, y_m, wrap_angle(yaw_rad + by_rad)),
        };
        if place.yaw_rad.is_finite() {
            placed.place = place;
            self.chosen = Some(thing);
        }
    }

    /// Puts the ball before a camera, and chooses it.
    pub fn put_ball(&mut self, eye: Eye) {
        let place = self.seen(eye, BALL_AHEAD_M).unwrap_or_else(|| self.at_middle(eye));
        self.is_shown = true;
        self.chosen = Some(Thing::Ball);
        let ball = PlacedThing { thing: Thing::Ball, place: Pose2::new(place.x, place.y, 0.0) };
        match self.placed.iter_mut().find(|placed| placed.thing == Thing::Ball) {
            Some(placed) => *placed = ball,
            None => self.placed.insert(0, ball),
        }
    }

    /// Adds a robot before a camera, which it faces, and chooses it; nothing happens where there are enough.
    pub fn add_robot(&mut self, eye: Eye) {
        if !self.has_room() {
            return;
        }
        let seen = ROBOTS_AHEAD_M.iter().filter_map(|&ahead_m| self.seen(eye, ahead_m));
        let ahead = ROBOTS_AHEAD_M.iter().map(|&ahead_m| self.ahead(eye.pose, ahead_m));
        let middle = self.at_middle(eye);
        let place = seen.chain(ahead).find(|&place| self.is_free(place)).unwrap_or(middle);
        let back = eye.pose.planar().position_in_world() - place;
        let yaw_rad = if back.length() > 1e-3 { back.to_angle() } else { eye.pose.yaw_rad + PI };
        self.robots_so_far += 1;
        let thing = Thing::Robot(RobotNumber(self.robots_so_far));
        self.placed.push(PlacedThing { thing, place: Pose2::new(place.x, place.y, wrap_angle(yaw_rad)) });
        self.is_shown = true;
        self.chosen = Some(thing);
    }

    /// Removes the thing that was touched last.
    pub fn remove_chosen(&mut self) {
        if let Some(chosen) = self.chosen() {
            self.placed.retain(|placed| placed.thing != chosen.thing);
            self.chosen = None;
        }
    }

    fn robots(&self) -> impl Iterator<Item = &PlacedThing> {
        self.placed.iter().filter(|placed| placed.thing != Thing::Ball)
    }

    fn is_free(&self, place: DVec2) -> bool {
        self.placed.iter().all(|placed| placed.place.position_in_world().distance(place) >= ROOM_M)
    }

    /// Returns a place ahead of a pose, metres forwards and to the left, in reach.
    fn ahead(&self, pose: CameraPose, [forward_m, left_m]: [f64; 2]) -> DVec2 {
        let moved = pose.planar().moved(Motion2 { forward_m, left_m, turn_rad: 0.0 });
        moved.position_in_world().clamp(-self.reach_m, self.reach_m)
    }

    /// Returns a place ahead of a camera if the camera sees the ground there.
    fn seen(&self, Eye { camera, pose }: Eye, ahead_m: [f64; 2]) -> Option<DVec2> {
        let place = self.ahead(pose, ahead_m);
        camera.project(pose.camera_from_world(place.extend(0.0))).is_ok().then_some(place)
    }

    /// Returns the place on the ground in the middle of the picture, in reach; one ahead if no ground is there.
    fn at_middle(&self, Eye { camera, pose }: Eye) -> DVec2 {
        let middle = 0.5 * DVec2::new(f64::from(camera.width - 1), f64::from(camera.height - 1));
        let ground = camera.unproject_to_ground(pose, middle);
        ground
            .map_or_else(|_| self.ahead(pose, BALL_AHEAD_M), |place| place.clamp(-self.reach_m, self.reach_m))
    }
}

#[cfg(test)]
mod tests;
