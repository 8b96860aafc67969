//! Where the walls stand: found by what pictures taken at different places agree on.
//!
//! A hall's measures are good when the colours that one picture shows are those that another shows at the same places of the
//! [`ProxyGeometry`]. One measure after the other is moved to where the mean difference, cut off so that what stands in
//! front does not decide, is least (coordinate descent), first in coarse steps, then in finer ones.

use std::sync::Arc;

use image::imageops::{FilterType, resize};
use rayon::prelude::*;
use reality_sim_core::{
    camera::{Camera, ImageCircle, KernelCamera},
    warp::{BlendWeights, Hall, Picture, Placement, ProxyGeometry, RayTable, Source, Target, glimpses},
};

use crate::{Archive, SynthesisError, select::select};

/// Pictures of the recording that are looked at.
const VIEWS: usize = 120;
/// Of these, every so many-th is compared with others.
const TARGET_STEP: usize = 2;
/// Pictures that each is compared with.
const PARTNERS: usize = 3;
/// Partners stand at least this far away, metres: from one place all distances look alike.
const BASELINE_M: f64 = 0.5;
/// Pictures are looked at no wider than this, pixels: noise and memory shrink.
const WIDTH: u32 = 320;
/// Differences of colour are cut off here, grey levels.
const CUT: f32 = 40.0;
/// With fewer places compared nothing is measured.
const LEAST_PLACES: f32 = 1000.0;
/// A measure is left as it usually is unless moving it back makes pictures differ by so much more, grey levels.
const EVIDENCE: f32 = 0.05;
/// From the coarsest step to the finest, metres.
const STEPS_M: [f64; 5] = [0.8, 0.4, 0.2, 0.1, 0.05];
/// Rounds over all measures for each step, at most.
const ROUNDS: usize = 4;
/// Walls stand at least this far from the carpet, metres; nothing is lower or less deep.
const LEAST_M: f64 = 0.1;
/// No wall stands farther from the carpet, and no ceiling hangs higher, metres.
const MOST_M: f64 = 12.0;

/// Measures the hall around an archive's field. `None` where the pictures do not tell: too few, or all from one place.
pub fn measure_hall(archive: &Archive) -> Result<Option<Hall>, SynthesisError> {
    let usual = Hall::usual(archive.field());
    let views = Views::new(archive, &usual)?;
    if views.difference(&usual).places < LEAST_PLACES {
        return Ok(None);
    }
    let mut best = views.descend(usual);
    for measure in MEASURES {
        let (mut without, mut usual) = (best, usual);
        *measure(&mut without) = *measure(&mut usual);
        if views.difference(&without).mean < views.difference(&best).mean + EVIDENCE {
            best = without;
        }
    }
    Ok(Some(best))
}

/// Walls towards −x, −y, +x, +y, ceiling, goals.
const MEASURES: [fn(&mut Hall) -> &mut f64; 6] = [
    |hall| &mut hall.min_m.x,
    |hall| &mut hall.min_m.y,
    |hall| &mut hall.max_m.x,
    |hall| &mut hall.max_m.y,
    |hall| &mut hall.ceiling_m,
    |hall| &mut hall.goal_depth_m,
];

/// A small picture and how it was taken.
struct View {
    camera: KernelCamera,
    rays: RayTable,
    placement: Placement,
    picture: Arc<Picture>,
}

impl View {
    fn source(&self) -> Source<'_> {
        Source { camera: &self.camera, placement: self.placement, picture: &self.picture, gain: [1.0; 3] }
    }
}

/// How much pictures differ.
struct Difference {
    /// Grey levels.
    mean: f32,
    /// That were compared.
    places: f32,
}

/// Pictures spread over a recording, and which are compared.
struct Views<'a> {
    archive: &'a Archive,
    views: Vec<View>,
    /// A picture, and one that sees much of the same from elsewhere.
    pairs: Vec<[usize; 2]>,
}

impl<'a> Views<'a> {
    fn new(archive: &'a Archive, usual: &Hall) -> Result<Self, SynthesisError> {
        let (count, wanted) = (archive.images().len(), archive.images().len().min(VIEWS));
        let chosen = (0..wanted).into_par_iter().with_max_len(1).map(|i| view(archive, i * count / wanted));
        let views: Vec<View> = chosen.collect::<Result<_, _>>()?;
        let proxy = ProxyGeometry::new(usual, archive.field());
        let targets = (0..views.len()).step_by(TARGET_STEP);
        let pairs = targets.flat_map(|target| partners(&views, target, &proxy)).collect();
        Ok(Self { archive, views, pairs })
    }

