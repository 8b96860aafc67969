//! Patterns of light in the picture, on the field or over time that no effect of the model explains.
//!
//! A pattern is a column of its own in the linearised model, beside the effects, the nuisance parameters and the reflectance of
//! all places: what the same place looks like elsewhere in the picture, or later, tells the light from the reflectance. Residuals
//! of a fit hardly show it, because the reflectance of places that are seen only once has taken it up.

use std::f64::consts::PI;

use glam::DVec2;
use nalgebra::DVector;

use crate::{
    frame_index::ViewIndex,
    inference::{evidence::Evidence, selected_model::SelectedModel},
    linear_model::{
        column::{ColumnIndex, Columns},
        linearized_frame::LinearizedFrame,
    },
    measurement::scalar::Measurement,
    recording::Recording,
    thresholds::Thresholds,
};

const SURFACE_SIGNIFICANCE: f64 = Thresholds::DEFAULT.inference.surface_significance;

/// Way in which light may depend on the place in the picture, on that on the field, or on time. What depends on the height in the picture alone is the
/// carpet's sheen as likely as the camera's doing, and is not among these.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    /// From one side to the other.
    Sideways,
    /// By the square of the distance from the middle, so many times squared.
    Radial(i32),
    /// Along the field, or across it, to this power.
    OnField(Axis, i32),
    /// Cosine of so many half periods over the recording.
    OverTime(u32),
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Axis {
    Along,
    Across,
}

const SHAPES: [Shape; 13] = [
    Shape::Sideways,
    Shape::Radial(1),
    Shape::Radial(2),
    Shape::OnField(Axis::Along, 1),
    Shape::OnField(Axis::Along, 2),
    Shape::OnField(Axis::Across, 1),
    Shape::OnField(Axis::Across, 2),
    Shape::OverTime(1),
    Shape::OverTime(2),
    Shape::OverTime(3),
    Shape::OverTime(4),
    Shape::OverTime(5),
    Shape::OverTime(6),
];

impl Shape {
    /// Returns the change of light at a place in the picture, in units of half its diagonal from its middle, at one on the field,
    /// in units of half its length and width, and at a part of the recording's time.
    fn at(self, place: DVec2, on_field: DVec2, part: f64) -> f64 {
        match self {
            Self::Sideways => place.x,
            Self::Radial(power) => place.length_squared().powi(power),
            Self::OnField(Axis::Along, power) => on_field.x.powi(power),
            Self::OnField(Axis::Across, power) => on_field.y.powi(power),
            Self::OverTime(half_periods) => (PI * f64::from(half_periods) * part).cos(),
        }
    }
}

/// Where a pattern of light is strongest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Strongest {
    /// Pixel of the picture.
    Picture(DVec2),
    /// Place on the field, world axes, metres.
    Field(DVec2),
    /// Time since the recording's start, seconds.
    Time(f64),
}

/// Pattern of light that no effect of the model explains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LightPattern {
    pub(crate) strongest: Strongest,
    /// Range of the light over the picture, over the field or over time, natural logarithm.
    pub(crate) size: f64,
    /// P-value, corrected for all patterns.
    pub(crate) p_value: f64,
}

/// Returns the most significant pattern of light in a recording's training frames.
pub(crate) fn light_pattern(recording: &Recording<'_>, found: &SelectedModel) -> Option<LightPattern> {
    let fits = found.effect_fits();
    let kept = fits.columns_of(&found.all());
    let layout = Layout { recording, kept: &kept, parameters: found.columns.len() };
    let linearized = &found.linearized;
    let frames: Vec<LinearizedFrame> = found
        .split
        .training()
        .map(|frame| layout.with_shapes(&linearized.frames[frame], recording.frames[frame].time_s))
        .collect();
    let columns = Columns { parameters: kept.len() + SHAPES.len(), ..linearized.system.columns.clone() };
    let views = recording.views();
    let views: Vec<ViewIndex> = found.split.training().map(|frame| views[frame]).collect();
    let system = linearized.system.with_columns(&frames.iter().collect::<Vec<_>>(), &columns, &views);
    let of_effects = kept.iter().map(|column| fits.evidence.base[column.0]);
    let base =
        DVector::from_iterator(kept.len() + SHAPES.len(), of_effects.chain(SHAPES.iter().map(|_| 0.0)));
    let evidence = Evidence::new(&system, base);
    let effects: Vec<ColumnIndex> = ColumnIndex::first(kept.len()).collect();
    let tested = SHAPES.iter().enumerate().filter_map(|(index, shape)| {
        let column = ColumnIndex(kept.len() + index);
        let free: Vec<ColumnIndex> = effects.iter().copied().chain([column]).collect();
        let fit = evidence.fit(&free)?;
        let p_value = evidence.p_value(&fit, &[column]).max(evidence.p_value_by_priors(&fit, &[column]));
        // The carpet's look by the direction of view is no light: lines have to show it, too.
        let is_on_both = evidence.p_value_of_both_surfaces(&free, &[column]) < SURFACE_SIGNIFICANCE;
        Some(layout.pattern(*shape, fit.delta[column.0], if is_on_both { p_value } else { 1.0 }))
    });
    tested.min_by(|a, b| a.p_value.total_cmp(&b.p_value))
}

