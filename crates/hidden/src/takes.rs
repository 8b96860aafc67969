//! Pictures as light: taken once, developed and written down as often as wanted.

use std::{fs, path::Path};

use glam::DVec2;
use rayon::prelude::*;
use reality_sim_core::pose::Pose2;
use reality_sim_core::sequence::{FrameRecord, Photometry, Sequence, StampedPose, write_tum};

use crate::{
    clock::Clock,
    drawn,
    effect::{Hidden, Mistake},
    error::Error,
    exposure::Exposer,
    film::Film,
    log::Logger,
    mistakes,
    nominal::Nominal,
    random::Random,
    recipe::{Recipe, World},
    scene::Scene,
    setting::Setting,
    trajectory::{Ground, Trajectory},
    truth::Truth,
};

/// Linear red, green and blue of every pixel of a picture.
type Planes = [Vec<f32>; 3];

/// World of a recipe with the light of its pictures, in which other effects than the recipe's can be hidden.
///
/// Most effects are hidden in files beside the same pictures, or while these are developed; only those that change which
/// light reaches the sensor need other pictures.
pub struct Takes {
    recipe: Recipe,
    setting: Setting,
    trajectory: Trajectory,
    light: Vec<Planes>,
}

/// What is hidden, by where it is hidden.
struct Plan {
    /// Everything hidden.
    all: Truth,
    /// What the pictures show.
    pictures: Truth,
    /// Camera and field as the files have them.
    nominal: Nominal,
    stated: Photometry,
    /// Whether the written poses are turned in place of the pictures.
    turns_poses: bool,
    clock: Clock,
}

impl Recipe {
    /// Writes a complete sequence folder, creating it if it is missing, and returns its content: `sequence.toml`,
    /// `camera.toml`, `field.toml`, `frames.csv`, `groundtruth.tum` and the pictures.
    pub fn record(&self, folder: &Path) -> Result<Sequence, Error> {
        self.check()?;
        let takes = Takes::without_light(self);
        takes.write(&takes.plan(&self.effects), &self.effects, folder)
    }

    /// Writes a sequence folder of pictures that the recipe's camera takes in its world at these places, where its robot need not have
    /// passed: the camera stands still, upright, as high and pitched as the robot carries it at rest. There is no odometry.
    ///
    /// # Panics
    ///
    /// Panics if there are no places.
    pub fn visit(&self, places: &[Pose2], folder: &Path) -> Result<Sequence, Error> {
        assert!(!places.is_empty(), "a visit needs a place");
        self.check()?;
        let takes = Takes::without_light(self);
        let mut plan = takes.plan(&self.effects);
        plan.clock = Clock::of_pictures(takes.setting.rate_hz, places.len(), &plan.all);
        let ground =
            |place: &Pose2| Ground { position: DVec2::new(place.x_m, place.y_m), yaw_rad: place.yaw_rad };
        let places: Vec<Ground> = places.iter().map(ground).collect();
        // What stands in the hall stands clear of the robot's own path.
        let stage = takes.stage(&plan);
        let visit = Takes { trajectory: takes.trajectory.through(&places, plan.clock.period_s()), ..takes };
        let mut sequence = visit.write_with(&plan, Some(&stage), folder)?;
        sequence.name.push_str("-visited");
        sequence.start = None;
        sequence.frames.iter_mut().for_each(|frame| frame.odometry = None);
        sequence.write(folder)?;
        Ok(Sequence::open(folder)?)
    }

    /// Takes the pictures of the recipe's world, with nothing hidden and not yet developed, for several recordings. They
    /// are kept in memory: twelve bytes a pixel.
    pub fn takes(&self) -> Result<Takes, Error> {
        self.check()?;
        Ok(Takes::new(self))
    }
}

impl std::fmt::Debug for Takes {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Takes").field("recipe", &self.recipe).finish_non_exhaustive()
    }
}

impl Takes {
    /// Takes the pictures of a recipe's world with nothing hidden.
    fn new(recipe: &Recipe) -> Self {
        let takes = Self::without_light(recipe);
        let plan = takes.plan(&[]);
        let (scene, exposer) = takes.stage(&plan);
        let expose = |take| takes.expose(&plan, &scene, &exposer, take);
        let light = (0..plan.clock.takes()).into_par_iter().map(expose).collect();
        Self { light, ..takes }
    }

