//! The hall: carpet with paint, floor, walls, posters, goals, a ball, robots, people; and the light along a ray.

use std::f32::consts::{PI, TAU};

use glam::{DVec2, Mat3, Vec2, Vec3};

use crate::{
    effect::Light,
    nominal::Nominal,
    random::Random,
    solid::{Part, Thing},
    texture::Texture,
    trajectory::Trajectory,
    truth::Truth,
};

/// Distance from the carpet's edge to the walls, metres.
const AISLE_M: f32 = 2.2;
/// Height of the ceiling above the floor, metres.
const CEILING_M: f32 = 3.6;
const CEILING_RGB: Vec3 = Vec3::new(0.052, 0.048, 0.044);
const FOG_RGB: Vec3 = Vec3::new(0.30, 0.30, 0.30);
/// Size of the posters' blotches, metres.
const POSTER_CELL_M: f32 = 2.0;

/// Positions in a cell relative to its centre, as fractions of its sides: Hammersley's points of base 2, no two of which
/// share a row or a column.
const CELL_PLACES: [[f32; 2]; 16] = hammersley();

/// Hall during a recording.
pub struct Scene {
    truth: Truth,
    carpet_rgb: Vec3,
    line_rgb: Vec3,
    wall_rgb: [Vec3; 4],
    floor_rgb: Vec3,
    carpet_half: Vec2,
    room_half: Vec2,
    blotches: Texture,
    wear: Texture,
    grain: Texture,
    posters: Vec<Poster>,
    things: Vec<Thing>,
    people: Vec<Person>,
    lamps: Vec<Lamp>,
}

/// Rectangle on a wall.
struct Poster {
    /// Index of the wall: +x, −x, +y, −y.
    wall: usize,
    center: Vec2,
    half: Vec2,
    rgb: [Vec3; 2],
}

/// Person who crosses the field to and fro.
struct Person {
    figure: Thing,
    from: Vec2,
    to: Vec2,
    speed_m_per_s: f32,
    start_s: f32,
}

/// Uneven illumination: its strength, and the mean over the field that is subtracted from a spot.
struct Lamp {
    strength: f32,
    shape: Light,
    mean: f32,
}

/// Ray in the world, with the data for finding its neighbours.
pub struct Ray<'a> {
    /// Projection centre, metres.
    pub origin: Vec3,
    /// Unit vector.
    pub direction: Vec3,
    /// Differences from this ray to the next on its right and the next below, in the camera frame.
    pub steps_in_camera: [Vec3; 2],
    /// Rotation whose columns are the camera's axes in the world.
    pub world_from_camera: &'a Mat3,
}

/// Surface behind all things.
#[derive(Clone, Copy)]
enum Backdrop {
    Ground,
    Wall(usize),
    Ceiling,
}

impl Scene {
    /// Draws a hall from the seed around the true field, with robots beside the camera's path.
    pub fn new(seed: u64, nominal: &Nominal, truth: &Truth, trajectory: &Trajectory) -> Self {
        let random = &mut Random::stream(seed, "hall", 0);
        // A larger field lies on the same carpet in the same hall.
        let field = &nominal.field;
        let border = (field.border_strip_m + field.line_width_m / 2.0) as f32;
        let carpet_half = Vec2::new(field.length_m as f32, field.width_m as f32) / 2.0 + border;
        let room_half = carpet_half + AISLE_M;
        let mut grey = |low: f64, high: f64| Vec3::splat(random.between(low, high) as f32);
        let (wall_rgb, floor_rgb) =
            ([0; 4].map(|_| grey(0.07, 0.13)), grey(0.13, 0.2) * Vec3::new(1.05, 1.0, 0.95));
        let posters = (0..4)
            .flat_map(|wall| (0..3).map(move |_| wall))
            .map(|wall| Poster::new(random, wall, room_half));
        let posters = posters.collect();
        let mut things = vec![
            goal(truth, 1.0, Vec3::new(0.55, 0.42, 0.02)),
            goal(truth, -1.0, Vec3::new(0.03, 0.09, 0.4)),
        ];
        things.extend(standing_things(random, carpet_half, trajectory));
        let paper = &mut Random::stream(seed, "textures", 0);
        Self {
            carpet_rgb: single(nominal.light.carpet_rgb),
            line_rgb: single(nominal.light.line_rgb),
            wall_rgb,
            floor_rgb,
            carpet_half,
            room_half,
            blotches: Texture::new(paper, &[(0.16, 0.065), (0.07, 0.045)]),
            wear: Texture::new(paper, &[(0.05, 0.03)]),
            grain: Texture::new(paper, &[(0.3, 0.5), (0.08, 0.35)]),
            posters,
            things,
            people: people(seed, truth.people, trajectory),
            lamps: truth
                .lights
                .iter()
                .map(|&(strength, shape)| Lamp::new(strength, shape, nominal))
                .collect(),
            truth: truth.clone(),
        }
    }

