//! Plan of the study: the worlds, the effects hidden in them, and what is left out of the library or of the files.

use clap::ValueEnum;
use reality_sim_hidden::{FOREIGN, Given, LIBRARY, Random, Recipe};
use serde::{Deserialize, Serialize};

/// Purposes of recordings. No two share a world: rules are made on the first, checked on the second, and reported on the
/// last, which is drawn once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Purpose {
    Development,
    Validation,
    Final,
}

/// Parts of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Part {
    /// Nothing is hidden.
    Nulls,
    /// Every effect of the library, at several sizes.
    Singles,
    /// Every effect, taken out of the library.
    Removed,
    /// Two effects.
    Pairs,
    /// Three effects.
    Triples,
    /// Effects that no library has.
    Foreign,
    /// Effects of light and sensor in recordings whose files tell nothing of brightness, noise and sharpness but the gamma.
    Unmeasured,
}

impl Part {
    pub const ALL: [Self; 7] = [
        Self::Nulls,
        Self::Singles,
        Self::Removed,
        Self::Pairs,
        Self::Triples,
        Self::Foreign,
        Self::Unmeasured,
    ];
}

/// What the files tell of brightness, noise and sharpness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Told {
    /// What the world's seed draws.
    Drawn,
    /// Everything.
    All,
    /// Nothing but the gamma.
    Gamma,
}

/// Sizes of single effects, in detection limits.
pub const SIZES: [f64; 3] = [3.0, 6.0, 1.0];
/// Size from which on an effect has to be named, in detection limits.
pub const CLEAR: f64 = 3.0;
/// Size of effects beside others, and of those taken out of the library, in detection limits.
const LARGE: f64 = 6.0;
/// Size of effects without nominal values, in detection limits of the same recording with them.
const UNMEASURED: f64 = 2.0;
/// Effects that have to be seen without nominal values.
const OF_LIGHT: [&str; 5] = ["vignetting", "exposure_drift", "tone_curve", "motion_blur", "sensor_noise"];

/// Number of worlds of each effect.
pub const WALKS: u64 = 30;
/// Number of worlds with nothing hidden, besides those of the effects.
const NULLS: u64 = 300;
const PAIRS: u64 = 60;
const TRIPLES: u64 = 40;

const SEEDS_OF_A_PURPOSE: u64 = 100_000_000;
const SEEDS_OF_A_PART: u64 = 1_000_000;
const SEEDS_OF_AN_EFFECT: u64 = 10_000;

/// Recording with its hidden effects and the options of its analysis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Task {
    pub part: Part,
    /// Seed of the world, which is a walk of its own.
    pub seed: u64,
    /// Ids of the hidden effects.
    pub effects: Vec<String>,
    /// Size of each hidden effect, in detection limits; 0 where there are none.
    pub size: f64,
    /// Effect that is left out of the library.
    pub without: Option<String>,
    pub told: Told,
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
        let Self { part, seed, effects, size, without, told, picture, frames } = self;
        format!("{part:?} {seed} {effects:?} {size} {without:?} {told:?} {picture:?} {frames}")
    }

    /// Returns the same recording with nothing hidden, on which detection limits are measured: with nominal values where
    /// the task's files lack them.
    pub fn with_nothing_hidden(&self) -> Self {
        let told = if self.told == Told::Gamma { Told::All } else { self.told };
        Self { part: Part::Nulls, effects: Vec::new(), size: 0.0, without: None, told, ..self.clone() }
    }

    pub fn recipe(&self) -> Recipe {
        let given = match self.told {
            Told::Drawn => None,
            Told::All => Some(Given::ALL),
            Told::Gamma => Some(Given::GAMMA_ALONE),
        };
        Recipe { frames: self.frames, size: self.picture, given, ..Recipe::drawn(self.seed) }
    }

    fn null(seed: u64) -> Self {
        Self {
            part: Part::Nulls,
            seed,
            effects: Vec::new(),
            size: 0.0,
            without: None,
            told: Told::Drawn,
            frames: 60,
            picture: [640, 480],
        }
    }

    fn hiding(part: Part, seed: u64, effects: &[&str], size: f64) -> Self {
        let effects = effects.iter().map(|id| (*id).to_owned()).collect();
        Self { part, effects, size, ..Self::null(seed) }
    }
}

