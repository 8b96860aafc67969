//! Recordings in which an effect has a certain size, simulated in the linearised model, and how often the effect is found.
//!
//! The simulated scores are those that the size makes, with errors as the recording shows them: the residual scores of the fit
//! with random signs, which neighbouring views share (wild bootstrap, Wu 1986; for dependent data Shao 2010), together with what
//! the nuisance parameters' priors allow. The nuisance parameters are eliminated beforehand, so that a simulation is small.

use nalgebra::{DMatrix, DVector};
use reality_sim_sensor::EffectIndex;

use crate::{
    frame_index::ViewIndex,
    inference::{
        cluster_covariance::LAG,
        effect_fit::EffectFits,
        effect_test::{EffectTest, EffectTests, acts_on_light},
        evidence::{Evidence, ReducedRecording},
    },
    linear_model::{
        column::ColumnIndex, normal_equations::NormalEquations, parameters::FittedParameter,
        reduced_equations::ProjectedEquations, system::LinearSystem,
    },
    thresholds::Thresholds,
};

/// Number of simulated recordings. The same random numbers are used for every size.
const DRAWS: u64 = Thresholds::DEFAULT.inference.limit_draws;

/// Equations of a recording, from which others are simulated.
pub(crate) struct PowerAnalysis<'a> {
    pub(crate) fits: &'a EffectFits<'a>,
    /// View of each frame.
    views: Vec<ViewIndex>,
    /// Equations without nuisance parameters, of all measurements.
    whole: ReducedRecording,
    /// The same without the levels of lines and without those of carpet.
    of_one_surface: Vec<ReducedRecording>,
}

impl<'a> PowerAnalysis<'a> {
    /// Prepares the simulation of recordings like that of `fits`; `views` are those of its training frames.
    pub(crate) fn new(fits: &'a EffectFits<'a>, views: Vec<ViewIndex>) -> Self {
        let of_one_surface = fits.evidence.of_one_surface();
        Self {
            fits,
            views,
            whole: fits.evidence.reduced(),
            of_one_surface: of_one_surface.iter().map(Evidence::reduced).collect(),
        }
    }

    /// Prepares the simulation of an effect beside those of the model. None if the fit is singular.
    pub(crate) fn of(&self, effect: EffectIndex, model: &[EffectIndex]) -> Option<SimulatedEffect<'_>> {
        let others: Vec<EffectIndex> = model.iter().copied().filter(|other| *other != effect).collect();
        let with: Vec<EffectIndex> = others.iter().copied().chain([effect]).collect();
        let chosen = self.fits.columns_of(&with);
        let base = chosen.iter().map(|column| self.fits.evidence.base[column.0]);
        let base = DVector::from_iterator(chosen.len(), base);
        // Only light is tested by one surface at a time.
        let of_one_surface = if acts_on_light(effect) { self.of_one_surface.as_slice() } else { &[] };
        let simulate = |recording| Simulation::new(recording, &chosen, &base, &self.views);
        Some(SimulatedEffect {
            columns: chosen.iter().map(|column| self.fits.columns[column.0]).collect(),
            whole: simulate(&self.whole)?,
            of_one_surface: of_one_surface.iter().map(simulate).collect::<Option<_>>()?,
            tested: self.fits.effects().len(),
            effect,
            others,
            base,
        })
    }
}

/// Simulated recordings that differ in the size of one effect.
pub(crate) struct SimulatedEffect<'a> {
    effect: EffectIndex,
    /// Effects of the model beside it.
    others: Vec<EffectIndex>,
    /// Number of effects that are tested.
    tested: usize,
    columns: Vec<FittedParameter>,
    base: DVector<f64>,
    whole: Simulation<'a>,
    of_one_surface: Vec<Simulation<'a>>,
}

impl SimulatedEffect<'_> {
    /// Whether the effect is found in at least this share of recordings if this parameter has this coordinate.
    pub(crate) fn is_found_in(&self, share: f64, parameter: usize, coordinate: f64) -> bool {
        let is_simulated =
            |column: &FittedParameter| column.effect == self.effect && column.parameter == parameter;
        let delta = DVector::from_iterator(
            self.columns.len(),
            self.columns.iter().map(|column| if is_simulated(column) { coordinate } else { 0.0 }),
        );
        let most_missed = ((1.0 - share) * DRAWS as f64).round() as usize;
        let missed = (0..DRAWS).filter(|&draw| !self.is_found(&delta, draw));
        missed.take(most_missed + 1).count() <= most_missed
    }

    /// Whether the effect is supported by a simulated recording.
    fn is_found(&self, delta: &DVector<f64>, draw: u64) -> bool {
        let of_one_surface = self.of_one_surface.iter().map(|surface| surface.drawn(delta, draw, Vec::new()));
        let system = self.whole.drawn(delta, draw, of_one_surface.collect());
        let evidence = Evidence::new(&system, self.base.clone());
        let tests = EffectTests::new(EffectFits { evidence, columns: &self.columns });
        let test = tests.test(self.effect, &self.others, self.tested);
        test.as_ref().is_some_and(EffectTest::is_supported)
    }
}