    /// Returns everything that can stand in front of the backdrop at a time, seconds.
    pub fn things(&self, time_s: f64) -> Vec<Thing> {
        let people = self.people.iter().map(|person| person.at(time_s as f32));
        self.things.iter().cloned().chain(people).collect()
    }

    /// Returns the linear light along a ray, with `things` in its way.
    pub fn light<'a>(&self, ray: &Ray, things: impl Iterator<Item = &'a Thing>) -> Vec3 {
        let (mut distance, backdrop) = self.backdrop(ray);
        let mut thing_rgb = None;
        for thing in things {
            if let Some((nearer, rgb)) = thing.hit(ray.origin, ray.direction, distance) {
                (distance, thing_rgb) = (nearer, Some(rgb));
            }
        }
        let place = ray.origin + ray.direction * distance;
        let rgb = thing_rgb.unwrap_or_else(|| match backdrop {
            Backdrop::Ground => self.ground(ray, place.truncate()),
            Backdrop::Wall(wall) => self.wall(wall, place),
            Backdrop::Ceiling => CEILING_RGB,
        });
        let lit = rgb * self.lamps.iter().map(|lamp| lamp.gain(place.truncate())).product::<f32>();
        if self.truth.extinction_per_m == 0.0 {
            return lit;
        }
        let clear = (-(self.truth.extinction_per_m as f32) * distance).exp();
        FOG_RGB + (lit - FOG_RGB) * clear
    }

    fn backdrop(&self, ray: &Ray) -> (f32, Backdrop) {
        let Ray { origin, direction, .. } = *ray;
        let vertical = if direction.z < 0.0 {
            (self.ground_distance(origin, direction), Backdrop::Ground)
        } else {
            ((CEILING_M - origin.z) / direction.z, Backdrop::Ceiling)
        };
        let to_wall = |position: f32, way: f32, half: f32| (half * way.signum() - position) / way;
        let along_x = to_wall(origin.x, direction.x, self.room_half.x);
        let along_y = to_wall(origin.y, direction.y, self.room_half.y);
        let (nearer, wall) = if along_x < along_y {
            (along_x, usize::from(direction.x < 0.0))
        } else {
            (along_y, 2 + usize::from(direction.y < 0.0))
        };
        if vertical.0 < nearer { vertical } else { (nearer, Backdrop::Wall(wall)) }
    }

    /// Returns the distance at which a ray that points down meets the wavy ground: each step uses the height at the last
    /// position.
    fn ground_distance(&self, origin: Vec3, direction: Vec3) -> f32 {
        let flat = -origin.z / direction.z;
        (0..if self.truth.waves.is_empty() { 0 } else { 4 }).fold(flat, |distance, _| {
            let place = origin + direction * distance;
            (self.ground_height(place.truncate()) - origin.z) / direction.z
        })
    }

    fn ground_height(&self, place: Vec2) -> f32 {
        let waves = self.truth.waves.iter();
        let height = |&[amplitude, x, y, phase]: &[f64; 4]| {
            amplitude * (x * f64::from(place.x) + y * f64::from(place.y) + phase).sin()
        };
        waves.map(height).sum::<f64>() as f32
    }

    fn ground(&self, ray: &Ray, place: Vec2) -> Vec3 {
        if place.abs().cmpgt(self.carpet_half).any() {
            return self.floor_rgb * (1.0 + 0.12 * self.grain.at(place.x, place.y));
        }
        let paint = self.paint(ray, place);
        let carpet = self.carpet_rgb * ((1.0 - paint) * (1.0 + self.blotches.at(place.x, place.y)));
        if paint == 0.0 {
            return carpet;
        }
        carpet + self.line_rgb * (paint * (1.0 + self.wear.at(place.x, place.y)))
    }

    /// Returns the painted fraction of a ray's cell on the ground. A cell on an edge is sampled at many positions; otherwise
    /// edges along rows or columns would jump from ray to ray.
    fn paint(&self, ray: &Ray, place: Vec2) -> f32 {
        let pattern = &self.truth.pattern;
        let distance_m = pattern.distance_m(place.x, place.y);
        let [right, down] = ray.steps_in_camera;
        let stretch = ray.origin.z / (ray.direction.z * ray.direction.z).max(1e-6);
        if distance_m.abs() > 0.6 * stretch * (right.length() + down.length()) {
            return f32::from(u8::from(distance_m < 0.0));
        }
        let ground = |step: Vec3| {
            let direction = ray.direction + step;
            (ray.origin - direction * (ray.origin.z / direction.z.min(-1e-3))).truncate()
        };
        let here = ground(Vec3::ZERO);
        let [right, down] = [right, down].map(|step| *ray.world_from_camera * step);
        let painted = CELL_PLACES.iter().filter(|[x, y]| {
            let beside = place + ground(right * *x + down * *y) - here;
            pattern.distance_m(beside.x, beside.y) < 0.0
        });
        painted.count() as f32 / CELL_PLACES.len() as f32
    }

    fn wall(&self, wall: usize, place: Vec3) -> Vec3 {
        let along = Vec2::new(if wall < 2 { place.y } else { place.x }, place.z);
        let poster = self
            .posters
            .iter()
            .find(|poster| poster.wall == wall && (along - poster.center).abs().cmple(poster.half).all());
        match poster {
            Some(Poster { rgb: [a, b], .. }) => {
                let blotch = self.grain.at(along.x * POSTER_CELL_M, along.y * POSTER_CELL_M);
                a.lerp(*b, (0.5 + 0.5 * blotch).clamp(0.0, 1.0))
            }
            None => self.wall_rgb[wall] * (1.0 + 0.04 * self.grain.at(along.x, along.y)),
        }
    }
}

