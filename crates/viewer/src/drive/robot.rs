//! The driven robot: its pose, and how keys, drawn paths and the mouse move it.

use glam::DVec2;
use reality_sim_core::{
    field::FieldDimensions,
    pose::{CameraPose, Motion2, Pose2},
};

use crate::shortcuts::Action;

/// Walking speed by keys, metres per second.
const WALK_M_PER_S: f64 = 0.4;
/// Turning speed by keys, radians per second.
const TURN_RAD_PER_S: f64 = 0.8;
/// Speed along a path, metres per second.
const FOLLOW_M_PER_S: f64 = 0.3;
/// Distance by which robots and ball may leave the carpet, metres.
pub const MARGIN_M: f64 = 1.0;
/// Distance between points of a path, metres.
const PATH_STEP_M: f64 = 0.05;
/// Look-ahead distance that gives the heading on a path, metres: hand-drawn lines are not straight.
const LOOK_AHEAD_M: f64 = 0.25;

/// The robot and the path drawn for it.
#[derive(Debug, Clone)]
pub struct Robot {
    pose: CameraPose,
    start: CameraPose,
    /// Largest distance from the field's centre along x and y, metres.
    reach_m: DVec2,
    path: Vec<DVec2>,
    /// Distance covered on the path, metres, while the robot follows it.
    followed_m: Option<f64>,
}

impl Robot {
    /// Places a robot at a pose.
    pub fn new(start: CameraPose, field: &FieldDimensions) -> Self {
        let reach_m = field.carpet_half_extent_m() + MARGIN_M;
        let mut robot = Self { pose: start, start, reach_m, path: Vec::new(), followed_m: None };
        robot.place(start);
        robot
    }

    /// Returns the camera's pose.
    pub fn pose(&self) -> CameraPose {
        self.pose
    }

    /// Moves the robot to a pose, clamped to where it may go; ignores poses that are not finite.
    pub fn place(&mut self, pose: CameraPose) {
        if !pose.is_finite() {
            return;
        }
        let place = pose.planar().position_in_world().clamp(-self.reach_m, self.reach_m);
        self.pose = pose.with_planar(Pose2::new(place.x, place.y, pose.yaw_rad));
    }

    /// Moves the robot to a planar pose, keeping height, pitch and roll.
    pub fn place_planar(&mut self, planar: Pose2) {
        self.place(self.pose.with_planar(planar));
    }

    /// Moves the robot by hand, which ends following the path.
    pub fn take(&mut self, pose: CameraPose) {
        self.followed_m = None;
        self.place(pose);
    }

    /// Returns the robot to its first pose.
    pub fn reset(&mut self) {
        self.take(self.start);
    }

    /// Walks for some seconds as the held keys direct; returns true if the robot moves.
    pub fn walk(&mut self, held: &[Action], seconds: f64) -> bool {
        let along = |plus: Action, minus: Action| {
            f64::from(u8::from(held.contains(&plus))) - f64::from(u8::from(held.contains(&minus)))
        };
        let step = DVec2::new(along(Action::Forward, Action::Backward), along(Action::Left, Action::Right));
        let step = WALK_M_PER_S * seconds * step.normalize_or_zero();
        let turn_rad = TURN_RAD_PER_S * seconds * along(Action::TurnLeft, Action::TurnRight);
        if step == DVec2::ZERO && turn_rad == 0.0 {
            return false;
        }
        self.followed_m = None;
        let motion = Motion2 { forward_m: step.x, left_m: step.y, turn_rad };
        self.place_planar(self.pose.planar().moved(motion));
        true
    }

    /// Returns the drawn path in the world frame, metres.
    pub fn path(&self) -> &[DVec2] {
        &self.path
    }

    /// Extends the path to a position.
    pub fn draw_to(&mut self, place_in_world: DVec2) {
        let place = place_in_world.clamp(-self.reach_m, self.reach_m);
        if self.path.last().is_none_or(|last| last.distance(place) >= PATH_STEP_M) {
            self.path.push(place);
        }
    }

    /// Deletes the path.
    pub fn clear_path(&mut self) {
        self.path.clear();
        self.followed_m = None;
    }

    /// Whether there is a path to follow.
    pub fn has_path(&self) -> bool {
        self.path.len() > 1
    }

    /// Whether the robot follows its path.
    pub fn is_following(&self) -> bool {
        self.followed_m.is_some()
    }

    /// Follows the path from its beginning, or stops.
    pub fn follow_or_stop(&mut self) {
        self.followed_m = if self.is_following() || !self.has_path() { None } else { Some(0.0) };
    }

