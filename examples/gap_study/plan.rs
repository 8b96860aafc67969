//! What is run.

use std::{collections::BTreeMap, error::Error};

use clap::ValueEnum;
use reality_sim::sensor::{Role, effect};
use reality_sim_hidden::{FOREIGN, Hidden, LIBRARY, Random};
use serde::{Deserialize, Serialize};

use crate::truth::main_size;

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
pub const SIZES: [f64; 4] = [3.0, 6.0, 12.0, 1.0];
const NULLS: u64 = 220;
const SEEDS: u64 = 4;
const PAIRS: u64 = 60;
const FOREIGN_SEEDS: u64 = 6;
/// Effects of a pair are so large, in detection limits.
const PAIR_SIZE: f64 = 6.0;
const REMOVED_SIZE: f64 = 6.0;

/// No effect is larger than this part of its plausible range.
const LARGEST: f64 = 0.8;

/// The plausible range of an effect's first parameter.
fn reach(id: &str) -> f64 {
    let first = effect(id)
        .and_then(|effect| effect.parameters().iter().find(|parameter| parameter.role == Role::Size));
    match id {
        // A factor of the standard deviation, not the library's variance.
        "sensor_noise" => 4.0,
        _ => first.map_or(f64::INFINITY, |parameter| parameter.range[1]),
    }
}

/// One recording and what is asked of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Task {
    pub part: Part,
    pub seed: u64,
    /// Ids of what is hidden, each with its multiple of [`Hidden::of`]'s reference size.
    pub hidden: Vec<(String, f64)>,
    /// Of the detection limit; 0 where it means nothing.
    pub size: f64,
    /// Left out of the library.
    pub without: Option<String>,
    pub frames: usize,
    pub picture: [u32; 2],
}

impl Task {
    pub fn key(&self) -> String {
        format!(
            "{:?} {} {:?} {} {:?} {:?}",
            self.part, self.seed, self.hidden, self.size, self.without, self.picture
        )
    }

    /// What is hidden, drawn by the seed.
    pub fn effects(&self) -> Result<Vec<Hidden>, Box<dyn Error>> {
        let mut random = Random::new(self.seed.wrapping_mul(77));
        Ok(self
            .hidden
            .iter()
            .map(|(id, multiple)| Hidden::of(id, *multiple, &mut random))
            .collect::<Result<_, _>>()?)
    }

    fn small(part: Part, seed: u64) -> Self {
        Self { part, seed, hidden: Vec::new(), size: 0.0, without: None, frames: 40, picture: [320, 240] }
    }
}

/// All runs of a part. `limits` are the detection limits by effect, in its main size.
pub fn tasks(part: Part, limits: &BTreeMap<String, f64>) -> Result<Vec<Task>, Box<dyn Error>> {
    let multiple = |id: &str, size: f64| -> Result<f64, Box<dyn Error>> {
        let unit = main_size(&Hidden::of(id, 1.0, &mut Random::new(1))?).abs();
        let wanted = size * limits.get(id).copied().unwrap_or(unit);
        Ok(wanted.min(LARGEST * reach(id)) / unit)
    };
    let single = |part: Part, id: &str, size: f64, seed: u64| -> Result<Task, Box<dyn Error>> {
        let hidden = vec![(id.to_owned(), multiple(id, size)?)];
        Ok(Task { hidden, size, ..Task::small(part, seed) })
    };
    let mut tasks = Vec::new();
    match part {
        Part::Nulls => tasks.extend((0..NULLS).map(|seed| Task::small(part, 10_000 + seed))),
        Part::Singles => {
            // All effects at one size before the next: a part of the runs is a study, too.
            for seed in 0..SEEDS {
                for size in SIZES {
                    for id in LIBRARY {
                        tasks.push(single(part, id, size, 20_000 + seed)?);
                    }
                }
            }
        }
        Part::Pairs => {
            let mut random = Random::new(7);
            for seed in 0..PAIRS {
                let count = LIBRARY.len() as u64;
                let first = random.below(count);
                let second = (first + 1 + random.below(count - 1)) % count;
                let hidden = [first, second].map(|index| index as usize).map(|index| {
                    Ok::<_, Box<dyn Error>>((LIBRARY[index].to_owned(), multiple(LIBRARY[index], PAIR_SIZE)?))
                });
                let hidden = hidden.into_iter().collect::<Result<_, _>>()?;
                tasks.push(Task { hidden, size: PAIR_SIZE, ..Task::small(part, 30_000 + seed) });
            }
        }
        Part::Removed => {
            for seed in 0..SEEDS {
                for id in LIBRARY {
                    let task = single(part, id, REMOVED_SIZE, 20_000 + seed)?;
                    tasks.push(Task { without: Some(id.to_owned()), ..task });
                }
            }
        }
        Part::Foreign => {
            for seed in 0..FOREIGN_SEEDS {
                for id in FOREIGN {
                    let hidden = vec![(id.to_owned(), 1.0)];
                    tasks.push(Task { hidden, ..Task::small(part, 40_000 + seed) });
                }
            }
        }
        Part::Full => {
            let full = |task: Task| Task { part, frames: 60, picture: [640, 480], ..task };
            for seed in 0..4 {
                tasks.push(full(Task::small(part, 50_000 + seed)));
            }
            for (index, id) in (0..).zip(LIBRARY) {
                tasks.push(full(single(part, id, 6.0, 50_100 + index)?));
            }
        }
    }
    Ok(tasks)
}
