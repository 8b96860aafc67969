//! Tunable parameters of the search, each with its default and the reason for it.

use super::grid::SearchGrid;
use crate::{filter::PlanarSigma, setters::setters};

/// Settings of the search of the field.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SearchConfig {
    /// Grid of poses that is scored first; `None`, the default, makes it as fine as the field needs, see
    /// [`SearchGrid::new`].
    pub grid: Option<SearchGrid>,
    /// Number of grid poses kept for refinement, 60: the grid's score is coarse, and the right pose is often not the
    /// best.
    pub kept_poses: usize,
    /// Number of scored grid poses that are compared with each other per pose kept, 400: most lie beside a better one, and
    /// only then it is asked which of the picture's lines they explain.
    pub compared_per_kept: usize,
    /// Maximum number of headings kept per place, 4: lines look alike in several headings, and these must not crowd out
    /// other places.
    pub kept_headings: usize,
    /// Number of places of the grid scored in one go, 1024: a fine grid has millions of poses.
    pub places_at_once: usize,
    /// Particles that refine each grid pose, 60 within 0.08 m and 0.04 rad: the grid's steps are 0.1 m and 0.05 rad.
    pub near: SearchParticles,
    /// Particles that search farther around the best places: a place where some of the lines fit may be next to the one
    /// where all do. 400 within 0.3 m and 0.06 rad.
    pub far: SearchParticles,
    /// Number of places around which the search goes farther, 8: each takes as long as half a filter's update.
    pub far_places: usize,
    /// Number of iterations of both, 6: the start is farther off than in tracking.
    pub iterations: u32,
    /// Number of places that are fitted with sub-pixel accuracy before they are ranked, 24: more than look alike on any
    /// field.
    pub fitted_places: usize,
    /// Log-weight that a fit may lose, 4: the particle from which it starts was chosen to maximise the log-weight.
    pub fit_margin: f64,
    /// Log-weight that a pose loses if no white line in the picture is a line of the field, seen from there, 20: as much as a prior
    /// that is wrong can cost. In 143 real pictures, on which it was chosen, a search without a prior ranks the right place first
    /// in 130; without it, and with 40 poses compared for each one kept, in 122.
    pub unexplained_weight: f64,
    /// Poses nearer to a better one than this are the same place, 0.35 m and 0.25 rad: more than the spread of
    /// [`SearchConfig::far`], so that no place is found twice.
    pub same_place: PlanarSigma,
}

setters!(SearchConfig {
    with_grid: grid = Option<SearchGrid>,
    with_kept_poses: kept_poses = usize,
    with_compared_per_kept: compared_per_kept = usize,
    with_kept_headings: kept_headings = usize,
    with_places_at_once: places_at_once = usize,
    with_near: near = SearchParticles,
    with_far: far = SearchParticles,
    with_far_places: far_places = usize,
    with_iterations: iterations = u32,
    with_fitted_places: fitted_places = usize,
    with_fit_margin: fit_margin = f64,
    with_unexplained_weight: unexplained_weight = f64,
    with_same_place: same_place = PlanarSigma,
});

impl Default for SearchConfig {
    fn default() -> Self {
        let sigma = |position_m, yaw_rad| PlanarSigma { position_m, yaw_rad };
        Self {
            grid: None,
            kept_poses: 60,
            compared_per_kept: 400,
            kept_headings: 4,
            places_at_once: 1024,
            near: SearchParticles { particles: 60, sigma: sigma(0.08, 0.04) },
            far: SearchParticles { particles: 400, sigma: sigma(0.3, 0.06) },
            far_places: 8,
            iterations: 6,
            fitted_places: 24,
            fit_margin: 4.0,
            unexplained_weight: 20.0,
            same_place: sigma(0.35, 0.25),
        }
    }
}

/// A small particle filter around a place, without motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchParticles {
    /// Number of particles.
    pub particles: usize,
    /// Spread of the particles around the place.
    pub sigma: PlanarSigma,
}
