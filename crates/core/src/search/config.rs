//! Every number of the search that can be tuned, with its default and the reason for it.

use crate::filter::PlanarSigma;

/// How the field is searched.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SearchConfig {
    /// Grid poses kept for refinement, 60: the grid's score is coarse, and the right pose is often not its best.
    pub kept_poses: usize,
    /// Headings of one place that can be among them, 4: lines look alike in several, and other places must not be crowded out.
    pub kept_headings: usize,
    /// Places of the grid scored in one go, 1024: a fine grid has millions of poses.
    pub places_at_once: usize,
    /// Refines each grid pose.
    pub near: SearchParticles,
    /// Looks farther around the best of them: a place where some of the lines fit may be next to the one where all do.
    pub far: SearchParticles,
    /// Places that are looked around farther, 8.
    pub far_places: usize,
    /// Iterations of both, 6: the start is farther off than while tracking.
    pub iterations: u32,
    /// Places that are fitted to a fraction of a pixel before they are ranked, 24.
    pub fitted_places: usize,
    /// A fit may lose this much log-weight, 4: the particle that it starts from was chosen to maximise it.
    pub fit_margin: f64,
    /// Poses nearer than this to a better one belong to it, 0.35 m and 0.25 rad: farther than
    /// [`SearchConfig::far`] spreads its particles, so that one place is not found twice.
    pub same_place: PlanarSigma,
}

impl Default for SearchConfig {
    fn default() -> Self {
        let sigma = |position_m, yaw_rad| PlanarSigma { position_m, yaw_rad };
        Self {
            kept_poses: 60,
            kept_headings: 4,
            places_at_once: 1024,
            near: SearchParticles { particles: 60, sigma: sigma(0.08, 0.04) },
            far: SearchParticles { particles: 400, sigma: sigma(0.3, 0.06) },
            far_places: 8,
            iterations: 6,
            fitted_places: 24,
            fit_margin: 4.0,
            same_place: sigma(0.35, 0.25),
        }
    }
}

/// A small particle filter around a place, standing still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchParticles {
    /// Number of particles.
    pub particles: usize,
    /// How far they are spread.
    pub sigma: PlanarSigma,
}
