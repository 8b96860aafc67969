//! Clean stage of an archive as pictures are drawn with it: masks of the images, and ground for where all of them hide it.

use glam::Vec2;
use rayon::prelude::*;
use reality_sim_core::{
    camera::LANES,
    warp::{Look, Origin, Source, Surface, Target, UNSEEN_COST, fill},
};
use reality_sim_db::{Database, Ground, ImageMask, ImageRecord, index::ImageIndex};

use crate::SynthesisError;

/// Trust in pixels that show the ground as many pictures together saw it: half, for it is coarser than a picture nearby.
const GROUND_TRUST: u8 = 128;
/// Largest difference between a drawn picture and the ground that light explains, grey levels.
const LIGHT: i16 = 40;
/// Middle of differences that are kept in bytes.
const MIDDLE: i16 = 128;

/// Clean stage, ready to draw with.
#[derive(Debug)]
pub(crate) struct CleanView {
    ground: Ground,
    /// Masks of the images, in the archive's order; `None` where nothing is hidden.
    masks: Vec<Option<ImageMask>>,
}

impl CleanView {
    /// Reads the clean stage of a field; `None` if the database holds none.
    pub fn read(
        database: &Database,
        field_id: i64,
        images: &[ImageRecord],
    ) -> Result<Option<Self>, SynthesisError> {
        let Some(ground) = database.ground(field_id)? else { return Ok(None) };
        let mut masks = database.image_masks(field_id)?;
        let masks = images.iter().map(|image| masks.remove(&image.id).filter(|mask| !mask.is_empty()));
        Ok(Some(Self { ground, masks: masks.collect() }))
    }

    /// Returns the mask of an image, if it hides anything.
    pub fn mask(&self, image: ImageIndex) -> Option<&ImageMask> {
        self.masks.get(image as usize)?.as_ref()
    }

    /// Raises the costs of pixels that an image does not show because something stood in front of them, see
    /// [`Look::costs`].
    pub fn raise_costs(&self, look: &Look, source: &Source, image: ImageIndex, costs: &mut [f32]) {
        let Some(mask) = self.mask(image) else { return };
        let size = [source.camera.max_u, source.camera.max_v].map(|last| last as u32 + 1);
        for (cost, place) in costs.iter_mut().zip(look.places(source)) {
            if place.is_some_and(|place| mask.hides(place.map(|pixel| pixel.round() as u32), size)) {
                *cost = cost.max(UNSEEN_COST);
            }
        }
    }

    /// Draws the ground where no source shows it, as bright as the picture around it.
    pub fn fill(&self, target: &Target, colors: &mut [[u8; 3]], origins: &mut [Origin]) {
        let places = self.ground_places(target, origins);
        if !places.iter().flatten().any(|place| matches!(place, Place::Missing(..))) {
            return;
        }
        let width = target.rays.width as usize;
        let differences = differences(&places, colors, width);
        let places = places.iter().flatten();
        for (((place, color), origin), difference) in
            places.zip(colors.iter_mut()).zip(origins.iter_mut()).zip(differences)
        {
            if let Place::Missing(ground, is_known) = place {
                *color = std::array::from_fn(|channel| {
                    let value = i16::from(ground[channel]) + i16::from(difference[channel]) - MIDDLE;
                    value.clamp(0, 255) as u8
                });
                if *is_known {
                    *origin = Origin { source: Origin::GROUND, trust: GROUND_TRUST };
                }
            }
        }
    }