    /// Follows the path for some seconds; returns true if the robot is following it.
    pub fn follow(&mut self, seconds: f64) -> bool {
        let Some(followed_m) = self.followed_m else { return false };
        let followed_m = followed_m + FOLLOW_M_PER_S * seconds;
        let place = along(&self.path, followed_m);
        let ahead = along(&self.path, followed_m + LOOK_AHEAD_M) - place;
        let yaw_rad = if ahead.length() > 0.5 * PATH_STEP_M { ahead.to_angle() } else { self.pose.yaw_rad };
        self.place_planar(Pose2::new(place.x, place.y, yaw_rad));
        self.followed_m = (followed_m < length_m(&self.path)).then_some(followed_m);
        true
    }
}

fn length_m(path: &[DVec2]) -> f64 {
    path.windows(2).map(|ends| ends[0].distance(ends[1])).sum()
}

/// Returns the position at this distance along a path, metres; its end beyond that.
fn along(path: &[DVec2], distance_m: f64) -> DVec2 {
    let mut left_m = distance_m;
    for ends in path.windows(2) {
        let step_m = ends[0].distance(ends[1]);
        if left_m < step_m {
            return ends[0].lerp(ends[1], left_m / step_m);
        }
        left_m -= step_m;
    }
    path.last().copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn robot() -> Robot {
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let start = CameraPose::new(Pose2::new(1.0, 0.5, 0.6), 0.5, 0.4, 0.02);
        Robot::new(start, &field)
    }

    #[test]
    fn keys_walk_as_fast_as_promised_in_the_robots_own_axes() {
        let mut robot = robot();
        let before = robot.pose().planar();
        assert!(robot.walk(&[Action::Forward], 0.5));
        let moved = before.motion_to(robot.pose().planar());
        assert!((moved.forward_m - 0.2).abs() < 1e-9 && moved.left_m.abs() < 1e-9, "{moved:?}");

        let before = robot.pose().planar();
        assert!(robot.walk(&[Action::Left, Action::Forward], 0.5));
        let moved = before.motion_to(robot.pose().planar());
        assert!((moved.distance_m() - 0.2).abs() < 1e-9, "no faster on the diagonal");
        assert!(moved.left_m > 0.1);

        let before = robot.pose().planar();
        assert!(robot.walk(&[Action::TurnRight], 0.5));
        let moved = before.motion_to(robot.pose().planar());
        assert!((moved.turn_rad + 0.4).abs() < 1e-9 && moved.distance_m() < 1e-9);
        assert!(!robot.walk(&[Action::Left, Action::Right], 0.5), "both at once cancel");
        assert!(!robot.walk(&[], 0.5));
        assert_eq!(robot.pose().height_m, 0.5);
    }

    #[test]
    fn the_robot_leaves_the_carpet_by_a_metre_at_most() {
        let mut robot = robot();
        robot.take(CameraPose { x_m: 90.0, y_m: -90.0, ..robot.pose() });
        let pose = robot.pose();
        let half = FieldDimensions::preset("humanoid-kidsize-2010").unwrap().carpet_half_extent_m();
        assert!((pose.x_m - half.x - 1.0).abs() < 1e-9 && (pose.y_m + half.y + 1.0).abs() < 1e-9, "{pose:?}");
        robot.take(CameraPose { yaw_rad: f64::NAN, ..pose });
        assert_eq!(robot.pose(), pose);
        robot.reset();
        assert_eq!(robot.pose(), self::robot().pose());
    }

    #[test]
    fn the_robot_follows_a_path_to_its_end_facing_along_it_and_stops() {
        let mut robot = robot();
        robot.follow_or_stop();
        assert!(!robot.is_following(), "there is no path");
        for step in 0..=10 {
            robot.draw_to(DVec2::new(0.1 * f64::from(step), 0.0));
        }
        for step in 1..=10 {
            robot.draw_to(DVec2::new(1.0, 0.1 * f64::from(step)));
        }
        robot.follow_or_stop();
        assert!(robot.follow(1.0));
        let pose = robot.pose();
        assert!((pose.x_m - 0.3).abs() < 1e-9 && pose.y_m.abs() < 1e-9 && pose.yaw_rad.abs() < 1e-9);
        let mut seconds = 1.0;
        while robot.follow(0.1) {
            seconds += 0.1;
        }
        let pose = robot.pose();
        assert!((pose.x_m - 1.0).abs() < 1e-9 && (pose.y_m - 1.0).abs() < 1e-9, "{pose:?}");
        assert!((pose.yaw_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
        assert!((seconds - 2.0 / FOLLOW_M_PER_S).abs() < 0.11, "{seconds}");
        robot.follow_or_stop();
        assert!(robot.walk(&[Action::Forward], 0.1) && !robot.is_following(), "keys take it off the path");
    }

    #[test]
    fn points_of_a_path_are_not_nearer_than_a_step() {
        let mut robot = robot();
        for step in 0..100 {
            robot.draw_to(DVec2::new(0.01 * f64::from(step), 0.0));
        }
        assert!(robot.path().windows(2).all(|ends| ends[0].distance(ends[1]) >= PATH_STEP_M - 1e-9));
        robot.clear_path();
        assert!(!robot.has_path());
    }
}