    /// Mean difference between the colours of pictures and of their partners.
    fn difference(&self, hall: &Hall) -> Difference {
        let proxy = ProxyGeometry::new(hall, self.archive.field());
        let sums = self.pairs.par_iter().map(|&[target, partner]| {
            let [own, other] = [target, partner].map(|index| &self.views[index]);
            let target = Target { rays: &own.rays, placement: own.placement, proxy: &proxy };
            let colors = glimpses(&target, &own.source()).into_iter().zip(glimpses(&target, &other.source()));
            let differences = colors.filter_map(|(a, b)| Some(color_difference(a?, b?)));
            differences.fold([0.0, 0.0], |sum, difference| [sum[0] + difference, sum[1] + 1.0])
        });
        let [sum, places] = sums.reduce(|| [0.0, 0.0], |a, b| [a[0] + b[0], a[1] + b[1]]);
        Difference { mean: sum / f32::max(places, 1.0), places }
    }

    /// The hall on which the pictures agree best, from this one on.
    fn descend(&self, mut best: Hall) -> Hall {
        let mut least = self.difference(&best).mean;
        for step_m in STEPS_M {
            for _ in 0..ROUNDS {
                let before = best;
                for (measure, signed_m) in (0..MEASURES.len()).flat_map(|m| [(m, step_m), (m, -step_m)]) {
                    while let Some(hall) = self.moved(&best, measure, signed_m)
                        && let found = self.difference(&hall).mean
                        && found < least
                    {
                        (best, least) = (hall, found);
                    }
                }
                if best == before {
                    break;
                }
            }
        }
        best
    }

    /// One measure larger by this, where that is a plausible hall.
    fn moved(&self, hall: &Hall, measure: usize, step_m: f64) -> Option<Hall> {
        let carpet = self.archive.field().carpet_half_extent_m();
        let range = match measure {
            0 => -carpet.x - MOST_M..=-carpet.x - LEAST_M,
            1 => -carpet.y - MOST_M..=-carpet.y - LEAST_M,
            2 => carpet.x + LEAST_M..=carpet.x + MOST_M,
            3 => carpet.y + LEAST_M..=carpet.y + MOST_M,
            4 => self.archive.usual_pose().height_m + 1.0..=MOST_M,
            _ => LEAST_M..=self.archive.field().border_strip_m.max(2.0 * LEAST_M),
        };
        let mut moved = *hall;
        *MEASURES[measure](&mut moved) += step_m;
        range.contains(MEASURES[measure](&mut moved)).then_some(moved)
    }
}

/// An image, small. It does not stay in the archive's cache.
fn view(archive: &Archive, image: usize) -> Result<View, SynthesisError> {
    let record = &archive.images()[image];
    let picture = archive.database().picture(record.id)?;
    let camera = archive.camera_of(image as u32);
    let shrink = f64::from(camera.width.div_ceil(WIDTH));
    let [width, height] =
        [camera.width, camera.height].map(|size| (f64::from(size) / shrink).round().max(1.0) as u32);
    let small = smaller(camera, [width, height]);
    let picture = if shrink > 1.0 { resize(&picture, width, height, FilterType::Triangle) } else { picture };
    Ok(View {
        camera: KernelCamera::new(&small),
        rays: RayTable::new(&small),
        placement: Placement::new(record.pose),
        picture: Arc::new(Picture::from(&picture)),
    })
}

/// The same camera with fewer pixels.
fn smaller(camera: &Camera, size: [u32; 2]) -> Camera {
    let [across, down] =
        [f64::from(size[0]) / f64::from(camera.width), f64::from(size[1]) / f64::from(camera.height)];
    // Pixels' centres are whole numbers: the picture begins half a pixel before the first one.
    let centre = [(camera.cx + 0.5) * across - 0.5, (camera.cy + 0.5) * down - 0.5];
    let intrinsics = [camera.fx * across, camera.fy * down, centre[0], centre[1]];
    let circle = camera.image_circle.map(|circle| ImageCircle {
        cx: (circle.cx + 0.5) * across - 0.5,
        cy: (circle.cy + 0.5) * down - 0.5,
        radius: circle.radius * across.min(down),
    });
    // A camera that was valid stays so when it shrinks.
    let small = Camera::new(size, intrinsics, camera.distortion).unwrap_or_else(|_| camera.clone());
    small.with_image_circle(circle)
}

/// Pairs of a picture with those that see much of the same from elsewhere.
fn partners(views: &[View], target: usize, proxy: &ProxyGeometry) -> Vec<[usize; 2]> {
    let own = &views[target];
    let distance_m = |other: &View| {
        let [a, b] = [own, other].map(|view| glam::Vec3::from_array(view.placement.position_in_world));
        f64::from(a.distance(b))
    };
    let others: Vec<usize> =
        (0..views.len()).filter(|&other| distance_m(&views[other]) > BASELINE_M).collect();
    let sources: Vec<Source> = others.iter().map(|&other| views[other].source()).collect();
    let wanted = Target { rays: &own.rays, placement: own.placement, proxy };
    let chosen = select(&wanted, &sources, &BlendWeights::default(), PARTNERS);
    chosen.into_iter().map(|index| [target, others[index]]).collect()
}

fn color_difference(a: [f32; 3], b: [f32; 3]) -> f32 {
    let sum: f32 = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum();
    (sum / 3.0).min(CUT)
}
