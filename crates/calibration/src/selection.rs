//! Choice of how many terms the lens needs, by cross-validation: every choice is fitted to some of the pictures, and the others
//! tell how well it predicts. More terms always fit better, and beyond what the recording supports they predict worse.

use rayon::prelude::*;

use crate::{
    adjust::{Adjusted, Adjustment, Prior, View},
    noise::Noise,
    parameter::{Parameter, distortion_choices},
    picture::Lines,
    state::State,
};

/// Number of parts into which the pictures are divided; each is predicted from all others.
const FOLDS: usize = 5;

/// Length of the runs of pictures that stay in one part: neighbours are alike, and must not predict each other.
const RUN: usize = 4;

/// Search ranges of a fit that starts from another choice's, pixels.
const SEARCH_PX: [f64; 4] = [8.0, 6.0, 4.0, 4.0];

/// Search ranges of a fit of one pose, pixels.
const POSE_SEARCH_PX: [f64; 3] = [6.0, 4.0, 4.0];

/// Residual that counts as much as any larger one, in standard deviations of the noise: lines that are not the field's do not
/// decide.
const LARGEST: f64 = 5.0;

/// Range of a lens that was calibrated before, if not exactly, as a multiple of that of an unknown one.
pub(crate) const GIVEN_LENS: f64 = 0.1;

/// What is common to all fits.
pub(crate) struct Recorded<'a> {
    pub lines: &'a Lines,
    pub views: Vec<View<'a>>,
    pub noise: Noise,
    /// Multiple of the usual prior of the lens.
    pub lens_prior: f64,
}

/// How well a choice of parameters predicts.
#[derive(Debug, Clone)]
pub struct Choice {
    /// Parameters that are fitted.
    pub parameters: Vec<Parameter>,
    /// Root mean square of the distances between projected and measured lines in pictures that were not used for the fit of
    /// the lens, pixels. Distances beyond five standard deviations of the noise count as five.
    pub held_out_px: f64,
    /// Squared distances of each picture, in the mean.
    losses: Vec<Option<f64>>,
}

/// Returns the choices of parameters with square pixels, from the fewest to the most terms of distortion.
fn choices(state: &State) -> Vec<Vec<Parameter>> {
    let common = [
        Parameter::FocalLength,
        Parameter::PrincipalX,
        Parameter::PrincipalY,
        Parameter::Height,
        Parameter::MountPitch,
        Parameter::MountRoll,
    ];
    let with = |terms: &&[usize]| {
        let mut parameters = common.to_vec();
        parameters.extend(terms.iter().map(|&term| Parameter::Distortion(term)));
        parameters
    };
    distortion_choices(&state.camera.distortion).iter().map(with).collect()
}

/// Returns the choice with square pixels and two terms of distortion, or as many as there are.
pub(crate) fn usual(state: &State) -> Vec<Parameter> {
    let is_simple = |choice: &Vec<Parameter>| !choice.contains(&Parameter::Distortion(2));
    choices(state).into_iter().rfind(is_simple).unwrap_or_default()
}

/// Compares the choices, starting from a state that fits: first the numbers of terms with square pixels, then whether the best of
/// these needs pixels that are not square. Returns what was compared, and the place of the best; `None` if nothing can be fitted.
pub(crate) fn compare(recorded: &Recorded<'_>, state: &State) -> Option<(Vec<Choice>, usize)> {
    let mut compared: Vec<Choice> =
        choices(state).into_par_iter().map(|parameters| recorded.evaluated(state, parameters)).collect();
    let mut parameters = compared[best(&compared)?].parameters.clone();
    parameters.push(Parameter::AspectRatio);
    compared.push(recorded.evaluated(state, parameters));
    let best = best(&compared)?;
    Some((compared, best))
}

/// Returns the place of the choice with the fewest parameters that predicts as well as the best, to within one standard error
/// of their difference (Breiman et al., "Classification and Regression Trees", 1984, section 3.4.3).
fn best(choices: &[Choice]) -> Option<usize> {
    let best = choices.iter().min_by(|a, b| a.held_out_px.total_cmp(&b.held_out_px))?;
    choices.iter().position(|choice| {
        let (excess, error) = choice.excess_over(best);
        excess <= error
    })
}

