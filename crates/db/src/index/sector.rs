//! The images of one sector of headings, triangulated by where they were taken.

use std::f64::consts::TAU;

use glam::DVec2;
use reality_sim_core::pose::CameraPose;
use spade::{
    DelaunayTriangulation, HasPosition, HierarchyHintGenerator, Point2, Triangulation,
    handles::FixedVertexHandle,
};

use super::neighbour::ImageIndex;

/// Number of sectors of headings. With eight, a heading is at most an eighth of a turn from the centres of its two
/// sectors: less than the view of any wide lens.
pub(super) const SECTORS: usize = 8;

/// Place with the images taken there.
#[derive(Debug, Clone)]
pub(super) struct Spot {
    position: Point2<f64>,
    /// First and end index in [`Sector::items`].
    items: [u32; 2],
}

impl HasPosition for Spot {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

type Delaunay = DelaunayTriangulation<Spot, (), (), (), HierarchyHintGenerator<f64>>;

/// Images whose heading lies in one sector.
#[derive(Debug)]
pub(super) struct Sector {
    delaunay: Delaunay,
    items: Vec<ImageIndex>,
}

/// Returns the two sectors between whose centres a heading lies, with their shares.
pub(super) fn around(yaw_rad: f64) -> [(usize, f64); 2] {
    let turned = (yaw_rad / TAU).rem_euclid(1.0) * SECTORS as f64;
    let first = turned.floor();
    let share = turned - first;
    let first = first as usize % SECTORS;
    [(first, 1.0 - share), ((first + 1) % SECTORS, share)]
}

/// Returns the sector that contains a heading.
fn of(yaw_rad: f64) -> usize {
    ((yaw_rad / TAU).rem_euclid(1.0) * SECTORS as f64).round() as usize % SECTORS
}

impl Sector {
    /// Builds the sector of this number. Images in the same cell of a grid with cells of this diagonal, metres, share a
    /// spot.
    pub(super) fn new(number: usize, poses: &[CameraPose], spot_m: f64) -> Self {
        let cell_m = spot_m / std::f64::consts::SQRT_2;
        let in_sector =
            poses.iter().zip(0..).filter(|(pose, _)| pose.is_finite() && of(pose.yaw_rad) == number);
        let mut spotted: Vec<Spotted> = in_sector
            .map(|(pose, image)| {
                let cell = [pose.x_m, pose.y_m].map(|metres| (metres / cell_m).floor() as i64);
                Spotted { place_on_curve: place_on_curve(cell), cell, image }
            })
            .collect();
        spotted.sort_unstable();
        let vertices = vertices(&spotted, poses);
        // Cells keep places apart, and none is NaN. Only coordinates beyond 10⁶⁰, or below 10⁻⁴³ but not 0, could be
        // refused.
        let delaunay = Delaunay::bulk_load_stable(vertices).unwrap_or_default();
        let mut items: Vec<ImageIndex> = spotted.into_iter().map(|spotted| spotted.image).collect();
        // They were collected in the memory of the larger items.
        items.shrink_to_fit();
        Self { delaunay, items }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.delaunay.num_vertices() == 0
    }

    /// Returns the images at the natural neighbours of a place, with their weights; outside the hull only the nearest one.
    pub(super) fn natural_spots(&self, pose: CameraPose) -> Vec<(&[ImageIndex], f64)> {
        let place = Point2::new(pose.x_m, pose.y_m);
        let mut weights = Vec::new();
        // With a single vertex there is no edge to start from, and spade needs one.
        if self.delaunay.num_vertices() > 1 {
            self.delaunay.natural_neighbor().get_weights(place, &mut weights);
        }
        if weights.is_empty() {
            weights.extend(self.delaunay.nearest_neighbor(place).map(|vertex| (vertex.fix(), 1.0)));
        }
        weights.into_iter().map(|(vertex, weight)| (self.images_at(vertex), weight)).collect()
    }

    /// Returns the edges between spots in the world frame, metres.
    pub(super) fn edges_in_world(&self) -> Vec<[DVec2; 2]> {
        let ends = self.delaunay.undirected_edges().map(|edge| edge.positions());
        ends.map(|ends| ends.map(|end| DVec2::new(end.x, end.y))).collect()
    }

    /// Returns the images at a spot.
    pub(super) fn images_at(&self, spot: FixedVertexHandle) -> &[ImageIndex] {
        let [first, end] = self.delaunay.vertex(spot).data().items;
        &self.items[first as usize..end as usize]
    }
}

/// Image with its cell of the grid, in the order in which spots are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Spotted {
    place_on_curve: u64,
    cell: [i64; 2],
    image: ImageIndex,
}

/// Position of a cell on Morton's curve, so that neighbouring spots are stored near each other: this saves a tenth of the
/// time of natural neighbours among a million images, most of which is spent waiting for memory.
fn place_on_curve(cell: [i64; 2]) -> u64 {
    let [even, odd] =
        cell.map(|number| (0..32).fold(0, |spread, bit| spread | ((number as u64 >> bit) & 1) << (2 * bit)));
    even | odd << 1
}

/// Makes one vertex per spot, at the mean of its images' places.
fn vertices(spotted: &[Spotted], poses: &[CameraPose]) -> Vec<Spot> {
    let mut first = 0;
    let spots = spotted.chunk_by(|a, b| a.cell == b.cell).map(|images| {
        let sum = |coordinate: fn(&CameraPose) -> f64| {
            images.iter().map(|spotted| coordinate(&poses[spotted.image as usize])).sum::<f64>()
        };
        let mean = |coordinate| sum(coordinate) / images.len() as f64;
        let items = [first, first + images.len() as u32];
        first = items[1];
        Spot { position: Point2::new(mean(|pose| pose.x_m), mean(|pose| pose.y_m)), items }
    });
    spots.collect()
}
