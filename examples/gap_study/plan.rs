//! Plan of the study: the recordings to make and the effects hidden in them.

use std::error::Error;

use clap::ValueEnum;
use reality_sim_hidden::{FOREIGN, LIBRARY, Random};
use serde::{Deserialize, Serialize};

use crate::{limits::Limits, sight::is_in_sight};

/// Parts of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Part {
    /// Nothing is hidden.
    Nulls,
    /// Every effect of the library, at several sizes.
    Singles,
    /// Two effects.
    Pairs,
    /// Every effect, taken out of the library.
    Removed,
    /// Effects that no library has.
    Foreign,
    /// Some of all that at full size.
    Full,
}

impl Part {
    pub const ALL: [Self; 6] =
        [Self::Nulls, Self::Singles, Self::Pairs, Self::Removed, Self::Foreign, Self::Full];
}

/// Sizes of single effects, in detection limits.
pub const SIZES: [f64; 3] = [3.0, 6.0, 1.0];
/// Size from which on an effect has to be named, in detection limits.
pub const CLEAR: f64 = 3.0;
const SEEDS_OF_A_DRAW: u64 = 1_000_000;
const NULLS: u64 = 220;
const SEEDS: u64 = 3;
const PAIRS: u64 = 48;
const FOREIGN_SEEDS: u64 = 6;
/// Size of the effects of a pair, and of those taken out of the library, in detection limits.
const LARGE: f64 = 6.0;

/// Recording with its hidden effects and the options of its analysis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Task {
    pub part: Part,
    pub seed: u64,
    /// Ids of the hidden effects.
    pub effects: Vec<String>,
    /// Size of each hidden effect, in detection limits.
    pub size: f64,
    /// Effect that is left out of the library.
    pub without: Option<String>,
    pub frames: usize,
    pub picture: [u32; 2],
}

/// Effect to hide.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Chosen {
    pub id: String,
    /// Size as a multiple of [`reality_sim_hidden::Hidden::of`]'s.
    pub multiple: f64,
    /// Size in the recording's detection limits; 0 if the effect has none.
    pub in_limits: f64,
}

impl Task {
    pub fn key(&self) -> String {
        format!(
            "{:?} {} {:?} {} {:?} {:?}",
            self.part, self.seed, self.effects, self.size, self.without, self.picture
        )
    }

    /// Returns the effects to hide with their sizes. None if one of them cannot be seen in the recording, or if the wanted
    /// size is not plausible.
    pub fn chosen(&self, limits: &mut Limits) -> Result<Option<Vec<Chosen>>, Box<dyn Error>> {
        let mut all = Vec::with_capacity(self.effects.len());
        for id in &self.effects {
            let size = if self.part == Part::Foreign {
                Some((foreign_multiple(id), 0.0))
            } else {
                let enough = 0.99 * self.size.min(CLEAR);
                limits.size(self, id, self.size)?.filter(|(_, in_limits)| *in_limits > enough)
            };
            let Some((multiple, in_limits)) = size else { return Ok(None) };
            let chosen = Chosen { id: id.clone(), multiple, in_limits };
            if self.part == Part::Foreign && !is_in_sight(self, &chosen)? {
                return Ok(None);
            }
            all.push(chosen);
        }
        Ok(Some(all))
    }

    fn small(part: Part, seed: u64) -> Self {
        Self { part, seed, effects: Vec::new(), size: 0.0, without: None, frames: 40, picture: [320, 240] }
    }

    fn single(part: Part, seed: u64, id: &str, size: f64) -> Self {
        Self { effects: vec![id.to_owned()], size, ..Self::small(part, seed) }
    }

    fn full(self) -> Self {
        Self { part: Part::Full, frames: 60, picture: [640, 480], ..self }
    }
}

/// Returns the size of an effect outside the library, as a multiple of [`reality_sim_hidden::Hidden::of`]'s: dirt that takes
/// 40 % of the light, bands of 10 %, a line displaced by 7.5 cm, six people, fog of 0.08 per metre (a fifth of the contrast
/// at three metres), waves of ±15 mm, a dent of half a percent of the picture's width. A missing line has no size.
fn foreign_multiple(id: &str) -> f64 {
    match id {
        "lens_dirt" => 4.0,
        "moving_people" => 6.0,
        "fog" => 8.0,
        _ => 5.0,
    }
}

/// Returns all runs of a part, on recordings that no other draw has.
pub fn tasks(part: Part, draw: u64) -> Vec<Task> {
    let of_draw = |task: Task| Task { seed: task.seed + draw * SEEDS_OF_A_DRAW, ..task };
    planned(part, draw).into_iter().map(of_draw).collect()
}

fn planned(part: Part, draw: u64) -> Vec<Task> {
    match part {
        Part::Nulls => (0..NULLS).map(|seed| Task::small(part, 10_000 + seed)).collect(),
        Part::Singles => singles(part, &SIZES),
        Part::Removed => {
            let without = |task: Task| Task { without: task.effects.first().cloned(), ..task };
            singles(part, &[LARGE]).into_iter().map(without).collect()
        }
        Part::Pairs => pairs(draw),
        Part::Foreign => {
            let of_seed = |seed| FOREIGN.iter().map(move |id| Task::single(part, 40_000 + seed, id, 0.0));
            (0..FOREIGN_SEEDS).flat_map(of_seed).collect()
        }
        Part::Full => {
            let nulls = (0..3).map(|seed| Task::small(part, 50_000 + seed));
            let singles = (0..).zip(LIBRARY).map(|(index, id)| Task::single(part, 50_100 + index, id, LARGE));
            nulls.chain(singles).map(Task::full).collect()
        }
    }
}

/// Returns runs with single effects, all effects at one size before the next size, so that the first runs alone are a study
/// too.
fn singles(part: Part, sizes: &[f64]) -> Vec<Task> {
    let mut tasks = Vec::new();
    for seed in 0..SEEDS {
        for &size in sizes {
            tasks.extend(LIBRARY.iter().map(|id| Task::single(part, 20_000 + seed, id, size)));
        }
    }
    tasks
}

fn pairs(draw: u64) -> Vec<Task> {
    let mut random = Random::new(7 + draw);
    let mut pair = |seed| {
        let count = LIBRARY.len() as u64;
        let first = random.below(count);
        let second = (first + 1 + random.below(count - 1)) % count;
        let effects = [first, second].map(|index| LIBRARY[index as usize].to_owned()).to_vec();
        Task { effects, size: LARGE, ..Task::small(Part::Pairs, 30_000 + seed) }
    };
    (0..PAIRS).map(&mut pair).collect()
}