/// Returns the size of an effect outside the library, as a multiple of [`reality_sim_hidden::Hidden::of`]'s: dirt that takes
/// 40 % of the light, bands of 10 %, a line displaced by 7.5 cm or wider by 1.5 cm, six people, fog of 0.08 per metre (a fifth
/// of the contrast at three metres), waves of ±15 mm, a dent of half a percent of the picture's width, five pictures lost or
/// stored twice. A missing line has no size.
pub fn foreign_multiple(id: &str) -> f64 {
    match id {
        "lens_dirt" => 4.0,
        "moving_people" => 6.0,
        "fog" => 8.0,
        _ => 5.0,
    }
}

/// Returns the runs of these parts, those of a world one after the other, and the worlds in turn over the effects: what is
/// done when the time is over is a smaller study.
pub fn tasks(purpose: Purpose, parts: &[Part], walks: u64) -> Vec<Task> {
    let mut tasks = Vec::new();
    for walk in 0..walks {
        for part in Part::ALL.into_iter().filter(|part| parts.contains(part)) {
            let first = (purpose as u64 + 1) * SEEDS_OF_A_PURPOSE;
            let share = |count: u64| (count * walk / walks)..(count * (walk + 1) / walks);
            match part {
                Part::Nulls => tasks.extend(share(NULLS).map(|index| Task::null(first + index))),
                Part::Pairs => tasks.extend(share(PAIRS).map(|index| together(part, first, index, 2))),
                Part::Triples => tasks.extend(share(TRIPLES).map(|index| together(part, first, index, 3))),
                // These are the worlds of single effects.
                Part::Removed if parts.contains(&Part::Singles) => {}
                _ => tasks.extend(of_effects(part, first, walk, parts)),
            }
        }
    }
    tasks
}

/// Returns the runs of a walk of every effect.
fn of_effects(part: Part, first: u64, walk: u64, parts: &[Part]) -> Vec<Task> {
    let ids: &[&str] = match part {
        Part::Foreign => &FOREIGN,
        Part::Unmeasured => &OF_LIGHT,
        _ => &LIBRARY,
    };
    let number = match part {
        Part::Foreign => 4,
        Part::Unmeasured => 5,
        _ => 1,
    };
    let of_effect = |(index, id): (u64, &&str)| {
        let seed = first + number * SEEDS_OF_A_PART + index * SEEDS_OF_AN_EFFECT + walk;
        let hiding = |part, size| Task::hiding(part, seed, &[*id], size);
        match part {
            Part::Foreign => vec![hiding(part, 0.0)],
            Part::Unmeasured => vec![Task { told: Told::Gamma, ..hiding(part, UNMEASURED) }],
            _ => {
                let sizes = SIZES.into_iter().filter(|_| parts.contains(&Part::Singles));
                let mut tasks: Vec<Task> = sizes.map(|size| hiding(Part::Singles, size)).collect();
                if parts.contains(&Part::Removed) {
                    let without = Some((*id).to_owned());
                    tasks.push(Task { without, ..hiding(Part::Removed, LARGE) });
                }
                tasks
            }
        }
    };
    (0..).zip(ids).flat_map(of_effect).collect()
}

/// Returns a run with several effects of the library.
fn together(part: Part, first: u64, index: u64, count: usize) -> Task {
    let seed = first + (count as u64) * SEEDS_OF_A_PART + index;
    let mut random = Random::stream(seed, "effects together", 0);
    let mut effects: Vec<&str> = Vec::new();
    while effects.len() < count {
        let id = LIBRARY[random.below(LIBRARY.len() as u64) as usize];
        if !effects.contains(&id) {
            effects.push(id);
        }
    }
    Task::hiding(part, seed, &effects, LARGE)
}
