//! All labels of a picture.

use glam::DVec2;
use rayon::prelude::*;
use reality_sim_core::{
    camera::{Camera, LANES},
    field::{Crossing, Curve, FieldDimensions, Goal, LineKind},
    pose::CameraPose,
    warp::{Origin, ProxyGeometry, RayTable},
};

use super::{
    extent::Extent,
    overlay::Overlay,
    painted_ground::PaintedGround,
    pixels::{Row, View, label_row},
    record::Labels,
    seen_lines::Sight,
};
use crate::{class::Class, seen_object::SeenObject};

/// Names of the goals, which come first among the things.
const GOALS: [&str; 2] = ["goal_negative_x", "goal_positive_x"];
/// Number of points along posts and crossbar of a goal by which the part outside the picture is told: 1 % is a goal seen whole but
/// for what its edges hide.
const GOAL_POINTS: u32 = 100;
/// Number of rows that a thread takes at a time.
const ROWS: usize = 8;

/// Source of the labels of one camera on one field. Threads share one.
#[derive(Debug, Clone)]
pub struct Labeler {
    camera: Camera,
    rays: RayTable,
    field: FieldDimensions,
    proxy: ProxyGeometry,
    ground: PaintedGround,
    lines: Vec<(LineKind, Curve)>,
    crossings: Vec<Crossing>,
}

impl Labeler {
    /// Prepares the labels of a camera's pictures.
    pub fn new(camera: &Camera, field: &FieldDimensions, proxy: &ProxyGeometry) -> Self {
        Self {
            camera: camera.clone(),
            rays: RayTable::new(camera),
            field: field.clone(),
            proxy: *proxy,
            ground: PaintedGround::new(field),
            lines: field.lines(),
            crossings: field.crossings(),
        }
    }

    /// Labels the picture at a pose, which must be possible for a camera. `origins` has one element for every pixel, or none where
    /// the picture comes from elsewhere: then all of it is trusted.
    pub fn label(&self, pose: CameraPose, origins: &[Origin], overlay: Overlay, labels: &mut Labels) {
        self.make_room(labels);
        labels.trust.clear();
        labels.trust.extend(origins.iter().map(|origin| origin.trust));
        labels.trust.resize(self.rays.pixels(), u8::MAX);
        let seen = self.label_pixels(pose, overlay, labels);
        labels.things.clear();
        labels.things.extend(self.goals(pose, &seen));
        let objects = overlay.objects.iter().zip(&seen.visible[GOALS.len()..]);
        labels.things.extend(objects.map(|(object, visible)| SeenObject {
            visible: visible.around(),
            visible_pixels: visible.count,
            ..object.clone()
        }));
        let (classes, width) = (&labels.classes, self.rays.width as usize);
        let is_hidden = |pixel: DVec2| {
            let index = pixel.y.round() as usize * width + pixel.x.round() as usize;
            classes.get(index).is_some_and(|class| *class >= Class::Goal)
        };
        let sight = Sight { camera: &self.camera, pose, is_hidden };
        (labels.lines, labels.crossings) = (sight.lines(&self.lines), sight.crossings(&self.crossings));
    }

    /// Returns both goals.
    fn goals(&self, pose: CameraPose, seen: &Seen) -> impl Iterator<Item = SeenObject> {
        let goals = GOALS.into_iter().zip(self.field.goals()).enumerate();
        goals.map(move |(number, (name, goal))| SeenObject {
            class: Class::Goal,
            name: name.to_owned(),
            visible: seen.visible[number].around(),
            whole: seen.whole[number].around(),
            visible_pixels: seen.visible[number].count,
            whole_pixels: seen.whole[number].count,
            truncation: self.truncation(pose, &goal) as f32,
        })
    }

    fn make_room(&self, labels: &mut Labels) {
        (labels.width, labels.height) = (self.rays.width, self.rays.height);
        labels.classes.resize(self.rays.pixels(), Class::default());
        labels.distance_m.resize(self.rays.pixels(), f32::INFINITY);
        labels.instances.resize(self.rays.pixels(), 0);
    }

