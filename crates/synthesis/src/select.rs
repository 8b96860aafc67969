//! Which neighbours to take: together they shall see as much of the target as possible, as well as possible.
//!
//! The nearest by pose are often pictures of one moment that all miss the same corner. Of the candidates, one after the
//! other is chosen that lowers most the sum over the target's pixels of the least cost (greedy facility location: within
//! 1 − 1/e of the best choice).

use reality_sim_core::warp::{BlendWeights, Source, Target, costs};

/// Indices of the candidates to take, at most `count`, the best first.
pub fn select(target: &Target, candidates: &[Source], weights: &BlendWeights, count: usize) -> Vec<usize> {
    let costs: Vec<Vec<f32>> = candidates.iter().map(|candidate| costs(target, candidate, weights)).collect();
    let Some(pixels) = costs.first().map(Vec::len) else { return Vec::new() };
    let mut least = vec![f32::INFINITY; pixels];
    let mut chosen: Vec<usize> = Vec::new();
    while chosen.len() < count.min(candidates.len()) {
        let total = |index: usize| -> f32 { costs[index].iter().zip(&least).map(|(a, b)| a.min(*b)).sum() };
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
