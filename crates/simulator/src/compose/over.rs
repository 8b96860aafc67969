//! Layers in one part of the picture, with each other and before the scene.

use rayon::prelude::*;
use reality_sim_core::{
    camera::LANES,
    warp::{Surface, SurfaceBlock, Target},
};
use reality_sim_sensor::LightTile;

use super::pixel::{Pixel, Stack};
use crate::{
    canvas::{Canvas, Fragment},
    pixel_box::PixelBox,
    seen_object::NO_OBJECT,
};

/// Distance behind the proxy geometry's walls up to which things are seen, metres: the box stands for a hall that nobody has
/// measured, with whatever stands along its walls.
const WALL_SLACK_M: f32 = 0.5;
/// Distance behind a goal's frame or back up to which things are seen, metres: half of what stands out from the plane that
/// stands for it.
const GOAL_SLACK_M: f32 = 0.02;
/// Height difference on the ground, pixels, by which a pixel may see the ground before the fragment of a thing that stands on
/// it: the fragment lies in another part of the pixel.
const GROUND_SLACK_PX: f32 = 1.5;

/// Least number of rows that are worth a task of their own.
const LEAST_ROWS: usize = 32;

/// Scene before which layers are seen.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scene<'a> {
    pub(crate) target: Target<'a>,
    /// Height of the camera, metres.
    pub(crate) height_m: f32,
    /// Smaller focal length, pixels.
    pub(crate) focal_px: f32,
}

impl Scene<'_> {
    /// Returns the largest distance at which something is seen before the scene.
    fn limit_m(&self, seen: &SurfaceBlock, lane: usize) -> f32 {
        let distance_m = seen.distance_m[lane];
        match seen.surface[lane] {
            Surface::Nothing => 0.0,
            // A pixel farther down the ground is nearer by d² / (h f).
            Surface::Ground => {
                distance_m
                    + GROUND_SLACK_PX * distance_m * distance_m / (self.height_m * self.focal_px).max(1e-3)
            }
            Surface::GoalFrame | Surface::GoalBack => distance_m + GOAL_SLACK_M,
            Surface::Wall | Surface::Ceiling => distance_m + WALL_SLACK_M,
        }
    }
}

/// How often an object is seen.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Tally {
    pub(crate) visible: PixelBox,
    pub(crate) visible_pixels: u32,
    pub(crate) whole: PixelBox,
    pub(crate) whole_pixels: u32,
}

impl Tally {
    pub(crate) fn add(&mut self, other: &Self) {
        self.visible = self.visible.union(other.visible);
        self.visible_pixels += other.visible_pixels;
        self.whole = self.whole.union(other.whole);
        self.whole_pixels += other.whole_pixels;
    }
}

/// A part of the picture with the layers in it.
#[derive(Debug)]
pub(crate) struct Composed {
    pub(crate) area: PixelBox,
    pub(crate) tile: LightTile,
    /// Object and its distance in each pixel of the area, row by row.
    pub(crate) objects: Vec<(u16, f32)>,
    pub(crate) tallies: Vec<Tally>,
}

/// Composes the layers in a part of the picture: one list of canvases for all colours, or one each for red, green and blue.
/// `first_object` is the number of each layer's first object, `objects` that of all objects.
pub(crate) fn compose(
    scene: &Scene<'_>,
    canvases: &[Vec<Canvas>],
    first_object: &[u16],
    objects: usize,
    area: PixelBox,
) -> Composed {
    let splits_colors = canvases.len() > 1;
    let [left, top] = [area.left, area.top].map(|side| side as usize);
    let [width, height] = [area.width(), area.height()].map(|side| side as usize);
    let mut tile = LightTile::empty([left, top], [width, height], splits_colors);
    let mut composed = Composed {
        area,
        tile: LightTile::default(),
        objects: vec![(NO_OBJECT, f32::INFINITY); width * height],
        tallies: vec![Tally::default(); objects],
    };
    // Labels are those of green.
    let labelled = canvases.len() / 2;
    for (index, canvases) in canvases.iter().enumerate() {
        let layers = Layers { canvases, first_object, objects };
        let rows = (0..height).into_par_iter().with_min_len(LEAST_ROWS);
        let rows: Vec<Row> = rows.map(|row| layers.row(scene, area, row)).collect();
        for (row, Row { pixels, tallies }) in rows.iter().enumerate() {
            for (column, pixel) in pixels.iter().enumerate() {
                let place = row * width + column;
                let channels = if splits_colors { index..index + 1 } else { 0..3 };
                channels.for_each(|channel| tile.color[channel][place] = pixel.color[channel]);
                tile.cover[index][place] = pixel.cover;
                if index == labelled
                    && let Some(object) = pixel.object
                {
                    composed.objects[place] = (object, pixel.distance_m);
                }
            }
            if index == labelled {
                composed.tallies.iter_mut().zip(tallies).for_each(|(sum, tally)| sum.add(tally));
            }
        }
    }
    Composed { tile, ..composed }
}

