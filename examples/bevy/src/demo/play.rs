//! The play: two robots and a ball that they kick to places before the camera.

use bevy::ecs::resource::Resource;
use reality_sim::{FieldDimensions, Pose2, glam::DVec2, pose::Motion2};

use super::walker::{Obstacle, Walker};

/// Radius of the ball, metres.
pub const BALL_RADIUS_M: f64 = 0.065;
/// Loss of speed of the rolling ball, metres per second squared.
const FRICTION_M_S2: f64 = 0.12;
/// Speed below which a robot kicks the ball, metres a second.
const SLOW_M_S: f64 = 0.05;
/// Distance from the ball's centre at which a robot kicks it, metres.
const REACH_M: f64 = 0.17;
/// Distance from the carpet's edge at which the ball comes back, metres.
const MARGIN_M: f64 = 0.2;
/// Places before the camera to which the ball is kicked in turn, metres forwards and to the left.
const TARGETS_M: [[f64; 2]; 5] = [[1.0, 0.5], [1.5, -0.4], [0.8, -0.2], [1.7, 0.4], [1.1, -0.6]];
/// Place at the beginning of the ball and of the robots, in the camera's frame as above, with headings.
const BALL_START_M: [f64; 2] = [0.8, -0.4];
const ROBOT_STARTS: [[f64; 3]; 2] = [[1.3, 0.75, -2.6], [1.25, -0.8, 2.6]];
/// Where a robot waits that does not go to the ball.
const POSTS_M: [[f64; 2]; 2] = [[1.3, 0.8], [1.4, -0.8]];

/// Ball and robots.
#[derive(Debug, Clone, Resource)]
pub struct Play {
    /// Centre of the ball on the ground.
    pub ball_in_world: DVec2,
    /// Velocity of the ball, metres a second.
    pub ball_velocity_in_world: DVec2,
    /// Robots.
    pub robots: [Walker; 2],
    kicks: usize,
    half_extent_m: DVec2,
}

impl Play {
    /// Starts a play before a camera.
    pub fn before(camera: Pose2, field: &FieldDimensions) -> Self {
        let start = |[forward_m, left_m, turn_rad]: [f64; 3]| {
            Walker::at(camera.moved(Motion2 { forward_m, left_m, turn_rad }))
        };
        Self {
            ball_in_world: ahead(camera, BALL_START_M),
            ball_velocity_in_world: DVec2::ZERO,
            robots: ROBOT_STARTS.map(start),
            kicks: 0,
            half_extent_m: field.carpet_half_extent_m() - MARGIN_M,
        }
    }

    /// Goes on for some time.
    pub fn step(&mut self, step_s: f64, camera: Pose2) {
        self.roll(step_s);
        let target = self.inside(ahead(camera, TARGETS_M[self.kicks % TARGETS_M.len()]));
        let direction = (target - self.ball_in_world).normalize_or(DVec2::X);
        let behind_ball = self.ball_in_world - REACH_M * direction;
        let [a, b] = [0, 1].map(|robot| self.robots[robot].pose.position_in_world());
        let kicker = usize::from(b.distance(behind_ball) < a.distance(behind_ball));
        let waiter = 1 - kicker;
        let carrier = Obstacle { place: camera.position_in_world(), room_m: 0.6 };
        let ball = Obstacle { place: self.ball_in_world, room_m: 0.22 };
        let robot = |place| Obstacle { place, room_m: 0.5 };

        let is_ready =
            self.robots[kicker].step(step_s, behind_ball, direction, &[carrier, ball, robot([a, b][waiter])]);
        let post = self.inside(ahead(camera, POSTS_M[waiter]));
        let to_ball = self.ball_in_world - [a, b][waiter];
        self.robots[waiter].step(step_s, post, to_ball, &[carrier, ball, robot([a, b][kicker])]);
        if is_ready && self.ball_velocity_in_world.length() < SLOW_M_S {
            let speed_m_s = (2.0 * FRICTION_M_S2 * target.distance(self.ball_in_world)).sqrt();
            self.ball_velocity_in_world = speed_m_s * direction;
            self.kicks += 1;
        }
    }

    /// Lets the ball roll; at the carpet's edge it comes back.
    fn roll(&mut self, step_s: f64) {
        let slower = (self.ball_velocity_in_world.length() - FRICTION_M_S2 * step_s).max(0.0);
        self.ball_velocity_in_world = slower * self.ball_velocity_in_world.normalize_or_zero();
        self.ball_in_world += step_s * self.ball_velocity_in_world;
        let inside = self.inside(self.ball_in_world);
        for axis in 0..2 {
            if inside[axis] != self.ball_in_world[axis] {
                self.ball_velocity_in_world[axis] *= -1.0;
            }
        }
        self.ball_in_world = inside;
    }

    fn inside(&self, place: DVec2) -> DVec2 {
        place.clamp(-self.half_extent_m, self.half_extent_m)
    }
}

/// Returns a place before the camera, metres forwards and to the left.
fn ahead(camera: Pose2, [forward_m, left_m]: [f64; 2]) -> DVec2 {
    camera.moved(Motion2 { forward_m, left_m, turn_rad: 0.0 }).position_in_world()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Plays before a camera that does not move, and looks at the play after every step.
    fn watch(mut look: impl FnMut(&Play)) -> Play {
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let camera = Pose2::new(-1.0, 0.0, 0.3);
        let mut play = Play::before(camera, &field);
        for _ in 0..2400 {
            play.step(0.05, camera);
            look(&play);
        }
        play
    }

    #[test]
    fn robots_kick_the_ball_again_and_again() {
        let play = watch(|_| {});
        assert!(play.kicks >= 6, "{} kicks in two minutes", play.kicks);
    }

    #[test]
    fn ball_and_robots_stay_on_the_carpet_and_apart() {
        watch(|play| {
            assert!(play.ball_in_world.abs().cmple(play.half_extent_m).all());
            let [a, b] = [0, 1].map(|robot| play.robots[robot].pose.position_in_world());
            assert!(a.distance(b) > 0.2, "{a} and {b}");
        });
    }
}