    /// Returns, row by row, what every pixel has to do with the ground.
    fn ground_places(&self, target: &Target, origins: &[Origin]) -> Vec<Vec<Place>> {
        let width = target.rays.width as usize;
        let place = |row: usize, origins: &[Origin]| {
            let mut places = Vec::with_capacity(width);
            for (block, origins) in origins.chunks(LANES).enumerate() {
                let seen = target.surfaces(row, block);
                for (lane, origin) in origins.iter().enumerate() {
                    let [x, y, _] = seen.point_in_world.map(|axis| axis[lane]);
                    let ground = (seen.surface[lane] == Surface::Ground)
                        .then(|| self.ground_at(Vec2::new(x, y)))
                        .flatten();
                    places.push(match ground {
                        Some((color, is_known)) if origin.source == Origin::NOWHERE => {
                            Place::Missing(color, is_known)
                        }
                        Some((color, true)) if origin.is_recorded() => Place::Seen(color),
                        _ => Place::Other,
                    });
                }
            }
            places
        };
        origins.par_chunks(width).enumerate().map(|(row, origins)| place(row, origins)).collect()
    }

    /// Returns the colour of the ground at a point, and whether it was seen empty there; `None` beside the carpet.
    fn ground_at(&self, point_m: Vec2) -> Option<([u8; 3], bool)> {
        let place = (point_m - self.ground.min_m.as_vec2()) / self.ground.cell_m as f32;
        let (width, height) = self.ground.colors.dimensions();
        let is_inside = place.cmpge(Vec2::ZERO).all() && place.x < width as f32 && place.y < height as f32;
        if !is_inside {
            return None;
        }
        let is_known = self.ground.views.get_pixel(place.x as u32, place.y as u32).0[0] > 0;
        let last = Vec2::new(width as f32 - 1.0, height as f32 - 1.0);
        let centred = (place - 0.5).clamp(Vec2::ZERO, last);
        let first = centred.floor().min((last - 1.0).max(Vec2::ZERO));
        let beside = centred - first;
        let cell = |right: u32, below: u32| {
            let (u, v) = (first.x as u32 + right, first.y as u32 + below);
            self.ground.colors.get_pixel(u.min(width - 1), v.min(height - 1)).0.map(f32::from)
        };
        let [a, b, c, d] = [cell(0, 0), cell(1, 0), cell(0, 1), cell(1, 1)];
        let color = std::array::from_fn(|channel| {
            let upper = a[channel] + beside.x * (b[channel] - a[channel]);
            let lower = c[channel] + beside.x * (d[channel] - c[channel]);
            (upper + beside.y * (lower - upper) + 0.5) as u8
        });
        Some((color, is_known))
    }
}

/// What a pixel has to do with the ground.
#[derive(Debug, Clone, Copy)]
enum Place {
    /// It shows the ground, which has this colour.
    Seen([u8; 3]),
    /// It would show the ground, which has this colour; whether the ground was seen empty there.
    Missing([u8; 3], bool),
    /// Nothing.
    Other,
}

/// Returns the differences between drawn pixels and the ground, around [`MIDDLE`], continued smoothly over the pixels that are
/// missing: light and exposure of the picture.
fn differences(places: &[Vec<Place>], colors: &[[u8; 3]], width: usize) -> Vec<[u8; 3]> {
    const SEEN: Origin = Origin { source: 0, trust: 0 };
    const NOWHERE: Origin = Origin { source: Origin::NOWHERE, trust: 0 };
    let difference = |(place, color): (&Place, &[u8; 3])| {
        let Place::Seen(ground) = place else { return ([MIDDLE as u8; 3], NOWHERE) };
        let by: [i16; 3] =
            std::array::from_fn(|channel| i16::from(color[channel]) - i16::from(ground[channel]));
        let is_light = by.iter().all(|by| by.abs() <= LIGHT);
        (by.map(|by| (by + MIDDLE).clamp(0, 255) as u8), if is_light { SEEN } else { NOWHERE })
    };
    let (mut differences, origins): (Vec<[u8; 3]>, Vec<Origin>) =
        places.iter().flatten().zip(colors).map(difference).unzip();
    for (difference, _) in differences.iter_mut().zip(&origins).filter(|(_, origin)| **origin == NOWHERE) {
        *difference = [MIDDLE as u8; 3];
    }
    fill(&mut differences, &origins, width);
    differences
}
