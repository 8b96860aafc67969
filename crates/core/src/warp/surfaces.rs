//! Which surface of the scene each pixel sees, and how far away it is.

use super::{
    Target,
    kernel::{CEILING, FIRST_BILLBOARD, GROUND, ProxyPoints, proxy_points},
};
use crate::camera::{LANES, Lanes};

/// Surface of the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Surface {
    /// None: the lens leaves the pixel black.
    #[default]
    Nothing,
    /// The ground: carpet, and the hall's floor beside it.
    Ground,
    /// Posts and crossbar of a goal.
    GoalFrame,
    /// Back of a goal: its net, or what stands for it.
    GoalBack,
    /// Wall of the hall, and whatever stands in front of it.
    Wall,
    /// Ceiling of the hall.
    Ceiling,
}

/// What sixteen neighbouring pixels of a row see.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceBlock {
    /// Surfaces.
    pub surface: [Surface; LANES],
    /// Distances along the rays, metres; NaN where a pixel sees nothing.
    pub distance_m: Lanes,
    /// Points in the world, metres; NaN where a pixel sees nothing.
    pub point_in_world: [Lanes; 3],
}

impl Target<'_> {
    /// Returns what the sixteen pixels from column 16 × `block` on see. Pixels beyond the row's end see nothing.
    ///
    /// # Panics
    ///
    /// Panics if the camera has no such row or block.
    pub fn surfaces(&self, row: usize, block: usize) -> SurfaceBlock {
        let points = proxy_points(self.proxy, &self.placement, &self.rays.row(row)[block]);
        let mut surface = [Surface::Nothing; LANES];
        for (lane, surface) in surface.iter_mut().enumerate() {
            *surface = self.surface(&points, lane);
        }
        let distance_m = std::array::from_fn(|lane| match surface[lane] {
            Surface::Nothing => f32::NAN,
            _ => points.distance[lane],
        });
        SurfaceBlock { surface, distance_m, point_in_world: points.place }
    }

    fn surface(&self, points: &ProxyPoints, lane: usize) -> Surface {
        let number = points.surface[lane];
        if points.direction[2][lane].is_nan() {
            Surface::Nothing
        } else if number == GROUND {
            Surface::Ground
        } else if number == CEILING {
            Surface::Ceiling
        } else if number < FIRST_BILLBOARD as f32 {
            Surface::Wall
        } else {
            match self.proxy.billboards.get(number as usize - FIRST_BILLBOARD) {
                Some(billboard) if billboard.opening_half_width_m > 0.0 => Surface::GoalFrame,
                _ => Surface::GoalBack,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::*;
    use crate::{
        camera::{Camera, Distortion, OpencvFisheye},
        field::FieldDimensions,
        pose::{CameraPose, Pose2},
        warp::{Hall, Placement, ProxyGeometry, RayTable},
    };

    /// Returns surface and distance of a ray by one plane after the other.
    fn truth(proxy: &ProxyGeometry, from: DVec3, ray: DVec3) -> (Surface, f64) {
        let mut seen = (Surface::Nothing, f64::INFINITY);
        let mut meet = |surface, distance: f64| {
            if distance > 0.0 && distance < seen.1 {
                seen = (surface, distance);
            }
        };
        meet(Surface::Ground, (proxy.min_in_world.z - from.z) / ray.z);
        meet(Surface::Ceiling, (proxy.max_in_world.z - from.z) / ray.z);
        for axis in 0..2 {
            meet(Surface::Wall, (proxy.min_in_world[axis] - from[axis]) / ray[axis]);
            meet(Surface::Wall, (proxy.max_in_world[axis] - from[axis]) / ray[axis]);
        }
        for (index, board) in proxy.billboards.iter().enumerate() {
            let distance = (board.x_m - from.x) / ray.x;
            let at = from + distance * ray;
            let opens = at.y.abs() < board.opening_half_width_m && at.z < board.opening_height_m;
            if at.y.abs() <= board.half_width_m && (0.0..=board.height_m).contains(&at.z) && !opens {
                meet([Surface::GoalFrame, Surface::GoalBack][index % 2], distance);
            }
        }
        seen
    }

    #[test]
    fn every_pixel_sees_the_first_surface_on_its_ray() {
        let field = FieldDimensions::preset("humanoid-kidsize-2010").unwrap();
        let proxy = ProxyGeometry::new(&Hall::usual(&field), &field);
        let lens = OpencvFisheye { k: [-0.058, 0.0082, -0.0009, 0.00005] };
        let camera =
            Camera::new([90, 60], [30.0, 30.0, 44.5, 29.5], Distortion::OpencvFisheye(lens)).unwrap();
        let rays = RayTable::new(&camera);
        let (mut counts, mut different) = (std::collections::HashMap::new(), 0);
        for yaw_rad in [0.0, 0.4, 2.9, -1.6] {
            let pose = CameraPose::new(Pose2::new(1.3, 0.2, yaw_rad), 0.52, 0.1, 0.05);
            let target = Target { rays: &rays, placement: Placement::new(pose), proxy: &proxy };
            for (row, block) in (0..60).flat_map(|row| (0..6).map(move |block| (row, block))) {
                let seen = target.surfaces(row, block);
                for lane in 0..LANES {
                    let pixel = DVec2::new((16 * block + lane) as f64, row as f64);
                    if pixel.x >= 90.0 {
                        assert_eq!(seen.surface[lane], Surface::Nothing);
                        assert!(seen.distance_m[lane].is_nan());
                        continue;
                    }
                    let ray = pose.rotation_world_from_camera() * camera.unproject(pixel).unwrap();
                    let (surface, distance_m) = truth(&proxy, pose.position_in_world(), ray);
                    *counts.entry(surface).or_insert(0) += 1;
                    // Rays through an edge may go either way.
                    if surface == seen.surface[lane] {
                        let off_m = (f64::from(seen.distance_m[lane]) - distance_m).abs();
                        assert!(off_m < 1e-4 * (1.0 + distance_m * distance_m), "{off_m}");
                    } else {
                        different += 1;
                    }
                }
            }
        }
        assert!(different <= 2, "{different}");
        for surface in
            [Surface::Ground, Surface::GoalFrame, Surface::GoalBack, Surface::Wall, Surface::Ceiling]
        {
            assert!(counts.get(&surface).is_some_and(|count| *count > 20), "{surface:?}: {counts:?}");
        }
    }
}
