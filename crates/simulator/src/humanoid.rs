//! A humanoid robot of simple parts, of the proportions of a small humanoid such as a NAO or a KidSize robot.

use std::borrow::Cow;

use glam::{DAffine3, DMat3, DVec2, DVec3, Quat, Vec3};
use reality_sim_core::pose::Pose2;

use crate::{
    canvas::Canvas,
    class::Class,
    layer::{Layer, Object, Sphere},
    mesh::Mesh,
    raster::{Placed, draw_mesh},
    shading::Shading,
    view::View,
};

/// Largest angle of a thigh before and behind the hip while walking, radians.
const STRIDE_RAD: f32 = 0.3;
/// Bend of the knees while standing, and what the leg that swings forward adds, radians.
const KNEE_RAD: [f32; 2] = [0.25, 0.5];
/// Largest angle of an arm before and behind the shoulder, radians.
const ARM_SWING_RAD: f32 = 0.35;
/// Bend of the elbows, radians.
const ELBOW_RAD: f32 = 0.5;
/// Reflectance of parts without a team's colour: grey plastic, and dark joints and feet.
const SHELL: Vec3 = Vec3::splat(0.55);
const JOINT: Vec3 = Vec3::splat(0.08);

/// Standing or walking humanoid. It looks along its heading.
#[derive(Debug, Clone, PartialEq)]
pub struct Humanoid {
    /// Name by which the simulator knows it.
    pub name: String,
    /// Place and heading of the point on the ground between its feet.
    pub place: Pose2,
    /// Height, metres.
    pub height_m: f64,
    /// Reflectance of what shows the team: trunk and upper arms; linear, 0 to 1.
    pub team_reflectance: Vec3,
    /// Phase of its gait, radians; `None` for one that stands.
    pub gait_rad: Option<f64>,
    /// Velocity, metres per second.
    pub velocity_in_world: DVec2,
}

impl Humanoid {
    /// Makes a humanoid that stands.
    pub fn standing(place: Pose2, height_m: f64, team_reflectance: Vec3) -> Self {
        let name = "robot".to_owned();
        Self { name, place, height_m, team_reflectance, gait_rad: None, velocity_in_world: DVec2::ZERO }
    }

    /// Gives the humanoid a name.
    pub fn named(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// Lets the humanoid walk: phase of its gait, radians, with its velocity, metres per second.
    pub fn walking(self, gait_rad: f64, velocity_in_world: DVec2) -> Self {
        Self { gait_rad: Some(gait_rad), velocity_in_world, ..self }
    }

    fn is_drawable(&self) -> bool {
        let Pose2 { x_m, y_m, yaw_rad } = self.place;
        let is_finite = [x_m, y_m, yaw_rad, self.height_m, self.gait_rad.unwrap_or(0.0)];
        is_finite.iter().all(|value| value.is_finite()) && self.height_m > 0.0
    }

    fn world_from_body(&self) -> DAffine3 {
        let turn =
            DMat3::from_rotation_z(self.place.yaw_rad) * DMat3::from_diagonal(DVec3::splat(self.height_m));
        DAffine3::from_mat3_translation(turn, self.place.position_in_world().extend(0.0))
    }

    /// Returns the body, 1 high, on the ground.
    fn body(&self) -> Mesh {
        let phase = self.gait_rad.map(|phase| phase.rem_euclid(std::f64::consts::TAU) as f32);
        let legs = [1.0, -1.0].map(|side: f32| Leg::new(side, phase));
        let lowest = legs.iter().map(|leg| leg.ankle.z).fold(f32::INFINITY, f32::min);
        let lift = Vec3::Z * (ANKLE_HEIGHT - lowest);
        let mut body = Mesh::default();
        for (leg, side) in legs.iter().zip([1.0, -1.0]) {
            leg.draw(lift, &mut body);
            arm(side, phase, lift, self.team_reflectance, &mut body);
        }
        let mut part = |mesh: Mesh, center: Vec3| body.add(&mesh, moved(center + lift));
        part(Mesh::cuboid(Vec3::new(0.07, 0.10, 0.12), self.team_reflectance), Vec3::new(0.0, 0.0, 0.62));
        part(Mesh::cuboid(Vec3::new(0.06, 0.08, 0.03), JOINT), Vec3::new(0.0, 0.0, 0.475));
        part(Mesh::rod(Vec3::ZERO, Vec3::Z * 0.05, 0.03, JOINT), Vec3::new(0.0, 0.0, 0.74));
        body.add(
            &Mesh::sphere(2, SHELL),
            scaled(Vec3::new(0.0, 0.0, 0.895) + lift, Vec3::new(0.085, 0.075, 0.095)),
        );
        body.add(
            &Mesh::cuboid(Vec3::new(0.02, 0.05, 0.02), JOINT),
            moved(Vec3::new(0.07, 0.0, 0.905) + lift),
        );
        body
    }
}

/// Height of the ankle over the sole.
const ANKLE_HEIGHT: f32 = 0.05;
/// Height of the hip of straight legs, and the lengths of thigh and shank.
const HIP: f32 = 0.46;
const THIGH: f32 = 0.205;

/// Leg in the frame of the body.
struct Leg {
    hip: Vec3,
    knee: Vec3,
    ankle: Vec3,
}

impl Leg {
    fn new(side: f32, phase: Option<f32>) -> Self {
        let swing = phase.map_or(0.0, |phase| side * phase.sin());
        let lift = phase.map_or(0.0, |phase| (side * phase.cos()).max(0.0));
        let knee_rad = KNEE_RAD[0] + lift * KNEE_RAD[1];
        let thigh_rad = STRIDE_RAD * swing + 0.5 * knee_rad;
        let hip = Vec3::new(0.0, 0.055 * side, HIP);
        let down = |angle_rad: f32| THIGH * Vec3::new(angle_rad.sin(), 0.0, -angle_rad.cos());
        let knee = hip + down(thigh_rad);
        Self { hip, knee, ankle: knee + down(thigh_rad - knee_rad) }
    }

