//! The paper's Eq. 4: a polynomial of second order between the pixels of two pictures.
//!
//! x' = α₀ + α₁ x + α₂ y + α₃ x² + α₄ x y + α₅ y², and y' with β, fitted by least squares to the points of a 25 cm grid on
//! the ground that both cameras see. It moves every pixel of the nearest picture (forward model); pixels of the target
//! that stay empty are looked up with the polynomial fitted the other way (reverse model).

use glam::DVec2;
use nalgebra::{DMatrix, Matrix6, SMatrix};
use reality_sim_core::{
    camera::Camera,
    field::FieldDimensions,
    pose::CameraPose,
    warp::{Origin, Picture},
};

use crate::{Memory, Method, Provenance, SynthesisError, Synthesizer};

/// Distance between the points of the grid, metres.
const GRID_M: f64 = 0.25;

/// Number of points needed for six coefficients.
const LEAST_POINTS: usize = 6;

/// Method of the paper's Eq. 4, from the nearest picture.
#[derive(Debug, Clone, Copy)]
pub struct Quadratic;

impl Method for Quadratic {
    fn name(&self) -> &'static str {
        "quadratic"
    }

    fn draw(
        &self,
        from: &Synthesizer,
        pose: CameraPose,
        _memory: &mut Memory,
        colors: &mut [[u8; 3]],
    ) -> Result<Provenance, SynthesisError> {
        let archive = from.archive();
        let nearest = from.nearest_of_size(pose)?;
        let record = &archive.images()[nearest.image as usize];
        let picture = from.picture(nearest.image)?;
        let pairs = ground_pairs(
            (archive.camera_of(nearest.image), record.pose),
            (from.camera(), pose),
            archive.field(),
        );
        let reversed: Vec<[DVec2; 2]> = pairs.iter().map(|&[source, target]| [target, source]).collect();
        let (Some(forward), Some(reverse)) = (Polynomial::fit(&pairs), Polynomial::fit(&reversed)) else {
            return Err(SynthesisError::TooFewPoints { pose });
        };
        let cameras = [archive.camera_of(nearest.image), from.camera()];
        let mut origins = draw_moved(&picture, cameras, [&forward, &reverse], colors);
        from.fill_hidden(pose, colors, &mut origins)?;
        Ok(Provenance::new(
            self.name(),
            std::iter::once((nearest.image, nearest.distance_px)),
            origins,
            from.rays(),
        ))
    }
}

/// Returns the pixels of points on the ground, in the source and in the target.
fn ground_pairs(
    (source, source_pose): (&Camera, CameraPose),
    (target, target_pose): (&Camera, CameraPose),
    field: &FieldDimensions,
) -> Vec<[DVec2; 2]> {
    let half = field.carpet_half_extent_m();
    let steps = (half / GRID_M).floor().as_ivec2();
    let mut pairs = Vec::new();
    for x in -steps.x..=steps.x {
        for y in -steps.y..=steps.y {
            let point = (GRID_M * DVec2::new(f64::from(x), f64::from(y))).extend(0.0);
            let pixel =
                |camera: &Camera, pose: CameraPose| camera.project(pose.camera_from_world(point)).ok();
            if let (Some(source), Some(target)) = (pixel(source, source_pose), pixel(target, target_pose)) {
                pairs.push([source, target]);
            }
        }
    }
    pairs
}

/// Two polynomials of second order in two variables.
struct Polynomial {
    /// Coefficients α and β.
    coefficients: SMatrix<f64, 6, 2>,
    /// Origin and unit of the pixel coordinates, so that the squares do not dominate.
    origin: DVec2,
    unit_px: f64,
}

impl Polynomial {
    /// Fits the map from the first to the second pixel of each pair; `None` if the pairs do not determine it.
    fn fit(pairs: &[[DVec2; 2]]) -> Option<Self> {
        if pairs.len() < LEAST_POINTS {
            return None;
        }
        let origin = pairs.iter().map(|[from, _]| *from).sum::<DVec2>() / pairs.len() as f64;
        let unit_px = pairs.iter().map(|[from, _]| from.distance(origin)).fold(1.0, f64::max);
        let rows: Vec<[f64; 6]> = pairs.iter().map(|[from, _]| terms((*from - origin) / unit_px)).collect();
        let design = DMatrix::from_fn(pairs.len(), 6, |row, term| rows[row][term]);
        let wanted = DMatrix::from_fn(pairs.len(), 2, |row, axis| pairs[row][1][axis]);
        let normal: Matrix6<f64> = (design.transpose() * &design).fixed_view::<6, 6>(0, 0).into_owned();
        let right: SMatrix<f64, 6, 2> = (design.transpose() * wanted).fixed_view::<6, 2>(0, 0).into_owned();
        // Points on one curve of second order do not determine a polynomial.
        let least = normal.symmetric_eigenvalues().min();
        let coefficients = normal.cholesky()?.solve(&right);
        (least > 1e-9 * normal.trace()).then_some(Self { coefficients, origin, unit_px })
    }

