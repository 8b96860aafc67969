//! The window: where its parts are, and the part that shows what the camera sees.

use bevy::{
    prelude::*,
    sprite::Anchor,
    window::{WindowPlugin, WindowResolution},
};

/// Space between parts and around them, pixels.
const GAP_PX: f32 = 16.0;
/// Height of a heading, pixels.
const HEADING_PX: f32 = 26.0;
/// Largest size of the camera's picture, pixels.
pub const PICTURE_PX: Vec2 = Vec2::new(640.0, 480.0);
/// Size of the view from above, pixels.
pub const TOP_VIEW_PX: Vec2 = Vec2::new(592.0, 432.0);
/// Size of the window, pixels.
const WINDOW_PX: Vec2 =
    Vec2::new(PICTURE_PX.x + TOP_VIEW_PX.x + 3.0 * GAP_PX, PICTURE_PX.y + HEADING_PX + 2.0 * GAP_PX);
/// Left upper corners, pixels to the right and down from that of the window.
pub const PICTURE_CORNER_PX: Vec2 = Vec2::new(GAP_PX, GAP_PX + HEADING_PX);
pub const TOP_VIEW_CORNER_PX: Vec2 = Vec2::new(PICTURE_PX.x + 2.0 * GAP_PX, GAP_PX + HEADING_PX);

/// Colour of the window.
pub const BACKGROUND: Color = Color::srgb_u8(17, 21, 20);
/// Colour of text.
pub const TEXT: Color = Color::srgb_u8(214, 222, 217);
/// Colour of text that matters less.
pub const FAINT_TEXT: Color = Color::srgb_u8(134, 148, 141);

/// Returns the plugin that opens the window.
pub fn window_plugin() -> WindowPlugin {
    let window = Window {
        title: "Reality Sim in Bevy".to_owned(),
        resolution: WindowResolution::new(WINDOW_PX.x as u32, WINDOW_PX.y as u32),
        resizable: false,
        ..default()
    };
    WindowPlugin { primary_window: Some(window), ..default() }
}

/// Returns a point of the window, pixels to the right and down from its left upper corner, for Bevy: from the middle, up. What
/// has a larger depth hides what has a smaller one.
pub fn place(point_px: Vec2, depth: f32) -> Vec3 {
    Vec3::new(point_px.x - 0.5 * WINDOW_PX.x, 0.5 * WINDOW_PX.y - point_px.y, depth)
}

/// Makes the camera of the window, which sees flat things, and the headings.
pub fn spawn(mut commands: Commands) {
    commands.spawn(Camera2d);
    let headings = [
        (PICTURE_CORNER_PX, "What the camera sees: recorded pictures with Bevy's ball and robots"),
        (TOP_VIEW_CORNER_PX, "Bevy's world from above; blue: where pictures were taken"),
    ];
    for (corner_px, heading) in headings {
        commands.spawn(text(heading, corner_px - Vec2::new(0.0, HEADING_PX + 2.0), TEXT));
    }
}

/// Returns a line of text whose left upper corner is at a point of the window.
pub fn text(text: &str, corner_px: Vec2, color: Color) -> impl Bundle + use<> {
    (
        Text2d::new(text),
        TextFont::from_font_size(15.0),
        TextColor(color),
        Anchor::TOP_LEFT,
        Transform::from_translation(place(corner_px, 9.0)),
    )
}
