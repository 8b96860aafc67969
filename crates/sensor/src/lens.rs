//! Rays of each pixel, found once for a camera: no lens is inverted while a picture is drawn.

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use crate::Chain;

/// Steps of the fixed-point iteration for the ray of a shifted pixel. A lens shifts neighbouring points so much alike that
/// each step leaves a tenth of the error at most.
const SHIFT_STEPS: usize = 4;

/// Rays that a pixel, or a part of one, collects: `center + x across + y down` with x and y between −½ and ½, in the camera
/// frame. Their lengths are arbitrary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RayPatch {
    /// Ray in the middle.
    pub(crate) center: Vec3,
    /// Difference between the right side and the left side.
    pub(crate) across: Vec3,
    /// Difference between the lower side and the upper side.
    pub(crate) down: Vec3,
}

impl RayPatch {
    /// Cuts the patch into `per_side` × `per_side` parts.
    pub(crate) fn parts(self, per_side: u16) -> impl Iterator<Item = Self> {
        let scale = f32::from(per_side).recip();
        let (across, down) = (self.across * scale, self.down * scale);
        let offset = move |index: u16| f32::from(index) - 0.5 * f32::from(per_side - 1);
        (0..per_side).flat_map(move |row| {
            (0..per_side).map(move |column| Self {
                center: self.center + offset(column) * across + offset(row) * down,
                across,
                down,
            })
        })
    }
}

/// Rays of all pixels.
#[derive(Debug, Clone)]
pub(crate) struct Lens {
    width: usize,
    /// Patches row by row; `None` where the picture is black.
    patches: Vec<Option<RayPatch>>,
}

impl Lens {
    /// Computes the rays of a chain's camera whose picture is also magnified about the principal point; 1 leaves it unchanged.
    pub(crate) fn new(chain: &Chain, magnification: f64) -> Self {
        let camera = chain.camera();
        let width = camera.width as usize;
        let mut patches = vec![None; width * camera.height as usize];
        patches.par_chunks_exact_mut(width).enumerate().for_each(|(v, row)| {
            for (u, patch) in row.iter_mut().enumerate() {
                *patch = ray_patch(chain, magnification, DVec2::new(u as f64, v as f64));
            }
        });
        Self { width, patches }
    }

    /// Returns the rays of a row's pixels, from left to right; `None` beyond the valid angle and outside the image circle.
    pub(crate) fn row(&self, v: usize) -> &[Option<RayPatch>] {
        &self.patches[v * self.width..(v + 1) * self.width]
    }
}

/// Linearises the rays within one pixel; the error is a thousandth of a pixel.
fn ray_patch(chain: &Chain, magnification: f64, pixel: DVec2) -> Option<RayPatch> {
    let camera = chain.camera();
    camera.check_inside(pixel).ok()?;
    let principal_point = DVec2::new(camera.cx, camera.cy);
    let ray =
        |pixel: DVec2| unshifted_ray(chain, pixel + (1.0 / magnification - 1.0) * (pixel - principal_point));
    let center = ray(pixel)?;
    let change = |step: DVec2| {
        let [before, after] = [pixel - 0.5 * step, pixel + 0.5 * step].map(ray);
        difference(before, center, after).as_vec3()
    };
    Some(RayPatch { center: center.as_vec3(), across: change(DVec2::X), down: change(DVec2::Y) })
}

/// Returns the ray that is seen at a pixel.
fn unshifted_ray(chain: &Chain, pixel: DVec2) -> Option<DVec3> {
    let mut ray = chain.camera().unproject(pixel).ok()?;
    if chain.shift_px(ray) != DVec2::ZERO {
        for _ in 0..SHIFT_STEPS {
            ray = chain.camera().unproject(pixel - chain.shift_px(ray)).ok()?;
        }
    }
    Some(ray)
}

/// Returns the difference across a pixel; on the lens's rim, one of its sides may have no ray.
fn difference(before: Option<DVec3>, center: DVec3, after: Option<DVec3>) -> DVec3 {
    match (before, after) {
        (Some(before), Some(after)) => after - before,
        (Some(before), None) => 2.0 * (center - before),
        (None, Some(after)) => 2.0 * (after - center),
        (None, None) => DVec3::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use reality_sim_core::{
        camera::{Camera, Distortion, OpencvFisheye},
        field::FieldDimensions,
        sequence::CameraSetup,
    };

    use super::*;
    use crate::{Model, effect};

    #[test]
    fn every_part_of_a_pixel_has_the_rays_that_are_projected_there() {
        let lens = OpencvFisheye { k: [-0.058, 0.0082, -0.0009, 0.00005] };
        let intrinsics = [215.0, 214.0, 319.5, 240.3];
        let camera = Camera::new([640, 480], intrinsics, Distortion::OpencvFisheye(lens)).unwrap();
        let setup = CameraSetup { camera, mount_height_m: 0.5, photometry: None };
        let field = FieldDimensions::preset("spl").unwrap();
        let decentred = Model::default().with(effect("tangential_distortion").unwrap(), [0.004, -0.003]);
        for model in [Model::default(), decentred] {
            let chain = Chain::new(&setup, &field, &model).unwrap();
            let lens = Lens::new(&chain, 1.0);
            for v in (0..480).step_by(53) {
                for (u, patch) in lens.row(v).iter().enumerate().step_by(13) {
                    for (i, part) in patch.unwrap().parts(3).enumerate() {
                        let offset = (DVec2::new((i % 3) as f64, (i / 3) as f64) - 1.0) / 3.0;
                        let pixel = chain.project_from_camera(part.center.as_dvec3()).unwrap();
                        let off_px = pixel.distance(DVec2::new(u as f64, v as f64) + offset);
                        assert!(off_px < 4e-3, "{u} {v}: {off_px}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_pixel_on_the_rim_whose_outer_side_has_no_ray_changes_as_its_inner_side_does() {
        let middle = DVec3::new(0.1, 0.2, 1.0);
        let step = DVec3::new(0.01, 0.0, 0.0);
        let sides = [
            (Some(middle - 0.5 * step), Some(middle + 0.5 * step)),
            (None, Some(middle + 0.5 * step)),
            (Some(middle - 0.5 * step), None),
        ];
        for (before, after) in sides {
            assert!(difference(before, middle, after).distance(step) < 1e-12);
        }
        assert_eq!(difference(None, middle, None), DVec3::ZERO);
    }
}
