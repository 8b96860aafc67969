//! White lines in one picture: the pieces that a model predicts, and their measurements.

use glam::DVec2;
use image::RgbImage;
use reality_sim_core::{
    field::{Curve, VisibleSample, sample_lines, visible_samples},
    preprocess::{Texture, luma},
};

use crate::{
    measurement::{
        camera::{FrameCamera, PixelVelocity},
        carpet::{self, CarpetBlock},
        curve_index::CurveIndex,
        line_profile::{self, LinePiece, Profile},
        line_search::{CoarseMatch, search},
        quantity::ColorChannel,
        visibility::Visibility,
    },
    thresholds::{LineThresholds, Thresholds},
};

const THRESHOLDS: LineThresholds = Thresholds::DEFAULT.measurement.line;
/// Variance of the blur by a pixel's own square aperture of side 1, pixels squared.
pub(crate) const APERTURE_PX2: f64 = 1.0 / 12.0;

/// Piece of line that the model predicts in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ExpectedLine {
    /// Curve of the field that it is a piece of.
    pub(crate) curve: CurveIndex,
    /// Half the width in the picture, pixels.
    pub(crate) half_width_px: f64,
    /// Whether it is occluded: its pixels show neither a line nor carpet.
    pub(crate) is_hidden: bool,
}

/// Piece of line that was measured.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    /// Curve of the field that it is a piece of.
    pub(crate) curve: CurveIndex,
    /// Position on the curve as a fraction of its length.
    pub(crate) fraction: f64,
    /// Point on the ground, world axes, metres.
    pub(crate) ground: DVec2,
    /// Predicted pixel of the middle.
    pub(crate) pixel: DVec2,
    /// Unit vector across the line in the picture.
    pub(crate) normal: DVec2,
    /// Speed of the image along the normal, pixels per second.
    pub(crate) speed_px_s: f64,
    pub(crate) profile: Profile,
    /// Half the width in the picture, pixels.
    pub(crate) half_width_px: f64,
    /// Whether it is far enough from the picture's border to count among the expected pieces.
    pub(crate) is_expected: bool,
}

impl Line {
    /// Returns the pixel at which the middle was found.
    pub(crate) fn measured_px(&self) -> DVec2 {
        self.pixel + self.profile.offset_px * self.normal
    }
}

/// Returns the curve of the field that a sample is a piece of.
pub(crate) fn curve_of(visible: &VisibleSample) -> CurveIndex {
    CurveIndex(visible.sample.curve)
}

/// Returns the pieces of line that the model predicts in the picture with nothing else in their profiles.
pub(crate) fn expected_lines(camera: &FrameCamera<'_>) -> Vec<VisibleSample> {
    let field = camera.chain.field();
    let visibility = Visibility::new(camera);
    let samples = sample_lines(field, THRESHOLDS.spacing_m);
    let visible = visible_samples(field, &samples, camera.chain.camera(), camera.pose, THRESHOLDS.spacing_px);
    let [thinnest, widest] = THRESHOLDS.half_width_px;
    let alone = visible.into_iter().filter(|visible| {
        (thinnest..=widest).contains(&visible.half_width_px) && visibility.stands_alone(visible)
    });
    let projected = alone.filter_map(|visible| {
        Some(VisibleSample {
            pixel: camera.project(visible.sample.point_in_world, ColorChannel::Green)?,
            ..visible
        })
    });
    projected.collect()
}

/// Measures pieces of line within `search_px` of where they are predicted. Also returns all predicted pieces that are clear of
/// the picture's border.
pub(crate) fn measure_lines(
    camera: &FrameCamera<'_>,
    picture: &RgbImage,
    blocks: &[CarpetBlock],
    search_px: f64,
    gamma: f64,
) -> (Vec<Line>, Vec<ExpectedLine>) {
    let finder = LineFinder { camera, picture, velocity: PixelVelocity::new(camera), search_px, gamma };
    let predicted = expected_lines(camera);
    let lines = search(&Texture::pack(&luma(picture)), &predicted, search_px, |found| finder.line(found));
    let carpet_level = carpet::median_level(blocks);
    let is_carpet = |pixel: DVec2| carpet_level.is_some_and(|level| carpet::is_carpet(picture, pixel, level));
    let is_found = |visible: &VisibleSample| lines.iter().any(|line| line.pixel == visible.pixel);
    let piece = |visible: &VisibleSample| ExpectedLine {
        curve: curve_of(visible),
        half_width_px: visible.half_width_px,
        is_hidden: !is_found(visible) && !is_carpet(visible.pixel),
    };
    let expected = predicted.iter().filter(|visible| finder.has_room(visible)).map(piece).collect();
    (lines, expected)
}

/// Fits profiles to pieces of line that a coarse search has found.
struct LineFinder<'a> {
    camera: &'a FrameCamera<'a>,
    picture: &'a RgbImage,
    velocity: PixelVelocity<'a>,
    search_px: f64,
    gamma: f64,
}

impl LineFinder<'_> {
    /// Whether a profile fits between the piece and the picture's border.
    fn has_room(&self, visible: &VisibleSample) -> bool {
        let size = DVec2::new(f64::from(self.picture.width()), f64::from(self.picture.height()));
        let room = visible.pixel.min(size - 1.0 - visible.pixel).min_element();
        room > self.search_px + 2.0 * visible.half_width_px + THRESHOLDS.border_margin_px
    }

    /// Measures a piece of line. None if it is too thin for its blur or its profile cannot be fitted.
    fn line(&self, found: &CoarseMatch) -> Option<Line> {
        let visible = &found.visible;
        let ground = visible.sample.point_in_world;
        let (pixel, normal) = (visible.pixel, visible.normal_in_image);
        let speed_px_s = self.velocity.along_px_s(ground, normal);
        let chain = self.camera.chain;
        let smear_px = chain.exposure_s() * speed_px_s;
        let expected_px2 = chain.psf_variance_px2(pixel) + APERTURE_PX2 + smear_px * smear_px / 12.0;
        let variance_px2 = expected_px2 + found.extra_px2;
        let half_width_px = visible.half_width_px;
        (half_width_px > THRESHOLDS.least_half_width_sigmas * variance_px2.sqrt()).then_some(())?;
        let piece = LinePiece { pixel, normal, half_width_px, variance_px2 };
        let profile = line_profile::fit(self.picture, self.gamma, &piece, found.offset_px)?;
        let curve = curve_of(visible);
        Some(Line {
            curve,
            fraction: fraction(self.camera.curve(curve)?, ground),
            ground,
            pixel,
            normal,
            speed_px_s,
            profile,
            half_width_px,
            is_expected: self.has_room(visible),
        })
    }
}

/// Returns the position of a point on its curve as a fraction of the curve's length.
fn fraction(curve: &Curve, point: DVec2) -> f64 {
    match curve {
        Curve::Segment { from, to } => (point - *from).dot(*to - *from) / from.distance_squared(*to),
        Curve::Circle { center, .. } => {
            (point - *center).to_angle().rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU
        }
    }
}
