//! Balls and robots, scattered at random over the part of the field that a camera sees.

use std::f64::consts::TAU;

use glam::{DVec2, Vec3};

use reality_sim_core::{
    camera::Camera,
    field::FieldDimensions,
    filter::{Purpose, Stream},
    pose::{CameraPose, Pose2},
};
use reality_sim_simulator::{Ball, Humanoid, Layer};

use super::Numbers;

/// Radius of the balls, metres: FIFA size 1, that of the ray-traced recordings.
const BALL_RADIUS_M: f64 = 0.065;
/// Reflectances of the balls: white, orange, yellow.
const BALL_REFLECTANCES: [Vec3; 3] =
    [Vec3::new(0.75, 0.75, 0.75), Vec3::new(0.75, 0.2, 0.03), Vec3::new(0.7, 0.6, 0.05)];
/// Least and greatest height of the robots, metres: the KidSize class has 0.4 m to 1 m, a NAO 0.58 m.
const ROBOT_HEIGHT_M: [f64; 2] = [0.45, 0.75];
/// Reflectances of the teams: red, blue, cyan, magenta.
const TEAM_REFLECTANCES: [Vec3; 4] = [
    Vec3::new(0.55, 0.03, 0.03),
    Vec3::new(0.03, 0.06, 0.5),
    Vec3::new(0.03, 0.4, 0.45),
    Vec3::new(0.45, 0.04, 0.4),
];
/// Space that a robot takes around its place, in its heights: arms and a stride.
const ROBOT_RADIUS: f64 = 0.25;
/// Space around the point below the camera that stays free, metres: the robot that carries it.
const CAMERA_RADIUS_M: f64 = 0.35;
/// Number of places that are drawn for a thing before it is left out.
const MOST_PLACES: u32 = 200;
/// Number of the first stream of the things; those before are of the poses.
const FIRST_STREAM: u32 = 1 << 23;

/// Numbers of random numbers of a thing; the two from `PLACE` on are its first place.
const KIND: u32 = 0;
const HEADING: u32 = 1;
const HEIGHT: u32 = 2;
const GAIT: u32 = 3;
const IS_WALKING: u32 = 4;
const PLACE: u32 = 5;

/// Source of the things in the pictures.
pub struct Things<'a> {
    pub field: &'a FieldDimensions,
    pub camera: &'a Camera,
    pub seed: u64,
    pub balls: Numbers,
    pub robots: Numbers,
}

/// Space on the ground that something takes.
#[derive(Debug, Clone, Copy)]
struct Disc {
    center: DVec2,
    radius_m: f64,
}

impl Disc {
    fn meets(&self, other: &Self) -> bool {
        self.center.distance(other.center) < self.radius_m + other.radius_m
    }
}

