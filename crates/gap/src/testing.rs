//! Test data shared by several modules.

use std::collections::BTreeMap;

use glam::DVec2;
use nalgebra::{DMatrix, DVector};
use reality_sim_core::field::FieldDimensions;
use reality_sim_sensor::{Parameter, effect};

use crate::{
    frame_index::ViewIndex,
    linear_model::{
        column::Columns,
        normal_equations::NormalEquations,
        reflectance::{ReflectanceField, Tree},
        system::LinearSystem,
    },
    measurement::{
        quantity::{ColorChannel, Quantity},
        scalar::{Measurement, Subject},
    },
    recording::ReferenceSource,
    report::data::{EffectReport, Estimate, Gap, PosesReport, Report, Verdict},
};

/// Numbers from a fixed linear congruential generator, summed to be nearly normal.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

/// Returns a measurement of a quantity, seen from straight above.
pub(crate) fn measurement(quantity: Quantity) -> Measurement {
    Measurement {
        subject: Subject::OdometryStep,
        quantity,
        measured: 0.0,
        sigma: 0.0,
        pixel: DVec2::ZERO,
        ground: DVec2::ZERO,
        normal: DVec2::X,
        speed_px_s: 0.0,
        half_width_px: 2.0,
        cos_incidence: 1.0,
        view_direction: DVec2::ZERO,
        luma_slope: 0.0,
        log_brightness: 0.0,
    }
}

/// Returns a measurement of the green level of a block of carpet.
pub(crate) fn carpet_measurement(pixel: DVec2, ground: DVec2) -> Measurement {
    Measurement {
        pixel,
        ground,
        normal: DVec2::ZERO,
        half_width_px: 0.0,
        ..measurement(Quantity::CarpetLevel(ColorChannel::Green))
    }
}

/// Returns the normal equations of 45 frames with 20 measurements each of two columns, whose true values are `truth`. The
/// measurements have unit noise, and those of a frame also share an error of standard deviation `shared`.
pub(crate) fn two_column_frames(
    seed: u64,
    truth: [f64; 2],
    shared: f64,
) -> Vec<(DMatrix<f64>, DVector<f64>)> {
    let mut noise = Noise(seed);
    let mut frame = || {
        let common = shared * noise.next();
        let (mut a, mut g) = (DMatrix::zeros(2, 2), DVector::zeros(2));
        for _ in 0..20 {
            let row = DVector::from_vec(vec![1.0 + 0.3 * noise.next(), noise.next()]);
            let residual = row.dot(&DVector::from_vec(truth.to_vec())) + common + noise.next();
            a.ger(1.0, &row, &row, 1.0);
            g += residual * row;
        }
        (a, g)
    };
    (0..45).map(|_| frame()).collect()
}

/// Returns columns of this number of fitted parameters alone.
pub(crate) fn parameters(count: usize) -> Columns {
    Columns { parameters: count, nuisances: 0, field: ReflectanceField::new(Tree::default()) }
}

/// Returns a linear system of frames with these normal equations. Each frame is a view and a cell of the field of its own.
pub(crate) fn system_of(frames: Vec<(DMatrix<f64>, DVector<f64>)>) -> LinearSystem {
    let size = frames[0].1.len();
    let frames: Vec<NormalEquations> =
        frames.into_iter().map(|(a, g)| NormalEquations::of_all(a, g)).collect();
    let views: Vec<ViewIndex> = (0..frames.len()).map(ViewIndex).collect();
    LinearSystem::of_equations(size, frames.clone(), frames, &views)
}

/// Returns the report of an effect whose parameters all have this value with certainty; all other entries are empty.
pub(crate) fn effect_report(id: &str, value: f64) -> EffectReport {
    let parameters = effect(id).map_or(&[][..], |known| known.parameters());
    let estimate = |parameter: &Parameter| {
        let unit = Some(parameter.unit.to_owned());
        (parameter.name.to_owned(), Estimate { value, sigma: 0.01 * value.abs(), unit, at_range_end: false })
    };
    EffectReport {
        id: id.to_owned(),
        parameters: parameters.iter().map(estimate).collect(),
        correlations: BTreeMap::new(),
        given: BTreeMap::new(),
        p_value: 1e-9,
        held_out_gain: Estimate { value: 310.0, sigma: 12.0, unit: None, at_range_end: false },
        confusable_with: Vec::new(),
        closes: BTreeMap::new(),
    }
}

/// Returns a report in which no effect was found.
pub(crate) fn report() -> Report {
    Report {
        recording: "hall".to_owned(),
        frames: 120,
        held_out_frames: 30,
        left_out: Vec::new(),
        verdict: Verdict::None,
        effects: Vec::new(),
        in_model: Vec::new(),
        unexplained: Vec::new(),
        objects: Vec::new(),
        gap: Gap { before: 1.0, after: 1.0, floor: 1.0, channels: BTreeMap::new() },
        not_found: Vec::new(),
        unobservable: Vec::new(),
        poses: PosesReport {
            source: ReferenceSource::Measured,
            rotation_sigma_rad: [0.002, 0.001, 0.003],
            position_sigma_m: [0.01, 0.012, 0.003],
        },
        maps: BTreeMap::new(),
        shown_frame: 17,
        seed: 0,
        field: FieldDimensions::preset("humanoid-kidsize-2010").unwrap(),
    }
}
