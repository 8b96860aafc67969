//! Recordings in which an effect has a certain size, simulated in the linearised model, and how often the effect is found.
//!
//! The simulated scores are those that the size makes, with errors as the recording shows them: the residual scores of the fit
//! with random signs, which neighbouring views share (wild bootstrap, Wu 1986; for dependent data Shao 2010), together with what
//! the nuisance parameters' priors allow. The nuisance parameters are eliminated beforehand, so that a simulation is small.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use reality_sim_sensor::EffectIndex;

use crate::{
    frame_index::ViewIndex,
    inference::{
        cluster_covariance::LAG,
        effect_fit::EffectFits,
        effect_test::{EffectTest, EffectTests},
        evidence::Evidence,
    },
    linear_model::{
        column::ColumnIndex, normal_equations::NormalEquations, parameters::FittedParameter,
        system::LinearSystem,
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
    /// Equations without nuisance parameters.
    reduced: LinearSystem,
    /// Equations of the nuisance parameters' priors.
    priors: NormalEquations,
}

impl<'a> PowerAnalysis<'a> {
    /// Prepares the simulation of recordings like that of `fits`; `views` are those of its training frames.
    pub(crate) fn new(fits: &'a EffectFits<'a>, views: Vec<ViewIndex>) -> Self {
        Self { fits, views, reduced: fits.evidence.reduced_system(), priors: fits.evidence.nuisance_priors() }
    }

    /// Prepares the simulation of an effect beside those of the model. None if the fit is singular.
    pub(crate) fn of(&self, effect: EffectIndex, model: &[EffectIndex]) -> Option<SimulatedEffect<'_>> {
        let others: Vec<EffectIndex> = model.iter().copied().filter(|other| *other != effect).collect();
        let with: Vec<EffectIndex> = others.iter().copied().chain([effect]).collect();
        let chosen = self.fits.columns_of(&with);
        let reduced = &self.reduced;
        // What the nuisance parameters' priors tell is divided among the parts, as if each had told a share of it.
        let part = |parts: &[NormalEquations]| -> Vec<NormalEquations> {
            let share = self.priors.scaled(1.0 / parts.len().max(1) as f64);
            parts
                .iter()
                .map(|part| NormalEquations::sum([part, &share].into_iter()).of_columns(&chosen))
                .collect()
        };
        let system = LinearSystem {
            size: chosen.len(),
            frames: part(&reduced.frames),
            views: part(&reduced.views),
            cells: part(&reduced.cells),
            sigmas: BTreeMap::new(),
            pose_sigmas: reduced.pose_sigmas,
            weights: Vec::new(),
        };
        let base = DVector::from_iterator(
            chosen.len(),
            chosen.iter().map(|column| self.fits.evidence.base[column.0]),
        );
        let all: Vec<ColumnIndex> = ColumnIndex::first(chosen.len()).collect();
        let delta = Evidence::new(&system, base.clone()).fit(&all)?.delta;
        let scores = |parts: &[NormalEquations]| -> Vec<DVector<f64>> {
            parts.iter().map(|part| part.score(&delta)).collect()
        };
        let nuisances = self.fits.evidence.nuisance_scatter(&chosen);
        let size = chosen.len();
        // A sum of squares is positive semidefinite: a little on the diagonal makes it definite.
        let ridge = 1e-12 * nuisances.trace().max(f64::MIN_POSITIVE);
        let root = (nuisances + DMatrix::identity(size, size) * ridge).cholesky()?.unpack();
        Some(SimulatedEffect {
            columns: chosen.iter().map(|column| self.fits.columns[column.0]).collect(),
            errors: [scores(&system.frames), scores(&system.cells)],
            views: &self.views,
            tested: self.fits.effects().len(),
            effect,
            others,
            system,
            base,
            root,
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
    system: LinearSystem,
    /// Residual scores of frames and of cells.
    errors: [Vec<DVector<f64>>; 2],
    views: &'a [ViewIndex],
    /// Root of the scatter of scores by the nuisance parameters' priors.
    root: DMatrix<f64>,
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
        let missed = (0..DRAWS).filter(|&draw| !self.is_found(&self.drawn(&delta, draw)));
        missed.take(most_missed + 1).count() <= most_missed
    }

    /// Whether the effect is supported by a simulated recording.
    fn is_found(&self, system: &LinearSystem) -> bool {
        let evidence = Evidence::new(system, self.base.clone());
        let tests = EffectTests::new(EffectFits { evidence, columns: &self.columns });
        let test = tests.test(self.effect, &self.others, self.tested);
        test.as_ref().is_some_and(EffectTest::is_supported)
    }

    /// Simulates a recording in which the columns are changed by `delta`.
    fn drawn(&self, delta: &DVector<f64>, draw: u64) -> LinearSystem {
        let mut signs = Signs(draw);
        let size = self.columns.len();
        // The priors' scatter is divided among the parts, each with a share of its own.
        let shared = |signs: &mut Signs, parts: usize| {
            let unit = DVector::from_fn(size, |_, _| signs.next());
            &self.root * unit / (parts.max(1) as f64).sqrt()
        };
        let [of_frames, of_cells] = &self.errors;
        let (mut block, mut sign) = (None, 1.0);
        let mut frames = Vec::with_capacity(of_frames.len());
        for ((equations, error), view) in self.system.frames.iter().zip(of_frames).zip(self.views) {
            if block.replace(view.0 / (LAG + 1)) != Some(view.0 / (LAG + 1)) {
                sign = signs.next();
            }
            let error = error * sign + shared(&mut signs, of_frames.len());
            frames.push(equations.with_score(delta, &error));
        }
        let views = self.views.chunk_by(|one, next| one == next);
        let mut rest = frames.as_slice();
        let views = views.map(|view| {
            let (own, others) = rest.split_at(view.len());
            rest = others;
            NormalEquations::sum(own.iter())
        });
        let views = views.collect();
        let of_cell = |(equations, error): (&NormalEquations, &DVector<f64>)| {
            let sign = signs.next();
            equations.with_score(delta, &(error * sign + shared(&mut signs, of_cells.len())))
        };
        let cells = self.system.cells.iter().zip(of_cells).map(of_cell).collect();
        LinearSystem {
            size,
            frames,
            views,
            cells,
            sigmas: BTreeMap::new(),
            pose_sigmas: self.system.pose_sigmas,
            weights: Vec::new(),
        }
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
}
