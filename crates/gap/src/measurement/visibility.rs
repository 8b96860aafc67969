//! Visibility: whether a piece of line or a block of carpet is alone in the picture, so that it can be measured.

use glam::{DVec2, DVec3};
use reality_sim_core::field::{GoalPost, LineSample, VisibleSample};

use crate::{
    measurement::{camera::FrameCamera, quantity::ColorChannel},
    thresholds::{Thresholds, VisibilityThresholds},
};

const THRESHOLDS: VisibilityThresholds = Thresholds::DEFAULT.measurement.visibility;

/// Objects on the field that may be in the way of a measurement, as one camera sees them.
pub(crate) struct Visibility<'a> {
    camera: &'a FrameCamera<'a>,
    /// Projection centre in the world, metres.
    camera_in_world: DVec3,
    /// Half the extent of the carpet, metres.
    half_extent_m: DVec2,
    line_width_m: f64,
    /// Half the field's length, metres.
    half_length_m: f64,
    /// Half the width of the space for goals and nets behind a goal line, metres.
    half_net_m: f64,
    marks: [DVec2; 3],
    posts: Vec<GoalPost>,
}

impl<'a> Visibility<'a> {
    pub(crate) fn new(camera: &'a FrameCamera<'a>) -> Self {
        let field = camera.chain.field();
        Self {
            camera,
            camera_in_world: camera.pose.position_in_world(),
            half_extent_m: field.carpet_half_extent_m(),
            line_width_m: field.line_width_m,
            half_length_m: 0.5 * field.length_m,
            half_net_m: 0.5 * field.goal_width_m + THRESHOLDS.net_m,
            marks: field.marks(),
            posts: field.goals().into_iter().flat_map(|goal| goal.posts).collect(),
        }
    }

    /// Whether the profile of a piece of line contains nothing else: no other line, mark, edge of the carpet or goal.
    pub(crate) fn stands_alone(&self, visible: &VisibleSample) -> bool {
        let LineSample { point_in_world, clearance_m, .. } = visible.sample;
        let blur_px = self.camera.chain.psf_variance_px2(visible.pixel).sqrt();
        let needed_px = visible.half_width_px + THRESHOLDS.flank_px + THRESHOLDS.flank_sigmas * blur_px;
        let to_marks = self.marks.into_iter().map(|mark| mark.distance(point_in_world) - THRESHOLDS.mark_m);
        let to_edge_m = (self.half_extent_m - point_in_world.abs()).min_element();
        let nearest_m =
            to_marks.fold(clearance_m.min(to_edge_m), f64::min).min(self.to_nets_m(point_in_world));
        let free_m = nearest_m - 0.5 * self.line_width_m;
        // A metre has fewer pixels on the far side of a line than on its near side.
        let is_free = |offset_m: f64| {
            let end = point_in_world + offset_m * visible.sample.normal_in_world();
            self.camera
                .project(end, ColorChannel::Green)
                .is_none_or(|pixel| pixel.distance(visible.pixel) > needed_px)
        };
        let needed_m = needed_px * 0.5 * self.line_width_m / visible.half_width_px;
        free_m > 0.0 && is_free(-free_m) && is_free(free_m) && self.off_posts(point_in_world, 0.0, needed_m)
    }

    /// Returns the point on the ground at the centre of a square of pixels. None unless the whole square shows plain carpet.
    pub(crate) fn plain_carpet(&self, corner: [u32; 2], side: u32) -> Option<DVec2> {
        let middle = DVec2::new(f64::from(corner[0]), f64::from(corner[1])) + 0.5 * f64::from(side - 1);
        let camera = self.camera.chain.camera();
        camera.check_inside(middle).ok()?;
        let at = |pixel: DVec2| camera.unproject_to_ground(self.camera.pose, pixel).ok();
        let center = at(middle)?;
        // Lines must be farther than the square's farthest corner.
        let blur_px = self.camera.chain.psf_variance_px2(middle).sqrt();
        let reach_px =
            0.5 * f64::from(side) + THRESHOLDS.block_margin_px + THRESHOLDS.block_margin_sigmas * blur_px;
        let mut radius_m: f64 = 0.0;
        for offset in
            [DVec2::new(-1.0, -1.0), DVec2::new(1.0, -1.0), DVec2::new(-1.0, 1.0), DVec2::new(1.0, 1.0)]
        {
            radius_m = radius_m.max(at(middle + reach_px * offset)?.distance(center));
        }
        let free_m = radius_m + THRESHOLDS.carpet_margin_m + 0.5 * self.line_width_m;
        let inside = (center.abs() + radius_m + THRESHOLDS.carpet_margin_m).cmple(self.half_extent_m).all();
        let off_lines = self.camera.curves.iter().all(|curve| curve.distance_m(center) > free_m);
        let off_marks = self.marks.iter().all(|mark| mark.distance(center) > radius_m + THRESHOLDS.mark_m);
        (inside && off_lines && off_marks && self.off_posts(center, THRESHOLDS.post_margin_m, 0.0))
            .then_some(center)
    }

    /// Whether a pixel shows carpet, a line or a mark, and neither a goal nor anything beyond the carpet.
    pub(crate) fn shows_field(&self, pixel: DVec2) -> bool {
        let camera = self.camera.chain.camera();
        let ground = camera.unproject_to_ground(self.camera.pose, pixel);
        camera.check_inside(pixel).is_ok()
            && ground.is_ok_and(|ground| {
                ground.abs().cmple(self.half_extent_m).all()
                    && self.to_nets_m(ground) > 0.0
                    && self.off_posts(ground, THRESHOLDS.post_margin_m, 0.0)
            })
    }

    /// Returns the distance from a point to the space behind a goal line between the posts, metres. Nets and bars are there,
    /// which the file of a field does not describe.
    fn to_nets_m(&self, point: DVec2) -> f64 {
        let beyond_m = self.half_length_m + THRESHOLDS.net_m - point.x.abs();
        if point.y.abs() < self.half_net_m { beyond_m } else { f64::INFINITY }
    }

    /// Whether no post stands between the camera and a point on the ground. Posts are taken to be `thicker_m` thicker than they
    /// are, and the line of sight to have the half width `beside_m` at the point.
    fn off_posts(&self, ground: DVec2, thicker_m: f64, beside_m: f64) -> bool {
        let camera = self.camera_in_world.truncate();
        let to_ground = ground - camera;
        self.posts.iter().all(|post| {
            let fraction = ((post.center - camera).dot(to_ground) / to_ground.length_squared().max(1e-9))
                .clamp(0.0, 1.0);
            let distance_m = (camera + fraction * to_ground).distance(post.center);
            distance_m >= post.radius_m + thicker_m + fraction * beside_m
        })
    }
}