const fn hammersley() -> [[f32; 2]; 16] {
    let mut places = [[0.0; 2]; 16];
    let mut index = 0;
    while index < 16 {
        let mirrored = (index as u8).reverse_bits() >> 4;
        places[index] = [(index as f32 + 0.5) / 16.0 - 0.5, (mirrored as f32 + 0.5) / 16.0 - 0.5];
        index += 1;
    }
    places
}

/// Converts to the precision of the rays.
fn single(linear_rgb: [f64; 3]) -> Vec3 {
    Vec3::from(linear_rgb.map(|value| value as f32))
}

impl Poster {
    fn new(random: &mut Random, wall: usize, room_half: Vec2) -> Self {
        let reach = if wall < 2 { room_half.y } else { room_half.x } - 1.0;
        let mut number = |low: f32, high: f32| random.between(low.into(), high.into()) as f32;
        let center = Vec2::new(number(-reach, reach), number(0.8, 1.7));
        let half = Vec2::new(number(0.25, 0.7), number(0.2, 0.45));
        let mut color = || Vec3::new(number(0.02, 0.35), number(0.02, 0.35), number(0.02, 0.35));
        Self { wall, center, half, rgb: [color(), color()] }
    }
}

impl Person {
    fn at(&self, time_s: f32) -> Thing {
        let length = self.from.distance(self.to);
        let way = ((time_s - self.start_s) * self.speed_m_per_s / length).rem_euclid(2.0);
        let place = self.from.lerp(self.to, if way > 1.0 { 2.0 - way } else { way });
        self.figure.moved(place.extend(0.0))
    }
}

impl Lamp {
    fn new(strength: f64, shape: Light, nominal: &Nominal) -> Self {
        let mut lamp = Self { strength: strength as f32, shape, mean: 0.0 };
        let half = Vec2::new(nominal.field.length_m as f32, nominal.field.width_m as f32) / 2.0;
        let grid =
            |count: u8| (0..count).map(move |index| (f32::from(index) + 0.5) / f32::from(count) * 2.0 - 1.0);
        let places = grid(60).flat_map(|x| grid(40).map(move |y| half * Vec2::new(x, y)));
        lamp.mean = places.map(|place| lamp.brightness(place)).sum::<f32>() / 2400.0;
        lamp
    }

    fn brightness(&self, place: Vec2) -> f32 {
        match self.shape {
            Light::Gradient { direction_rad } => place.dot(DVec2::from_angle(direction_rad).as_vec2()) / 3.0,
            Light::Spot { center_m, sigma_m } => {
                (-0.5 * place.distance_squared(center_m.as_vec2()) / (sigma_m * sigma_m) as f32).exp()
            }
        }
    }

    fn gain(&self, place: Vec2) -> f32 {
        (1.0 + self.strength * (self.brightness(place) - self.mean)).max(0.0)
    }
}

