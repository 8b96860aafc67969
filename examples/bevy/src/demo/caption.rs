//! The picture of the camera in the window, and what is said about it.

use bevy::prelude::*;
use reality_sim_bevy::{LookStatus, RealityCamera, axes::camera_pose};

use super::layout::{
    FAINT_TEXT, PICTURE_CORNER_PX, PICTURE_PX, TEXT, TOP_VIEW_CORNER_PX, TOP_VIEW_PX, place, text,
};

/// Colour of the text when the camera shows its last picture.
const WARNING: Color = Color::srgb_u8(255, 140, 100);
/// Lines below the view from above: distance of the first from it, and of the second from the first, pixels.
const LINES_PX: [f32; 2] = [6.0, 20.0];
/// Depth of the picture: above the marks of the map, which may leave it.
const ABOVE_MAP: f32 = 8.0;
/// What the keys do.
const KEYS: &str = "WASD or arrows: drive   Q, E: sideways   Space: back to the path";

/// Line that says what the camera does.
#[derive(Debug, Clone, Copy, Component)]
pub struct Caption;

/// Shows the camera's image, and makes the lines.
pub fn spawn(mut commands: Commands, camera: Single<&RealityCamera>) {
    let lens = &camera.camera.synthesizer().archive().setup().camera;
    let size = Vec2::new(lens.width as f32, lens.height as f32);
    let size_px = size * (PICTURE_PX / size).min_element();
    commands.spawn((
        Sprite { custom_size: Some(size_px), ..Sprite::from_image(camera.image.clone()) },
        Transform::from_translation(place(PICTURE_CORNER_PX + 0.5 * PICTURE_PX, ABOVE_MAP)),
    ));
    let below_px = TOP_VIEW_CORNER_PX + Vec2::new(0.0, TOP_VIEW_PX.y + LINES_PX[0]);
    commands.spawn((text("", below_px, TEXT), Caption));
    commands.spawn(text(KEYS, below_px + Vec2::new(0.0, LINES_PX[1]), FAINT_TEXT));
}

/// Writes what the camera does.
pub fn write(
    camera: Single<(&RealityCamera, &GlobalTransform)>,
    caption: Single<(&mut Text2d, &mut TextColor), With<Caption>>,
) {
    let (camera, place) = *camera;
    let (mut text, mut color) = caption.into_inner();
    let pose = camera_pose(place);
    let [x_m, y_m, yaw_degrees] = [pose.x_m, pose.y_m, pose.yaw_rad.to_degrees()];
    let what = match &camera.status {
        LookStatus::Waiting => "not looked yet".to_owned(),
        LookStatus::Seen => format!("{:.0} % recorded", 100.0 * camera.frame.covered),
        LookStatus::NotRecorded(_) => "not recorded here".to_owned(),
        LookStatus::Failed(_) => "failed".to_owned(),
    };
    text.0 = format!("Camera at {x_m:5.2} m, {y_m:5.2} m, {yaw_degrees:4.0} degrees: {what}");
    color.0 = if camera.status.error().is_some() { WARNING } else { TEXT };
}
