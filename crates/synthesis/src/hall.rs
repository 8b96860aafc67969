//! Measurement of the hall: walls are where pictures taken at different places agree best.
//!
//! The hall's dimensions are right when one picture shows the same colours as another at the same places of the
//! [`ProxyGeometry`]. Coordinate descent varies one dimension after the other to minimise the mean difference, first in
//! coarse steps, then in finer ones. Differences are clipped, so that objects in front of the walls do not decide.

use rayon::prelude::*;
use reality_sim_core::warp::{BlendWeights, Hall, Look, ProxyGeometry, Source, Target};

use crate::{
    Archive, SynthesisError,
    select::select,
    shrunk::{ShrunkCameras, ShrunkPicture},
};

/// Number of pictures used of a recording.
const PICTURES: usize = 120;
/// Interval of those that are compared with others.
const TARGET_STEP: usize = 2;
/// Number of pictures that each is compared with.
const PARTNERS: usize = 3;
/// Smallest distance to a partner, metres: from a single place, walls at all distances look alike.
const BASELINE_M: f64 = 0.5;
/// Value at which differences of colour are clipped, grey levels.
const CUT: f32 = 40.0;
/// Smallest number of compared places for a measurement.
const LEAST_PLACES: f32 = 1000.0;
/// Smallest increase of the mean difference, grey levels, when a dimension is set back to its default: with less evidence
/// the default is kept.
const EVIDENCE: f32 = 0.05;
/// Steps from the coarsest to the finest, metres.
const STEPS_M: [f64; 5] = [0.8, 0.4, 0.2, 0.1, 0.05];
/// Largest number of rounds over all dimensions for each step.
const ROUNDS: usize = 4;
/// Smallest distance of walls from the carpet, and smallest height and depth, metres.
const LEAST_M: f64 = 0.1;
/// Largest distance of walls from the carpet, and largest height of the ceiling, metres.
const MOST_M: f64 = 12.0;

/// Measures the hall around an archive's field. `None` if the pictures are too few, or all were taken at one place.
pub fn measure_hall(archive: &Archive) -> Result<Option<Hall>, SynthesisError> {
    let usual = Hall::usual(archive.field());
    let cameras = ShrunkCameras::new(archive);
    let pairs = PicturePairs::new(archive, &cameras, &usual)?;
    if pairs.difference(&usual).places < LEAST_PLACES {
        return Ok(None);
    }
    let mut best = pairs.descend(usual);
    for measure in MEASURES {
        let (mut without, mut usual) = (best, usual);
        *measure(&mut without) = *measure(&mut usual);
        if pairs.difference(&without).mean < pairs.difference(&best).mean + EVIDENCE {
            best = without;
        }
    }
    Ok(Some(best))
}

/// Walls towards −x, −y, +x and +y, ceiling, goals.
const MEASURES: [fn(&mut Hall) -> &mut f64; 6] = [
    |hall| &mut hall.min_m.x,
    |hall| &mut hall.min_m.y,
    |hall| &mut hall.max_m.x,
    |hall| &mut hall.max_m.y,
    |hall| &mut hall.ceiling_m,
    |hall| &mut hall.goal_depth_m,
];

/// Difference between pictures.
struct Difference {
    /// Mean difference, grey levels.
    mean: f32,
    /// Number of places compared.
    places: f32,
}

/// Pictures spread over a recording, and the pairs that are compared.
struct PicturePairs<'a> {
    archive: &'a Archive,
    pictures: Vec<ShrunkPicture<'a>>,
    /// Pairs of a picture and one that shows much of the same from elsewhere.
    pairs: Vec<[usize; 2]>,
}

impl<'a> PicturePairs<'a> {
    fn new(archive: &'a Archive, cameras: &'a ShrunkCameras, usual: &Hall) -> Result<Self, SynthesisError> {
        let (count, wanted) = (archive.images().len(), archive.images().len().min(PICTURES));
        let chosen =
            (0..wanted).into_par_iter().with_max_len(1).map(|i| cameras.read(archive, i * count / wanted));
        let pictures: Vec<ShrunkPicture> = chosen.collect::<Result<_, _>>()?;
        let proxy = ProxyGeometry::new(usual, archive.field());
        let targets = (0..pictures.len()).step_by(TARGET_STEP);
        let pairs = targets.flat_map(|target| partners(&pictures, target, &proxy)).collect();
        Ok(Self { archive, pictures, pairs })
    }

    /// Mean difference between the colours of pictures and of their partners.
    fn difference(&self, hall: &Hall) -> Difference {
        let proxy = ProxyGeometry::new(hall, self.archive.field());
        let sums = self.pairs.par_iter().map(|&[target, partner]| {
            let [own, other] = [target, partner].map(|index| &self.pictures[index]);
            let target = Target { rays: &own.camera.rays, placement: own.placement, proxy: &proxy };
            let look = Look::new(&target);
            let colors = look.colors(&own.source()).into_iter().zip(look.colors(&other.source()));
            let differences = colors.filter_map(|(a, b)| Some(color_difference(a?, b?)));
            differences.fold([0.0, 0.0], |sum, difference| [sum[0] + difference, sum[1] + 1.0])
        });
        let [sum, places] = sums.reduce(|| [0.0, 0.0], |a, b| [a[0] + b[0], a[1] + b[1]]);
        Difference { mean: sum / f32::max(places, 1.0), places }
    }

    /// Searches, from this hall on, for the one on which the pictures agree best.
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

    /// Changes one dimension by this much, if the result is a plausible hall.
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

/// Pairs a picture with those that show much of the same from elsewhere.
fn partners(pictures: &[ShrunkPicture], target: usize, proxy: &ProxyGeometry) -> Vec<[usize; 2]> {
    let own = &pictures[target];
    let distance_m = |other: &ShrunkPicture| {
        let [a, b] = [own, other].map(|one| glam::Vec3::from_array(one.placement.position_in_world));
        f64::from(a.distance(b))
    };
    let others: Vec<usize> =
        (0..pictures.len()).filter(|&other| distance_m(&pictures[other]) > BASELINE_M).collect();
    let sources: Vec<Source> = others.iter().map(|&other| pictures[other].source()).collect();
    let wanted = Target { rays: &own.camera.rays, placement: own.placement, proxy };
    let chosen = select(&Look::new(&wanted), &sources, &BlendWeights::default(), PARTNERS);
    chosen.into_iter().map(|index| [target, others[index]]).collect()
}

fn color_difference(a: [f32; 3], b: [f32; 3]) -> f32 {
    let sum: f32 = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum();
    (sum / 3.0).min(CUT)
}