impl Choice {
    /// Returns by how much the loss is larger than another's, over the pictures that both predict, and the standard error of
    /// that.
    fn excess_over(&self, other: &Self) -> (f64, f64) {
        let both = self.losses.iter().zip(&other.losses);
        let excess: Vec<f64> = both.filter_map(|(own, other)| Some((*own)? - (*other)?)).collect();
        let count = excess.len() as f64;
        if excess.len() < 2 {
            return (0.0, 0.0);
        }
        let mean = excess.iter().sum::<f64>() / count;
        let variance = excess.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
        (mean, (variance / count).sqrt())
    }
}

impl Recorded<'_> {
    /// Adjusts the parameters and the poses of some pictures.
    pub fn adjusted(
        &self,
        state: &State,
        parameters: &[Parameter],
        views: &[View<'_>],
        search_px: &[f64],
    ) -> Option<Adjusted> {
        let prior = Prior::around(state, parameters).scaled(parameters, self.lens_prior);
        let adjustment = Adjustment { lines: self.lines, parameters, prior, noise: self.noise };
        adjustment.run(state, views, search_px)
    }

    /// Takes over poses and noise of an adjustment to all pictures.
    pub fn take_over(&mut self, adjusted: &Adjusted) {
        let poses = self.views.iter().zip(&adjusted.poses).map(|(view, &pose)| View { pose, ..*view });
        self.views = poses.collect();
        self.noise = adjusted.noise;
    }

    fn evaluated(&self, state: &State, parameters: Vec<Parameter>) -> Choice {
        let mut losses = vec![None; self.views.len()];
        for fold in 0..FOLDS {
            let is_held_out = |index: usize| (index / RUN) % FOLDS == fold;
            let training: Vec<View<'_>> =
                (0..self.views.len()).filter(|&i| !is_held_out(i)).map(|i| self.views[i]).collect();
            let start = without_others(state, &parameters);
            let fitted = start.and_then(|start| self.adjusted(&start, &parameters, &training, &SEARCH_PX));
            let Some(fitted) = fitted else { continue };
            for index in (0..self.views.len()).filter(|&index| is_held_out(index)) {
                losses[index] = self.loss(&fitted, self.views[index]);
            }
        }
        let known: Vec<f64> = losses.iter().flatten().copied().collect();
        let held_out_px = match known.is_empty() {
            true => f64::INFINITY,
            false => (known.iter().sum::<f64>() / known.len() as f64).sqrt(),
        };
        Choice { parameters, held_out_px, losses }
    }

    /// Returns the mean squared distance of the lines in a picture whose pose, but not the lens, is fitted to it.
    fn loss(&self, fitted: &Adjusted, view: View<'_>) -> Option<f64> {
        let prior = Prior::around(&fitted.state, &[]);
        let alone = Adjustment { lines: self.lines, parameters: &[], prior, noise: fitted.noise };
        let posed = alone.run(&fitted.state, &[view], &POSE_SEARCH_PX)?;
        if !posed.used[0] {
            return None;
        }
        let measured = self.lines.measure(view.picture, (&fitted.state, posed.poses[0]), &[], 6.0);
        let largest_px = LARGEST * self.noise.offset_px;
        let squares = measured.rows.iter().map(|row| row.offset_px.powi(2).min(largest_px * largest_px));
        (!measured.rows.is_empty()).then(|| squares.sum::<f64>() / measured.rows.len() as f64)
    }
}

/// Returns the state with the lens's terms that are not fitted at their neutral values.
pub(crate) fn without_others(state: &State, parameters: &[Parameter]) -> Option<State> {
    let terms = (0..state.camera.distortion.parameters().len()).map(Parameter::Distortion);
    let neutral = terms.map(|term| (term, 0.0)).chain([(Parameter::AspectRatio, 1.0)]);
    let others: Vec<(Parameter, f64)> =
        neutral.filter(|(parameter, _)| !parameters.contains(parameter)).collect();
    let names: Vec<Parameter> = others.iter().map(|(parameter, _)| *parameter).collect();
    let steps = others.iter().map(|(parameter, neutral)| neutral - state.value(*parameter));
    state.stepped(&names, &nalgebra::DVector::from_iterator(others.len(), steps)).ok()
}