    fn label_pixels(&self, pose: CameraPose, overlay: Overlay, labels: &mut Labels) -> Seen {
        let view = View::new(&self.ground, &self.field, &self.proxy, pose);
        let (width, things) = (self.rays.width as usize, GOALS.len() + overlay.objects.len());
        let rows = labels.classes.par_chunks_mut(width).zip(labels.distance_m.par_chunks_mut(width));
        let rows = rows.zip(labels.instances.par_chunks_mut(width)).zip(labels.trust.par_chunks_mut(width));
        let rows = rows.zip(self.rays.blocks().par_chunks(width.div_ceil(LANES))).enumerate();
        let label = |mut seen: Seen, (number, ((((classes, distance_m), instances), trust), rays))| {
            let mut row = Row { number: number as u32, classes, distance_m, instances };
            label_row(&view, rays, &mut row, &mut seen.whole);
            draw_over(overlay, &mut row, trust);
            seen.add_visible(&row);
            seen
        };
        let none = || Seen::new(things);
        rows.with_min_len(ROWS).fold(none, label).reduce(none, Seen::merged)
    }

    /// Returns the share of posts and crossbar that lies outside the picture.
    fn truncation(&self, pose: CameraPose, goal: &Goal) -> f64 {
        let [a, b] = goal.posts;
        let top_m = a.height_m - a.radius_m;
        let corners =
            [a.center.extend(0.0), a.center.extend(top_m), b.center.extend(top_m), b.center.extend(0.0)];
        let lengths = [top_m, a.center.distance(b.center), top_m];
        let whole_m: f64 = lengths.iter().sum();
        let point = |number: u32| {
            let mut along_m = whole_m * (f64::from(number) + 0.5) / f64::from(GOAL_POINTS);
            let mut bar = 0;
            while bar < 2 && along_m > lengths[bar] {
                along_m -= lengths[bar];
                bar += 1;
            }
            corners[bar].lerp(corners[bar + 1], along_m / lengths[bar].max(f64::MIN_POSITIVE))
        };
        let outside = (0..GOAL_POINTS)
            .filter(|number| self.camera.project(pose.camera_from_world(point(*number))).is_err())
            .count();
        outside as f64 / f64::from(GOAL_POINTS)
    }
}

/// Puts the objects of a row over the scene.
fn draw_over(overlay: Overlay, row: &mut Row, trust: &mut [u8]) {
    let first = row.number as usize * trust.len();
    let Some(object_of) = overlay.object_of.get(first..first + trust.len()) else { return };
    for (column, object) in object_of.iter().enumerate() {
        // None for a pixel that shows no object.
        let Some(seen) = overlay.objects.get(usize::from(*object)) else { continue };
        row.classes[column] = seen.class;
        row.distance_m[column] = overlay.distance_m[first + column];
        row.instances[column] = (GOALS.len() + 1) as u16 + object;
        trust[column] = u8::MAX;
    }
}

/// Pixels of every thing.
#[derive(Debug, Clone)]
struct Seen {
    /// Pixels that show it.
    visible: Vec<Extent>,
    /// Pixels that would show it if nothing stood before it.
    whole: Vec<Extent>,
}

impl Seen {
    fn new(things: usize) -> Self {
        Self { visible: vec![Extent::default(); things], whole: vec![Extent::default(); things] }
    }

    fn add_visible(&mut self, row: &Row) {
        for (block, instances) in row.instances.chunks(LANES).enumerate() {
            // Most blocks show none.
            if instances.iter().fold(0, |any, instance| any | instance) == 0 {
                continue;
            }
            for (lane, instance) in instances.iter().enumerate().filter(|(_, instance)| **instance != 0) {
                let column = block * LANES + lane;
                self.visible[usize::from(*instance) - 1].add(column as u32, row.number);
            }
        }
    }

    fn merged(mut self, other: Self) -> Self {
        self.visible.iter_mut().zip(other.visible).for_each(|(extent, other)| extent.merge(other));
        self.whole.iter_mut().zip(other.whole).for_each(|(extent, other)| extent.merge(other));
        self
    }
}
