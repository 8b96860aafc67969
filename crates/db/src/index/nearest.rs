//! The nearest images by the metric, exactly, without looking at all of them.
//!
//! Spots are visited in the order of a lower bound of their images' distances. In a Delaunay triangulation every spot has
//! an edge to one that is nearer to the place asked for, unless it is the nearest itself: from that one, edges lead to all
//! others in the order of their distances in the plane, of which the bound is a multiple.

use std::{
    cmp::Ordering,
    collections::{BinaryHeap, HashSet},
};

use reality_sim_core::pose::{CameraPose, wrap_angle};
use spade::handles::FixedVertexHandle;

use super::{
    ImageIndex, PoseIndex,
    sector::{SECTORS, Sector},
};

/// A spot to visit, the one with the least bound first.
struct Pending {
    bound_px: f64,
    sector: usize,
    /// None for a sector that has not been entered.
    spot: Option<FixedVertexHandle>,
}

impl PartialEq for Pending {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Pending {}

impl PartialOrd for Pending {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Pending {
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound_px.total_cmp(&self.bound_px)
    }
}

/// Images and distances, pixels, nearest first.
pub(super) fn search(index: &PoseIndex, pose: CameraPose, count: usize) -> Vec<(ImageIndex, f64)> {
    let mut found = Nearest { images: Vec::with_capacity(count + 1), count };
    let mut seen = HashSet::new();
    let mut pending = BinaryHeap::new();
    for (sector, images) in index.sectors.iter().enumerate().filter(|(_, images)| !images.is_empty()) {
        pending.push(Pending { bound_px: sector_bound_px(index, images, pose), sector, spot: None });
    }
    while let Some(Pending { bound_px, sector, spot }) = pending.pop() {
        if bound_px >= found.limit_px() {
            break;
        }
        let images = &index.sectors[sector];
        let sector_px = sector_bound_px(index, images, pose);
        let mut visit = |spot, distance_m: f64| {
            if seen.insert((sector, spot)) {
                let spot_px = index.metric.least_distance_px((distance_m - images.spot_m).max(0.0));
                pending.push(Pending { bound_px: spot_px.max(sector_px), sector, spot: Some(spot) });
            }
        };
        match spot {
            None => {
                if let Some(first) = images.first(pose) {
                    visit(first, images.distance_m(first, pose));
                }
            }
            Some(spot) => {
                for &image in images.images_at(spot) {
                    found.offer(image, index.metric.distance_px(index.poses[image as usize], pose));
                }
                images.joined(spot, pose).for_each(|(spot, distance_m)| visit(spot, distance_m));
            }
        }
    }
    found.images
}

/// No image of a sector is nearer.
fn sector_bound_px(index: &PoseIndex, sector: &Sector, pose: CameraPose) -> f64 {
    let half_sector_rad = std::f64::consts::PI / SECTORS as f64;
    let away_rad = wrap_angle(pose.yaw_rad - sector.middle_rad).abs();
    index.metric.least_turn_px((away_rad - half_sector_rad).max(0.0))
}

/// The nearest so far.
struct Nearest {
    images: Vec<(ImageIndex, f64)>,
    count: usize,
}

impl Nearest {
    fn limit_px(&self) -> f64 {
        if self.images.len() < self.count { f64::INFINITY } else { self.images[self.count - 1].1 }
    }

    fn offer(&mut self, image: ImageIndex, distance_px: f64) {
        if distance_px < self.limit_px() {
            let place = self.images.partition_point(|(_, other_px)| *other_px <= distance_px);
            self.images.insert(place, (image, distance_px));
            self.images.truncate(self.count);
        }
    }
}
