//! Search for the images that were recorded near a pose.
//!
//! Distances are measured by [`PixelMetric`]. The nearest images are found with a tree. Natural neighbours and their
//! weights (Sibson, 1981) come from Delaunay triangulations of where the images were taken, one for each sector of
//! headings; the two sectors on both sides of the heading are mixed in proportion, so that the weights change smoothly
//! with x, y and yaw. Images of one sector at nearly the same place share a vertex, a *spot*; all of them are kept.

mod nearest;
mod neighbour;
mod sector;

use glam::DVec2;
use rayon::prelude::*;
use reality_sim_core::pose::CameraPose;

pub use self::neighbour::{ImageIndex, Neighbour, NoNeighbours};
use self::{
    nearest::NearestTree,
    sector::{SECTORS, Sector},
};
use crate::metric::PixelMetric;

/// Distance within which images share a spot, pixels: the difference is invisible.
const SPOT_PX: f64 = 1.0;

/// Delaunay triangulation of one sector's spots, in which the natural neighbours of a heading are found.
#[derive(Debug, Clone, PartialEq)]
pub struct SectorTriangulation {
    /// Share of the sector at the heading; the shares of both sectors sum to 1.
    pub share: f64,
    /// Edges between spots in the world frame, metres.
    pub edges_in_world: Vec<[DVec2; 2]>,
}

/// Index of images by pose.
#[derive(Debug)]
pub struct PoseIndex {
    metric: PixelMetric,
    poses: Vec<CameraPose>,
    sectors: Vec<Sector>,
    tree: NearestTree,
}

impl PoseIndex {
    /// Builds an index of images taken at these poses. Poses with numbers that are not finite are never found.
    pub fn new(metric: PixelMetric, poses: Vec<CameraPose>) -> Self {
        let spot_m = metric.reach_m(SPOT_PX);
        let (tree, sectors) = rayon::join(
            || NearestTree::new(&metric, &poses),
            || (0..SECTORS).into_par_iter().map(|number| Sector::new(number, &poses, spot_m)).collect(),
        );
        Self { metric, poses, sectors, tree }
    }

    /// Returns the poses of the images.
    pub fn poses(&self) -> &[CameraPose] {
        &self.poses
    }

    /// Returns the metric that distances are measured by.
    pub fn metric(&self) -> &PixelMetric {
        &self.metric
    }

    /// Returns the nearest image if it is not farther than this, root mean square pixels.
    pub fn check_reach(&self, pose: CameraPose, limit_px: f64) -> Result<Neighbour, NoNeighbours> {
        let nearest = self.nearest(pose, 1)?[0];
        let Neighbour { distance_px, .. } = nearest;
        if distance_px <= limit_px {
            Ok(nearest)
        } else {
            Err(NoNeighbours::OutOfReach { distance_px, limit_px })
        }
    }

    /// Returns the nearest images, nearest first, with equal weights: `count` of them, or all if there are fewer.
    pub fn nearest(&self, pose: CameraPose, count: usize) -> Result<Vec<Neighbour>, NoNeighbours> {
        self.check(pose)?;
        let found = self.tree.search(&self.metric, pose, count.max(1));
        let weight = 1.0 / found.len() as f64;
        Ok(found.into_iter().map(|(image, distance_px)| Neighbour { image, distance_px, weight }).collect())
    }

    /// Returns the natural neighbours with their weights, largest weight first. Outside the convex hull of a sector's
    /// images, the nearest of them takes their place.
    pub fn natural(&self, pose: CameraPose) -> Result<Vec<Neighbour>, NoNeighbours> {
        self.check(pose)?;
        let mut neighbours: Vec<Neighbour> = Vec::new();
        for (sector, share) in self.sectors_around(pose.yaw_rad) {
            for (items, weight) in sector.natural_spots(pose) {
                let (image, distance_px) = self.nearest_of(items, pose);
                neighbours.push(Neighbour { image, distance_px, weight: share * weight });
            }
        }
        if neighbours.is_empty() {
            return self.nearest(pose, 1);
        }
        neighbours.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        Ok(neighbours)
    }

    /// Returns the triangulations that [`PoseIndex::natural`] mixes at a heading, radians: at most two. The time is
    /// proportional to the number of images in the two sectors.
    pub fn triangulations(&self, yaw_rad: f64) -> Vec<SectorTriangulation> {
        if !yaw_rad.is_finite() {
            return Vec::new();
        }
        let sectors = self.sectors_around(yaw_rad);
        sectors
            .map(|(sector, share)| SectorTriangulation { share, edges_in_world: sector.edges_in_world() })
            .collect()
    }

    fn check(&self, pose: CameraPose) -> Result<(), NoNeighbours> {
        if !pose.is_finite() {
            return Err(NoNeighbours::NotFinite);
        }
        if self.tree.is_empty() { Err(NoNeighbours::NoImages) } else { Ok(()) }
    }

    /// Returns the two sectors between whose centres a heading lies, with shares that sum to 1. An empty sector leaves its
    /// share to the other.
    fn sectors_around(&self, yaw_rad: f64) -> impl Iterator<Item = (&Sector, f64)> {
        let [(a, share_a), (b, share_b)] = sector::around(yaw_rad);
        let (a, b) = (&self.sectors[a], &self.sectors[b]);
        let shares = match (a.is_empty(), b.is_empty()) {
            (false, false) => [share_a, share_b],
            (a_is_empty, b_is_empty) => [f64::from(u8::from(!a_is_empty)), f64::from(u8::from(!b_is_empty))],
        };
        [(a, shares[0]), (b, shares[1])].into_iter().filter(|(_, share)| *share > 0.0)
    }

    /// Returns the nearest of some images, of which there is at least one.
    fn nearest_of(&self, items: &[ImageIndex], pose: CameraPose) -> (ImageIndex, f64) {
        let distance =
            |&image: &ImageIndex| (image, self.metric.distance_px(self.poses[image as usize], pose));
        items.iter().map(distance).fold((0, f64::INFINITY), |a, b| if b.1 < a.1 { b } else { a })
    }
}

#[cfg(test)]
mod tests;
