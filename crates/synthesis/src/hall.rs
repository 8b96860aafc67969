//! Where the walls stand: found by what pictures taken at different places agree on.
//!
//! A hall's measures are good when the colours that one picture shows are those that another shows at the same places of the
//! [`Hull`]. One measure after the other is moved to where the mean difference, cut off so that what stands in
//! front does not decide, is least (coordinate descent), first in coarse steps, then in finer ones.

use rayon::prelude::*;
use reality_sim_core::warp::{BlendWeights, Hall, Hull, Placement, RayTable, Source, Target, glimpses};
use reality_sim_db::index::ImageIndex;

use crate::{Archive, SynthesisError, select::select};

/// Pictures that are compared with others.
const TARGETS: usize = 60;
/// Pictures that each is compared with.
const PARTNERS: usize = 3;
/// Partners stand at least this far away, metres: from one place all distances look alike.
const BASELINE_M: f64 = 0.5;
/// Differences of colour are cut off here, grey levels.
const CUT: f32 = 40.0;
/// With fewer pictures nothing is measured.
const LEAST_IMAGES: usize = 12;
/// From the coarsest step to the finest, metres.
const STEPS_M: [f64; 5] = [0.8, 0.4, 0.2, 0.1, 0.05];
/// Rounds over all measures for each step, at most.
const ROUNDS: usize = 4;
/// Walls stand at least this far from the carpet, metres; nothing is lower or less deep.
const LEAST_M: f64 = 0.1;
/// No wall stands farther from the carpet, and no ceiling hangs higher, metres.
const MOST_M: f64 = 12.0;

/// Measures the hall around an archive's field. `None` where there are too few pictures to tell.
pub fn measure_hall(archive: &Archive) -> Result<Option<Hall>, SynthesisError> {
    if archive.images().len() < LEAST_IMAGES {
        return Ok(None);
    }
    let usual = Hall::usual(archive.field());
    let views = views(archive, &Hull::new(&usual, archive.field()))?;
    let rays = RayTable::new(&archive.setup().camera);
    let difference = |hall: &Hall| difference(archive, &rays, &views, &Hull::new(hall, archive.field()));
    let mut best = usual;
    let mut least = difference(&best);
    for step_m in STEPS_M {
        for _ in 0..ROUNDS {
            let before = best;
            for measure in 0..MEASURES {
                for signed_m in [step_m, -step_m] {
                    descend(archive, measure, signed_m, &difference, &mut best, &mut least);
                }
            }
            if best == before {
                break;
            }
        }
    }
    Ok(Some(best))
}

/// Walls towards −x, −y, +x, +y, ceiling, goals.
const MEASURES: usize = 6;

/// Goes on in one direction while the difference falls.
fn descend(
    archive: &Archive,
    measure: usize,
    step_m: f64,
    difference: &impl Fn(&Hall) -> f32,
    best: &mut Hall,
    least: &mut f32,
) {
    while let Some(hall) = moved(archive, best, measure, step_m) {
        let found = difference(&hall);
        if found >= *least {
            break;
        }
        (*best, *least) = (hall, found);
    }
}

/// One measure larger by this, where that is a plausible hall.
fn moved(archive: &Archive, hall: &Hall, measure: usize, step_m: f64) -> Option<Hall> {
    let carpet = archive.field().carpet_half_extent_m();
    let mut moved = *hall;
    let (value, range) = match measure {
        0 => (&mut moved.min_m.x, -carpet.x - MOST_M..=-carpet.x - LEAST_M),
        1 => (&mut moved.min_m.y, -carpet.y - MOST_M..=-carpet.y - LEAST_M),
        2 => (&mut moved.max_m.x, carpet.x + LEAST_M..=carpet.x + MOST_M),
        3 => (&mut moved.max_m.y, carpet.y + LEAST_M..=carpet.y + MOST_M),
        4 => (&mut moved.ceiling_m, archive.usual_pose().height_m + 1.0..=MOST_M),
        _ => (&mut moved.goal_depth_m, LEAST_M..=archive.field().border_strip_m.max(2.0 * LEAST_M)),
    };
    *value += step_m;
    range.contains(value).then_some(moved)
}

/// A picture, and those it is compared with.
struct View {
    image: ImageIndex,
    partners: Vec<ImageIndex>,
}

/// Pictures spread over the recording, each with partners that see much of the same from elsewhere.
fn views(archive: &Archive, hull: &Hull) -> Result<Vec<View>, SynthesisError> {
    let count = archive.images().len();
    let spread =
        |wanted: usize| (0..count.min(wanted)).map(move |i| (i * count / count.min(wanted)) as ImageIndex);
    let rays = RayTable::new(&archive.setup().camera);
    let poses = archive.index().poses();
    let nothing = Archive::no_picture();
    let view = |image: ImageIndex| {
        let pose = poses[image as usize];
        let target = Target { rays: &rays, placement: Placement::new(pose), hull };
        let is_apart = |other: &ImageIndex| {
            poses[*other as usize].position_in_world().distance(pose.position_in_world()) > BASELINE_M
        };
        let others: Vec<ImageIndex> = spread(2 * TARGETS).filter(is_apart).collect();
        let sources: Vec<Source> = others.iter().map(|&other| archive.source(other, &nothing)).collect();
        let chosen = select(&target, &sources, &BlendWeights::default(), PARTNERS);
        View { image, partners: chosen.into_iter().map(|index| others[index]).collect() }
    };
    let views: Vec<View> = spread(TARGETS).map(view).collect();
    for view in &views {
        archive.pictures(&view.partners)?;
        archive.picture(view.image)?;
    }
    Ok(views)
}

/// Mean difference between the colours of pictures and of their partners, grey levels.
fn difference(archive: &Archive, rays: &RayTable, views: &[View], hull: &Hull) -> f32 {
    let sums = views.par_iter().map(|view| {
        let placement = Placement::new(archive.index().poses()[view.image as usize]);
        let target = Target { rays, placement, hull };
        let colors = |image: ImageIndex| {
            // Decoded before; a picture that cannot be read any more says nothing.
            let picture = archive.picture(image).unwrap_or_else(|_| Archive::no_picture());
            glimpses(&target, &archive.source(image, &picture))
        };
        let own = colors(view.image);
        let others = view.partners.iter().flat_map(|&partner| own.iter().copied().zip(colors(partner)));
        others
            .filter_map(|(a, b)| Some(color_difference(a?, b?)))
            .fold([0.0, 0.0], |sum, d| [sum[0] + d, sum[1] + 1.0])
    });
    let [sum, count] = sums.reduce(|| [0.0, 0.0], |a, b| [a[0] + b[0], a[1] + b[1]]);
    sum / f32::max(count, 1.0)
}

fn color_difference(a: [f32; 3], b: [f32; 3]) -> f32 {
    let sum: f32 = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum();
    (sum / 3.0).min(CUT)
}
