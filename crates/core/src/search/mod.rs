//! Global localization: an exhaustive search of the whole field for places that fit a picture, whose best results are
//! then refined. It is used for an unknown start, and when the filter is lost.

mod config;
mod grid;
mod mode;
mod seen_lines;

use rayon::prelude::*;

use self::seen_lines::SeenLines;
pub use self::{
    config::{SearchConfig, SearchParticles},
    grid::SearchGrid,
    mode::{Mode, Prior},
};
use crate::{
    backend::{Backend, CpuBackend},
    backend_error::BackendError,
    camera::Camera,
    field::FieldDimensions,
    filter::{FilterConfig, ParticleFilter, PlanarSigma},
    mount::{MountPose, MountPoseSigma},
    observation::{CpuScorer, ObservationConfig, Scorer},
    pose::{CameraPose, Pose2, wrap_angle},
    preprocess::Prepared,
    refine::{Reach, RefineConfig, Refiner},
};

/// Searches the whole field for poses that fit pictures of one camera.
pub struct GlobalSearch {
    config: SearchConfig,
    grid: SearchGrid,
    grid_scorer: Box<dyn Scorer>,
    scorer: CpuScorer,
    white_contrast: f64,
    /// Lines of the picture loaded last.
    seen: SeenLines,
    camera: Camera,
    field: FieldDimensions,
    refiner: Refiner,
}

impl std::fmt::Debug for GlobalSearch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("GlobalSearch").field("config", &self.config).finish_non_exhaustive()
    }
}

impl GlobalSearch {
    /// Prepares a search on the CPU.
    pub fn new(camera: &Camera, field: &FieldDimensions, mount_sigma: MountPoseSigma) -> Self {
        let refiner = Refiner::new(camera, field, RefineConfig::default(), mount_sigma);
        Self::with_backend(camera, field, SearchConfig::default(), refiner, &CpuBackend)
            .unwrap_or_else(|error| unreachable!("this processor never fails: {error}"))
    }

    /// Works as [`GlobalSearch::new`], with other settings, and with the grid scored on the backend's device. `refiner` fits
    /// the best places; its camera and field are those of the search. Fails if the device does.
    pub fn with_backend(
        camera: &Camera,
        field: &FieldDimensions,
        config: SearchConfig,
        refiner: Refiner,
        backend: &dyn Backend,
    ) -> Result<Self, BackendError> {
        Ok(Self {
            config,
            grid: config.grid.unwrap_or_else(|| SearchGrid::new(field)),
            grid_scorer: backend.scorer(camera, field, ObservationConfig::grid(field))?,
            scorer: CpuScorer::new(camera, field, ObservationConfig::coarse_contrast()),
            white_contrast: 1.0,
            seen: SeenLines::default(),
            camera: camera.clone(),
            field: field.clone(),
            refiner,
        })
    }

    /// Returns the fits of poses that the search makes; others may use them, too.
    pub fn refiner(&self) -> &Refiner {
        &self.refiner
    }

    /// Loads a new picture for the methods that do not search the field.
    pub fn load(&mut self, picture: &Prepared) {
        self.seen = SeenLines::new(&self.camera, &self.field, picture);
        self.scorer.set_picture(picture);
        self.white_contrast = f64::from(picture.levels.contrast());
    }

    /// Returns the fraction of the line in view that the picture shows where the pose projects it, see
    /// [`CpuScorer::line_fraction`]; 0 if no line is in view.
    pub fn line_fraction(&self, pose: CameraPose) -> f64 {
        self.scorer.line_fraction(pose).unwrap_or(0.0)
    }

    /// Returns the fraction of the white lines in the picture that are lines of the field as seen from a pose; 1 if the
    /// picture shows none.
    pub fn explained_fraction(&self, pose: CameraPose) -> f64 {
        self.seen.explained_fraction(pose)
    }

