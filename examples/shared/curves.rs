//! Curves over two logarithmic axes, as an SVG file.

use std::{ops::Range, path::Path};

use anyhow::Context;
use plotters::prelude::*;

const COLORS: [RGBColor; 4] =
    [RGBColor(214, 96, 77), RGBColor(67, 147, 195), RGBColor(27, 120, 55), RGBColor(244, 165, 130)];

/// Names of the axes, and the range of the first one.
pub struct Axes<'a> {
    pub x: &'a str,
    pub y: &'a str,
    pub x_range: Range<f64>,
}

/// Points, x and y, and their name.
pub type Named<'a> = (&'a str, Vec<(f64, f64)>);

/// Draws curves, and crosses at single points; each of the crosses has the colour of the curve with its number.
pub fn plot(
    file: &Path,
    axes: Axes,
    curves: &[Named],
    crosses: &[Named],
    legend: SeriesLabelPosition,
) -> anyhow::Result<()> {
    let values = || curves.iter().chain(crosses).flat_map(|(_, points)| points).map(|(_, y)| *y);
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
    let root = SVGBackend::new(file, (640, 420)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(56)
        .build_cartesian_2d(axes.x_range.log_scale(), (0.8 * low..1.3 * high).log_scale())?;
    chart
        .configure_mesh()
        .x_desc(axes.x)
        .y_desc(axes.y)
        .x_label_formatter(&tick)
        .y_label_formatter(&tick)
        .light_line_style(WHITE)
        .draw()?;
    for ((name, points), color) in crosses.iter().zip(COLORS) {
        chart
            .draw_series(points.iter().map(|point| Cross::new(*point, 5, color.stroke_width(2))))?
            .label(*name)
            .legend(move |(x, y)| Cross::new((x + 9, y), 5, color.stroke_width(2)));
    }
    for ((name, points), color) in curves.iter().zip(COLORS) {
        chart
            .draw_series(LineSeries::new(points.iter().copied(), color.stroke_width(2)).point_size(3))?
            .label(*name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
    }
    chart.configure_series_labels().position(legend).background_style(WHITE).border_style(BLACK).draw()?;
    root.present().with_context(|| format!("{}: cannot be written", file.display()))
}

/// Formats ticks of a logarithmic axis: 1, 2 and 5 in every decade, so that none covers another.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "the form that the plotting library calls")]
fn tick(value: &f64) -> String {
    let decade = 10_f64.powf(value.log10().floor());
    match (value / decade).round() as u32 {
        1 | 2 | 5 if *value >= 1.0 => format!("{value:.0}"),
        1 | 2 | 5 => format!("{value:.2}"),
        _ => String::new(),
    }
}
