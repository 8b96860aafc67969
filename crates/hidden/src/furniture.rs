//! Things that stand on the field and beside it.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};
use reality_sim_core::field::FieldDimensions;

use crate::{
    carpet::Shadow,
    figures,
    movers::Mover,
    random::Random,
    setting::HallPlan,
    solid::{Part, Thing},
    trajectory::Trajectory,
};

/// Things in a hall.
pub struct Furniture {
    /// Those that stand still.
    pub things: Vec<Thing>,
    /// Those that move.
    pub movers: Vec<Mover>,
    /// Shadows of those that stand on the carpet.
    pub shadows: Vec<Shadow>,
}

impl Furniture {
    /// Makes furniture that stands still and casts no shadows.
    pub fn standing(things: Vec<Thing>) -> Self {
        Self { things, movers: Vec::new(), shadows: Vec::new() }
    }
}

/// Draws goals, a ball, robots, people beside the field and boxes.
pub fn drawn(
    random: &mut Random,
    plan: &HallPlan,
    field: &FieldDimensions,
    carpet_half: Vec2,
    trajectory: &Trajectory,
) -> Furniture {
    let rgb = |values: [f64; 3]| Vec3::from(values.map(|value| value as f32));
    let [ahead, behind] = plan.goal_rgb.map(rgb);
    let mut furniture =
        Furniture::standing(vec![figures::goal(field, 1.0, ahead), figures::goal(field, -1.0, behind)]);
    let [x, y] = [field.length_m, field.goal_width_m].map(|side| side as f32 / 2.0);
    let radius = field.goal_post_diameter_m as f32 / 2.0;
    for post in [Vec2::new(x, y), Vec2::new(x, -y), Vec2::new(-x, y), Vec2::new(-x, -y)] {
        furniture.shadows.push(Shadow { center: post + radius * post.signum() * Vec2::Y, radius });
    }
    if plan.has_ball {
        let place = free_place(random, carpet_half - 1.0, 0.5, trajectory);
        let rgb = if random.sign() > 0.0 { Vec3::new(0.5, 0.14, 0.01) } else { Vec3::splat(0.45) };
        furniture.stand(&Thing::new(vec![Part::ball(Vec3::Z * 0.07, 0.07, rgb)]), place, 0.03);
    }
    for _ in 0..plan.robots {
        draw_robot(random, &mut furniture, carpet_half, trajectory);
    }
    for _ in 0..plan.people {
        draw_person(random, &mut furniture, carpet_half);
    }
    furniture.things.extend(boxes(random, carpet_half));
    furniture
}

impl Furniture {
    fn stand(&mut self, figure: &Thing, place: Vec2, radius: f32) {
        self.things.push(figure.moved(place.extend(0.0)));
        self.shadows.push(Shadow { center: place, radius });
    }
}

/// Draws a robot on the field; three of four stand.
fn draw_robot(random: &mut Random, furniture: &mut Furniture, carpet_half: Vec2, trajectory: &Trajectory) {
    let place = free_place(random, carpet_half - 0.8, 0.9, trajectory);
    let heading = random.between(0.0, TAU.into()) as f32;
    let grey = random.between(0.02, 0.2) as f32;
    let tint = Vec3::new(random.between(0.7, 1.5) as f32, 1.0, random.between(0.7, 1.5) as f32);
    let figure = figures::robot(heading, tint * grey, random.between(0.8, 1.6) as f32);
    let end = place + Vec2::from_angle(heading) * random.between(0.3, 1.2) as f32;
    let along = (0..=6).map(|part| place.lerp(end, part as f32 / 6.0).as_dvec2());
    let clear = along.map(|place| trajectory.clearance_m(place)).fold(f64::INFINITY, f64::min);
    if clear > 0.9 && random.uniform() < 0.25 {
        let speed_m_per_s = random.between(0.05, 0.3) as f32;
        furniture.movers.push(Mover { figure, from: place, to: end, speed_m_per_s, start_s: 0.0 });
    } else {
        furniture.stand(&figure, place, 0.1);
    }
}

/// Draws a person beside the field; half of them walk to and fro.
fn draw_person(random: &mut Random, furniture: &mut Furniture, carpet_half: Vec2) {
    let side = random.sign() as f32;
    let beside = |random: &mut Random| {
        let along = random.between(-1.0, 1.0) as f32 * carpet_half.x;
        Vec2::new(along, side * (carpet_half.y + random.between(0.0, 1.2) as f32))
    };
    let (from, to) = (beside(random), beside(random));
    let dark = Vec3::new(random.between(0.01, 0.12) as f32, 0.03, random.between(0.01, 0.12) as f32);
    let figure = figures::person((to - from).to_angle(), dark, random.between(0.92, 1.12) as f32);
    if from.distance(to) > 0.8 && random.uniform() < 0.5 {
        let speed_m_per_s = random.between(0.3, 1.0) as f32;
        furniture.movers.push(Mover { figure, from, to, speed_m_per_s, start_s: 0.0 });
    } else {
        furniture.stand(&figure, from, 0.15);
    }
}

/// Draws a ball, one to three robots on the field, and boxes beside it.
pub fn standing_things(random: &mut Random, carpet_half: Vec2, trajectory: &Trajectory) -> Vec<Thing> {
    let mut things = Vec::new();
    let ball = free_place(random, carpet_half - 1.0, 0.4, trajectory);
    things.push(Thing::new(vec![Part::ball(ball.extend(0.07), 0.07, Vec3::new(0.5, 0.14, 0.01))]));
    for _ in 0..=random.below(3) {
        let place = free_place(random, carpet_half - 0.8, 0.7, trajectory);
        let heading = random.between(0.0, TAU.into()) as f32;
        let grey = random.between(0.02, 0.09) as f32;
        let tint = Vec3::new(random.between(0.7, 1.5) as f32, 1.0, random.between(0.7, 1.5) as f32);
        things.push(figures::robot(heading, tint * grey, 1.0).moved(place.extend(0.0)));
    }
    things.extend(boxes(random, carpet_half));
    things
}

/// Draws boxes beside the carpet.
fn boxes(random: &mut Random, carpet_half: Vec2) -> Vec<Thing> {
    let make = |index: u8| {
        let angle = (f32::from(index) + random.uniform() as f32) * TAU / 5.0;
        let beside = Vec2::from_angle(angle) * (carpet_half + 1.0);
        let half = Vec3::new(
            random.between(0.15, 0.4) as f32,
            random.between(0.15, 0.4) as f32,
            random.between(0.15, 0.6) as f32,
        );
        let rgb = Vec3::new(
            random.between(0.01, 0.2) as f32,
            random.between(0.01, 0.2) as f32,
            random.between(0.02, 0.25) as f32,
        );
        Thing::new(vec![Part::cuboid(beside.extend(half.z), half, angle, rgb)])
    };
    (0..5).map(make).collect()
}

/// Draws a position that the camera keeps away from; the last of many draws if the camera goes everywhere.
pub fn free_place(random: &mut Random, half: Vec2, clearance_m: f64, trajectory: &Trajectory) -> Vec2 {
    let mut place = Vec2::ZERO;
    for _ in 0..200 {
        place = Vec2::new(random.between(-1.0, 1.0) as f32, random.between(-1.0, 1.0) as f32) * half;
        if trajectory.clearance_m(place.as_dvec2()) > clearance_m {
            break;
        }
    }
    place
}
