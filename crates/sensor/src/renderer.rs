//! Rendering of the picture at a pose: every stage, pixel by pixel.

use glam::{DVec2, Vec3};
use image::RgbImage;
use rayon::prelude::*;
use reality_sim_core::{
    field::FieldDimensions,
    pose::{CameraPose, FARTHEST_M},
    sequence::CameraSetup,
};

use crate::{
    Chain, Model, ModelError, SceneColors, Trajectory,
    blur::blurred,
    encoding::Encoding,
    lens::{Lens, RayPatch},
    light::Light,
    motion::Motion,
    projected_scene::ProjectedScene,
    scene::Scene,
    sensor::Sensor,
    sharpening::sharpened,
    surface::Surface,
};

/// Default number of parts along each side of a pixel that an edge crosses.
const DEFAULT_PARTS_PER_SIDE: u16 = 3;

/// Error of a pose that cannot be rendered.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A coordinate is NaN or infinite.
    #[error("the camera's pose {0:?} has a coordinate that is not a finite number: give six finite ones")]
    NotFinite(CameraPose),
    /// The camera is on the ground or under it.
    #[error("the camera's height is {height_m} m: it must be above 0, the ground")]
    NotAboveGround {
        /// Height as given, metres.
        height_m: f64,
    },
    /// The camera is farther from the field's centre than [`FARTHEST_M`].
    #[error(
        "the camera's pose {0:?} is farther than {FARTHEST_M:.0} m from the field's centre: give one above the field"
    )]
    TooFar(CameraPose),
}

/// Draws the picture of one camera on one field at any pose. Make it once: it keeps every pixel's rays.
#[derive(Debug, Clone)]
pub struct Renderer {
    chain: Chain,
    scene: Scene,
    /// One lens for all colours, or one each where the lens magnifies them differently.
    lenses: Vec<Lens>,
    encoding: Encoding,
    size: [u32; 2],
    parts_per_side: u16,
}

impl Renderer {
    /// Name of simulated pictures where they are listed beside those made from recorded pictures.
    pub const NAME: &str = "simulated";

    /// Makes a renderer for a camera, a field and colours. The hall's walls stand 3 m outside the carpet; its ceiling is 4 m
    /// above the ground. Pixel values follow the gamma of the camera's photometry, or 2.2 without photometry.
    pub fn new(setup: &CameraSetup, field: &FieldDimensions, colors: SceneColors) -> Self {
        Self::through(Chain::nominal(setup, field), colors)
    }

    /// Makes a renderer for a camera and a field with effects. Fails where the effects leave no valid camera or tone curve.
    pub fn with_model(
        setup: &CameraSetup,
        field: &FieldDimensions,
        colors: SceneColors,
        model: &Model,
    ) -> Result<Self, ModelError> {
        Ok(Self::through(Chain::new(setup, field, model)?, colors))
    }

    fn through(chain: Chain, colors: SceneColors) -> Self {
        let [line, carpet] = Surface::ALL.map(|surface| chain.reflectance(surface) as f32);
        let colors = SceneColors {
            line_linear_rgb: line * colors.line_linear_rgb,
            carpet_linear_rgb: carpet * colors.carpet_linear_rgb,
            ..colors
        };
        let camera = chain.camera();
        let [red, green, blue] = chain.magnification();
        let magnifications = if red == green && green == blue { vec![green] } else { vec![red, green, blue] };
        Self {
            scene: Scene::new(chain.field(), colors),
            lenses: magnifications.iter().map(|factor| Lens::new(&chain, *factor)).collect(),
            encoding: Encoding::new(chain.tone()),
            size: [camera.width, camera.height],
            parts_per_side: DEFAULT_PARTS_PER_SIDE,
            chain,
        }
    }

    /// Sets the number of parts, `per_side` × `per_side`, into which a pixel is cut where an edge crosses it (0 is taken as
    /// 1); the default is 3 × 3. The part's area that a shape covers is computed, not sampled: more parts help where edges
    /// of several colours meet.
    pub fn with_parts_per_side(self, per_side: u16) -> Self {
        Self { parts_per_side: per_side.max(1), ..self }
    }

    /// Returns the camera with its effects.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// Draws the picture at a pose. Pixels beyond the camera's valid angle or outside its image circle are black.
    ///
    /// Without effects, this is the picture of an ideal sensor: no blur, no black level, no noise. With a model, it is the
    /// picture of [`Renderer::draw_at`] at time 0 by a still camera, without noise.
    pub fn draw(&self, pose: CameraPose) -> Result<RgbImage, RenderError> {
        if !self.chain.model().effects.is_empty() {
            return self.draw_at(&Trajectory::still(pose), 0.0, None);
        }
        let scene = self.projected(pose)?;
        let [width, height] = self.size;
        let mut picture = RgbImage::new(width, height);
        let row_length = 3 * width as usize;
        picture
            .par_chunks_exact_mut(row_length)
            .enumerate()
            .for_each(|(v, row)| self.draw_row(&scene, v, row));
        Ok(picture)
    }