    fn without_light(recipe: &Recipe) -> Self {
        let setting = recipe.setting();
        let trajectory = recipe.trajectory(&setting);
        Self { recipe: recipe.clone(), setting, trajectory, light: Vec::new() }
    }

    /// Writes a complete sequence folder with these effects hidden, creating it if it is missing, and returns its content.
    pub fn record(&self, effects: &[Hidden], folder: &Path) -> Result<Sequence, Error> {
        Recipe { effects: effects.to_vec(), ..self.recipe.clone() }.check()?;
        self.write(&self.plan(effects), effects, folder)
    }

    fn plan(&self, effects: &[Hidden]) -> Plan {
        let Setting { nominal, stated, rate_hz, .. } = &self.setting;
        let all = Truth::new(nominal, effects);
        let frames = self.recipe.frames.saturating_sub(all.lost).max(1);
        if self.recipe.world == World::Standard {
            let clock = Clock::of_pictures(*rate_hz, frames, &all);
            let (nominal, stated) = (nominal.clone(), *stated);
            return Plan { pictures: all.clone(), all, nominal, stated, turns_poses: false, clock };
        }
        let seen: Vec<Hidden> = effects.iter().copied().filter(|effect| !nominal.can_lack(effect)).collect();
        let mut lacking = nominal.clone();
        effects.iter().filter(|effect| nominal.can_lack(effect)).for_each(|effect| lacking.take_out(effect));
        let [carpet, line] = all.reflectance;
        let over = |rgb: [f64; 3], factor: f64| rgb.map(|value| value / factor);
        let stated = Photometry {
            carpet_linear_rgb: stated.carpet_linear_rgb.map(|rgb| over(rgb, carpet)),
            line_linear_rgb: stated.line_linear_rgb.map(|rgb| over(rgb, line)),
            ..*stated
        };
        Plan {
            clock: Clock::of_files(*rate_hz, frames, &all),
            pictures: Truth::new(nominal, &seen),
            nominal: lacking,
            stated,
            turns_poses: true,
            all,
        }
    }

    fn stage(&self, plan: &Plan) -> (Scene, Exposer) {
        let scene = Scene::new(self.recipe.seed, &self.setting, &plan.pictures, &self.trajectory);
        let exposer = Exposer::new(&plan.pictures, self.recipe.size, self.setting.psf);
        (scene, if self.recipe.world == World::Standard { exposer } else { exposer.with_plain_pixels() })
    }

    fn expose(&self, plan: &Plan, scene: &Scene, exposer: &Exposer, take: usize) -> Planes {
        exposer.expose(scene, &self.trajectory, plan.clock.exposed_s(take))
    }

    fn write(&self, plan: &Plan, effects: &[Hidden], folder: &Path) -> Result<Sequence, Error> {
        let is_new = self.recipe.world == World::Standard && !effects.is_empty();
        let needs_rays = is_new || effects.iter().any(|effect| self.needs_rays(effect));
        let keeps = !self.light.is_empty() && !needs_rays;
        let stage = (!keeps).then(|| self.stage(plan));
        self.write_with(plan, stage.as_ref(), folder)
    }

    /// Writes a sequence folder of pictures taken on this stage, or, without one, of the light there is.
    fn write_with(
        &self,
        plan: &Plan,
        stage: Option<&(Scene, Exposer)>,
        folder: &Path,
    ) -> Result<Sequence, Error> {
        let images = folder.join("images");
        fs::create_dir_all(&images).map_err(|source| Error::Unwritable { path: images.clone(), source })?;
        let film = self.film(plan);
        let ending = self.setting.storage.ending();
        (0..plan.clock.frames()).into_par_iter().try_for_each(|frame| {
            let take = plan.clock.take_of(frame);
            let fresh = stage.map(|(scene, exposer)| self.expose(plan, scene, exposer, take));
            let light = fresh.as_ref().unwrap_or_else(|| &self.light[take]);
            let noise = &mut Random::stream(self.recipe.seed, "noise", take as u64);
            let picture = film.develop(light, take, plan.clock.nominal_s(take), noise);
            let path = images.join(format!("{frame:06}.{ending}"));
            let bytes = self
                .setting
                .storage
                .encode(&picture)
                .map_err(|source| Error::Unencodable { path: path.clone(), source })?;
            fs::write(&path, bytes).map_err(|source| Error::Unwritable { path, source })
        })?;
        self.write_files(plan, folder)
    }