    fn at(&self, pixel: DVec2) -> DVec2 {
        let terms = terms((pixel - self.origin) / self.unit_px);
        let value = |axis: usize| (0..6).map(|term| terms[term] * self.coefficients[(term, axis)]).sum();
        DVec2::new(value(0), value(1))
    }
}

fn terms(at: DVec2) -> [f64; 6] {
    [1.0, at.x, at.y, at.x * at.x, at.x * at.y, at.y * at.y]
}

/// Draws the picture moved by the forward model, with gaps filled by the reverse one; pixels that neither reaches are black.
/// Returns the origin of each pixel.
fn draw_moved(
    picture: &Picture,
    [source, camera]: [&Camera; 2],
    [forward, reverse]: [&Polynomial; 2],
    colors: &mut [[u8; 3]],
) -> Vec<Origin> {
    const FORWARD: Origin = Origin { source: 0, trust: 128 };
    const REVERSE: Origin = Origin { source: 0, trust: 64 };
    let (width, count) = (camera.width, colors.len());
    colors.fill([0; 3]);
    let mut origins = vec![Origin { source: Origin::NOWHERE, trust: 0 }; count];
    let color = |u: u32, v: u32| {
        let [red, green, blue, mask] = picture.pixels[(v * picture.width + u) as usize].to_le_bytes();
        (mask == Picture::SHOWN).then_some([red, green, blue])
    };
    for v in 0..picture.height {
        for u in 0..picture.width {
            let pixel = DVec2::new(f64::from(u), f64::from(v));
            if source.check_inside(pixel).is_err() {
                continue;
            }
            let target = forward.at(pixel);
            if let Some((column, row)) = pixel_at(target, camera)
                && let Some(color) = color(u, v)
            {
                let index = (row * width + column) as usize;
                (colors[index], origins[index]) = (color, FORWARD);
            }
        }
    }
    for index in (0..count).filter(|&index| origins[index].source == Origin::NOWHERE).collect::<Vec<_>>() {
        let (u, v) = (index as u32 % width, index as u32 / width);
        let place = reverse.at(DVec2::new(f64::from(u), f64::from(v)));
        if let Some((column, row)) = pixel_at(place, source)
            && let Some(color) = color(column, row)
        {
            (colors[index], origins[index]) = (color, REVERSE);
        }
    }
    origins
}

/// Returns the pixel nearest to a place, if the camera sees something there.
fn pixel_at(place: DVec2, camera: &Camera) -> Option<(u32, u32)> {
    let rounded = place.round();
    camera.check_inside(rounded).ok()?;
    Some((rounded.x as u32, rounded.y as u32))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_polynomial_of_second_order_is_found_again(
            coefficients in prop::array::uniform12(-1.0..1.0_f64),
            points in prop::collection::vec((0.0..640.0_f64, 0.0..480.0_f64), 20..80),
        ) {
            let value = |of: &[f64], x: f64, y: f64| {
                of[0] * 300.0 + of[1] * x + of[2] * y + 1e-3 * (of[3] * x * x + of[4] * x * y + of[5] * y * y)
            };
            let wanted = |x: f64, y: f64| DVec2::new(value(&coefficients[..6], x, y), value(&coefficients[6..], x, y));
            let pairs: Vec<[DVec2; 2]> = points.iter().map(|&(x, y)| [DVec2::new(x, y), wanted(x, y)]).collect();
            let found = Polynomial::fit(&pairs).unwrap();
            for (x, y) in [(0.0, 0.0), (639.0, 479.0), (100.0, 400.0)] {
                prop_assert!(found.at(DVec2::new(x, y)).distance(wanted(x, y)) < 1e-3);
            }
        }
    }

    #[test]
    fn points_that_leave_the_polynomial_free_are_refused() {
        let line: Vec<[DVec2; 2]> = (0..40).map(|i| [DVec2::splat(f64::from(i)), DVec2::X]).collect();
        assert!(Polynomial::fit(&line).is_none(), "on a line");
        assert!(Polynomial::fit(&line[..3]).is_none(), "too few");
        assert!(Polynomial::fit(&[]).is_none());
    }
}