impl Things<'_> {
    /// Draws the things of a picture that is taken at a pose. They stand in view, on the carpet, and nowhere inside each other, in a
    /// post or in the robot that carries the camera.
    pub fn draw(&self, picture: u32, pose: CameraPose) -> Vec<Box<dyn Layer>> {
        let stream = |number: u32| Stream::new(self.seed, Purpose::Dataset, picture, FIRST_STREAM + number);
        let balls = self.balls.choose(stream(0).uniform(0));
        let robots = self.robots.choose(stream(0).uniform(1));
        let mut taken = self.taken(pose);
        let mut things: Vec<Box<dyn Layer>> = Vec::new();
        for number in 1..=balls {
            let stream = stream(number);
            let Some(place) = self.place(&stream, pose, BALL_RADIUS_M, &mut taken) else { continue };
            let reflectance = one_of(&BALL_REFLECTANCES, stream.uniform(KIND));
            let ball = Ball::on_ground(place.x, place.y, BALL_RADIUS_M, reflectance);
            things.push(Box::new(ball.named(format!("ball_{number}"))));
        }
        for number in 1..=robots {
            let stream = stream(balls + number);
            let [least_m, most_m] = ROBOT_HEIGHT_M;
            let height_m = least_m + (most_m - least_m) * stream.uniform(HEIGHT);
            let Some(place) = self.place(&stream, pose, ROBOT_RADIUS * height_m, &mut taken) else {
                continue;
            };
            let place = Pose2::new(place.x, place.y, TAU * stream.uniform(HEADING));
            let robot = Humanoid::standing(place, height_m, one_of(&TEAM_REFLECTANCES, stream.uniform(KIND)));
            let robot = robot.named(format!("robot_{number}"));
            let is_walking = stream.uniform(IS_WALKING) < 0.5;
            let gait_rad = TAU * stream.uniform(GAIT);
            things.push(Box::new(if is_walking { robot.walking(gait_rad, DVec2::ZERO) } else { robot }));
        }
        things
    }

    /// Returns the space that goals and the camera take.
    fn taken(&self, pose: CameraPose) -> Vec<Disc> {
        let posts = self.field.goals().into_iter().flat_map(|goal| goal.posts);
        let posts = posts.map(|post| Disc { center: post.center, radius_m: post.radius_m });
        let below = pose.planar().position_in_world();
        posts.chain([Disc { center: below, radius_m: CAMERA_RADIUS_M }]).collect()
    }

    /// Draws a place in view that is free, and takes it.
    fn place(
        &self,
        stream: &Stream,
        pose: CameraPose,
        radius_m: f64,
        taken: &mut Vec<Disc>,
    ) -> Option<DVec2> {
        let half = self.field.carpet_half_extent_m();
        let any = |number: u32| {
            let [x, y] = [2 * number, 2 * number + 1].map(|part| stream.uniform(PLACE + part));
            half * (2.0 * DVec2::new(x, y) - 1.0)
        };
        let is_free = |center: &DVec2| {
            let disc = Disc { center: *center, radius_m };
            let in_view = self.camera.project(pose.camera_from_world(center.extend(radius_m))).is_ok();
            in_view && !taken.iter().any(|other| disc.meets(other))
        };
        let center = (0..MOST_PLACES).map(any).find(is_free)?;
        taken.push(Disc { center, radius_m });
        Some(center)
    }
}

fn one_of<T: Copy>(list: &[T], random: f64) -> T {
    list[((random * list.len() as f64) as usize).min(list.len() - 1)]
}

#[cfg(test)]
mod tests {
    use reality_sim_core::camera::Distortion;

    use super::*;

    #[test]
    fn things_stand_apart_in_view_and_differ_from_picture_to_picture() {
        let field = FieldDimensions::preset("humanoid-kidsize-2010").expect("a preset");
        let camera =
            Camera::new([640, 480], [215.0, 215.0, 319.5, 239.5], Distortion::Pinhole).expect("a camera");
        let numbers: Numbers = "3".parse().expect("a number");
        let things = Things { field: &field, camera: &camera, seed: 7, balls: numbers, robots: numbers };
        let pose = CameraPose { x_m: -2.0, height_m: 0.5, pitch_rad: 0.3, ..CameraPose::default() };
        let mut before = String::new();
        for picture in 0..50 {
            let drawn = things.draw(picture, pose);
            assert_eq!(drawn.len(), 6, "there is room for all");
            let spheres: Vec<_> = drawn.iter().map(|thing| thing.occluders()).collect();
            for (index, one) in spheres.iter().enumerate() {
                assert!(camera.project(pose.camera_from_world(one[0].center_in_world)).is_ok());
                for other in spheres[index + 1..].iter().flatten() {
                    for sphere in one {
                        let distance_m = sphere.center_in_world.distance(other.center_in_world);
                        assert!(distance_m > sphere.radius_m + other.radius_m, "{sphere:?} {other:?}");
                    }
                }
            }
            let now = format!("{drawn:?}");
            assert_eq!(now, format!("{:?}", things.draw(picture, pose)));
            assert_ne!(now, before);
            before = now;
        }
    }
}
