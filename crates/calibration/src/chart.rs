//! The uncertainty of the projection over the picture, drawn as an SVG file.

use std::fmt::Write;

use crate::calibration::Calibration;

/// Width and height of the legend below the picture, pixels.
const LEGEND: [f64; 2] = [360.0, 64.0];

/// Uncertainties from which a cell has the next colour, pixels, and the colours: from what no application notices to what spoils
/// every one.
const SHADES: [(f64, &str); 7] = [
    (0.0, "#1a9850"),
    (0.1, "#91cf60"),
    (0.2, "#d9ef8b"),
    (0.5, "#fee08b"),
    (1.0, "#fc8d59"),
    (2.0, "#d73027"),
    (5.0, "#7a0020"),
];

impl Calibration {
    /// Draws how uncertain the projection is where in the picture. Dots mark cells in which lines were measured, the larger the
    /// more; without dots the value comes from the lens model alone.
    pub fn uncertainty_svg(&self, title: &str) -> String {
        let (width, height) = (f64::from(self.camera.width), f64::from(self.camera.height));
        let scale = 640.0 / width.max(height);
        let size = [(width * scale).max(LEGEND[0]) + 32.0, height * scale + LEGEND[1] + 64.0];
        let mut svg = format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0:.0} {1:.0}" width="{0:.0}" height="{1:.0}" font-family="sans-serif" font-size="14"><rect width="100%" height="100%" fill="#ffffff"/><text x="16" y="28" font-size="16">{2}</text><g transform="translate(16 44) scale({scale:.4})"><rect width="{width}" height="{height}" fill="#333333"/>"##,
            size[0],
            size[1],
            escaped(title)
        );
        self.draw_cells(&mut svg);
        svg.push_str("</g>");
        draw_legend(&mut svg, height * scale + 60.0);
        svg.push_str("</svg>\n");
        svg
    }

    fn draw_cells(&self, svg: &mut String) {
        let map = &self.uncertainty;
        let most = map.measured.iter().copied().max().unwrap_or(0).max(1);
        for (index, (sigma, &count)) in map.sigma_px.iter().zip(&map.measured).enumerate() {
            let Some(sigma_px) = sigma else { continue };
            let (column, row) = (index % map.size[0], index / map.size[0]);
            let [x, y] = [column, row].map(|cell| cell as f64 * map.cell_px);
            let side = map.cell_px + 0.3;
            // Writing into a string cannot fail.
            let _ = write!(
                svg,
                r#"<rect x="{x:.1}" y="{y:.1}" width="{side:.1}" height="{side:.1}" fill="{}"/>"#,
                shade(*sigma_px)
            );
            if count > 0 {
                let radius = 0.4 * map.cell_px * (f64::from(count) / f64::from(most)).sqrt().max(0.15);
                let middle = 0.5 * map.cell_px;
                let _ = write!(
                    svg,
                    r##"<circle cx="{:.1}" cy="{:.1}" r="{radius:.1}" fill="#000000" fill-opacity="0.35"/>"##,
                    x + middle,
                    y + middle
                );
            }
        }
    }
}

fn draw_legend(svg: &mut String, top: f64) {
    let step = LEGEND[0] / SHADES.len() as f64;
    for (index, (from_px, colour)) in SHADES.iter().enumerate() {
        let x = 16.0 + index as f64 * step;
        let _ = write!(
            svg,
            r#"<rect x="{x:.1}" y="{top:.1}" width="{step:.1}" height="14" fill="{colour}"/><text x="{x:.1}" y="{:.1}">{from_px}</text>"#,
            top + 30.0
        );
    }
    let _ = write!(
        svg,
        r#"<text x="16" y="{:.1}">standard deviation of the projection, pixels; dots: lines measured</text>"#,
        top + 50.0
    );
}

fn shade(sigma_px: f64) -> &'static str {
    SHADES.iter().rev().find(|(from_px, _)| sigma_px >= *from_px).map_or(SHADES[0].1, |(_, colour)| colour)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
