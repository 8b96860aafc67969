//! What is looked at in a picture, and what is measured there: pieces of white line and blocks of plain carpet, where
//! the model expects them.

use glam::{DVec2, DVec3};
use image::RgbImage;
use reality_sim_core::{
    field::{Curve, VisibleSample, sample_lines, visible_samples},
    pose::CameraPose,
    preprocess::{Texture, luma},
};
use reality_sim_sensor::{Chain, Frame, Trajectory};

use crate::{
    measurement::carpet::{self, CarpetBlock, Spectrum},
    measurement::line_profile::{self, LinePiece, Profile},
    measurement::line_search::{Coarse, search},
    measurement::quantization::{BLOCK, luma_steps},
    measurement::visibility::Surroundings,
};

/// Between samples along a line on the ground, metres.
const SPACING_M: f64 = 0.03;
/// Between them in the picture, pixels.
const SPACING_PX: f64 = 9.0;
/// Lines whose half width in the picture is outside this are too thin to be measured, or too near, pixels.
const HALF_WIDTH_PX: std::ops::RangeInclusive<f64> = 0.5..=30.0;
/// And those that are narrower than this against the blur: carpet has as much contrast as is left of them.
const THINNEST: f64 = 0.25;
/// Variance of a pixel's own square aperture, pixels squared.
pub(crate) const APERTURE_PX2: f64 = 1.0 / 12.0;
/// Room that a profile needs beyond a line's sides and the search, pixels.
const ROOM_PX: f64 = 8.0;
/// A pixel's speed is found from its places this long before and after, seconds.
const FLOW_STEP_S: f64 = 2e-3;

/// A piece of line that the model expects in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ExpectedLine {
    /// Which of the field's curves.
    pub(crate) curve: usize,
    /// Half its width in the picture, pixels.
    pub(crate) half_width_px: f64,
    /// Whether something stands before it: neither a line is there nor carpet.
    pub(crate) is_hidden: bool,
}

/// A piece of line that was found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    /// Which of the field's curves, and where on it as a fraction of its length.
    pub(crate) curve: usize,
    pub(crate) fraction: f64,
    /// On the ground, metres.
    pub(crate) ground: DVec2,
    /// Where the model has it, and across it in the picture.
    pub(crate) pixel: DVec2,
    pub(crate) normal: DVec2,
    /// How fast what is seen moves along the normal, pixels a second.
    pub(crate) speed_px_s: f64,
    pub(crate) profile: Profile,
    /// Half its width in the picture, pixels.
    pub(crate) half_width_px: f64,
    /// Whether it is so far from the picture's rim that it is among the expected ones.
    pub(crate) is_expected: bool,
}

/// All that was measured in one picture.
#[derive(Debug, Clone)]
pub(crate) struct FrameMeasurements {
    /// The projection centre in the world, metres.
    pub(crate) camera: DVec3,
    pub(crate) lines: Vec<Line>,
    /// All pieces of line that the model expects in the picture, found or not.
    pub(crate) expected_lines: Vec<ExpectedLine>,
    pub(crate) blocks: Vec<CarpetBlock>,
    /// Rounding of the coefficients that noise was measured in, grey levels.
    pub(crate) noise_steps: Vec<f64>,
}

/// The model's view of one frame.
#[derive(Debug)]
pub(crate) struct FrameCamera<'a> {
    pub(crate) chain: &'a Chain,
    pub(crate) trajectory: &'a Trajectory,
    pub(crate) time_s: f64,
    /// The field's lines.
    pub(crate) curves: Vec<Curve>,
    /// The pose while the middle row is exposed.
    pub(crate) pose: CameraPose,
    frame: Frame<'a>,
}

impl<'a> FrameCamera<'a> {
    pub(crate) fn new(chain: &'a Chain, trajectory: &'a Trajectory, time_s: f64) -> Self {
        Self {
            chain,
            trajectory,
            time_s,
            curves: chain.field().curves(),
            pose: chain.pose(trajectory, time_s, 0.5),
            frame: chain.frame(trajectory, time_s),
        }
    }

    /// Where a point of the ground is seen in a colour's picture.
    pub(crate) fn project(&self, ground: DVec2, channel: usize) -> Option<DVec2> {
        self.frame.project(ground.extend(0.0), channel)
    }
}

/// How fast points of the ground move through the picture.
struct Flow<'a> {
    /// The view a moment before and a moment after; none where nothing moves.
    around: Option<[FrameCamera<'a>; 2]>,
}

impl<'a> Flow<'a> {
    fn new(view: &FrameCamera<'a>) -> Self {
        let at = |time_s: f64| FrameCamera::new(view.chain, view.trajectory, time_s);
        let around = (!view.trajectory.is_still())
            .then(|| [at(view.time_s - FLOW_STEP_S), at(view.time_s + FLOW_STEP_S)]);
        Self { around }
    }

    /// Along a direction in the picture, pixels a second.
    fn speed_px_s(&self, ground: DVec2, direction: DVec2) -> f64 {
        let Some([before, after]) = &self.around else { return 0.0 };
        match (before.project(ground, 1), after.project(ground, 1)) {
            (Some(before), Some(after)) => direction.dot(after - before) / (2.0 * FLOW_STEP_S),
            _ => 0.0,
        }
    }
}

