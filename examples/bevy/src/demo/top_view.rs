//! The view from above: the field, the recorded poses, and where Bevy's entities are.

use std::f32::consts::FRAC_PI_2;

use bevy::prelude::*;
use reality_sim::{
    FieldDimensions,
    camera::Camera as Lens,
    field::{Curve, MARK_HALF_SIDE_M},
    glam::DVec2,
};
use reality_sim_bevy::{RealityBall, RealityCamera, axes::ground_pose};

use super::{
    layout::{TOP_VIEW_CORNER_PX, TOP_VIEW_PX, place},
    play::BALL_RADIUS_M,
    things::RobotNumber,
};

const CARPET: Color = Color::srgb_u8(18, 56, 36);
const BESIDE: Color = Color::srgb_u8(24, 38, 32);
const LINE: Color = Color::srgb_u8(225, 235, 228);
const RECORDED: Color = Color::srgba(0.35, 0.75, 1.0, 0.55);
/// As the things, brighter.
const BALL: Color = Color::WHITE;
const TEAMS: [Color; 2] = [Color::srgb_u8(90, 120, 255), Color::srgb_u8(240, 80, 75)];
const CAMERA: Color = Color::srgb_u8(255, 205, 0);
const BLIND: Color = Color::srgb_u8(255, 90, 60);
/// How far the sector of the view reaches, metres, and how much it hides.
const VIEW_RADIUS_M: f32 = 0.9;
const VIEW_ALPHA: f32 = 0.14;
/// Width of the rim around the ball, metres.
const RIM_M: f64 = 0.025;

/// Depths, from the ground up.
const LINES: f32 = 1.0;
const POSES: f32 = 2.0;
const VIEW: f32 = 3.0;
const THINGS: f32 = 4.0;

/// Mark on the map of an entity of Bevy's world.
#[derive(Debug, Clone, Copy, Component)]
#[require(Transform, Visibility)]
pub struct MarkOf(Entity);

/// Part of the camera's mark that shows whether there is a picture.
#[derive(Debug, Clone, Component)]
pub struct ViewMark {
    seen: Handle<ColorMaterial>,
    blind: Handle<ColorMaterial>,
}

/// What makes flat shapes; their sizes are metres.
struct Brush<'a> {
    meshes: &'a mut Assets<Mesh>,
    materials: &'a mut Assets<ColorMaterial>,
}

type Shape = (Mesh2d, MeshMaterial2d<ColorMaterial>, Transform);

impl Brush<'_> {
    fn shape(&mut self, mesh: impl Into<Mesh>, color: Color, at: Transform) -> Shape {
        (Mesh2d(self.meshes.add(mesh)), MeshMaterial2d(self.materials.add(color)), at)
    }

    fn curve(&mut self, curve: Curve, width_m: f64) -> Shape {
        match curve {
            Curve::Segment { from, to } => {
                let turn = Quat::from_rotation_z((to - from).to_angle() as f32);
                let size = Rectangle::new((from.distance(to) + width_m) as f32, width_m as f32);
                self.shape(size, LINE, at(0.5 * (from + to), LINES).with_rotation(turn))
            }
            Curve::Circle { center, radius_m } => {
                let [inner, outer] = [-0.5, 0.5].map(|side| (radius_m + side * width_m) as f32);
                let ring = Annulus::new(inner, outer).mesh().resolution(64).build();
                self.shape(ring, LINE, at(center, LINES))
            }
        }
    }
}

/// Makes the view from above.
pub fn spawn(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<ColorMaterial>>,
    camera: Single<(Entity, &RealityCamera)>,
    ball: Single<Entity, With<RealityBall>>,
    robots: Query<(Entity, &RobotNumber)>,
) {
    let (camera_entity, camera) = camera.into_inner();
    let archive = camera.camera.synthesizer().archive();
    let field = archive.field();
    let mut brush = Brush { meshes: &mut meshes, materials: &mut materials };
    let carpet_m = 2.0 * field.carpet_half_extent_m().as_vec2();
    let px_per_m = (TOP_VIEW_PX.x / carpet_m.x).min(TOP_VIEW_PX.y / carpet_m.y);

    let middle = place(TOP_VIEW_CORNER_PX + 0.5 * TOP_VIEW_PX, 0.0);
    commands.spawn((Sprite::from_color(BESIDE, TOP_VIEW_PX), Transform::from_translation(middle)));
    let scale = Vec3::new(px_per_m, px_per_m, 1.0);
    let ground = brush.shape(
        Rectangle::new(carpet_m.x, carpet_m.y),
        CARPET,
        Transform::from_translation(middle + 0.5 * Vec3::Z).with_scale(scale),
    );
    let mut ground = commands.spawn(ground);
    ground.with_children(|ground| {
        for shape in painted(&mut brush, field) {
            ground.spawn(shape);
        }
        let (_, color, _) = brush.shape(Circle::new(1.0), RECORDED, Transform::IDENTITY);
        let dot = Mesh2d(brush.meshes.add(Circle::new(0.018)));
        for image in archive.images() {
            let place = at(image.pose.planar().position_in_world(), POSES);
            ground.spawn((dot.clone(), color.clone(), place));
        }
        ground
            .spawn(MarkOf(camera_entity))
            .with_children(|mark| camera_mark(mark, &mut brush, &archive.setup().camera));
        ground.spawn(MarkOf(*ball)).with_children(|mark| ball_mark(mark, &mut brush));
        for (robot, number) in &robots {
            ground.spawn(MarkOf(robot)).with_children(|mark| robot_mark(mark, &mut brush, TEAMS[number.0]));
        }
    });
}

