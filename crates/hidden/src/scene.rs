//! The hall: carpet with paint, floor, walls, posters, goals, a ball, robots, people; and the light along a ray.

use glam::{Mat3, Vec2, Vec3};

use crate::{
    carpet::{Carpet, Shadow},
    figures::goal,
    furniture::{self, Furniture},
    lamps::Lamp,
    movers::{Mover, people},
    nominal::Nominal,
    pattern::Pattern,
    random::Random,
    setting::{HallPlan, Setting},
    solid::Thing,
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
    ceiling_m: f32,
    turf: Turf,
    wear: Texture,
    grain: Texture,
    posters: Vec<Poster>,
    furniture: Furniture,
    lamps: Vec<Lamp>,
}

/// Carpet, and what distinguishes paint from paint.
enum Turf {
    /// Blotches on an even carpet.
    Blotches(Texture),
    /// Uneven carpet.
    Laid(Box<Laid>),
}

struct Laid {
    carpet: Carpet,
    /// Factors on the reflectance of the parts of the pattern.
    paint: [f32; 7],
    /// Raggedness of the paint's edges, and its size in metres.
    edges: (Texture, f32),
}

/// What stands and moves in the hall at a time.
pub struct Moment {
    /// Things in front of the backdrop.
    pub things: Vec<Thing>,
    /// Shadows of those that move.
    pub shadows: Vec<Shadow>,
}

/// Rectangle on a wall.
struct Poster {
    /// Index of the wall: +x, −x, +y, −y.
    wall: usize,
    center: Vec2,
    half: Vec2,
    rgb: [Vec3; 2],
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
    pub fn new(seed: u64, setting: &Setting, truth: &Truth, trajectory: &Trajectory) -> Self {
        let nominal = &setting.nominal;
        let random = &mut Random::stream(seed, "hall", 0);
        // A larger field lies on the same carpet in the same hall.
        let carpet_half = carpet_half(nominal);
        let room_half = carpet_half + AISLE_M;
        let mut grey = |low: f64, high: f64| Vec3::splat(random.between(low, high) as f32);
        let (wall_rgb, floor_rgb) =
            ([0; 4].map(|_| grey(0.07, 0.13)), grey(0.13, 0.2) * Vec3::new(1.05, 1.0, 0.95));
        let posters = (0..4)
            .flat_map(|wall| (0..3).map(move |_| wall))
            .map(|wall| Poster::new(random, wall, room_half));
        let posters = posters.collect();
        let mut furniture = match &setting.hall {
            None => Furniture::standing(standing(random, truth, carpet_half, trajectory)),
            Some(plan) => furniture::drawn(random, plan, &truth.field, carpet_half, trajectory),
        };
        furniture.movers.extend(people(seed, truth.people, &nominal.field, trajectory));
        let paper = &mut Random::stream(seed, "textures", 0);
        let blotches = Texture::new(paper, &[(0.16, 0.065), (0.07, 0.045)]);
        let wear = setting.hall.as_ref().map_or((0.05, 0.03), |plan| plan.wear);
        let wear = Texture::new(paper, &[wear]);
        let grain = Texture::new(paper, &[(0.3, 0.5), (0.08, 0.35)]);
        let shadows = &furniture.shadows;
        let lamp_rgb = setting.hall.as_ref().map_or(Vec3::ONE, |plan| single(plan.lamp_rgb));
        let turf = match &setting.hall {
            None => Turf::Blotches(blotches),
            Some(plan) => Turf::Laid(Box::new(Laid::new(seed, plan, carpet_half, shadows))),
        };
        let lamp = |&(strength, shape)| Lamp::new(strength, shape, nominal);
        let [carpet, line] = truth.reflectance.map(|factor| factor as f32);
        Self {
            carpet_rgb: single(nominal.light.carpet_rgb) * carpet,
            line_rgb: single(nominal.light.line_rgb) * line,
            wall_rgb: wall_rgb.map(|rgb| rgb * lamp_rgb),
            floor_rgb: floor_rgb * lamp_rgb,
            carpet_half,
            room_half,
            ceiling_m: setting.hall.as_ref().map_or(CEILING_M, |plan| plan.ceiling_m as f32),
            turf,
            wear,
            grain,
            posters,
            furniture,
            lamps: truth.lights.iter().map(lamp).collect(),
            truth: truth.clone(),
        }
    }

    /// Returns what stands in front of the backdrop at a time, seconds.
    pub fn moment(&self, time_s: f64) -> Moment {
        let movers: Vec<Thing> =
            self.furniture.movers.iter().map(|mover: &Mover| mover.at(time_s as f32)).collect();
        let shadow = |thing: &Thing| Shadow { center: thing.center.truncate(), radius: 0.12 };
        let casts = matches!(self.turf, Turf::Laid(_));
        Moment {
            shadows: movers.iter().filter(|_| casts).map(shadow).collect(),
            things: self.furniture.things.iter().cloned().chain(movers).collect(),
        }
    }