/// Builds the goal on one side: two posts, a bar and a back of cloth.
fn goal(truth: &Truth, side: f32, rgb: Vec3) -> Thing {
    let field = &truth.field;
    let x = side * field.length_m as f32 / 2.0;
    let radius = field.goal_post_diameter_m as f32 / 2.0;
    let y = field.goal_width_m as f32 / 2.0 + radius;
    let top = field.goal_height_m as f32 + radius;
    let depth = 0.45 * side;
    let post = |y: f32| Part::tube(Vec3::new(x, y, 0.0), Vec3::new(x, y, top), radius, rgb);
    let bar = Part::tube(Vec3::new(x, -y, top), Vec3::new(x, y, top), radius, rgb);
    let back = Vec3::new(x + depth, 0.0, 0.35);
    Thing::new(vec![post(y), post(-y), bar, Part::cuboid(back, Vec3::new(0.01, y, 0.35), 0.0, rgb * 0.7)])
}

/// Draws a ball, one to three robots on the field, and boxes beside it.
fn standing_things(random: &mut Random, carpet_half: Vec2, trajectory: &Trajectory) -> Vec<Thing> {
    let mut things = Vec::new();
    let ball = free_place(random, carpet_half - 1.0, 0.4, trajectory);
    things.push(Thing::new(vec![Part::ball(ball.extend(0.07), 0.07, Vec3::new(0.5, 0.14, 0.01))]));
    for _ in 0..=random.below(3) {
        let place = free_place(random, carpet_half - 0.8, 0.7, trajectory);
        let heading = random.between(0.0, TAU.into()) as f32;
        let grey = random.between(0.02, 0.09) as f32;
        let tint = Vec3::new(random.between(0.7, 1.5) as f32, 1.0, random.between(0.7, 1.5) as f32);
        things.push(robot(heading, tint * grey).moved(place.extend(0.0)));
    }
    for index in 0..5 {
        let angle = (index as f32 + random.uniform() as f32) * TAU / 5.0;
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
        things.push(Thing::new(vec![Part::cuboid(beside.extend(half.z), half, angle, rgb)]));
    }
    things
}

/// Draws a position that the camera keeps away from; the last of many draws if the camera goes everywhere.
fn free_place(random: &mut Random, half: Vec2, clearance_m: f64, trajectory: &Trajectory) -> Vec2 {
    let mut place = Vec2::ZERO;
    for _ in 0..200 {
        place = Vec2::new(random.between(-1.0, 1.0) as f32, random.between(-1.0, 1.0) as f32) * half;
        if trajectory.clearance_m(place.as_dvec2()) > clearance_m {
            break;
        }
    }
    place
}

/// Builds a robot with two legs, a body, two arms and a head, half a metre tall.
fn robot(heading_rad: f32, rgb: Vec3) -> Thing {
    let side = Vec2::from_angle(heading_rad + PI / 2.0);
    let part = |across: f32, height: f32, half: [f32; 3]| {
        Part::cuboid((side * across).extend(height), half.into(), heading_rad, rgb)
    };
    Thing::new(vec![
        part(0.05, 0.12, [0.035, 0.03, 0.12]),
        part(-0.05, 0.12, [0.035, 0.03, 0.12]),
        part(0.0, 0.33, [0.05, 0.08, 0.1]),
        part(0.12, 0.32, [0.03, 0.025, 0.1]),
        part(-0.12, 0.32, [0.03, 0.025, 0.1]),
        part(0.0, 0.48, [0.04, 0.04, 0.045]),
    ])
}

/// Draws people on straight paths across the field that keep clear of the camera's.
fn people(seed: u64, count: u32, trajectory: &Trajectory) -> Vec<Person> {
    let random = &mut Random::stream(seed, "people", 0);
    (0..count).map(|_| person(random, trajectory)).collect()
}

fn person(random: &mut Random, trajectory: &Trajectory) -> Person {
    let end =
        |random: &mut Random| Vec2::new(random.between(-3.2, 3.2) as f32, random.between(-2.2, 2.2) as f32);
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
    let body = Part::cuboid(Vec3::new(0.0, 0.0, 1.1), Vec3::new(0.14, 0.22, 0.35), heading, dark * 1.3);
    let legs = Part::cuboid(Vec3::new(0.0, 0.0, 0.38), Vec3::new(0.11, 0.16, 0.38), heading, dark);
    let head = Part::ball(Vec3::new(0.0, 0.0, 1.6), 0.12, dark * 2.0);
    let figure = Thing::new(vec![legs, body, head]);
    let speed_m_per_s = random.between(0.5, 1.0) as f32;
    Person { figure, from, to, speed_m_per_s, start_s: random.between(-5.0, 5.0) as f32 }
}