struct Row {
    pixels: Vec<Pixel>,
    tallies: Vec<Tally>,
}

struct Layers<'a> {
    canvases: &'a [Canvas],
    first_object: &'a [u16],
    objects: usize,
}

impl Layers<'_> {
    fn row(&self, scene: &Scene<'_>, area: PixelBox, row: usize) -> Row {
        let v = area.top + row as u32;
        let mut made = Row {
            pixels: vec![Pixel::EMPTY; area.width() as usize],
            tallies: vec![Tally::default(); self.objects],
        };
        let here: Vec<(&Canvas, u16)> = self
            .canvases
            .iter()
            .zip(self.first_object)
            .filter(|(canvas, _)| (canvas.area().top..canvas.area().bottom).contains(&v))
            .map(|(canvas, first)| (canvas, *first))
            .collect();
        let mut stack = Stack::default();
        let mut block: Option<(usize, SurfaceBlock)> = None;
        let mut whole: Vec<(u16, u16)> = Vec::new();
        for (u, pixel) in (area.left..).zip(&mut made.pixels) {
            stack.fragments.clear();
            whole.clear();
            for (canvas, first) in &here {
                for fragment in canvas.fragments(u, v) {
                    let fragment = Fragment { object: fragment.object.saturating_add(*first), ..*fragment };
                    note(&mut whole, &fragment);
                    stack.fragments.push(fragment);
                }
            }
            if stack.fragments.is_empty() {
                continue;
            }
            let index = u as usize / LANES;
            if block.as_ref().is_none_or(|(known, _)| *known != index) {
                block = Some((index, scene.target.surfaces(v as usize, index)));
            }
            let limit_m = block.as_ref().map_or(0.0, |(_, seen)| scene.limit_m(seen, u as usize % LANES));
            stack.fragments.retain(|fragment| fragment.distance_m <= limit_m);
            *pixel = stack.composed();
            tally(&mut made.tallies, &whole, pixel.object, PixelBox::around(u, v));
        }
        made
    }
}

/// Notes which parts of a pixel an object would cover alone.
fn note(whole: &mut Vec<(u16, u16)>, fragment: &Fragment) {
    if fragment.alpha < 0.5 {
        return;
    }
    match whole.iter_mut().find(|(object, _)| *object == fragment.object) {
        Some((_, parts)) => *parts |= fragment.parts,
        None => whole.push((fragment.object, fragment.parts)),
    }
}

fn tally(tallies: &mut [Tally], whole: &[(u16, u16)], shown: Option<u16>, pixel: PixelBox) {
    if let Some(tally) = shown.and_then(|object| tallies.get_mut(usize::from(object))) {
        tally.visible = tally.visible.union(pixel);
        tally.visible_pixels += 1;
    }
    for (object, parts) in whole {
        let is_whole = parts.count_ones() as usize * 2 >= crate::canvas::PARTS || shown == Some(*object);
        if let Some(tally) = tallies.get_mut(usize::from(*object)).filter(|_| is_whole) {
            tally.whole = tally.whole.union(pixel);
            tally.whole_pixels += 1;
        }
    }
}