    /// Returns the linear light along a ray, with `things` in its way and these shadows on the ground.
    pub fn light<'a>(&self, ray: &Ray, things: impl Iterator<Item = &'a Thing>, shadows: &[Shadow]) -> Vec3 {
        let (mut distance, backdrop) = self.backdrop(ray);
        let mut thing_rgb = None;
        for thing in things {
            if let Some((nearer, rgb)) = thing.hit(ray.origin, ray.direction, distance) {
                (distance, thing_rgb) = (nearer, Some(rgb));
            }
        }
        let place = ray.origin + ray.direction * distance;
        let rgb = thing_rgb.unwrap_or_else(|| match backdrop {
            Backdrop::Ground => self.ground(ray, place.truncate(), shadows, None),
            Backdrop::Wall(wall) => self.wall(wall, place),
            Backdrop::Ceiling => CEILING_RGB,
        });
        self.through_air(rgb, place, distance)
    }

    /// Returns the light along the ray in the middle of a pixel, if it is that of the whole pixel, since nothing but plain
    /// carpet is there. `ray` has the steps to the next pixels.
    pub fn plain_light(&self, ray: &Ray, shadows: &[Shadow]) -> Option<Vec3> {
        let (distance, Backdrop::Ground) = self.backdrop(ray) else { return None };
        let place = ray.origin + ray.direction * distance;
        let [right, down] = ray.steps_in_camera;
        let stretch = ray.origin.z / (ray.direction.z * ray.direction.z).max(1e-6);
        let reach_m = stretch * (right.length() + down.length());
        let ground = place.truncate();
        let inside = ground.abs().cmplt(self.carpet_half - reach_m).all();
        let from_paint_m = self.truth.pattern.distance_m(ground.x, ground.y).abs();
        if !inside || from_paint_m < reach_m + 0.01 {
            return None;
        }
        let painted = f32::from(u8::from(self.truth.pattern.distance_m(ground.x, ground.y) < 0.0));
        Some(self.through_air(self.ground(ray, ground, shadows, Some(painted)), place, distance))
    }

    fn through_air(&self, rgb: Vec3, place: Vec3, distance: f32) -> Vec3 {
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
            ((self.ceiling_m - origin.z) / direction.z, Backdrop::Ceiling)
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

    /// Returns the light from a place on the ground; `painted` is the part of it that is painted, if that is known.
    fn ground(&self, ray: &Ray, place: Vec2, shadows: &[Shadow], painted: Option<f32>) -> Vec3 {
        if place.abs().cmpgt(self.carpet_half).any() {
            return self.floor_rgb * (1.0 + 0.12 * self.grain.at(place.x, place.y));
        }
        let paint = painted.unwrap_or_else(|| self.paint(ray, place));
        match &self.turf {
            Turf::Blotches(blotches) => {
                let carpet = self.carpet_rgb * ((1.0 - paint) * (1.0 + blotches.at(place.x, place.y)));
                if paint == 0.0 {
                    return carpet;
                }
                carpet + self.line_rgb * (paint * (1.0 + self.wear.at(place.x, place.y)))
            }
            Turf::Laid(laid) => {
                let [right, down] = ray.steps_in_camera;
                let stretch = ray.origin.z / ray.direction.z.abs().powf(1.5).max(1e-4);
                let footprint_m = stretch * 0.5 * (right.length() + down.length());
                let spot = laid.carpet.spot(place, ray.direction, footprint_m);
                let carpet = self.carpet_rgb * spot.reflectance + spot.sheen;
                let shade: f32 = shadows.iter().map(|shadow| shadow.light(place)).product();
                let mut rgb = carpet * (1.0 - paint);
                if paint > 0.0 {
                    let wear = 1.0 + self.wear.at(place.x, place.y);
                    rgb += self.line_rgb * (paint * wear * laid.paint_at(&self.truth.pattern, place));
                }
                rgb * (spot.light * shade)
            }
        }
    }

    /// Returns the painted fraction of a ray's cell on the ground. A cell on an edge is sampled at many positions; otherwise
    /// edges along rows or columns would jump from ray to ray.
    fn paint(&self, ray: &Ray, place: Vec2) -> f32 {
        let pattern = &self.truth.pattern;
        let ragged_m = match &self.turf {
            Turf::Blotches(_) => 0.0,
            Turf::Laid(laid) => laid.edges.1 * laid.edges.0.at(place.x, place.y),
        };
        let distance_m = pattern.distance_m(place.x, place.y) + ragged_m;
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
            pattern.distance_m(beside.x, beside.y) + ragged_m < 0.0
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

impl Laid {
    fn new(seed: u64, plan: &HallPlan, carpet_half: Vec2, shadows: &[Shadow]) -> Self {
        let random = &mut Random::stream(seed, "carpet", 0);
        let carpet = Carpet::new(random, &plan.carpet, carpet_half, shadows);
        let paint = std::array::from_fn(|_| (1.0 + plan.line_spread * random.normal()) as f32);
        let (cell_m, ragged_m) = plan.edges;
        Self { carpet, paint, edges: (Texture::new(random, &[(cell_m, 1.0)]), ragged_m as f32) }
    }

    /// Returns the factor on the reflectance of the part of the pattern at a place.
    fn paint_at(&self, pattern: &Pattern, place: Vec2) -> f32 {
        let distances = pattern.distances_m(place.x, place.y).into_iter().zip(self.paint);
        distances.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(1.0, |(_, factor)| factor)
    }
}

/// Returns half the sides of the carpet, metres.
fn carpet_half(nominal: &Nominal) -> Vec2 {
    let field = &nominal.field;
    let border = (field.border_strip_m + field.line_width_m / 2.0) as f32;
    Vec2::new(field.length_m as f32, field.width_m as f32) / 2.0 + border
}

/// Returns goals in two colours and what stands about.
fn standing(random: &mut Random, truth: &Truth, carpet_half: Vec2, trajectory: &Trajectory) -> Vec<Thing> {
    let mut things = vec![
        goal(&truth.field, 1.0, Vec3::new(0.55, 0.42, 0.02)),
        goal(&truth.field, -1.0, Vec3::new(0.03, 0.09, 0.4)),
    ];
    things.extend(furniture::standing_things(random, carpet_half, trajectory));
    things
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
