//! The same frame, measured and simulated: both with a line to drag between them, or their difference.

use eframe::egui::{Color32, Ui, Vec2};

use reality_sim_gap::report::text::digits;

use super::{loaded::Loaded, settings::GapSettings, side::Side, table::words, title::title_ui};
use crate::picture_view::{PictureCanvas, Uploaded};

/// Pictures on the graphics device.
#[derive(Default)]
pub struct Pictures {
    measured: Uploaded,
    simulated: [Uploaded; 2],
    differences: [Uploaded; 2],
}

impl Pictures {
    /// Draws the pictures into the room.
    pub fn ui(&mut self, ui: &mut Ui, loaded: &Loaded, settings: &mut GapSettings, room: Vec2) {
        let side = settings.side;
        if settings.is_difference {
            self.difference_ui(ui, loaded, side, room);
        } else {
            self.wipe_ui(ui, loaded, side, &mut settings.wipe_share, room);
        }
    }

    fn difference_ui(&mut self, ui: &mut Ui, loaded: &Loaded, side: Side, room: Vec2) {
        let limit =
            loaded.difference_ramp.map_or_else(String::new, |ramp| format!(", ±{}", digits(ramp.limit(), 3)));
        title_ui(
            ui,
            &format!("Difference {}{limit}", side.name()),
            &format!(
                "Brightness of frame {}, measured minus simulated, grey levels of 255: blue where the simulation is brighter, red where the measured picture is",
                loaded.report.shown_frame
            ),
        );
        let Some(difference) = side.of(&loaded.differences) else { return missing(ui, room) };
        let name = format!("difference {}", side.name());
        let canvas = PictureCanvas::allocate(ui, difference.size, room, &name);
        let uploaded = &mut self.differences[usize::from(side == Side::With)];
        canvas.draw(uploaded.texture(ui.ctx(), difference), Color32::WHITE);
    }

    fn wipe_ui(&mut self, ui: &mut Ui, loaded: &Loaded, side: Side, share: &mut f32, room: Vec2) {
        title_ui(
            ui,
            &format!("Measured | simulated {}", side.name()),
            &format!("Frame {}: drag the line", loaded.report.shown_frame),
        );
        let simulated = side.of(&loaded.simulated).as_ref();
        // If one picture is missing, the other is shown alone.
        let (Some(left), Some(right)) =
            (loaded.measured.as_ref().or(simulated), simulated.or(loaded.measured.as_ref()))
        else {
            return missing(ui, room);
        };
        let of = |is_there: bool, name: String| if is_there { name } else { format!("{name} is missing") };
        let names = [
            of(loaded.measured.is_some(), "measured".to_owned()),
            of(simulated.is_some(), format!("simulated {}", side.name())),
        ];
        let name = format!("{}, {:.0} % of the width; then {}", names[0], 100.0 * *share, names[1]);
        let canvas = PictureCanvas::allocate(ui, left.size, room, &name);
        let uploaded = &mut self.simulated[usize::from(side == Side::With)];
        let textures = [self.measured.texture(ui.ctx(), left), uploaded.texture(ui.ctx(), right)];
        canvas.drag_wipe(ui, share);
        canvas.draw_wipe(textures[0], textures[1], *share);
    }
}

fn missing(ui: &mut Ui, room: Vec2) {
    words(ui, room, "the report has no pictures of this");
}
