//! Coverage as colours on the carpet.

use std::sync::Arc;

use eframe::egui::{self, Color32, Rect, Ui, vec2};
use glam::DVec2;
use reality_sim_db::coverage::{Coverage, CoverageCell, FAR_PX, shade_srgb};

use super::{
    super::source::Source,
    layers::{CoverageLayer, Layers},
};
use crate::{
    background::{Outcome, Task},
    field_view::FieldCanvas,
    problems::Problems,
};

/// Side of a cell of the coverage grid, metres.
const CELL_M: f64 = 0.25;

/// Coverage, counted in the background once it is needed.
pub struct CoverageMap(Counted);

enum Counted {
    NotYet,
    Counting(Task<Coverage>),
    Done(Coverage),
    /// Not possible, or not requested.
    Never,
}

impl Default for CoverageMap {
    fn default() -> Self {
        Self(Counted::NotYet)
    }
}

/// Counting holds the database, which may be temporary, so the drop waits for it.
impl Drop for CoverageMap {
    fn drop(&mut self) {
        if let Counted::Counting(task) = std::mem::replace(&mut self.0, Counted::Never) {
            task.finish();
        }
    }
}

impl CoverageMap {
    /// Starts counting the coverage once it is needed.
    pub fn poll(&mut self, ui: &Ui, source: &Arc<Source>, layers: &mut Layers, problems: &mut Problems) {
        if layers.coverage == CoverageLayer::Off {
            return;
        }
        match &self.0 {
            Counted::NotYet => {
                let source = source.clone();
                self.0 =
                    Counted::Counting(Task::spawn(ui.ctx(), "Looking at the coverage …", move |progress| {
                        let (archive, goes_on) = (&source.archive, || !progress.is_cancelled());
                        let (field, usual) = (archive.field(), archive.usual_pose());
                        let coverage = Coverage::new_while(archive.index(), field, usual, CELL_M, goes_on);
                        coverage.ok_or_else(|| "cancelled".to_owned())
                    }));
            }
            Counted::Counting(task) => match task.poll() {
                Some(Outcome::Done(coverage)) => self.0 = Counted::Done(coverage),
                Some(Outcome::Failed(reason)) => {
                    problems.add(reason);
                    self.0 = Counted::Never;
                }
                Some(Outcome::Cancelled) => {
                    (self.0, layers.coverage) = (Counted::NotYet, CoverageLayer::Off);
                }
                None => {}
            },
            Counted::Done(_) | Counted::Never => {}
        }
    }

    /// Shows the meaning of the colours.
    pub fn legend_ui(&self, ui: &mut Ui, layer: CoverageLayer) {
        match (&self.0, layer) {
            (_, CoverageLayer::Off) | (Counted::NotYet | Counted::Never, _) => {}
            (Counted::Counting(task), _) => task.ui(ui),
            (Counted::Done(coverage), CoverageLayer::Pictures) => {
                ui.weak("1");
                scale(ui, |share| shade(share.max(1.0 / most(coverage))));
                let square = 100.0 * coverage.cell_m;
                ui.weak(format!("{:.0} in {square:.0} cm × {square:.0} cm", most(coverage)));
            }
            (Counted::Done(_), CoverageLayer::Distance) => {
                ui.weak("0");
                scale(ui, |share| shade(1.0 - share));
                ui.weak(format!("{FAR_PX:.0} px or more, mean over all headings"));
            }
        }
    }

    /// Colours the carpet.
    pub fn draw(&self, canvas: &FieldCanvas, layer: CoverageLayer) {
        let Counted::Done(coverage) = &self.0 else { return };
        let most = most(coverage);
        let color = |cell: &CoverageCell| match layer {
            CoverageLayer::Off => None,
            CoverageLayer::Pictures if cell.count() == 0 => None,
            CoverageLayer::Pictures => Some(shade(f64::from(cell.count()) / most)),
            CoverageLayer::Distance => Some(shade(1.0 - cell.mean_distance_px() / FAR_PX)),
        };
        let half = DVec2::splat(0.5 * coverage.cell_m);
        for cell in &coverage.cells {
            if let Some(color) = color(cell) {
                let corners = [cell.middle_in_world - half, cell.middle_in_world + half]
                    .map(|corner| canvas.at(corner));
                let rect = Rect::from_two_pos(corners[0], corners[1]);
                canvas.painter.rect_filled(rect, 0.0, color.gamma_multiply(0.8));
            }
        }
    }
}

/// Returns the colour of a fraction of the coverage: brighter means better covered, as the carpet is dark.
fn shade(share: f64) -> Color32 {
    let [red, green, blue] = shade_srgb(1.0 - share);
    Color32::from_rgb(red, green, blue)
}

fn most(coverage: &Coverage) -> f64 {
    f64::from(coverage.cells.iter().map(CoverageCell::count).max().unwrap_or(0).max(1))
}

/// Shows a colour bar.
fn scale(ui: &mut Ui, color: impl Fn(f64) -> Color32) {
    const STEPS: u32 = 24;
    let (rect, _) = ui.allocate_exact_size(vec2(96.0, 10.0), egui::Sense::hover());
    let step = rect.width() / STEPS as f32;
    for number in 0..STEPS {
        let color = color(f64::from(number) / f64::from(STEPS - 1));
        let left = rect.left() + step * number as f32;
        let part = Rect::from_x_y_ranges(left..=left + step, rect.y_range());
        ui.painter().rect_filled(part, 0.0, color);
    }
}
