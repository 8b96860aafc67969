//! The usual alternative to our index: a kd-tree over points whose Euclidean distances approximate the metric. It proposes
//! candidates, from which the metric chooses.

use kdtree::{KdTree, distance::squared_euclidean};
use reality_sim::CameraPose;
use reality_sim::db::metric::PixelMetric;

/// Number of coordinates: place, the heading as a point on a circle, height, pitch and roll, pixels.
const AXES: usize = 7;

/// Embedding of poses as points.
#[derive(Debug, Clone, Copy)]
struct Embedding {
    px_per_m: f64,
    px_per_rad: f64,
    px_per_attitude: [f64; 3],
}

impl Embedding {
    /// Scales every motion by how far it alone moves the picture; forward and left share their mean.
    fn new(metric: &PixelMetric) -> Self {
        let matrix = metric.matrix();
        let [_, _, px_per_rad, height, pitch, roll] = std::array::from_fn(|axis| matrix[(axis, axis)].sqrt());
        let px_per_m = (0.5 * (matrix[(0, 0)] + matrix[(1, 1)])).sqrt();
        Self { px_per_m, px_per_rad, px_per_attitude: [height, pitch, roll] }
    }

    fn point(self, pose: CameraPose) -> [f64; AXES] {
        let (sin, cos) = pose.yaw_rad.sin_cos();
        let [height, pitch, roll] = self.px_per_attitude;
        [
            self.px_per_m * pose.x_m,
            self.px_per_m * pose.y_m,
            self.px_per_rad * cos,
            self.px_per_rad * sin,
            height * pose.height_m,
            pitch * pose.pitch_rad,
            roll * pose.roll_rad,
        ]
    }
}

/// Index that usually finds the nearest images by pose.
pub struct KdIndex {
    tree: KdTree<f64, u32, [f64; AXES]>,
    embedding: Embedding,
    metric: PixelMetric,
    poses: Vec<CameraPose>,
}

impl KdIndex {
    /// Builds an index of images taken at these poses.
    pub fn new(metric: PixelMetric, poses: Vec<CameraPose>) -> Self {
        let embedding = Embedding::new(&metric);
        let mut tree = KdTree::new(AXES);
        for (image, &pose) in poses.iter().enumerate() {
            tree.add(embedding.point(pose), image as u32).expect("finite numbers");
        }
        Self { tree, embedding, metric, poses }
    }

    /// Returns the nearest images among this many candidates with their distances in pixels, nearest first.
    pub fn nearest(&self, pose: CameraPose, count: usize, candidates: usize) -> Vec<(u32, f64)> {
        let point = self.embedding.point(pose);
        let found = self.tree.nearest(&point, candidates, &squared_euclidean).expect("finite numbers");
        let mut found: Vec<(u32, f64)> = found
            .into_iter()
            .map(|(_, &image)| (image, self.metric.distance_px(self.poses[image as usize], pose)))
            .collect();
        found.sort_by(|a, b| a.1.total_cmp(&b.1));
        found.truncate(count);
        found
    }
}
