//! The clean stage: the ground as it is without the people, robots and balls that stood on it, and where pictures show these.
//!
//! Pictures of the same ground vote on its colours, cell by cell. Where a picture differs from the colours that it should show, beyond
//! noise and errors of its pose, something stood: those pixels are masked. The ground is then made once more, of what is not masked.

mod blobs;
mod carpet;
mod differences;
mod found;
mod goal_volumes;
mod grid;
mod mosaic;
mod predicted;
mod upright;
mod votes;

use std::{
    collections::BTreeMap,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
};

use image::{GrayImage, Luma, Rgb, RgbImage};
use rayon::prelude::*;
use reality_sim_core::warp::{Origin, fill};
use reality_sim_db::{Ground, ImageMask};

use self::{
    blobs::Bits,
    carpet::Carpet,
    found::{EmptyScene, image_mask},
    goal_volumes::GoalVolumes,
    grid::Grid,
    mosaic::{Cell, Mosaic, coarse_colors},
    predicted::GroundPyramid,
};
use crate::{
    Archive, SynthesisError,
    shrunk::{ShrunkCameras, ShrunkPicture},
};

/// Largest number of pictures that vote on the ground.
const VOTING: usize = 300;
/// Largest number of pictures among which those that show the hall behind a thing are chosen.
const HALL_PICTURES: usize = 60;
/// Cells across a line: it keeps its edges.
const CELLS_A_LINE: f64 = 4.0;
/// Largest number of cells.
const MOST_CELLS: f64 = 1e6;
/// Side of the coarse cells by which the carpet's usual colours are found, metres.
const COARSE_M: f64 = 0.06;
/// Smallest number of directions in which some cell was seen, for a clean stage.
const LEAST_VIEWS: u8 = 2;

/// Ground and masks that were found.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundCleanStage {
    /// Ground without things.
    pub ground: Ground,
    /// Masks of the images that show things, by the images' ids.
    pub masks: BTreeMap<i64, ImageMask>,
}

/// Finds the clean stage of an archive's field. `goes_on` gets the number of images done and that of all, on any thread; once it
/// returns false, the search ends. `None` if it does, or if the pictures show too little of the ground.
pub fn find_clean_stage(
    archive: &Archive,
    goes_on: &(dyn Fn(usize, usize) -> bool + Sync),
) -> Result<Option<FoundCleanStage>, SynthesisError> {
    let field = archive.field();
    let cameras = ShrunkCameras::new(archive);
    let count = archive.images().len();
    let voting = count.min(VOTING);
    let read = (0..voting).into_par_iter().with_max_len(1);
    let pictures: Vec<ShrunkPicture> =
        read.map(|i| cameras.read(archive, i * count / voting)).collect::<Result<_, _>>()?;
    let goals = GoalVolumes::new(field, archive.proxy_geometry());
    let coarse = Grid::of_carpet(field, COARSE_M);
    let colors = coarse_colors(&coarse, &pictures, &goals);
    let Some(carpet) = Carpet::new(field, &coarse, &colors) else { return Ok(None) };
    let search = Search { archive, goals, carpet };
    let half = field.carpet_half_extent_m();
    let cell_m = (field.line_width_m / CELLS_A_LINE).max((4.0 * half.x * half.y / MOST_CELLS).sqrt());
    let mut pictures = pictures;
    let first = search.mosaic(2.0 * cell_m, &pictures);
    let scene = search.scene(&first);
    pictures.par_iter_mut().for_each(|picture| {
        let things = scene.things_in(picture);
        hide(picture, &things.pixels);
    });
    let mosaic = search.mosaic(cell_m, &pictures);
    if mosaic.cells.iter().flatten().all(|cell| cell.views < LEAST_VIEWS) {
        return Ok(None);
    }
    let voted: BTreeMap<usize, ShrunkPicture> =
        pictures.into_iter().map(|picture| (picture.image, picture)).collect();
    let masks = search.masks(&mosaic, &cameras, &voted, goes_on)?;
    Ok(masks.map(|masks| FoundCleanStage { ground: ground(&mosaic), masks }))
}