    /// Draws the picture with a timestamp, seconds, through all stages of a camera whose reference poses are on a
    /// trajectory. Adds noise if a seed is given; the same seed and time give the same noise. No light falls on pixels
    /// beyond the camera's valid angle or outside its image circle.
    pub fn draw_at(
        &self,
        trajectory: &Trajectory,
        time_s: f64,
        noise_seed: Option<u64>,
    ) -> Result<RgbImage, RenderError> {
        let light = self.light(&Motion::new(&self.chain, trajectory, time_s))?;
        let light =
            blurred(light, |pixel| self.chain.psf_variance_px2(pixel)).veiled(self.chain.glare() as f32);
        let picture = self.recorded(&light, &Sensor::new(&self.chain, time_s, noise_seed));
        let amount = self.chain.sharpening();
        Ok(if amount == 0.0 { picture } else { sharpened(&picture, amount) })
    }

    /// Returns the light that falls through the lens while each row is exposed.
    fn light(&self, motion: &Motion<'_>) -> Result<Light, RenderError> {
        let mut light = Light::dark(self.size);
        let shared = if motion.is_same_for_rows() { Some(self.instants(motion, 0.5)?) } else { None };
        let last_row = f64::from(self.size[1].max(2) - 1);
        light.rows_mut().enumerate().try_for_each(|(v, row)| {
            match &shared {
                Some(instants) => self.expose_row(instants, v, row),
                None => self.expose_row(&self.instants(motion, v as f64 / last_row)?, v, row),
            }
            Ok(())
        })?;
        Ok(light)
    }

    /// Projects the scene at each instant of a row's exposure; rows run from 0 at the top to 1 at the bottom.
    fn instants(&self, motion: &Motion<'_>, row: f64) -> Result<Vec<ProjectedScene>, RenderError> {
        motion.poses(row).map(|pose| self.projected(pose)).collect()
    }

    /// Projects the scene to a camera pose above the ground.
    fn projected(&self, pose: CameraPose) -> Result<ProjectedScene, RenderError> {
        if !pose.is_finite() {
            return Err(RenderError::NotFinite(pose));
        }
        if pose.height_m <= 0.0 {
            return Err(RenderError::NotAboveGround { height_m: pose.height_m });
        }
        if !pose.is_possible() {
            return Err(RenderError::TooFar(pose));
        }
        Ok(ProjectedScene::new(&self.scene, pose))
    }

    fn expose_row(&self, instants: &[ProjectedScene], v: usize, row: &mut [Vec3]) {
        for (u, light) in row.iter_mut().enumerate() {
            let falloff = self.chain.falloff(DVec2::new(u as f64, v as f64)) as f32;
            let sum: Vec3 = instants.iter().map(|scene| self.color(scene, u, v)).sum();
            *light = falloff * sum / instants.len() as f32;
        }
    }

    /// Returns the colour at a pixel, each channel through its own lens.
    fn color(&self, scene: &ProjectedScene, u: usize, v: usize) -> Vec3 {
        let through = |lens: &Lens| match lens.row(v)[u] {
            Some(patch) => scene.color(patch, self.parts_per_side, self.light_on_ground(scene, patch)),
            None => Vec3::ZERO,
        };
        match self.lenses.as_slice() {
            [red, green, blue] => Vec3::new(through(red).x, through(green).y, through(blue).z),
            lenses => lenses.first().map_or(Vec3::ZERO, through),
        }
    }

    fn light_on_ground(&self, scene: &ProjectedScene, patch: RayPatch) -> f32 {
        scene.ground(patch.center).map_or(1.0, |point| self.chain.light_on_ground(point) as f32)
    }

    fn recorded(&self, light: &Light, sensor: &Sensor<'_>) -> RgbImage {
        let [width, height] = self.size;
        let mut picture = RgbImage::new(width, height);
        picture.par_chunks_exact_mut(3 * width as usize).zip(light.rows()).enumerate().for_each(
            |(v, (row, light))| {
                for (u, (pixel, light)) in row.as_chunks_mut::<3>().0.iter_mut().zip(light).enumerate() {
                    *pixel = self.encoding.encode(sensor.record(*light, v as u32 * width + u as u32));
                }
            },
        );
        picture
    }

    fn draw_row(&self, scene: &ProjectedScene, v: usize, row: &mut [u8]) {
        for (patch, pixel) in self.lenses[0].row(v).iter().zip(row.as_chunks_mut::<3>().0) {
            if let Some(patch) = patch {
                *pixel = self.encoding.encode(scene.color(*patch, self.parts_per_side, 1.0));
            }
        }
    }
}