    /// Returns the poses that fit the picture, best first. On a field with equal halves, a pose and its mirror pose fit
    /// equally well: without a prior only one of them is searched for, with a prior the prior decides. Fails if the
    /// backend's device does.
    pub fn search(
        &mut self,
        picture: &Prepared,
        mount: MountPose,
        prior: Option<Prior>,
        seed: u64,
    ) -> Result<Vec<Mode>, BackendError> {
        self.load(picture);
        let config = self.config;
        let mut places = self.best_on_grid(picture, mount, prior)?;
        if let Some(prior) = prior {
            places.push(prior.pose);
        }
        let mut modes = self.ranked(self.look_around(&places, config.near, mount, prior, seed)?);
        let best: Vec<Pose2> = modes.iter().take(config.far_places).map(|mode| mode.pose.planar()).collect();
        modes.extend(self.look_around(&best, config.far, mount, prior, !seed)?);
        let mut modes = self.ranked(modes);
        modes.truncate(config.fitted_places);
        // The expected place is fitted as well: the particles around it may have found a worse one.
        modes.extend(prior.map(|known| self.mode(mount.at(known.pose), mount, prior)));
        modes.par_iter_mut().for_each(|mode| *mode = self.fitted(*mode, mount, prior));
        Ok(with_probabilities(self.ranked(modes)))
    }

    /// Returns the most probable of several poses, each fitted to the picture loaded or searched last.
    pub fn best_of(&self, poses: &[CameraPose], mount: MountPose, prior: Option<Prior>) -> Option<Mode> {
        let fitted: Vec<Mode> =
            poses.par_iter().map(|&pose| self.fitted(self.mode(pose, mount, prior), mount, prior)).collect();
        fitted.into_iter().max_by(|a, b| a.log_weight.total_cmp(&b.log_weight))
    }

    /// Returns a pose fitted to the picture loaded last, without any prior; as it is where the fit leads to another place.
    pub fn best_near(&self, pose: CameraPose, mount: MountPose) -> Mode {
        let own = self.mode(pose, mount, None);
        let fitted = self.fitted(own, mount, None);
        if self.is_same_place(pose.planar(), fitted.pose.planar()) { fitted } else { own }
    }

    fn is_same_place(&self, a: Pose2, b: Pose2) -> bool {
        distinct(vec![a, b], self.config.same_place, |pose| *pose).len() == 1
    }

    fn fitted(&self, mode: Mode, mount: MountPose, prior: Option<Prior>) -> Mode {
        // If lines lie close together, a wide search can slip from one to the next; a narrow one stays on its line.
        [Reach::Wide, Reach::Narrow]
            .into_iter()
            .filter_map(|reach| {
                let fit =
                    self.refiner.fit(self.scorer.texture(), mode.pose, mount, self.white_contrast, reach)?;
                Some(Mode { fit: Some(fit), ..self.mode(fit.pose, mount, prior) })
            })
            .find(|fitted| fitted.log_weight >= mode.log_weight - self.config.fit_margin)
            .unwrap_or(mode)
    }

    fn mode(&self, pose: CameraPose, mount: MountPose, prior: Option<Prior>) -> Mode {
        let prior = prior.map_or(0.0, |prior| prior.log_probability(pose.planar()));
        let unexplained = self.config.unexplained_weight * (1.0 - self.seen.explained_fraction(pose));
        let log_weight =
            self.scorer.log_weight(&pose) + self.refiner.mount_sigma().log_prior(pose, mount) + prior
                - unexplained;
        Mode { pose, log_weight, probability: 0.0, fit: None }
    }

