//! Everything shown of one picture after the filter has processed it. The filter's thread makes it, so that the window only
//! draws.

use std::sync::Arc;

use eframe::egui::ColorImage;
use glam::DVec2;
use reality_sim_core::{
    field::{project_lines, project_polygon},
    filter::{FilterEstimate, best_index, normalise},
    localization::LocalizedFrame,
    mount::MountPose,
    observation::CpuScorer,
    pose::{CameraPose, Pose2, wrap_angle},
    preprocess::{Prepared, distance_field, gaussian_blur},
    sequence::Sequence,
};

use super::settings::Veil;
use crate::picture_view::{color_image, gray_image};

/// Largest number of particles shown: more cannot be distinguished.
const SHOWN_PARTICLES: usize = 2000;

/// A curve's values for one picture, and the data for its paths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record {
    pub index: usize,
    pub pose: CameraPose,
    /// Horizontal distance from the ground truth, if it is known.
    pub error_m: Option<f64>,
    pub error_yaw_rad: Option<f64>,
    pub effective_sample_size: f64,
    pub spread_m: f64,
    pub particles: usize,
    pub milliseconds: f64,
    pub sure: bool,
    pub searched: bool,
}

impl Record {
    pub fn new(index: usize, tagged: &LocalizedFrame, truth: Option<CameraPose>) -> Self {
        Self {
            milliseconds: 1000.0 * tagged.seconds,
            sure: tagged.sure,
            searched: tagged.searched,
            ..Self::of_filter(index, tagged.pose, &tagged.filter, truth)
        }
    }

    /// Makes the record of a filter alone, which is never sure.
    pub fn of_filter(
        index: usize,
        pose: CameraPose,
        filter: &FilterEstimate,
        truth: Option<CameraPose>,
    ) -> Self {
        let offset_m = |truth: CameraPose| (pose.x_m - truth.x_m).hypot(pose.y_m - truth.y_m);
        Self {
            index,
            pose,
            error_m: truth.map(offset_m),
            error_yaw_rad: truth.map(|truth| wrap_angle(pose.yaw_rad - truth.yaw_rad).abs()),
            effective_sample_size: filter.effective_sample_size,
            spread_m: filter.spread_m,
            particles: filter.particles,
            milliseconds: 0.0,
            sure: false,
            searched: false,
        }
    }
}

/// Particle to be drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedParticle {
    pub pose: Pose2,
    /// Weight relative to the best particle's.
    pub relative_weight: f32,
}

/// Step of the gathering with which the demonstration begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GatheringStep {
    /// Updates so far; at 0 the particles are spread over the field.
    pub number: u32,
    /// Updates in all.
    pub of: u32,
}

impl GatheringStep {
    /// Whether the particles are only spread: none weighs more than another, and there is no pose yet.
    pub fn is_spread(self) -> bool {
        self.number == 0
    }
}

/// Everything shown of one picture.
pub struct FrameView {
    pub record: Record,
    /// `None` while the recording is followed.
    pub gathering: Option<GatheringStep>,
    pub picture: Arc<ColorImage>,
    pub veil: Option<Arc<ColorImage>>,
    pub particles: Vec<WeightedParticle>,
    pub best_particle: CameraPose,
    pub truth: Option<CameraPose>,
    /// Polylines in pixels: both edges of the lines at the estimated pose and at the best particle, the centre lines at the
    /// true pose.
    pub pose_lines: Vec<Vec<DVec2>>,
    pub best_lines: Vec<Vec<DVec2>>,
    pub truth_lines: Vec<Vec<DVec2>>,
    /// Detected border of the field.
    pub border: Vec<Vec<DVec2>>,
}

impl FrameView {
    /// Whether a pose has been found, however doubtful.
    pub fn has_pose(&self) -> bool {
        !self.gathering.is_some_and(GatheringStep::is_spread)
    }
}

/// Pose and particles found in a picture.
pub struct Found {
    pub record: Record,
    pub best_particle: CameraPose,
    pub particles: Vec<CameraPose>,
    /// `None` while the recording is followed.
    pub gathering: Option<GatheringStep>,
}

impl Found {
    fn is_spread(&self) -> bool {
        self.gathering.is_some_and(GatheringStep::is_spread)
    }
}

/// Picture and what was found in it, with the data for drawing them.
pub struct Seen {
    prepared: Prepared,
    mount: MountPose,
    /// Converted once: only the veil and what was found change while the picture stays.
    picture: Arc<ColorImage>,
    pub found: Found,
}

impl Seen {
    pub fn new(prepared: Prepared, mount: MountPose, found: Found) -> Self {
        let picture = color_image(&prepared.picture);
        Self { prepared, mount, picture, found }
    }

    /// Prepares everything shown of the picture.
    pub fn view(
        &self,
        sequence: &Sequence,
        scorer: &mut CpuScorer,
        blur_sigma_px: f32,
        veil: Veil,
    ) -> FrameView {
        let (camera, field) = (&sequence.setup.camera, &sequence.field);
        let half_width_m = 0.5 * field.line_width_m;
        let lines = |pose, sideways_m| project_lines(camera, field, pose, sideways_m);
        let has_pose = !self.found.is_spread();
        let edges = |pose| match has_pose {
            true => [lines(pose, -half_width_m), lines(pose, half_width_m)].concat(),
            false => Vec::new(),
        };
        let corners: Vec<DVec2> =
            self.prepared.border.outline_in_heading.iter().map(|corner| corner.as_dvec2()).collect();
        let Found { record, best_particle, gathering, .. } = self.found;
        let truth = sequence.frames[record.index].reference_pose;
        FrameView {
            record,
            gathering,
            picture: self.picture.clone(),
            veil: self.veil(veil, blur_sigma_px),
            particles: self.weighted_particles(scorer),
            best_particle,
            truth,
            pose_lines: edges(record.pose),
            best_lines: edges(best_particle),
            truth_lines: truth.map_or_else(Vec::new, |truth| lines(truth, 0.0)),
            border: project_polygon(camera, &corners, self.mount.at(Pose2::default())),
        }
    }

    fn veil(&self, veil: Veil, blur_sigma_px: f32) -> Option<Arc<ColorImage>> {
        let evidence = || self.prepared.evidence();
        match veil {
            Veil::None => None,
            Veil::Blurred => Some(gray_image(&gaussian_blur(&self.prepared.luma(), blur_sigma_px))),
            Veil::Evidence => Some(gray_image(&evidence())),
            Veil::Distances => Some(gray_image(&distance_field(&evidence()))),
        }
    }

    /// Returns the particles weighted by the observation model: every n-th of many, and always the best one.
    fn weighted_particles(&self, scorer: &mut CpuScorer) -> Vec<WeightedParticle> {
        let particles = &self.found.particles;
        let log_weights = if self.found.is_spread() {
            vec![0.0; particles.len()]
        } else {
            scorer.set_picture(&self.prepared);
            scorer.log_weights_of(particles)
        };
        let Some(best) = best_index(&log_weights) else { return Vec::new() };
        let weights = normalise(&log_weights);
        let most = weights[best].max(f64::MIN_POSITIVE);
        let weighted = |index: usize| WeightedParticle {
            pose: particles[index].planar(),
            relative_weight: (weights[index] / most) as f32,
        };
        let step = particles.len().div_ceil(SHOWN_PARTICLES).max(1);
        let others = (0..particles.len()).step_by(step).filter(|index| *index != best);
        others.chain([best]).map(weighted).collect()
    }
}