    fn film(&self, plan: &Plan) -> Film {
        let clock = &plan.clock;
        let span_s = [clock.nominal_s(0), clock.nominal_s(clock.frames() - 1)];
        let film = Film::new(&plan.pictures, self.setting.nominal.light, self.recipe.size, span_s);
        if self.recipe.world == World::Standard { film } else { film.with_tables() }
    }

    /// Whether an effect changes which light reaches the sensor.
    fn needs_rays(&self, effect: &Hidden) -> bool {
        let changes_light = matches!(
            effect,
            Hidden::RollingShutter { .. }
                | Hidden::MotionBlur { .. }
                | Hidden::Defocus { .. }
                | Hidden::ChromaticAberration { .. }
                | Hidden::TangentialDistortion { .. }
                | Hidden::LensDent { .. }
                | Hidden::UnevenIllumination { .. }
                | Hidden::MissingLine { .. }
                | Hidden::ShiftedLine { .. }
                | Hidden::WideLine { .. }
                | Hidden::MovingPeople { .. }
                | Hidden::Fog { .. }
                | Hidden::WavyGround { .. }
        );
        changes_light && !self.setting.nominal.can_lack(effect)
    }

    fn write_files(&self, plan: &Plan, folder: &Path) -> Result<Sequence, Error> {
        let logger = Logger {
            seed: self.recipe.seed,
            walk: self.recipe.walk,
            trajectory: &self.trajectory,
            truth: &plan.all,
            clock: plan.clock,
            errors: self.setting.errors,
            turns_poses: plan.turns_poses,
            ending: self.setting.storage.ending(),
        };
        let mut frames: Vec<FrameRecord> = logger.frames();
        let stamps_s: Vec<f64> = frames.iter().map(|frame| frame.timestamp_s).collect();
        for (frame, pose) in frames.iter_mut().zip(logger.references(&stamps_s)) {
            frame.reference_pose = Some(pose);
        }
        let mistaken: &[Mistake] = &plan.all.mistakes;
        let other_field = mistaken.contains(&Mistake::AnotherLeaguesField);
        let field = &plan.nominal.field;
        let mut sequence = Sequence {
            folder: folder.to_path_buf(),
            files: Vec::new(),
            name: format!("hidden-{}", self.recipe.seed),
            setup: plan.nominal.setup(plan.stated)?,
            frames,
            poses_between_frames: Vec::new(),
            start: Some(logger.start()),
            calibration: None,
            corrected_by: None,
            field: if other_field { drawn::another_league(field) } else { field.clone() },
        };
        mistaken.iter().for_each(|mistake| mistakes::make(*mistake, &mut sequence.frames));
        sequence.write(folder)?;
        if let Some(rate_hz) = self.recipe.reference_rate_hz {
            self.write_references(&logger, rate_hz, folder)?;
        }
        Ok(Sequence::open(folder)?)
    }

    /// Writes reference poses at a rate of their own over those at the frames' times.
    fn write_references(&self, logger: &Logger, rate_hz: f64, folder: &Path) -> Result<(), Error> {
        let last_s = logger.clock.stamp_s(logger.clock.frames() - 1);
        let count = ((last_s + logger.clock.period_s()) * rate_hz) as usize;
        let stamps_s: Vec<f64> = (0..count).map(|index| index as f64 / rate_hz).collect();
        let poses = logger.references(&stamps_s);
        let stamped: Vec<StampedPose> = stamps_s
            .iter()
            .zip(poses)
            .map(|(&timestamp_s, pose)| StampedPose { timestamp_s, pose })
            .collect();
        Ok(write_tum(&folder.join("groundtruth.tum"), &stamped)?)
    }
}
