//! Carpet that is not even: rolls, pile, blotches, dirt, worn paths, stains, and shadows of what stands on it.

use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

use crate::{random::Random, texture::Texture};

/// Side of a cell of the finest map, metres.
const CELL_M: f32 = 0.01;
/// Number of maps, each half as fine as the one before.
const LEVELS: usize = 6;

/// Properties of a carpet.
#[derive(Debug, Clone, PartialEq)]
pub struct CarpetPlan {
    /// Width of the rolls, metres.
    pub roll_m: f64,
    /// Whether the rolls lie along x, else along y.
    pub rolls_along_x: bool,
    /// Largest difference of a roll's reflectance from the mean, as a fraction.
    pub roll_spread: f64,
    /// Loss of light in the seams between rolls, as a fraction.
    pub seam: f64,
    /// Brightness of the pile seen along it, which leans one way or the other in each roll, as a fraction.
    pub pile: f64,
    /// Blotches: size in metres and standard deviation as a fraction.
    pub blotches: Vec<(f64, f64)>,
    /// Standard deviation of brown dirt, as a fraction.
    pub dirt: f64,
    /// Number of paths worn by feet, and the largest change of reflectance there, as a fraction.
    pub paths: (u64, f64),
    /// Number of dark stains.
    pub stains: u64,
    /// Light reflected at grazing angles, linear.
    pub sheen: f64,
    /// Standard deviation of the light's unevenness over the hall, as a fraction.
    pub unevenness: f64,
}

/// Shadow of a thing that stands on the carpet.
#[derive(Debug, Clone, Copy)]
pub struct Shadow {
    /// Middle, metres.
    pub center: Vec2,
    /// Radius of the thing, metres.
    pub radius: f32,
}

/// Carpet ready to be looked at. Its mean reflectance is 1.
pub struct Carpet {
    rolls: Rolls,
    pile: f32,
    sheen: f32,
    maps: Vec<Map>,
}

struct Rolls {
    width_m: f32,
    along_x: bool,
    shift_m: f32,
    /// Reflectance relative to the mean, and lean of the pile, by roll.
    rolls: Vec<(f32, f32)>,
}

/// Reflectance in red, green and blue, and the light that reaches the carpet, in cells.
struct Map {
    corner: Vec2,
    cells_per_m: f32,
    columns: usize,
    rows: usize,
    values: Vec<Vec4>,
}

/// What the carpet does at a place.
#[derive(Debug, Clone, Copy)]
pub struct Spot {
    /// Factor on the carpet's mean colour.
    pub reflectance: Vec3,
    /// Light that reaches carpet and paint.
    pub light: f32,
    /// Light that the carpet reflects besides its colour, linear.
    pub sheen: f32,
}

impl Shadow {
    /// Returns the part of the light that reaches a place: little reaches what the thing touches, and a wide shadow is weak,
    /// as under many lamps.
    pub fn light(&self, place: Vec2) -> f32 {
        let distance = place.distance(self.center);
        if distance > self.radius + 1.2 {
            return 1.0;
        }
        let outside = (distance - self.radius).max(0.0);
        let near = 0.4 * (-0.5 * (outside / 0.05).powi(2)).exp();
        let wide = 0.15 * (-0.5 * (outside / 0.3).powi(2)).exp();
        1.0 - near - wide
    }
}