    /// Scores every pose of the grid, and returns the best ones that lie apart from each other. Fails if the backend's
    /// device does.
    pub fn best_on_grid(
        &mut self,
        picture: &Prepared,
        mount: MountPose,
        prior: Option<Prior>,
    ) -> Result<Vec<Pose2>, BackendError> {
        self.grid_scorer.load(picture)?;
        let mut places = self.grid.places(&self.field);
        if prior.is_none() {
            // The other half of the field looks the same when turned by 180°.
            places.retain(|place| place.x <= self.grid.step_m);
        }
        let mut scored: Vec<(Pose2, f64)> = Vec::new();
        for places in places.chunks(self.config.places_at_once.max(1)) {
            let poses: Vec<Pose2> = places.iter().flat_map(|&place| self.grid.poses_at(place)).collect();
            let cameras: Vec<CameraPose> = poses.iter().map(|&pose| mount.at(pose)).collect();
            let log_weights = self.grid_scorer.log_weights(&cameras)?;
            let headings = self.grid.headings as usize;
            scored.extend(poses.chunks(headings).zip(log_weights.chunks(headings)).flat_map(
                |(poses, scores)| {
                    let prior = |pose: &Pose2| prior.map_or(0.0, |prior| prior.log_probability(*pose));
                    let mut here: Vec<(Pose2, f64)> =
                        poses.iter().zip(scores).map(|(pose, score)| (*pose, score + prior(pose))).collect();
                    here.sort_by(|a, b| b.1.total_cmp(&a.1));
                    here.truncate(self.config.kept_headings);
                    here
                },
            ));
        }
        scored.sort_by(|a, b| b.1.total_cmp(&a.1));
        scored.truncate(self.config.kept_poses * self.config.compared_per_kept);
        scored.par_iter_mut().for_each(|(pose, score)| {
            let explained = self.seen.roughly_explained_fraction(mount.at(*pose));
            *score -= self.config.unexplained_weight * (1.0 - explained);
        });
        scored.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut places = distinct(scored, self.config.same_place, |(pose, _)| *pose);
        places.truncate(self.config.kept_poses);
        Ok(places.into_iter().map(|(pose, _)| pose).collect())
    }

    /// Returns the best pose that a small particle filter finds around each place.
    fn look_around(
        &self,
        places: &[Pose2],
        filter: SearchParticles,
        mount: MountPose,
        prior: Option<Prior>,
        seed: u64,
    ) -> Result<Vec<Mode>, BackendError> {
        let found = places.par_iter().enumerate().map(|(index, place)| {
            let seed = seed ^ (index as u64) << 32;
            let pose = self.best_around(*place, filter, mount, seed)?;
            Ok(self.mode(pose, mount, prior))
        });
        found.collect()
    }

    fn best_around(
        &self,
        place: Pose2,
        SearchParticles { particles, sigma }: SearchParticles,
        mount: MountPose,
        seed: u64,
    ) -> Result<CameraPose, BackendError> {
        let config = FilterConfig {
            particles,
            iterations: self.config.iterations,
            seed,
            mount_sigma: Some(self.refiner.mount_sigma()),
            ..FilterConfig::default()
        };
        let mut filter = ParticleFilter::new(config, place, sigma);
        Ok(filter.update(&self.scorer, mount, sigma)?.pose)
    }

    /// Sorts the modes, best first, and keeps one for each place.
    fn ranked(&self, mut modes: Vec<Mode>) -> Vec<Mode> {
        modes.sort_by(|a, b| b.log_weight.total_cmp(&a.log_weight));
        distinct(modes, self.config.same_place, |mode| mode.pose.planar())
    }
}

/// Drops everything near something better; the input is sorted, best first.
fn distinct<T>(sorted: Vec<T>, same_place: PlanarSigma, pose: impl Fn(&T) -> Pose2) -> Vec<T> {
    let mut kept: Vec<T> = Vec::new();
    for item in sorted {
        let here = pose(&item);
        let known = kept.iter().map(&pose).any(|other| {
            (here.position_in_world() - other.position_in_world()).length() < same_place.position_m
                && wrap_angle(here.yaw_rad - other.yaw_rad).abs() < same_place.yaw_rad
        });
        if !known {
            kept.push(item);
        }
    }
    kept
}

