//! Exact search for the nearest images by the metric, without a comparison with all of them.
//!
//! The tree is a kd-tree: the images are halved along the axis over which the picture moves most, until few are left. They
//! are compared by [`PixelMetric::least_px`], a lower bound of the distance that needs only place and heading and no
//! sines; boxes and images whose bound is too large are skipped. Among a million images, 80 are compared and the distance
//! of 12 is computed. Bounds that include height, pitch and roll skip more, but cost several times as much.

use std::f64::consts::TAU;

use glam::DVec2;
use reality_sim_core::pose::CameraPose;

use super::neighbour::ImageIndex;
use crate::metric::{PixelMetric, shorter_turn};

/// Smallest number of images in a leaf; the largest is nearly twice that.
const LEAF_IMAGES: usize = 8;

/// Kd-tree of images by pose.
#[derive(Debug)]
pub(super) struct NearestTree {
    /// Images of the leaves, one leaf after the other. Poses are copied: looking them up elsewhere among a million would
    /// wait for memory each time.
    images: Vec<(CameraPose, ImageIndex)>,
    /// Boxes of the nodes; the two halves of box n are at 2n + 1 and 2n + 2.
    boxes: Vec<PlanarBox>,
}

impl NearestTree {
    /// Builds the tree of images taken at these poses, without those whose numbers are not finite.
    pub(super) fn new(metric: &PixelMetric, poses: &[CameraPose]) -> Self {
        let finite = poses.iter().zip(0..).filter(|(pose, _)| pose.is_finite());
        let mut images: Vec<(CameraPose, ImageIndex)> = finite
            .map(|(&pose, image)| (CameraPose { yaw_rad: pose.yaw_rad.rem_euclid(TAU), ..pose }, image))
            .collect();
        // It grew by doubling.
        images.shrink_to_fit();
        let leaves = 1 << (images.len() / LEAF_IMAGES).max(1).ilog2();
        let mut boxes = vec![PlanarBox::default(); 2 * leaves - 1];
        split(metric, &mut boxes, 0, &mut images);
        Self { images, boxes }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.images.is_empty()
    }

    /// Returns images and distances, pixels, nearest first: `count` of them, or all if there are fewer.
    pub(super) fn search(
        &self,
        metric: &PixelMetric,
        pose: CameraPose,
        count: usize,
    ) -> Vec<(ImageIndex, f64)> {
        let count = count.min(self.images.len());
        let mut search =
            Search { boxes: &self.boxes, metric, pose, found: Vec::with_capacity(count + 1), count };
        search.enter(0, &self.images);
        search.found
    }
}

/// Sorts images into the order of the leaves and writes the boxes, from the one at `node` downwards.
fn split(
    metric: &PixelMetric,
    boxes: &mut [PlanarBox],
    node: usize,
    images: &mut [(CameraPose, ImageIndex)],
) {
    boxes[node] = PlanarBox::around(images);
    if 2 * node + 1 >= boxes.len() {
        return;
    }
    let [x_m, y_m, yaw_rad] = boxes[node].half;
    let widths_px = [metric.least_px(x_m, 0.0), metric.least_px(y_m, 0.0), metric.least_px(0.0, yaw_rad)];
    let widest = (0..3).max_by(|&a, &b| widths_px[a].total_cmp(&widths_px[b])).unwrap_or_default();
    let middle = images.len() / 2;
    images.select_nth_unstable_by(middle, |(a, _), (b, _)| planar(a)[widest].total_cmp(&planar(b)[widest]));
    let (first, second) = images.split_at_mut(middle);
    split(metric, boxes, 2 * node + 1, first);
    split(metric, boxes, 2 * node + 2, second);
}

/// Returns x, y and yaw, metres and radians.
fn planar(pose: &CameraPose) -> [f64; 3] {
    [pose.x_m, pose.y_m, pose.yaw_rad]
}

/// Box of places and headings, metres and radians.
#[derive(Debug, Clone, Copy, Default)]
struct PlanarBox {
    middle: [f64; 3],
    half: [f64; 3],
}

impl PlanarBox {
    fn around(images: &[(CameraPose, ImageIndex)]) -> Self {
        let bound = |axis: usize, start: f64, choose: fn(f64, f64) -> f64| {
            images.iter().map(|(pose, _)| planar(pose)[axis]).fold(start, choose)
        };
        let min: [f64; 3] = std::array::from_fn(|axis| bound(axis, f64::INFINITY, f64::min));
        let max: [f64; 3] = std::array::from_fn(|axis| bound(axis, f64::NEG_INFINITY, f64::max));
        Self {
            middle: std::array::from_fn(|axis| 0.5 * (min[axis] + max[axis])),
            half: std::array::from_fn(|axis| 0.5 * (max[axis] - min[axis])),
        }
    }

    /// Lower bound of the distance to any pose in the box, pixels.
    fn bound_px(&self, metric: &PixelMetric, pose: CameraPose) -> f64 {
        let [x_m, y_m, yaw_rad] = self.middle;
        let outside = |away: f64, axis: usize| (away.abs() - self.half[axis]).max(0.0);
        let plane_m = DVec2::new(outside(pose.x_m - x_m, 0), outside(pose.y_m - y_m, 1));
        metric.least_px(plane_m.length(), outside(shorter_turn(pose.yaw_rad - yaw_rad), 2))
    }
}

/// Nearest images that a search has found so far.
struct Search<'a> {
    boxes: &'a [PlanarBox],
    metric: &'a PixelMetric,
    pose: CameraPose,
    found: Vec<(ImageIndex, f64)>,
    count: usize,
}

impl Search<'_> {
    /// Searches the images of a box, the half with the smaller bound first.
    fn enter(&mut self, node: usize, images: &[(CameraPose, ImageIndex)]) {
        let [first, second] = [2 * node + 1, 2 * node + 2];
        if second >= self.boxes.len() {
            images.iter().for_each(|image| self.offer(*image));
            return;
        }
        let (firsts, seconds) = images.split_at(images.len() / 2);
        let [first_px, second_px] =
            [first, second].map(|half| self.boxes[half].bound_px(self.metric, self.pose));
        let mut halves = [(first_px, first, firsts), (second_px, second, seconds)];
        if second_px < first_px {
            halves.swap(0, 1);
        }
        for (bound_px, half, images) in halves {
            if self.may_take(bound_px) {
                self.enter(half, images);
            }
        }
    }

    /// Whether an image at this distance, pixels, can be one of the nearest: as long as there are too few, any can.
    fn may_take(&self, distance_px: f64) -> bool {
        self.found.get(self.count - 1).is_none_or(|(_, last_px)| distance_px < *last_px)
    }

    fn offer(&mut self, (pose, image): (CameraPose, ImageIndex)) {
        let away_m = DVec2::new(pose.x_m - self.pose.x_m, pose.y_m - self.pose.y_m);
        let turn_rad = shorter_turn(pose.yaw_rad - self.pose.yaw_rad).abs();
        if !self.may_take(self.metric.least_px(away_m.length(), turn_rad)) {
            return;
        }
        let distance_px = self.metric.distance_px(pose, self.pose);
        if self.may_take(distance_px) {
            let place = self.found.partition_point(|(_, other_px)| *other_px <= distance_px);
            self.found.insert(place, (image, distance_px));
            self.found.truncate(self.count);
        }
    }
}
