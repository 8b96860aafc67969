//! Objects in front of the carpet that the model does not have.

use crate::{
    diagnostics::{
        carpet,
        detector::{Detector, FitResiduals, FrameResiduals},
        finding::Finding,
    },
    thresholds::Thresholds,
};

/// Smallest share of the carpet that is reported as hidden.
const LEAST_SHARE: f64 = Thresholds::DEFAULT.diagnostics.least_hidden_share;

/// Detector of objects that hide the carpet.
pub(crate) struct Occluders;

impl Detector for Occluders {
    fn detect(&self, fit: &FitResiduals<'_>) -> Vec<Finding> {
        Vec::from_iter(occluders(&fit.frames, carpet::sigma(fit.sigmas)))
    }
}

/// Returns the share of the carpet that is hidden, if it is large enough. `sigma` is the standard deviation of a block's
/// residual.
fn occluders(frames: &[FrameResiduals<'_>], sigma: f64) -> Option<Finding> {
    let shares: Vec<f64> = frames.iter().filter_map(|frame| hidden_share(frame, sigma)).collect();
    let share = shares.iter().sum::<f64>() / shares.len() as f64;
    (share > LEAST_SHARE).then_some(Finding::Occluders { share })
}

/// Returns the share of a frame's carpet that is hidden. None if the frame shows no carpet.
fn hidden_share(frame: &FrameResiduals<'_>, sigma: f64) -> Option<f64> {
    let (hidden, all) = carpet::blocks(frame).fold((0, 0), |(hidden, all), (_, residual)| {
        (hidden + usize::from(carpet::is_hidden(residual, sigma)), all + 1)
    });
    (all > 0).then(|| hidden as f64 / all as f64)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::diagnostics::carpet::pictures::{SIGMA, with_pictures};

    #[test]
    fn occluders_are_reported_with_the_share_of_the_carpet_that_they_hide() {
        let covered = |part: f64| move |_: u32, place: DVec2| if place.x < part { -1.0 } else { 0.0 };
        let find = |frames: &[FrameResiduals<'_>]| occluders(frames, SIGMA);
        let Some(Finding::Occluders { share }) = with_pictures(covered(0.1), find) else { panic!() };
        assert!((share - 0.1).abs() < 0.03, "{share}");
        assert_eq!(with_pictures(covered(0.02), find), None);
    }

    #[test]
    fn without_carpet_in_view_nothing_is_reported() {
        assert_eq!(occluders(&[], SIGMA), None);
    }
}