/// How a picture is looked at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeasurementConfig {
    /// Lines are searched this far from where the model has them, pixels.
    pub(crate) search_px: f64,
    /// Of the camera's nominal encoding.
    pub(crate) gamma: f64,
}

/// Measures a picture, given also as the bytes of its file.
pub(crate) fn measure_frame(
    view: &FrameCamera<'_>,
    picture: &RgbImage,
    bytes: &[u8],
    looking: MeasurementConfig,
) -> FrameMeasurements {
    let spectrum = Spectrum::new(&luma_steps(bytes));
    let blocks = find_carpet(view, picture, &spectrum);
    let (lines, expected_lines) = find_lines(view, picture, &blocks, looking);
    let camera = view.pose.position_in_world();
    FrameMeasurements { camera, lines, expected_lines, blocks, noise_steps: spectrum.steps }
}

/// The pieces of line that the model expects in the picture and that stand alone there.
pub(crate) fn expected_lines(view: &FrameCamera<'_>) -> Vec<VisibleSample> {
    let field = view.chain.field();
    let surroundings = Surroundings::new(view);
    let samples = sample_lines(field, SPACING_M);
    let visible = visible_samples(field, &samples, view.chain.camera(), view.pose, SPACING_PX);
    let alone = visible.into_iter().filter(|visible| {
        HALF_WIDTH_PX.contains(&visible.half_width_px) && surroundings.stands_alone(visible)
    });
    let placed = alone.filter_map(|visible| {
        Some(VisibleSample { pixel: view.project(visible.sample.point_in_world, 1)?, ..visible })
    });
    placed.collect()
}

fn find_lines(
    view: &FrameCamera<'_>,
    picture: &RgbImage,
    blocks: &[CarpetBlock],
    looking: MeasurementConfig,
) -> (Vec<Line>, Vec<ExpectedLine>) {
    let flow = Flow::new(view);
    let expected = expected_lines(view);
    // At the picture's rim a profile has no room.
    let size = DVec2::new(f64::from(picture.width()), f64::from(picture.height()));
    let has_room = |visible: &VisibleSample| {
        let room = visible.pixel.min(size - 1.0 - visible.pixel).min_element();
        room > looking.search_px + 2.0 * visible.half_width_px + ROOM_PX
    };
    let line = |found: &Coarse| {
        let visible = &found.visible;
        let ground = visible.sample.point_in_world;
        let normal = visible.normal_in_image;
        let speed_px_s = flow.speed_px_s(ground, normal);
        let smear_px = view.chain.exposure_s() * speed_px_s;
        let expected_px2 =
            view.chain.psf_variance_px2(visible.pixel) + APERTURE_PX2 + smear_px * smear_px / 12.0;
        let variance_px2 = expected_px2 + found.extra_px2;
        (visible.half_width_px > THINNEST * variance_px2.sqrt()).then_some(())?;
        let piece =
            LinePiece { pixel: visible.pixel, normal, half_width_px: visible.half_width_px, variance_px2 };
        let profile = line_profile::fit(picture, looking.gamma, &piece, found.offset_px)?;
        let curve = visible.sample.curve;
        let fraction = fraction(&view.curves[curve], ground);
        Some(Line {
            curve,
            fraction,
            ground,
            pixel: visible.pixel,
            normal,
            speed_px_s,
            profile,
            half_width_px: visible.half_width_px,
            is_expected: has_room(visible),
        })
    };
    let lines = search(&Texture::pack(&luma(picture)), &expected, looking.search_px, line);
    let usual = carpet::usual(blocks);
    let is_carpet = |pixel: DVec2| usual.is_some_and(|usual| carpet::is_carpet(picture, pixel, usual));
    let is_found = |visible: &VisibleSample| lines.iter().any(|line| line.pixel == visible.pixel);
    let piece = |visible: &VisibleSample| ExpectedLine {
        curve: visible.sample.curve,
        half_width_px: visible.half_width_px,
        is_hidden: !is_found(visible) && !is_carpet(visible.pixel),
    };
    let all = expected.iter().filter(|visible| has_room(visible)).map(piece).collect();
    (lines, all)
}

/// Where on a curve a point of it lies, as a fraction of the curve's length.
fn fraction(curve: &Curve, point: DVec2) -> f64 {
    match curve {
        Curve::Segment { from, to } => (point - *from).dot(*to - *from) / from.distance_squared(*to),
        Curve::Circle { center, .. } => {
            (point - *center).to_angle().rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU
        }
    }
}

/// Side of a block of carpet, pixels: smaller in small pictures.
fn block_side(picture: &RgbImage) -> u32 {
    if picture.width() >= 480 { 2 * BLOCK as u32 } else { BLOCK as u32 }
}

fn find_carpet(view: &FrameCamera<'_>, picture: &RgbImage, spectrum: &Spectrum) -> Vec<CarpetBlock> {
    let side = block_side(picture);
    let surroundings = Surroundings::new(view);
    let mut blocks = Vec::new();
    for row in 0..picture.height() / side {
        for column in 0..picture.width() / side {
            let corner = [column * side, row * side];
            if let Some(point) = surroundings.plain_carpet(corner, side) {
                blocks.push(carpet::measure(picture, spectrum, corner, side, point));
            }
        }
    }
    blocks
}
