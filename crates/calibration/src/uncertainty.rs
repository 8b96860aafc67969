//! Where in the picture the projection is how uncertain (as in Kogan's mrcal): the standard deviation of the pixel of a direction
//! that is fixed to the body, by the uncertainty of lens and mount together.

use glam::{DVec2, DVec3};
use nalgebra::{DMatrix, Matrix2};

use crate::{parameter::Parameter, state::State};

/// Step of the numeric derivatives by the turns of the mount, radians.
const STEP_RAD: f64 = 1e-6;

/// Number of cells along the longer side of the picture.
const CELLS: u32 = 32;

/// Uncertainty of the projection over the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct UncertaintyMap {
    /// Side of a cell, pixels.
    pub cell_px: f64,
    /// Number of columns and rows.
    pub size: [usize; 2],
    /// Larger standard deviation of the two axes at the middle of each cell, row by row, pixels; `None` where the lens
    /// sees nothing.
    pub sigma_px: Vec<Option<f64>>,
    /// Number of measured lines in each cell.
    pub measured: Vec<u32>,
}

impl UncertaintyMap {
    /// Returns the uncertainties where lines were measured, pixels.
    pub fn where_measured(&self) -> impl Iterator<Item = f64> + '_ {
        self.sigma_px
            .iter()
            .zip(&self.measured)
            .filter(|(_, count)| **count > 0)
            .filter_map(|(sigma, _)| *sigma)
    }

    /// Returns the cells without any measured line among those that the lens sees, as a fraction.
    pub fn unseen_fraction(&self) -> f64 {
        let seen = self.sigma_px.iter().zip(&self.measured).filter(|(sigma, _)| sigma.is_some());
        let (all, empty) =
            seen.fold((0, 0), |(all, empty), (_, &count)| (all + 1, empty + u32::from(count == 0)));
        f64::from(empty) / f64::from(all.max(1))
    }
}

/// Cells of a picture.
pub(crate) struct Cells {
    pub cell_px: f64,
    pub size: [usize; 2],
}

impl Cells {
    pub fn of(state: &State) -> Self {
        let sides = [state.camera.width, state.camera.height];
        let cell_px = f64::from(sides[0].max(sides[1])) / f64::from(CELLS);
        Self { cell_px, size: sides.map(|side| (f64::from(side) / cell_px).ceil() as usize) }
    }

    /// Returns the middles of the cells, row by row.
    pub fn middles(&self) -> impl Iterator<Item = DVec2> + '_ {
        (0..self.size[1]).flat_map(move |row| {
            (0..self.size[0])
                .map(move |column| DVec2::new(column as f64 + 0.5, row as f64 + 0.5) * self.cell_px - 0.5)
        })
    }

    fn index(&self, pixel: DVec2) -> Option<usize> {
        let [column, row] = [pixel.x, pixel.y].map(|value| ((value + 0.5) / self.cell_px) as usize);
        (column < self.size[0] && row < self.size[1]).then_some(row * self.size[0] + column)
    }
}

/// Computes the map.
pub(crate) fn map(
    state: &State,
    parameters: &[Parameter],
    covariance: &DMatrix<f64>,
    measured: &[DVec2],
) -> UncertaintyMap {
    let cells = Cells::of(state);
    let sigma = |pixel: DVec2| {
        let gradients = gradients(state, parameters, pixel)?;
        let of_pixel = &gradients * covariance * gradients.transpose();
        let of_pixel = Matrix2::new(of_pixel[(0, 0)], of_pixel[(0, 1)], of_pixel[(1, 0)], of_pixel[(1, 1)]);
        Some(of_pixel.symmetric_eigenvalues().max().max(0.0).sqrt())
    };
    let sigma_px = cells.middles().map(sigma).collect();
    let mut counts = vec![0; cells.size[0] * cells.size[1]];
    for index in measured.iter().filter_map(|pixel| cells.index(*pixel)) {
        counts[index] += 1;
    }
    UncertaintyMap { cell_px: cells.cell_px, size: cells.size, sigma_px, measured: counts }
}

/// Returns the derivatives of the pixel of a direction that is fixed to the body, one row for u and one for v, by the parameters;
/// `None` if the lens sees nothing there.
pub(crate) fn gradients(state: &State, parameters: &[Parameter], pixel: DVec2) -> Option<DMatrix<f64>> {
    let ray = state.camera.unproject(pixel).ok()?;
    state.camera.check_inside(pixel).ok()?;
    let lens = state.lens_gradients(parameters, ray)?;
    let stated_ray = state.mounting().stated_from_true() * ray;
    let seen = |state: &State| -> Option<DVec2> {
        let ray: DVec3 = state.mounting().stated_from_true().inverse() * stated_ray;
        state.camera.project_unbounded(ray).ok()
    };
    let mut gradients = DMatrix::zeros(2, parameters.len());
    for (column, (parameter, lens)) in parameters.iter().zip(lens).enumerate() {
        let beside = |step: f64| {
            let mut state = state.clone();
            match parameter {
                Parameter::MountPitch => state.pitch_rad += step,
                Parameter::MountRoll => state.roll_rad += step,
                _ => return None,
            }
            seen(&state)
        };
        let gradient = match (beside(-STEP_RAD), beside(STEP_RAD)) {
            (Some(behind), Some(ahead)) => (ahead - behind) / (2.0 * STEP_RAD),
            _ => lens,
        };
        gradients[(0, column)] = gradient.x;
        gradients[(1, column)] = gradient.y;
    }
    Some(gradients)
}