impl Carpet {
    /// Lays a carpet whose middle is the world's origin.
    pub fn new(random: &mut Random, plan: &CarpetPlan, half: Vec2, shadows: &[Shadow]) -> Self {
        let rolls = Rolls::new(random, plan, half);
        let layers = Layers::new(random, plan, half);
        let mut finest = Map::empty(half, CELL_M);
        let Map { corner, cells_per_m, columns, .. } = finest;
        finest.values.par_chunks_mut(columns).enumerate().for_each(|(row, values)| {
            for (column, value) in values.iter_mut().enumerate() {
                let place = corner + (Vec2::new(column as f32, row as f32) + 0.5) / cells_per_m;
                let light: f32 = shadows.iter().map(|shadow| shadow.light(place)).product();
                let reflectance = layers.at(place) * rolls.reflectance(place, plan.seam as f32);
                *value = reflectance.extend(light * layers.light(place));
            }
        });
        finest.normalise();
        let mut maps = vec![finest];
        for _ in 1..LEVELS {
            maps.extend(maps.last().map(Map::halved));
        }
        Self { rolls, pile: plan.pile as f32, sheen: plan.sheen as f32, maps }
    }

    /// Returns what the carpet does at a place, seen along a unit direction by a ray as wide as `footprint_m` there.
    pub fn spot(&self, place: Vec2, direction: Vec3, footprint_m: f32) -> Spot {
        let level = (footprint_m / CELL_M).max(1.0).log2().round() as usize;
        let value = self.maps[level.min(LEVELS - 1)].at(place);
        let lean = self.rolls.lean(place);
        let along = if self.rolls.along_x { direction.x } else { direction.y };
        let grazing = (1.0 - direction.z.abs()).powi(5);
        Spot {
            reflectance: value.truncate() * (1.0 + self.pile * lean * along),
            light: value.w,
            sheen: self.sheen * grazing,
        }
    }
}

impl Rolls {
    fn new(random: &mut Random, plan: &CarpetPlan, half: Vec2) -> Self {
        let reach = half.max_element();
        let width_m = plan.roll_m as f32;
        let shift_m = reach + random.between(0.0, plan.roll_m) as f32;
        let count = ((reach + shift_m) / width_m) as usize + 2;
        let roll = |random: &mut Random| {
            let reflectance = 1.0 + plan.roll_spread * random.between(-1.0, 1.0);
            (reflectance as f32, random.sign() as f32)
        };
        Self {
            width_m,
            along_x: plan.rolls_along_x,
            shift_m,
            rolls: (0..count).map(|_| roll(random)).collect(),
        }
    }

    /// Returns the position across the rolls, in rolls.
    fn across(&self, place: Vec2) -> f32 {
        let across = if self.along_x { place.y } else { place.x };
        ((across + self.shift_m) / self.width_m).clamp(0.0, (self.rolls.len() - 1) as f32)
    }

    fn reflectance(&self, place: Vec2, seam: f32) -> f32 {
        let across = self.across(place);
        let from_seam_m = (across - across.round()).abs() * self.width_m;
        let seam = seam * (-0.5 * (from_seam_m / 0.006).powi(2)).exp();
        self.rolls[across as usize].0 * (1.0 - seam)
    }

    fn lean(&self, place: Vec2) -> f32 {
        self.rolls[self.across(place) as usize].1
    }
}

/// Changes of the carpet that have nothing to do with its rolls.
struct Layers {
    blotches: Texture,
    dirt: Texture,
    unevenness: Texture,
    /// Two ends, half width and change of reflectance.
    paths: Vec<(Vec2, Vec2, f32, f32)>,
    /// Middle, radius and loss.
    stains: Vec<(Vec2, f32, f32)>,
}

impl Layers {
    fn new(random: &mut Random, plan: &CarpetPlan, half: Vec2) -> Self {
        let place = |random: &mut Random| {
            half * Vec2::new(random.between(-1.0, 1.0) as f32, random.between(-1.0, 1.0) as f32)
        };
        let (paths, change) = plan.paths;
        Self {
            blotches: Texture::new(random, &plan.blotches),
            dirt: Texture::new(random, &[(0.9, 0.8 * plan.dirt), (0.25, 0.6 * plan.dirt)]),
            unevenness: Texture::new(random, &[(3.0, plan.unevenness)]),
            paths: (0..paths)
                .map(|_| {
                    let (from, to) = (place(random), place(random));
                    let half_width = random.between(0.15, 0.4) as f32;
                    (from, to, half_width, random.between(-change, change) as f32)
                })
                .collect(),
            stains: (0..plan.stains)
                .map(|_| {
                    let radius = random.between(0.03, 0.25) as f32;
                    (place(random), radius, random.between(0.08, 0.35) as f32)
                })
                .collect(),
        }
    }

