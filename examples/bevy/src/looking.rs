//! The systems: cameras look, and their pictures become images.

use std::mem::discriminant;

use bevy::prelude::*;
use reality_sim::simulator::{Ball, Humanoid, Layer};

use crate::{
    axes::camera_pose,
    ball::RealityBall,
    camera::{LookStatus, RealityCamera},
    picture::write_picture,
    robot::RealityRobot,
};

type Placed<'a, T> = (Entity, &'a T, &'a GlobalTransform, Option<&'a Name>);

/// Lets all cameras look, each on a thread of its own where there are several.
pub(crate) fn look(
    time: Res<Time>,
    balls: Query<Placed<'_, RealityBall>>,
    robots: Query<Placed<'_, RealityRobot>>,
    parents: Query<&ChildOf>,
    mut cameras: Query<(Entity, &mut RealityCamera, &GlobalTransform)>,
) {
    let time_s = time.elapsed_secs_f64();
    let balls: Vec<Ball> =
        balls.iter().map(|(_, ball, place, name)| ball.layer(place, name_or(name, "ball"))).collect();
    let robots: Vec<(Entity, Humanoid)> = robots
        .iter()
        .map(|(entity, robot, place, name)| (entity, robot.layer(place, name_or(name, "robot"))))
        .collect();
    cameras.par_iter_mut().for_each(|(entity, mut camera, place)| {
        if !camera.is_active {
            return;
        }
        let carries = |robot: Entity| robot == entity || parents.iter_ancestors(entity).any(|it| it == robot);
        let others =
            robots.iter().filter(|(robot, _)| !carries(*robot)).map(|(_, robot)| robot as &dyn Layer);
        let layers: Vec<&dyn Layer> = balls.iter().map(|ball| ball as &dyn Layer).chain(others).collect();
        let before = discriminant(&camera.status);
        camera.look(camera_pose(place), &layers, time_s);
        if discriminant(&camera.status) != before {
            report(entity, &camera.status);
        }
    });
}

/// Writes what cameras see into their images. A camera without a picture leaves its image as it is.
pub(crate) fn show(cameras: Query<&RealityCamera>, mut images: ResMut<Assets<Image>>) {
    for camera in cameras.iter().filter(|camera| camera.is_active && camera.status.is_seen()) {
        if let Some(mut image) = images.get_mut(&camera.image) {
            write_picture(&camera.frame.picture, &mut image);
        }
    }
}

fn name_or<'a>(name: Option<&'a Name>, usual: &'a str) -> &'a str {
    name.map_or(usual, Name::as_str)
}

/// Reports a new status, not that it lasts.
fn report(camera: Entity, status: &LookStatus) {
    match status {
        LookStatus::Waiting | LookStatus::Seen => {}
        LookStatus::NotRecorded(reason) => warn!("camera {camera} keeps its last picture: {reason}"),
        LookStatus::Failed(reason) => error!("camera {camera} keeps its last picture: {reason}"),
    }
}