/// What all steps need.
struct Search<'a> {
    archive: &'a Archive,
    goals: GoalVolumes,
    carpet: Carpet,
}

impl Search<'_> {
    fn mosaic(&self, cell_m: f64, pictures: &[ShrunkPicture]) -> Mosaic {
        Mosaic::new(self.archive.field(), cell_m, pictures, &self.goals, &self.carpet)
    }

    fn scene<'a>(&'a self, mosaic: &'a Mosaic) -> EmptyScene<'a> {
        let pyramid = GroundPyramid::new(mosaic);
        EmptyScene { mosaic, pyramid, proxy: self.archive.proxy_geometry(), goals: &self.goals }
    }

    /// Finds the masks of all images; those that voted are at hand. `None` where it is not to go on.
    fn masks(
        &self,
        mosaic: &Mosaic,
        cameras: &ShrunkCameras,
        voted: &BTreeMap<usize, ShrunkPicture>,
        goes_on: &(dyn Fn(usize, usize) -> bool + Sync),
    ) -> Result<Option<BTreeMap<i64, ImageMask>>, SynthesisError> {
        let scene = self.scene(mosaic);
        let step = voted.len().div_ceil(HALL_PICTURES).max(1);
        let others: Vec<ShrunkPicture> = voted.values().step_by(step).cloned().collect();
        let (records, done) = (self.archive.images(), AtomicUsize::new(0));
        let masks = (0..records.len()).into_par_iter().with_max_len(1).map(|image| {
            let mut picture = match voted.get(&image) {
                Some(picture) => picture.clone(),
                None => cameras.read(self.archive, image)?,
            };
            let mask = image_mask(&scene.whole_things_in(&mut picture, &others));
            let is_wanted = goes_on(done.fetch_add(1, Ordering::Relaxed) + 1, records.len());
            Ok::<_, SynthesisError>(is_wanted.then_some((records[image].id, mask)))
        });
        let masks: Option<BTreeMap<i64, ImageMask>> = masks.collect::<Result<_, _>>()?;
        Ok(masks.map(|mut masks| {
            masks.retain(|_, mask| !mask.is_empty());
            masks
        }))
    }
}

/// Hides things in a picture.
fn hide(picture: &mut ShrunkPicture, things: &Bits) {
    Arc::make_mut(&mut picture.picture).hide(|pixel| things.pixels[pixel]);
}

/// Makes the ground that is stored. Cells that are not known take the colours around them.
fn ground(mosaic: &Mosaic) -> Ground {
    let Mosaic { grid, cells, never_empty } = mosaic;
    let (width, height) = (grid.width as u32, grid.height as u32);
    let known = |u: u32, v: u32| {
        let cell = v as usize * grid.width + u as usize;
        cells[cell].filter(|_| !never_empty[cell])
    };
    let views = GrayImage::from_fn(width, height, |u, v| Luma([known(u, v).map_or(0, |cell| cell.views)]));
    let cells = (0..grid.len()).map(|cell| known(cell as u32 % width, cell as u32 / width));
    let color = |cell: Option<Cell>| cell.map_or([0; 3], |cell| cell.color.map(|value| value.round() as u8));
    let mut colors: Vec<[u8; 3]> = cells.clone().map(color).collect();
    let source = |cell: Option<Cell>| if cell.is_some() { 0 } else { Origin::NOWHERE };
    let origins: Vec<Origin> = cells.map(|cell| Origin { source: source(cell), trust: 0 }).collect();
    fill(&mut colors, &origins, grid.width);
    let colors = RgbImage::from_fn(width, height, |u, v| Rgb(colors[(v * width + u) as usize]));
    Ground { min_m: grid.min_m, cell_m: grid.cell_m, colors, views }
}