    fn at(&self, place: Vec2) -> Vec3 {
        let mut factor = 1.0 + self.blotches.at(place.x, place.y);
        for &(from, to, half_width, change) in &self.paths {
            let along = ((place - from).dot(to - from) / from.distance_squared(to)).clamp(0.0, 1.0);
            let beside = place.distance(from.lerp(to, along)) / half_width;
            factor *= 1.0 + change * (-0.5 * beside * beside).exp();
        }
        for &(center, radius, loss) in &self.stains {
            let distance = place.distance(center) / radius;
            factor *= 1.0 - loss / (1.0 + distance.powi(6));
        }
        // Dirt is brown: it adds to the red what it takes from the green.
        let dirt = self.dirt.at(place.x, place.y);
        factor.max(0.05) * (Vec3::ONE + dirt * Vec3::new(0.6, -1.0, -0.5))
    }

    fn light(&self, place: Vec2) -> f32 {
        1.0 + self.unevenness.at(place.x, place.y)
    }
}

impl Map {
    fn empty(half: Vec2, cell_m: f32) -> Self {
        let cells = (2.0 * half / cell_m).ceil();
        let (columns, rows) = (cells.x as usize + 1, cells.y as usize + 1);
        let values = vec![Vec4::ZERO; columns * rows];
        Self { corner: -half, cells_per_m: cell_m.recip(), columns, rows, values }
    }

    /// Makes the mean reflectance 1 in each colour.
    fn normalise(&mut self) {
        let mean = self.values.iter().map(|value| value.as_dvec4()).sum::<glam::DVec4>();
        let mean = (mean / self.values.len() as f64).as_vec4().with_w(1.0);
        self.values.iter_mut().for_each(|value| *value /= mean);
    }

