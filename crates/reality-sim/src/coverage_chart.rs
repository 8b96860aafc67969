//! Coverage of a database, drawn on the field as an SVG file.

use std::{f64::consts::TAU, fmt::Write};

use crate::{
    db::coverage::{Coverage, CoverageCell, FAR_PX, HEADINGS, shade_srgb},
    field::{Curve, FieldDimensions},
};

/// Scale, pixels per metre.
const SCALE: f64 = 80.0;
/// Margin around the fields, pixels.
const MARGIN: f64 = 28.0;
/// Height of the text above and below each field, pixels.
const TEXT_HEIGHT: f64 = 64.0;

/// Draws two fields from above, side by side: how many pictures were taken where and in which directions, and how far
/// every place is from the nearest picture. The opponent's goal (+x) is on the right.
pub fn coverage_svg(coverage: &Coverage, field: &FieldDimensions, title: &str) -> String {
    let [columns, rows] = coverage.size.map(|cells| cells as f64 * coverage.cell_m * SCALE);
    let (width, height) = (2.0 * columns + 3.0 * MARGIN, rows + 2.0 * TEXT_HEIGHT);
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0} {height:.0}" width="{width:.0}" height="{height:.0}" font-family="sans-serif" font-size="15"><rect width="100%" height="100%" fill="#ffffff"/>"##
    );
    let most = coverage.cells.iter().map(CoverageCell::count).max().unwrap_or(0).max(1);
    let counted = Panel { left: MARGIN, coverage, size: [columns, rows] };
    let square = 100.0 * coverage.cell_m;
    counted.head(&mut svg, title, &format!("pictures in a square of {square:.0} cm, and where they look"));
    counted
        .cells(&mut svg, |cell| (cell.count() > 0).then(|| shade(f64::from(cell.count()) / f64::from(most))));
    counted.lines(&mut svg, field);
    counted.headings(&mut svg, most);
    counted.legend(&mut svg, "1", &most.to_string(), "pictures", |share| {
        shade(share.max(1.0 / f64::from(most)))
    });

    let distances = Panel { left: 2.0 * MARGIN + columns, ..counted };
    distances.head(&mut svg, "", "how far the nearest picture is, mean over all headings");
    distances.cells(&mut svg, |cell| Some(shade(1.0 - cell.mean_distance_px() / FAR_PX)));
    distances.lines(&mut svg, field);
    distances.legend(&mut svg, "0", &format!("{FAR_PX:.0} or more"), "pixels", |share| shade(1.0 - share));
    svg.push_str("</svg>\n");
    svg
}

fn shade(share: f64) -> String {
    let [red, green, blue] = shade_srgb(share);
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// One of the two drawn fields.
#[derive(Clone, Copy)]
struct Panel<'a> {
    left: f64,
    coverage: &'a Coverage,
    /// Width and height, pixels.
    size: [f64; 2],
}

// Writing into a string cannot fail.
impl Panel<'_> {
    fn at(&self, x_m: f64, y_m: f64) -> (f64, f64) {
        (self.left + 0.5 * self.size[0] + SCALE * x_m, TEXT_HEIGHT + 0.5 * self.size[1] - SCALE * y_m)
    }

    fn head(&self, svg: &mut String, title: &str, text: &str) {
        let title: String =
            title.chars().filter(|letter| !letter.is_control() && !"<>&".contains(*letter)).collect();
        let _ = write!(
            svg,
            r#"<text x="{:.0}" y="26" font-weight="bold">{title}</text><text x="{:.0}" y="50">{text}</text>"#,
            self.left, self.left
        );
    }

    fn cells(&self, svg: &mut String, color: impl Fn(&CoverageCell) -> Option<String>) {
        let side = self.coverage.cell_m * SCALE;
        for cell in &self.coverage.cells {
            let (u, v) = self.at(cell.middle_in_world.x, cell.middle_in_world.y);
            let color = color(cell).unwrap_or_else(|| "#ffffff".to_owned());
            let _ = write!(
                svg,
                r##"<rect x="{:.1}" y="{:.1}" width="{side:.1}" height="{side:.1}" fill="{color}" stroke="#e4e4e0" stroke-width="0.5"/>"##,
                u - side / 2.0,
                v - side / 2.0
            );
        }
    }

    fn lines(&self, svg: &mut String, field: &FieldDimensions) {
        const STROKE: &str = r##"fill="none" stroke="#808078" stroke-width="1.5""##;
        for curve in field.curves() {
            let _ = match curve {
                Curve::Segment { from, to } => {
                    let ((x1, y1), (x2, y2)) = (self.at(from.x, from.y), self.at(to.x, to.y));
                    write!(svg, r#"<line x1="{x1:.1}" y1="{y1:.1}" x2="{x2:.1}" y2="{y2:.1}" {STROKE}/>"#)
                }
                Curve::Circle { center, radius_m } => {
                    let (u, v) = self.at(center.x, center.y);
                    write!(svg, r#"<circle cx="{u:.1}" cy="{v:.1}" r="{:.1}" {STROKE}/>"#, SCALE * radius_m)
                }
            };
        }
    }

    /// Draws a stroke from the centre of a cell into every direction in which pictures were taken, longer for more
    /// pictures.
    fn headings(&self, svg: &mut String, most: u32) {
        for cell in &self.coverage.cells {
            for (heading, &count) in cell.pictures.iter().enumerate().filter(|(_, count)| **count > 0) {
                let share = (f64::from(count) / f64::from(most)).sqrt();
                let length_m = 0.5 * self.coverage.cell_m * (0.35 + 0.65 * share);
                let (sin, cos) = (TAU * heading as f64 / HEADINGS as f64).sin_cos();
                let middle = cell.middle_in_world;
                let (x1, y1) = self.at(middle.x, middle.y);
                let (x2, y2) = self.at(middle.x + length_m * cos, middle.y + length_m * sin);
                let _ = write!(
                    svg,
                    r##"<line x1="{x1:.1}" y1="{y1:.1}" x2="{x2:.1}" y2="{y2:.1}" stroke="#d04a10" stroke-width="2" stroke-linecap="round"/>"##
                );
            }
        }
    }

    fn legend(&self, svg: &mut String, first: &str, last: &str, unit: &str, color: impl Fn(f64) -> String) {
        const STEPS: u32 = 24;
        let (top, step) = (TEXT_HEIGHT + self.size[1] + 14.0, 7.0);
        for number in 0..STEPS {
            let share = f64::from(number) / f64::from(STEPS - 1);
            let _ = write!(
                svg,
                r#"<rect x="{:.1}" y="{top:.1}" width="{step:.1}" height="14" fill="{}"/>"#,
                self.left + step * f64::from(number),
                color(share)
            );
        }
        let (end, base) = (self.left + step * f64::from(STEPS), top + 32.0);
        let _ = write!(
            svg,
            r#"<text x="{:.0}" y="{base:.0}">{first}</text><text x="{end:.0}" y="{base:.0}" text-anchor="middle">{last}</text><text x="{:.0}" y="{:.0}">{unit}</text>"#,
            self.left,
            end + 10.0,
            top + 12.0
        );
    }
}