/// Columns of a linearisation in which patterns of light take the place of the effects that are not in the model.
struct Layout<'a> {
    recording: &'a Recording<'a>,
    /// Columns of the effects in the model.
    kept: &'a [ColumnIndex],
    /// Number of columns of all effects.
    parameters: usize,
}

impl Layout<'_> {
    /// Returns the columns of a frame with those of the patterns.
    fn with_shapes(&self, frame: &LinearizedFrame, time_s: f64) -> LinearizedFrame {
        let rows = frame.jacobian.iter().zip(&frame.measurements).zip(&frame.patches);
        let row = |((row, measurement), patch): ((&Vec<_>, &Measurement), &Option<(_, f64)>)| {
            let effects = row.iter().filter_map(|(column, value)| Some((self.of_effect(*column)?, *value)));
            let nuisances = row.iter().filter(|(column, _)| column.0 >= self.parameters);
            let nuisances = nuisances.map(|(column, value)| (self.of_nuisance(*column), *value));
            let shapes = patch.iter().flat_map(|(_, by_light)| {
                let place = self.place(measurement.pixel);
                let on_field = measurement.ground / self.half_field_m();
                let at = move |shape: &Shape| by_light * shape.at(place, on_field, self.part(time_s));
                (0..).zip(SHAPES.iter().map(at)).map(|(index, value)| (self.of_shape(index), value))
            });
            effects.chain(shapes).chain(nuisances).collect()
        };
        LinearizedFrame { jacobian: rows.map(row).collect(), ..frame.clone() }
    }

    fn of_effect(&self, column: ColumnIndex) -> Option<ColumnIndex> {
        self.kept.iter().position(|kept| *kept == column).map(ColumnIndex)
    }

    fn of_shape(&self, index: usize) -> ColumnIndex {
        ColumnIndex(self.kept.len() + index)
    }

    fn of_nuisance(&self, column: ColumnIndex) -> ColumnIndex {
        ColumnIndex(column.0 - self.parameters + self.kept.len() + SHAPES.len())
    }

    /// Returns a place in the picture in units of half its diagonal, from its middle.
    fn place(&self, pixel: DVec2) -> DVec2 {
        let camera = &self.recording.sequence.setup.camera;
        let size = DVec2::new(f64::from(camera.width), f64::from(camera.height));
        2.0 * (pixel + 0.5 - 0.5 * size) / size.length()
    }

    fn half_field_m(&self) -> DVec2 {
        let field = &self.recording.sequence.field;
        0.5 * DVec2::new(field.length_m, field.width_m)
    }

    /// Returns the part of the recording's time that has passed.
    fn part(&self, time_s: f64) -> f64 {
        (time_s - self.recording.start_s()) / self.recording.duration_s().max(f64::MIN_POSITIVE)
    }

    /// Summarises a pattern with this coefficient.
    fn pattern(&self, shape: Shape, coefficient: f64, p_value: f64) -> LightPattern {
        let camera = &self.recording.sequence.setup.camera;
        let corner = DVec2::new(f64::from(camera.width), f64::from(camera.height)) - 1.0;
        // The corners, the darker side or end, the darkest moment.
        let darker = if coefficient < 0.0 { 1.0 } else { -1.0 };
        let (strongest, range) = match shape {
            Shape::Sideways => {
                let side = if coefficient < 0.0 { corner.x } else { 0.0 };
                (Strongest::Picture(DVec2::new(side, 0.5 * corner.y)), 2.0 * self.place(corner).x)
            }
            Shape::Radial(_) => (Strongest::Picture(corner), 1.0),
            Shape::OnField(axis, power) => {
                let end = if axis == Axis::Along { DVec2::X } else { DVec2::Y };
                let place = darker * end * self.half_field_m();
                (Strongest::Field(place), if power == 1 { 2.0 } else { 1.0 })
            }
            Shape::OverTime(half_periods) => {
                let darkest = if coefficient < 0.0 { 0.0 } else { 1.0 / f64::from(half_periods) };
                (Strongest::Time(darkest * self.recording.duration_s()), 2.0)
            }
        };
        let size = coefficient.abs() * range;
        LightPattern { strongest, size, p_value: (p_value * SHAPES.len() as f64).min(1.0) }
    }
}
