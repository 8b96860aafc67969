//! The images of one sector of headings, triangulated by where they were taken.

use std::{collections::HashMap, f64::consts::TAU};

use reality_sim_core::pose::CameraPose;
use spade::{
    DelaunayTriangulation, HasPosition, HierarchyHintGenerator, Point2, Triangulation,
    handles::FixedVertexHandle,
};

use super::ImageIndex;

/// Sectors of a turn. With an eighth a heading lies at most a quarter of a turn's half from the images of its two sectors:
/// less than the view of any wide lens.
pub(super) const SECTORS: usize = 8;

/// A place and the images taken there.
#[derive(Debug, Clone)]
pub(super) struct Spot {
    position: Point2<f64>,
    /// First and end in [`Sector::items`].
    items: [u32; 2],
}

impl HasPosition for Spot {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

type Delaunay = DelaunayTriangulation<Spot, (), (), (), HierarchyHintGenerator<f64>>;

/// The images whose heading lies in one sector.
#[derive(Debug)]
pub(super) struct Sector {
    delaunay: Delaunay,
    items: Vec<ImageIndex>,
    /// No image lies farther from its spot, metres.
    pub(super) spot_m: f64,
    /// Heading of the middle, radians.
    pub(super) middle_rad: f64,
}

/// The two sectors between whose middles a heading lies, with their shares.
pub(super) fn around(yaw_rad: f64) -> [(usize, f64); 2] {
    let turned = (yaw_rad / TAU).rem_euclid(1.0) * SECTORS as f64;
    let first = turned.floor();
    let share = turned - first;
    let first = first as usize % SECTORS;
    [(first, 1.0 - share), ((first + 1) % SECTORS, share)]
}

/// The sector in which a heading lies.
fn of(yaw_rad: f64) -> usize {
    ((yaw_rad / TAU).rem_euclid(1.0) * SECTORS as f64).round() as usize % SECTORS
}

impl Sector {
    /// The images of a sector. Those in one cell of a grid with this diagonal, metres, share a spot.
    pub(super) fn new(number: usize, poses: &[CameraPose], spot_m: f64) -> Self {
        let cell_m = spot_m / std::f64::consts::SQRT_2;
        let mut spots: HashMap<[i64; 2], Vec<ImageIndex>> = HashMap::new();
        for (image, pose) in poses.iter().enumerate() {
            if pose.is_finite() && of(pose.yaw_rad) == number {
                let cell = [pose.x_m, pose.y_m].map(|metres| (metres / cell_m).floor() as i64);
                spots.entry(cell).or_default().push(image as ImageIndex);
            }
        }
        let mut spots: Vec<([i64; 2], Vec<ImageIndex>)> = spots.into_iter().collect();
        spots.sort_unstable_by_key(|(cell, _)| *cell);
        let (vertices, items) = vertices(&spots, poses);
        // Cells keep places apart, and none is NaN: all that could be refused are coordinates beyond 10⁶⁰.
        let delaunay = Delaunay::bulk_load_stable(vertices).unwrap_or_default();
        let middle_rad = TAU * number as f64 / SECTORS as f64;
        Self { delaunay, items, spot_m, middle_rad }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.delaunay.num_vertices() == 0
    }

    /// The images at the natural neighbours of a place, with the weights of these; the nearest alone outside the hull.
    pub(super) fn natural_spots(&self, pose: CameraPose) -> Vec<(&[ImageIndex], f64)> {
        let place = Point2::new(pose.x_m, pose.y_m);
        let mut weights = Vec::new();
        self.delaunay.natural_neighbor().get_weights(place, &mut weights);
        if weights.is_empty() {
            weights.extend(self.delaunay.nearest_neighbor(place).map(|vertex| (vertex.fix(), 1.0)));
        }
        weights.into_iter().map(|(vertex, weight)| (self.images_at(vertex), weight)).collect()
    }

    /// The spot nearest to a place, from which all others are reached.
    pub(super) fn first(&self, pose: CameraPose) -> Option<FixedVertexHandle> {
        self.delaunay.nearest_neighbor(Point2::new(pose.x_m, pose.y_m)).map(|vertex| vertex.fix())
    }

    /// The spots joined to one by an edge, with their distances from a place, metres.
    pub(super) fn joined(
        &self,
        spot: FixedVertexHandle,
        pose: CameraPose,
    ) -> impl Iterator<Item = (FixedVertexHandle, f64)> {
        self.delaunay.vertex(spot).out_edges().map(move |edge| {
            let vertex = edge.to();
            (vertex.fix(), distance_m(vertex.position(), pose))
        })
    }

    /// Distance of a spot from a place, metres.
    pub(super) fn distance_m(&self, spot: FixedVertexHandle, pose: CameraPose) -> f64 {
        distance_m(self.delaunay.vertex(spot).position(), pose)
    }

    /// The images at a spot.
    pub(super) fn images_at(&self, spot: FixedVertexHandle) -> &[ImageIndex] {
        let [first, end] = self.delaunay.vertex(spot).data().items;
        &self.items[first as usize..end as usize]
    }

    pub(super) fn edges(&self) -> impl Iterator<Item = [[f64; 2]; 2]> {
        self.delaunay.undirected_edges().map(|edge| edge.positions().map(|position| [position.x, position.y]))
    }
}

fn distance_m(position: Point2<f64>, pose: CameraPose) -> f64 {
    (position.x - pose.x_m).hypot(position.y - pose.y_m)
}

/// A vertex a spot, at the mean of its images' places, and all images in the order of the vertices.
fn vertices(spots: &[([i64; 2], Vec<ImageIndex>)], poses: &[CameraPose]) -> (Vec<Spot>, Vec<ImageIndex>) {
    let mut vertices = Vec::with_capacity(spots.len());
    let mut items = Vec::new();
    for (_, images) in spots {
        let mean = |coordinate: fn(&CameraPose) -> f64| {
            images.iter().map(|&image| coordinate(&poses[image as usize])).sum::<f64>() / images.len() as f64
        };
        let position = Point2::new(mean(|pose| pose.x_m), mean(|pose| pose.y_m));
        let first = items.len() as u32;
        items.extend_from_slice(images);
        vertices.push(Spot { position, items: [first, items.len() as u32] });
    }
    (vertices, items)
}