    fn draw(&self, lift: Vec3, body: &mut Mesh) {
        let still = moved(lift);
        body.add(&Mesh::rod(self.hip, self.knee, 0.042, SHELL), still);
        body.add(&Mesh::rod(self.knee, self.ankle, 0.036, SHELL), still);
        let foot = self.ankle + Vec3::new(0.025, 0.0, -0.5 * ANKLE_HEIGHT);
        body.add(&Mesh::cuboid(Vec3::new(0.10, 0.05, 0.5 * ANKLE_HEIGHT), JOINT), moved(foot + lift));
    }
}

fn arm(side: f32, phase: Option<f32>, lift: Vec3, team: Vec3, body: &mut Mesh) {
    // An arm swings against the leg of its side.
    let swing_rad = phase.map_or(0.0, |phase| -ARM_SWING_RAD * side * phase.sin());
    let down = |angle_rad: f32| 0.15 * (Quat::from_rotation_y(-angle_rad) * Vec3::NEG_Z);
    let shoulder = Vec3::new(0.0, 0.14 * side, 0.71);
    let elbow = shoulder + down(swing_rad);
    body.add(&Mesh::rod(shoulder, elbow, 0.035, team), moved(lift));
    body.add(&Mesh::rod(elbow, elbow + down(swing_rad + ELBOW_RAD), 0.03, SHELL), moved(lift));
}

fn moved(by: Vec3) -> DAffine3 {
    DAffine3::from_translation(by.as_dvec3())
}

fn scaled(center: Vec3, size: Vec3) -> DAffine3 {
    DAffine3::from_mat3_translation(DMat3::from_diagonal(size.as_dvec3()), center.as_dvec3())
}

/// Spheres that stand for the body of height 1 where it takes light from the ground: feet and legs, trunk.
const OCCLUDERS: [([f64; 3], f64); 4] = [
    ([0.02, 0.055, 0.075], 0.07),
    ([0.02, -0.055, 0.075], 0.07),
    ([0.0, 0.0, 0.30], 0.09),
    ([0.0, 0.0, 0.62], 0.14),
];

impl Layer for Humanoid {
    fn objects(&self) -> Vec<Object<'_>> {
        vec![Object { class: Class::Robot, name: Cow::Borrowed(&self.name) }]
    }

    fn draw(&self, view: &View<'_>, canvas: &mut Canvas) {
        if !self.is_drawable() {
            return;
        }
        let placed = Placed {
            world_from_mesh: self.world_from_body(),
            velocity_in_world: self.velocity_in_world.extend(0.0),
        };
        let occluders = self.occluders();
        let shading =
            Shading { occluders: &occluders, ..Shading::matt(view.light_at(self.place.position_in_world())) };
        draw_mesh(view, canvas, &self.body(), &placed, &shading, 0);
    }

    fn occluders(&self) -> Vec<Sphere> {
        if !self.is_drawable() {
            return Vec::new();
        }
        let world_from_body = self.world_from_body();
        let sphere = |(center, radius): ([f64; 3], f64)| Sphere {
            center_in_world: world_from_body.transform_point3(DVec3::from_array(center)),
            radius_m: radius * self.height_m,
        };
        OCCLUDERS.map(sphere).to_vec()
    }
}
