//! People and robots that move.

use glam::{Vec2, Vec3};
use reality_sim_core::field::FieldDimensions;

use crate::{figures, random::Random, solid::Thing, trajectory::Trajectory};

/// Person or robot on the way to and fro.
pub struct Mover {
    /// Figure in the middle of the field.
    pub figure: Thing,
    /// One end of the way, metres.
    pub from: Vec2,
    /// The other end, metres.
    pub to: Vec2,
    /// Speed, metres per second.
    pub speed_m_per_s: f32,
    /// Time at which the figure was at the first end, seconds.
    pub start_s: f32,
}

impl Mover {
    /// Returns the figure where it is at a time, seconds.
    pub fn at(&self, time_s: f32) -> Thing {
        let length = self.from.distance(self.to);
        let way = ((time_s - self.start_s) * self.speed_m_per_s / length).rem_euclid(2.0);
        let place = self.from.lerp(self.to, if way > 1.0 { 2.0 - way } else { way });
        self.figure.moved(place.extend(0.0))
    }
}

/// Draws people on straight paths across the field that keep clear of the camera's.
pub fn people(seed: u64, count: u32, field: &FieldDimensions, trajectory: &Trajectory) -> Vec<Mover> {
    let random = &mut Random::stream(seed, "people", 0);
    let reach = [field.length_m, field.width_m].map(|side| side / 2.0 + 0.2);
    (0..count).map(|_| person(random, reach, trajectory)).collect()
}

fn person(random: &mut Random, [x, y]: [f64; 2], trajectory: &Trajectory) -> Mover {
    let end = |random: &mut Random| Vec2::new(random.between(-x, x) as f32, random.between(-y, y) as f32);
    let (mut from, mut to) = (end(random), end(random));
    for _ in 0..500 {
        let along = (0..=8).map(|part| from.lerp(to, part as f32 / 8.0));
        let clear = along.map(|place| trajectory.clearance_m(place.as_dvec2())).fold(f64::INFINITY, f64::min);
        if clear > 0.6 && from.distance(to) > 1.2 {
            break;
        }
        (from, to) = (end(random), end(random));
    }
    let heading = (to - from).to_angle();
    let dark = Vec3::splat(random.between(0.015, 0.04) as f32);
    let figure = figures::person(heading, dark, 1.0);
    let speed_m_per_s = random.between(0.5, 1.0) as f32;
    Mover { figure, from, to, speed_m_per_s, start_s: random.between(-5.0, 5.0) as f32 }
}
