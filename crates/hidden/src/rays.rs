//! Rays of a camera, several per pixel, computed once for a recording.

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use crate::truth::Truth;

/// Number of rays along each side of a pixel.
pub const PER_PIXEL: usize = 3;

/// Number of neighbouring pixels in a row that share one cone for finding the things they may see.
pub const CONE_PX: usize = 8;

/// Rays of the channels that the lens magnifies alike.
pub struct Rays {
    /// Channels: red is 0, green 1, blue 2.
    pub channels: Vec<usize>,
    /// Unit directions in the camera frame, row by row; zero where the lens sees nothing.
    pub directions: Vec<Vec3>,
    /// Cones of each row of pixels, `cones_per_row` of them.
    pub cones: Vec<Cone>,
}

/// Bounding cone of the rays of a few neighbouring pixels.
#[derive(Debug, Clone, Copy)]
pub struct Cone {
    /// Unit vector in the camera frame; zero where there is no ray.
    pub axis: Vec3,
    /// Largest angle of a ray from the axis, radians.
    pub half_angle_rad: f32,
}

/// Size of a picture in rays: pixels with a margin from which blur takes light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame {
    /// Size of the picture without margin, pixels.
    pub size: [usize; 2],
    /// Margin on each side, pixels.
    pub margin: usize,
}

impl Frame {
    /// Number of pixels in a row, margins included.
    pub fn columns(&self) -> usize {
        self.size[0] + 2 * self.margin
    }

    /// Number of rows of pixels, margins included.
    pub fn rows(&self) -> usize {
        self.size[1] + 2 * self.margin
    }

    /// Number of rays in a row.
    pub fn rays_per_row(&self) -> usize {
        self.columns() * PER_PIXEL
    }

    /// Number of cones in a row of pixels.
    pub fn cones_per_row(&self) -> usize {
        self.columns().div_ceil(CONE_PX)
    }

    /// Returns the position in the picture of the ray with this index along a side, pixels.
    fn place(&self, index: usize) -> f64 {
        (index as f64 + 0.5) / PER_PIXEL as f64 - 0.5 - self.margin as f64
    }
}

/// Casts the rays of the true lens: one set if all colours have the same magnification, else one per colour.
pub fn cast(truth: &Truth, frame: Frame) -> Vec<Rays> {
    let alike = truth.magnification == [1.0; 3];
    let sets = if alike { vec![vec![0, 1, 2]] } else { vec![vec![0], vec![1], vec![2]] };
    sets.into_iter()
        .map(|channels| {
            let directions = directions(truth, frame, truth.magnification[channels[0]]);
            Rays { cones: cones(&directions, frame), channels, directions }
        })
        .collect()
}

fn directions(truth: &Truth, frame: Frame, magnification: f64) -> Vec<Vec3> {
    let largest_radius = truth.lens.largest_radius();
    let width = frame.rays_per_row();
    let mut directions = vec![Vec3::ZERO; width * frame.rows() * PER_PIXEL];
    directions.par_chunks_mut(width).enumerate().for_each(|(row, rays)| {
        for (column, ray) in rays.iter_mut().enumerate() {
            let pixel = DVec2::new(frame.place(column), frame.place(row));
            // This is the pixel at which a lens without dents and with one magnification would see the same.
            let undented = pixel + truth.dents.iter().map(|dent| dent.at(pixel)).sum::<DVec2>();
            let center = truth.lens.center_px;
            let place = center + (undented - center) / magnification;
            *ray = truth.lens.ray(place, largest_radius).map_or(Vec3::ZERO, DVec3::as_vec3);
        }
    });
    directions
}

fn cones(directions: &[Vec3], frame: Frame) -> Vec<Cone> {
    let width = frame.rays_per_row();
    let rows = directions.chunks(width * PER_PIXEL);
    rows.flat_map(|rows| {
        (0..frame.cones_per_row()).map(move |cone| {
            let from = cone * CONE_PX * PER_PIXEL;
            let to = (from + CONE_PX * PER_PIXEL).min(width);
            cone_of(rows.chunks(width).flat_map(|row| &row[from..to]))
        })
    })
    .collect()
}

fn cone_of<'a>(rays: impl Iterator<Item = &'a Vec3> + Clone) -> Cone {
    let axis = rays.clone().copied().sum::<Vec3>().normalize_or_zero();
    let lit = rays.filter(|ray| **ray != Vec3::ZERO);
    let half_angle_rad = lit.map(|ray| axis.angle_between(*ray)).fold(0.0, f32::max);
    Cone { axis, half_angle_rad }
}
