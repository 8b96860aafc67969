//! Mean reflectance of lines and carpet that predictions start from: the nominal one or, where none is given, that which the
//! recording shows.

use reality_sim_core::{sequence::Photometry, statistics::median};
use reality_sim_sensor::Chain;

use crate::{
    frame_index::PerFrame,
    measurement::{carpet::CarpetBlock, frame::FrameMeasurements, lines::Line},
    recording::{Frame, Recording},
    thresholds::{NuisanceThresholds, Thresholds},
};

const THRESHOLDS: NuisanceThresholds = Thresholds::DEFAULT.linear_model.nuisance;
/// Number of pieces of a surface from which its mean is taken; more do not make it better.
const MOST_PIECES: usize = 500;

/// Mean reflectance of one surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SurfaceReflectance {
    /// Linear values of red, green and blue as the nominal camera records them; 1 is full scale.
    pub(crate) linear_rgb: [f64; 3],
    /// Standard deviation of the logarithm of its brightness, of all colours alike.
    pub(crate) sigma: f64,
    /// Standard deviation of the logarithm of each colour against the others.
    pub(crate) color_sigma: f64,
}

/// Mean reflectance of both surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MeanReflectance {
    pub(crate) line: SurfaceReflectance,
    pub(crate) carpet: SurfaceReflectance,
}

/// Encoded levels of a piece of a surface, with the factors on the light by which a model explains them.
type Piece = ([f64; 3], [f64; 3]);

impl MeanReflectance {
    /// Returns the nominal reflectance of each surface or, where the camera's file has none, that at which the model predicts
    /// the median of what was measured.
    pub(crate) fn new(
        recording: &Recording<'_>,
        measurements: &PerFrame<FrameMeasurements>,
        chain: &Chain,
    ) -> Self {
        let given = recording.sequence.setup.photometry.unwrap_or(Photometry::of_gamma(recording.gamma()));
        let nominal = |linear_rgb: Option<[f64; 3]>, trust: Option<f64>, usual: [f64; 2]| {
            let [sigma, color_sigma] = trusted(usual, trust);
            linear_rgb.map(|linear_rgb| SurfaceReflectance { linear_rgb, sigma, color_sigma })
        };
        let line = nominal(given.line_linear_rgb, given.trust().line, THRESHOLDS.line_level);
        let carpet = nominal(given.carpet_linear_rgb, given.trust().carpet, THRESHOLDS.carpet_level);
        Self {
            line: line.unwrap_or_else(|| shown(chain, &lines(recording, measurements, chain))),
            carpet: carpet.unwrap_or_else(|| shown(chain, &blocks(recording, measurements, chain))),
        }
    }

    /// Returns the reflectance at which the model predicts the medians of what was measured.
    pub(crate) fn shown(
        recording: &Recording<'_>,
        measurements: &PerFrame<FrameMeasurements>,
        chain: &Chain,
    ) -> Self {
        Self {
            line: shown(chain, &lines(recording, measurements, chain)),
            carpet: shown(chain, &blocks(recording, measurements, chain)),
        }
    }
}

/// Returns the standard deviations of a surface's brightness and colours, in the proportion that is usual.
fn trusted([sigma, color_sigma]: [f64; 2], trust: Option<f64>) -> [f64; 2] {
    trust.map_or([sigma, color_sigma], |stated| [stated, stated * color_sigma / sigma])
}

fn lines(recording: &Recording<'_>, measurements: &PerFrame<FrameMeasurements>, chain: &Chain) -> Vec<Piece> {
    let of_frame = |(frame, measured): (&Frame, &FrameMeasurements)| -> Vec<Piece> {
        let light = |line: &Line| chain.light(frame.time_s, line.pixel, Some(line.ground));
        measured.lines.iter().filter_map(|line| Some((line.profile.level?, light(line)))).collect()
    };
    recording.frames.iter().zip(measurements.iter()).flat_map(of_frame).collect()
}

fn blocks(
    recording: &Recording<'_>,
    measurements: &PerFrame<FrameMeasurements>,
    chain: &Chain,
) -> Vec<Piece> {
    let of_frame = |(frame, measured): (&Frame, &FrameMeasurements)| -> Vec<Piece> {
        let light = |block: &CarpetBlock| chain.light(frame.time_s, block.pixel, Some(block.ground));
        measured.blocks.iter().map(|block| (block.level, light(block))).collect()
    };
    recording.frames.iter().zip(measurements.iter()).flat_map(of_frame).collect()
}

/// Returns the reflectance at which a model predicts the median of these pieces.
fn shown(chain: &Chain, pieces: &[Piece]) -> SurfaceReflectance {
    let every = pieces.len().div_ceil(MOST_PIECES).max(1);
    let reflectance = |color: usize| {
        let of_piece = |(level, light): &Piece| chain.linear_of(level[color]) / light[color].max(1e-6);
        let values: Vec<f64> = pieces.iter().step_by(every).map(of_piece).collect();
        if values.is_empty() { f64::NAN } else { median(values).max(1e-6) }
    };
    let free = THRESHOLDS.free_level;
    SurfaceReflectance { linear_rgb: [0, 1, 2].map(reflectance), sigma: free, color_sigma: free }
}