    /// Returns the map with cells of twice the side.
    fn halved(&self) -> Self {
        let (columns, rows) = (self.columns.div_ceil(2), self.rows.div_ceil(2));
        let at = |column: usize, row: usize| {
            self.values[row.min(self.rows - 1) * self.columns + column.min(self.columns - 1)]
        };
        let mean = |column: usize, row: usize| {
            let (x, y) = (2 * column, 2 * row);
            (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)) / 4.0
        };
        let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        Self {
            corner: self.corner,
            cells_per_m: self.cells_per_m / 2.0,
            columns,
            rows,
            values: cells.map(|(column, row)| mean(column, row)).collect(),
        }
    }

    /// Interpolates between the nearest four cells.
    fn at(&self, place: Vec2) -> Vec4 {
        let limit = Vec2::new((self.columns - 2) as f32, (self.rows - 2) as f32);
        let cell = ((place - self.corner) * self.cells_per_m - 0.5).clamp(Vec2::ZERO, limit);
        let (column, row) = (cell.x as usize, cell.y as usize);
        let part = cell - Vec2::new(column as f32, row as f32);
        let at = |right: usize, up: usize| self.values[(row + up) * self.columns + column + right];
        let low = at(0, 0).lerp(at(1, 0), part.x);
        low.lerp(at(0, 1).lerp(at(1, 1), part.x), part.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF: Vec2 = Vec2::new(3.7, 2.7);

    fn plan() -> CarpetPlan {
        CarpetPlan {
            roll_m: 1.5,
            rolls_along_x: false,
            roll_spread: 0.0,
            seam: 0.0,
            pile: 0.0,
            blotches: Vec::new(),
            dirt: 0.0,
            paths: (0, 0.0),
            stains: 0,
            sheen: 0.0,
            unevenness: 0.0,
        }
    }

    fn values(plan: &CarpetPlan, shadows: &[Shadow]) -> Vec<(Vec2, Spot)> {
        let carpet = Carpet::new(&mut Random::new(5), plan, HALF, shadows);
        let places = (0..150).flat_map(|x| (0..110).map(move |y| (x as f32, y as f32)));
        let places = places.map(|(x, y)| Vec2::new(x, y) * 0.049 - HALF + 0.02);
        places.map(|place| (place, carpet.spot(place, -Vec3::Z, 0.0))).collect()
    }

    fn moments(values: impl Iterator<Item = f32> + Clone) -> [f64; 2] {
        let count = values.clone().count() as f64;
        let mean = values.clone().map(f64::from).sum::<f64>() / count;
        let variance = values.map(|value| (f64::from(value) - mean).powi(2)).sum::<f64>() / count;
        [mean, variance.sqrt()]
    }

    #[test]
    fn an_even_carpet_is_even() {
        for (_, spot) in values(&plan(), &[]) {
            assert!((spot.reflectance - 1.0).abs().max_element() < 1e-5 && spot.light == 1.0);
        }
    }

    #[test]
    fn rolls_differ_from_each_other_and_not_in_themselves() {
        let spots = values(&CarpetPlan { roll_spread: 0.1, ..plan() }, &[]);
        let [mean, deviation] = moments(spots.iter().map(|(_, spot)| spot.reflectance.y));
        assert!((mean - 1.0).abs() < 0.01, "{mean}");
        assert!((0.02..0.1).contains(&deviation), "{deviation}");
        let mut levels: Vec<i32> =
            spots.iter().map(|(_, spot)| (spot.reflectance.y * 2000.0).round() as i32).collect();
        levels.sort_unstable();
        levels.dedup();
        assert!((4..40).contains(&levels.len()), "rolls and what lies between them: {levels:?}");
    }

    #[test]
    fn blotches_and_dirt_have_their_deviations() {
        let blotches = vec![(0.05, 0.03), (0.3, 0.04), (1.0, 0.02)];
        let spots = values(&CarpetPlan { blotches, ..plan() }, &[]);
        let [mean, deviation] = moments(spots.iter().map(|(_, spot)| spot.reflectance.y));
        assert!((mean - 1.0).abs() < 0.01 && (deviation - 0.054).abs() < 0.012, "{mean} {deviation}");
        let spots = values(&CarpetPlan { dirt: 0.04, ..plan() }, &[]);
        let [_, red] = moments(spots.iter().map(|(_, spot)| spot.reflectance.x));
        let [_, green] = moments(spots.iter().map(|(_, spot)| spot.reflectance.y));
        assert!((green - 0.04).abs() < 0.015 && (red / green - 0.6).abs() < 0.05, "{red} {green}");
    }

    #[test]
    fn the_pile_is_bright_from_one_side_and_dark_from_the_other() {
        let carpet = Carpet::new(&mut Random::new(5), &CarpetPlan { pile: 0.04, ..plan() }, HALF, &[]);
        let seen = |way: f32| {
            let direction = Vec3::new(0.0, way, -1.0).normalize_or_zero();
            carpet.spot(Vec2::new(0.3, 0.2), direction, 0.0).reflectance.y
        };
        assert!((seen(1.0) + seen(-1.0) - 2.0).abs() < 1e-5 && (seen(1.0) - 1.0).abs() > 0.02);
    }

    #[test]
    fn it_is_darker_beside_a_thing_and_not_far_from_it() {
        let shadow = Shadow { center: Vec2::new(1.0, 0.5), radius: 0.1 };
        for (place, spot) in values(&plan(), &[shadow]) {
            let distance = place.distance(shadow.center);
            assert!(distance < 1.4 || spot.light == 1.0);
            assert!(distance > 0.15 || spot.light < 0.7, "{distance} {}", spot.light);
        }
    }
}