/// Returns what is painted on the carpet, and the goals.
fn painted(brush: &mut Brush<'_>, field: &FieldDimensions) -> Vec<Shape> {
    let mut shapes: Vec<Shape> =
        field.curves().into_iter().map(|curve| brush.curve(curve, field.line_width_m)).collect();
    let mark = Rectangle::from_length(2.0 * MARK_HALF_SIDE_M as f32);
    shapes.extend(field.marks().map(|mark_in_world| brush.shape(mark, LINE, at(mark_in_world, LINES))));
    let colors = [field.goal_srgb_negative_x, field.goal_srgb_positive_x];
    for (goal, srgb) in field.goals().into_iter().zip(colors) {
        let [red, green, blue] = srgb.unwrap_or([255; 3]);
        let color = Color::srgb_u8(red, green, blue);
        let [a, b] = goal.posts.map(|post| post.center);
        let bar = Rectangle::new(2.0 * goal.posts[0].radius_m as f32, a.distance(b) as f32);
        shapes.push(brush.shape(bar, color, at(0.5 * (a + b), LINES + 0.1)));
    }
    shapes
}

fn camera_mark(mark: &mut ChildSpawnerCommands<'_>, brush: &mut Brush<'_>, lens: &Lens) {
    let sector = CircularSector::new(VIEW_RADIUS_M, half_view_rad(lens) as f32);
    // A sector points along y, a heading of zero along x.
    let along_x = at(DVec2::ZERO, VIEW).with_rotation(Quat::from_rotation_z(-FRAC_PI_2));
    let view = brush.shape(sector, LINE.with_alpha(VIEW_ALPHA), along_x);
    let blind = brush.materials.add(BLIND.with_alpha(VIEW_ALPHA));
    mark.spawn((ViewMark { seen: view.1.0.clone(), blind }, view));
    mark.spawn(brush.shape(Circle::new(0.07), CAMERA, at(DVec2::ZERO, THINGS)));
}

/// Draws the ball, with a rim that tells it from white lines.
fn ball_mark(mark: &mut ChildSpawnerCommands<'_>, brush: &mut Brush<'_>) {
    for (radius_m, color, depth) in [(BALL_RADIUS_M + RIM_M, BESIDE, 0.3), (BALL_RADIUS_M, BALL, 0.4)] {
        mark.spawn(brush.shape(Circle::new(radius_m as f32), color, at(DVec2::ZERO, THINGS + depth)));
    }
}

/// Draws a robot: shoulders, head, and a nose that shows its heading.
fn robot_mark(mark: &mut ChildSpawnerCommands<'_>, brush: &mut Brush<'_>, team: Color) {
    let nose = Triangle2d::new(Vec2::new(0.2, 0.0), Vec2::new(0.06, 0.08), Vec2::new(0.06, -0.08));
    mark.spawn(brush.shape(nose, LINE, at(DVec2::ZERO, THINGS)));
    mark.spawn(brush.shape(Ellipse::new(0.075, 0.14), team, at(DVec2::ZERO, THINGS + 0.1)));
    mark.spawn(brush.shape(Circle::new(0.055), LINE, at(DVec2::ZERO, THINGS + 0.2)));
}

/// Returns the angle between the optical axis and what is seen at the left edge, at the axis's height, radians.
fn half_view_rad(lens: &Lens) -> f64 {
    lens.unproject(DVec2::new(0.0, lens.cy)).map_or(0.5, |ray| (-ray.x).atan2(ray.z).abs())
}

fn at(place_in_world: DVec2, depth: f32) -> Transform {
    Transform::from_xyz(place_in_world.x as f32, place_in_world.y as f32, depth)
}

/// Moves the marks to where their entities are.
pub fn follow(
    mut marks: Query<(&MarkOf, &mut Transform)>,
    places: Query<&Transform, Without<MarkOf>>,
    cameras: Query<&RealityCamera>,
    mut views: Query<(&ViewMark, &mut MeshMaterial2d<ColorMaterial>)>,
) {
    for (mark, mut transform) in &mut marks {
        if let Ok(place) = places.get(mark.0) {
            let pose = ground_pose(&(*place).into());
            transform.translation = Vec3::new(pose.x_m as f32, pose.y_m as f32, 0.0);
            transform.rotation = Quat::from_rotation_z(pose.yaw_rad as f32);
        }
    }
    let is_blind = cameras.iter().any(|camera| camera.status.error().is_some());
    for (mark, mut material) in &mut views {
        material.0 = if is_blind { mark.blind.clone() } else { mark.seen.clone() };
    }
}
