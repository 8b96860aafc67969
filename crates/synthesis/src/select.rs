//! Selection of neighbours that together show as much of the target as possible, as well as possible.
//!
//! The nearest images by pose are often pictures of one moment that all miss the same corner. Candidates are therefore
//! chosen one after the other: each lowers the sum, over the target's pixels, of the least cost as much as possible
//! (greedy facility location: within 1 − 1/e of the best choice).

use rayon::prelude::*;
use reality_sim_core::{
    camera::LANES,
    warp::{BlendWeights, Look, Source},
};

/// Candidates that one task looks through: less work would not outweigh its start.
const CANDIDATES_A_TASK: usize = 16;

/// Returns the indices of the candidates to use, at most `count`, the best first.
pub fn select(look: &Look, candidates: &[Source], weights: &BlendWeights, count: usize) -> Vec<usize> {
    least_costly(&all_costs(look, candidates, weights, |_, _| {}), count)
}

/// Returns how badly each candidate shows the pixels of a look, see [`Look::costs`]. `change` may raise the costs of a candidate,
/// which it gets with its index.
pub fn all_costs(
    look: &Look,
    candidates: &[Source],
    weights: &BlendWeights,
    change: impl Fn(usize, &mut [f32]) + Sync,
) -> Vec<Vec<f32>> {
    let costs_of = |(index, candidate): (usize, &Source)| {
        let mut costs = look.costs(candidate, weights);
        change(index, &mut costs);
        costs
    };
    candidates.par_iter().enumerate().with_min_len(CANDIDATES_A_TASK).map(costs_of).collect()
}

/// Returns the indices of the candidates, at most `count`, that together have the least costs; the best first.
pub fn least_costly(costs: &[Vec<f32>], count: usize) -> Vec<usize> {
    let Some(pixels) = costs.first().map(Vec::len) else { return Vec::new() };
    let mut least = vec![f32::INFINITY; pixels];
    let mut chosen: Vec<usize> = Vec::new();
    while chosen.len() < count.min(costs.len()) {
        let total = |index: usize| sum_of_least(&costs[index], &least);
        let rest = (0..costs.len()).filter(|index| !chosen.contains(index));
        let Some((best, _)) = rest.map(|index| (index, total(index))).min_by(|a, b| a.1.total_cmp(&b.1))
        else {
            break;
        };
        least.iter_mut().zip(&costs[best]).for_each(|(least, cost)| *least = least.min(*cost));
        chosen.push(best);
    }
    chosen
}

/// Returns the sum of the lesser numbers of two lists, summed in sixteen parts, which takes vectors.
fn sum_of_least(a: &[f32], b: &[f32]) -> f32 {
    let mut sums = [0.0_f32; LANES];
    for (a, b) in a.chunks(LANES).zip(b.chunks(LANES)) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a.min(*b);
        }
    }
    sums.iter().sum()
}
