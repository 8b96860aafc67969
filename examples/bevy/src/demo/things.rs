//! Entities of the camera, the ball and the robots.

use bevy::prelude::*;
use reality_sim::{glam::DVec3, simulator};
use reality_sim_bevy::{
    RealityBall, RealityCamera, RealityRobot,
    axes::{bevy_from_world, camera_transform, ground_transform},
};

use super::{
    driver::{Driver, step_s},
    play::{BALL_RADIUS_M, Play},
};

/// Height of the robots, metres.
const ROBOT_HEIGHT_M: f64 = 0.58;
/// Colours of the ball and of the teams.
const BALL: Color = Color::srgb_u8(235, 235, 235);
const TEAMS: [Color; 2] = [Color::srgb_u8(48, 69, 188), Color::srgb_u8(195, 48, 48)];

/// Camera of the library, until there is an entity for it.
#[derive(Debug, Resource)]
pub struct LibraryCamera(pub simulator::Camera);

/// Number of a robot of the play.
#[derive(Debug, Clone, Copy, Component)]
pub struct RobotNumber(pub usize);

/// Makes the entities.
pub fn spawn(
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    library: Res<LibraryCamera>,
    driver: Res<Driver>,
    play: Res<Play>,
) {
    let camera = RealityCamera::new(library.0.clone(), &mut images);
    commands.spawn((camera, camera_transform(driver.pose())));
    commands.remove_resource::<LibraryCamera>();
    let ball = RealityBall { gloss: 0.3, ..RealityBall::new(BALL_RADIUS_M, BALL) };
    commands.spawn((ball, ball_transform(&play), Name::new("ball")));
    for (number, (walker, team)) in play.robots.iter().zip(TEAMS).enumerate() {
        let robot = RealityRobot::standing(ROBOT_HEIGHT_M, team);
        let name = Name::new(["blue robot", "red robot"][number]);
        commands.spawn((RobotNumber(number), robot, ground_transform(walker.pose), name));
    }
}

/// Lets the play go on, and moves ball and robots as it says.
pub fn play(
    time: Res<Time>,
    driver: Res<Driver>,
    mut play: ResMut<Play>,
    ball: Single<(&mut RealityBall, &mut Transform), Without<RobotNumber>>,
    mut robots: Query<(&RobotNumber, &mut RealityRobot, &mut Transform)>,
) {
    play.step(step_s(&time), driver.pose().planar());
    let (mut ball, mut place) = ball.into_inner();
    *place = ball_transform(&play);
    ball.velocity_m_s = bevy_from_world(play.ball_velocity_in_world.extend(0.0));
    for (number, mut robot, mut place) in &mut robots {
        let walker = &play.robots[number.0];
        *place = ground_transform(walker.pose);
        robot.gait_rad = walker.is_walking().then_some(walker.gait_rad);
        robot.velocity_m_s = bevy_from_world(walker.velocity_in_world().extend(0.0));
    }
}

fn ball_transform(play: &Play) -> Transform {
    let center_in_world: DVec3 = play.ball_in_world.extend(BALL_RADIUS_M);
    Transform::from_translation(bevy_from_world(center_in_world))
}