/// Equations of some columns alone, with the errors of their scores.
struct Simulation<'a> {
    frames: Vec<ProjectedEquations>,
    cells: Vec<ProjectedEquations>,
    /// Residual scores of frames and of cells.
    errors: [Vec<DVector<f64>>; 2],
    views: &'a [ViewIndex],
    /// Scatter of the sum of all scores by the priors of nuisance parameters and by that of reflectance.
    scatter: [DMatrix<f64>; 2],
    /// Root of both together.
    root: DMatrix<f64>,
}

impl<'a> Simulation<'a> {
    /// Prepares the simulation of these columns. None if the fit is singular.
    fn new(
        recording: &ReducedRecording,
        chosen: &[ColumnIndex],
        base: &DVector<f64>,
        views: &'a [ViewIndex],
    ) -> Option<Self> {
        // What the nuisance parameters' priors tell is divided among the parts, as if each had told a share of it.
        let priors = &recording.priors;
        let part = |parts: &[ProjectedEquations]| -> Vec<ProjectedEquations> {
            let share = 1.0 / parts.len().max(1) as f64;
            parts.iter().map(|part| part.with_share_of(priors, share, chosen)).collect()
        };
        let (frames, cells) = (part(&recording.frames), part(&recording.cells));
        let size = chosen.len();
        let equations = frames.iter().map(|frame| NormalEquations::of_all(frame.a.clone(), frame.g.clone()));
        let system = LinearSystem::of_equations(size, equations.collect(), Vec::new(), views);
        let fit = Evidence::new(&system, base.clone()).fit(&ColumnIndex::first(size).collect::<Vec<_>>())?;
        let scores = |parts: &[ProjectedEquations]| parts.iter().map(|part| part.score(&fit)).collect();
        let of_chosen =
            |scatter: &DMatrix<f64>| DMatrix::from_fn(size, size, |i, j| scatter[(chosen[i].0, chosen[j].0)]);
        let scatter = recording.prior_scatter.each_ref().map(of_chosen);
        let both = &scatter[0] + &scatter[1];
        // A sum of squares is positive semidefinite: a little on the diagonal makes it definite.
        let ridge = 1e-12 * both.trace().max(f64::MIN_POSITIVE);
        let root = (both + DMatrix::identity(size, size) * ridge).cholesky()?.unpack();
        Some(Self { errors: [scores(&frames), scores(&cells)], frames, cells, views, scatter, root })
    }

    /// Simulates a recording in which the columns are changed by `delta`, with these systems of one surface.
    fn drawn(&self, delta: &DVector<f64>, draw: u64, of_one_surface: Vec<LinearSystem>) -> LinearSystem {
        let mut signs = Signs(draw);
        let size = delta.len();
        // What the nuisance parameters are off by is the same in all parts.
        let off_by = &self.root * DVector::from_fn(size, |_, _| signs.normal());
        let shared = |parts: usize| &off_by / parts.max(1) as f64;
        let changed = |equations: &ProjectedEquations, error: DVector<f64>| {
            NormalEquations::of_all(equations.a.clone(), &equations.a * delta + error)
        };
        let [of_frames, of_cells] = &self.errors;
        let (mut block, mut sign) = (None, 1.0);
        let mut frames = Vec::with_capacity(of_frames.len());
        for ((equations, error), view) in self.frames.iter().zip(of_frames).zip(self.views) {
            if block.replace(view.0 / (LAG + 1)) != Some(view.0 / (LAG + 1)) {
                sign = signs.next();
            }
            frames.push(changed(equations, error * sign + shared(of_frames.len())));
        }
        let of_cell = |(equations, error): (&ProjectedEquations, &DVector<f64>)| {
            let sign = signs.next();
            changed(equations, error * sign + shared(of_cells.len()))
        };
        let cells = self.cells.iter().zip(of_cells).map(of_cell).collect();
        let prior_scatter = Some(self.scatter.clone());
        let system = LinearSystem::of_equations(size, frames, cells, self.views);
        LinearSystem { prior_scatter, of_one_surface, ..system }
    }
}

/// Random signs of one draw: the bits of SplitMix64 (Steele, Lea and Flood 2014).
struct Signs(u64);

impl Signs {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        if (bits ^ (bits >> 31)) & 1 == 0 { 1.0 } else { -1.0 }
    }

    /// Returns a sum of signs, which is nearly a normal number.
    fn normal(&mut self) -> f64 {
        const SIGNS: u32 = 12;
        (0..SIGNS).map(|_| self.next()).sum::<f64>() / f64::from(SIGNS).sqrt()
    }
}
