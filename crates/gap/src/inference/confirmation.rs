//! Confirmation of named effects on held-out frames: an effect is kept only where these frames are explained better with it
//! than without it.
//!
//! This is the one decision that held-out frames take part in. They stay unseen by fits and by p-values.

use nalgebra::DVector;
use reality_sim_sensor::{EffectIndex, Model};

use crate::{
    inference::held_out::{Comparison, refitted},
    inference::linearized_recording::LinearizedRecording,
    inference::model_search::{ConvergedSet, ModelSearch},
    linear_model::linearization::MeasureError,
    linear_model::linearized_frame::LinearizedFrame,
    linear_model::normal_equations::PRIOR,
    linear_model::robust_weights::INDEPENDENT,
    linear_model::system::LinearSystem,
    measurement::quantity::Channel,
    thresholds::{InferenceThresholds, Thresholds},
};

const THRESHOLDS: InferenceThresholds = Thresholds::DEFAULT.inference;

/// Returns a model without one effect.
pub(crate) fn without(model: &Model, effect: EffectIndex) -> Model {
    let id = effect.effect().id();
    let mut model = model.clone();
    model.effects.retain(|used| used.effect.id() != id);
    model
}

impl ModelSearch<'_> {
    /// Drops named effects one after the other, with all others fitted anew, until held-out frames confirm the rest.
    /// `before` is the model as it was given.
    pub(crate) fn confirmed(
        &self,
        before: &Model,
        (mut named, mut linearized): ConvergedSet,
    ) -> Result<ConvergedSet, MeasureError> {
        while let Some(dropped) = self.unconfirmed(before, &linearized, &named)? {
            named.retain(|effect| *effect != dropped);
            linearized = self.converge(linearized, &self.all(&named))?;
        }
        Ok((named, linearized))
    }

    /// Returns the named effect that held-out frames confirm least, if they do not confirm all: one without which they are
    /// more likely, or, if the gap did not shrink, the one to which this is mostly due.
    fn unconfirmed(
        &self,
        before: &Model,
        linearized: &LinearizedRecording,
        named: &[EffectIndex],
    ) -> Result<Option<EffectIndex>, MeasureError> {
        if named.is_empty() {
            return Ok(None);
        }
        let mut checks = Vec::with_capacity(named.len());
        for &effect in named {
            let comparison = self.source.compare(&without(&linearized.model, effect), linearized)?;
            let claimed = comparison.claimed();
            let gain = self.held_out_gain(linearized, named, effect, &claimed);
            checks.push(Check { effect, comparison, claimed, gain });
        }
        let likelier_without = checks.iter().filter(|check| check.gain <= 0.0);
        if let Some(check) = likelier_without.min_by(|a, b| a.gain.total_cmp(&b.gain)) {
            return Ok(Some(check.effect));
        }
        let whole = self.source.compare(before, linearized)?;
        let all: Vec<Channel> = whole.gaps().into_keys().collect();
        let mut claims: Vec<Channel> =
            checks.iter().flat_map(|check| check.claimed.iter().copied()).collect();
        claims.sort_unstable();
        claims.dedup();
        let shrank = |channels: &[Channel]| {
            let [before, after] = whole.whole(channels);
            after < before
        };
        if shrank(&claims) && shrank(&all) {
            return Ok(None);
        }
        let growth = |check: &Check| {
            let [without, with] = check.comparison.whole(&check.claimed);
            with / without.max(1e-9)
        };
        let most = checks.iter().max_by(|a, b| growth(a).total_cmp(&growth(b)));
        Ok(most.map(|check| check.effect))
    }

    /// Returns by how much the likelihood of held-out frames is larger with an effect than without it, natural logarithm. Both
    /// times all else is fitted to the training frames, and nominal values that it takes out of their tolerance count against it;
    /// outliers count at most as such.
    fn held_out_gain(
        &self,
        linearized: &LinearizedRecording,
        named: &[EffectIndex],
        effect: EffectIndex,
        claimed: &[Channel],
    ) -> f64 {
        let fits = linearized.effect_fits(self.columns);
        let all = self.all(named);
        let without: Vec<EffectIndex> = all.iter().copied().filter(|other| *other != effect).collect();
        let likelihood = |effects: &[EffectIndex]| {
            let delta = fits.fit_in_range(effects)?.delta;
            let of_frame =
                |frame| log_likelihood(&linearized.frames[frame], &linearized.system, &delta, claimed);
            // Nominal values that would have to be far off make a fit less plausible, which no frame shows.
            let nuisances = delta.rows_range(self.columns.len()..).norm_squared();
            Some(self.split.held_out().map(of_frame).sum::<f64>() - 0.5 * PRIOR * nuisances)
        };
        // A fit that is singular says nothing against the effect.
        likelihood(&all).zip(likelihood(&without)).map_or(f64::INFINITY, |(with, without)| with - without)
    }
}

/// What held-out frames say of a named effect.
struct Check {
    effect: EffectIndex,
    /// Comparison of the model without the effect with that with it.
    comparison: Comparison,
    /// Channels that the effect claims to change.
    claimed: Vec<Channel>,
    /// Gain in log-likelihood with the effect.
    gain: f64,
}

/// Returns the log-likelihood of a frame's measurements in some channels after a change of the columns, with the pose refitted
/// within its errors, up to a constant. Residuals are cut off where they count as outliers.
fn log_likelihood(
    frame: &LinearizedFrame,
    system: &LinearSystem,
    delta: &DVector<f64>,
    channels: &[Channel],
) -> f64 {
    let fitted = refitted(frame, system, delta);
    let rows = frame.measurements.iter().zip(&fitted.residuals);
    let most = THRESHOLDS.outlying_sigmas * THRESHOLDS.outlying_sigmas;
    let squares = rows.filter_map(|(measurement, residual)| {
        let sigma = system.sigmas.get(&measurement.quantity)?;
        let counts = channels.contains(&measurement.quantity.channel()) && residual.is_finite();
        let independent = if measurement.quantity.is_proprioceptive() { 1.0 } else { INDEPENDENT };
        let variance = sigma * sigma + measurement.sigma * measurement.sigma;
        counts.then(|| independent * (residual * residual / variance).min(most))
    });
    let of_pose =
        if channels.contains(&Channel::Geometry) { fitted.pose_penalty(&system.pose_sigmas) } else { 0.0 };
    -0.5 * (squares.sum::<f64>() + of_pose)
}