fn with_probabilities(modes: Vec<Mode>) -> Vec<Mode> {
    let log_weights: Vec<f64> = modes.iter().map(|mode| mode.log_weight).collect();
    let weights = crate::filter::normalise(&log_weights);
    modes.into_iter().zip(weights).map(|(mode, probability)| Mode { probability, ..mode }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        filter::{Purpose, Stream},
        preprocess::Preprocessor,
        test_scene,
    };

    /// Uses guesses so far away that a fit finds wrong lines.
    #[test]
    fn a_fit_never_explains_the_picture_worse_than_the_pose_it_starts_from() {
        let (camera, field) = (test_scene::fisheye(), test_scene::field());
        let mut search = GlobalSearch::new(&camera, &field, MountPoseSigma::default());
        let (mut fitted, mut slipped) = (0, 0);
        for (scene, pose) in test_scene::poses().into_iter().enumerate() {
            let mount = MountPose::of(pose);
            let picture = Preprocessor::new(&camera, field.line_width_m)
                .prepare(test_scene::render(&camera, pose, &field), mount);
            search.load(&picture);
            let stream = Stream::new(7, Purpose::Initialise, scene as u32, 0);
            for index in 0..40 {
                let normals = stream.normals(index);
                let place = Pose2::new(
                    pose.x_m + 0.2 * normals[0],
                    pose.y_m + 0.2 * normals[1],
                    pose.yaw_rad + 0.1 * normals[2],
                );
                let prior = Prior { pose: place, sigma: PlanarSigma { position_m: 0.05, yaw_rad: 0.03 } };
                let before = search.mode(mount.at(place), mount, Some(prior));
                let after = search.best_of(&[before.pose], mount, Some(prior)).unwrap();
                assert!(
                    after.log_weight >= before.log_weight - search.config.fit_margin,
                    "{before:?} {after:?}"
                );
                fitted += u32::from(after.fit.is_some());
                slipped += u32::from(after.fit.is_none());
            }
        }
        assert!(fitted > 20 && slipped > 5, "both happen: {fitted} fitted, {slipped} slipped");
    }

    #[test]
    fn where_only_some_lines_fit_fewer_of_the_pictures_lines_are_explained() {
        let (camera, field) = (test_scene::fisheye(), test_scene::field());
        let mut search = GlobalSearch::new(&camera, &field, MountPoseSigma::default());
        let grid = SearchGrid { step_m: 0.2, headings: 72 };
        for pose in test_scene::poses() {
            let mount = MountPose::of(pose);
            let preprocessor = Preprocessor::new(&camera, field.line_width_m);
            search.load(&preprocessor.prepare(test_scene::render(&camera, pose, &field), mount));
            let explained = search.explained_fraction(pose);
            assert!(explained > 0.97, "{explained} at the pose of the picture");
            let is_wrong = |other: &CameraPose| {
                [pose, pose.mirrored()].iter().all(|right| {
                    (right.x_m - other.x_m).hypot(right.y_m - other.y_m) > 0.4
                        || wrap_angle(right.yaw_rad - other.yaw_rad).abs() > 0.3
                })
            };
            let all = grid.places(&field).into_iter().flat_map(|place| grid.poses_at(place));
            let wrong = all.map(|place| mount.at(place)).filter(is_wrong);
            let most_fitting =
                wrong.max_by(|a, b| search.line_fraction(*a).total_cmp(&search.line_fraction(*b)));
            let most_fitting = most_fitting.unwrap();
            assert!(search.line_fraction(most_fitting) > 0.3, "lines fit at a wrong place");
            let explained = search.explained_fraction(most_fitting);
            assert!(explained < 0.8, "{explained} at {most_fitting:?} instead of {pose:?}");
        }
    }

    #[test]
    fn a_picture_alone_tells_the_place_up_to_the_mirror() {
        let (camera, field) = (test_scene::fisheye(), test_scene::field());
        let mut search = GlobalSearch::new(&camera, &field, MountPoseSigma::default());
        for pose in test_scene::poses() {
            let mount = MountPose::of(pose);
            let picture = Preprocessor::new(&camera, field.line_width_m)
                .prepare(test_scene::render(&camera, pose, &field), mount);
            search.load(&picture);
            let error = |found: CameraPose| {
                (found.x_m - pose.x_m).hypot(found.y_m - pose.y_m)
                    + wrap_angle(found.yaw_rad - pose.yaw_rad).abs()
            };
            let modes = search.search(&picture, mount, None, 1).unwrap();
            let best = modes[0].pose;
            assert!(error(best).min(error(best.mirrored())) < 0.05, "{best:?} instead of {pose:?}");
            assert!((modes.iter().map(|mode| mode.probability).sum::<f64>() - 1.0).abs() < 1e-9);

            let prior = Prior {
                pose: pose.planar().mirrored(),
                sigma: PlanarSigma { position_m: 0.5, yaw_rad: 0.5 },
            };
            let modes = search.search(&picture, mount, Some(prior), 1).unwrap();
            assert!(error(modes[0].pose.mirrored()) < 0.05, "a prior tells which of the two");
        }
    }
}
