//! What is below the pictures: how fast they come, what they are made of, and what the colours mean.

use eframe::egui::{self, Color32, RichText, Ui};
use reality_sim_synthesis::Archive;

use super::{
    answer::{Drawn, Facts},
    kind::Aspect,
    layout::Layout,
    overlay::{CLASSES, class_color},
    settings::DriveSettings,
    widgets::{hue, swatch},
};

/// Least fraction that is listed.
const LEAST_SHARE: f64 = 0.005;
/// Height of a row, points.
const ROW: f32 = 22.0;
/// Explanation of the pace.
const PACE_MEANS: &str = "frames/s: how often this picture was drawn anew in the last second in which it changed; nothing is drawn while nothing changes\ndrawing: the scene, from recorded pictures or the field's model, with decoding; not needed again while only things move\nthings: ball and robots with their light and shadows\nlabels: classes of all pixels, boxes, lines and crossings";

/// Returns the height of the rows, points.
pub fn height(settings: &DriveSettings) -> f32 {
    let made_of = if settings.layout == Layout::All { 0.0 } else { 2.0 };
    let classes = if settings.is_labelled { 1.0 } else { 0.0 };
    ROW * (1.0 + made_of + classes)
}

/// Shows the rows, for the first of the pictures.
pub fn ui(ui: &mut Ui, settings: &DriveSettings, drawn: Option<&Drawn>, archive: &Archive) {
    let Some(drawn) = drawn else { return };
    ui.weak(pace(&drawn.facts)).on_hover_text(PACE_MEANS);
    if settings.is_labelled {
        classes_ui(ui);
    }
    if settings.layout != Layout::All {
        made_of_ui(ui, settings.aspect, &drawn.facts, archive);
    }
}

/// Returns how fast a picture came, in words.
fn pace(facts: &Facts) -> String {
    let times = &facts.times;
    let parts = [("drawing", times.drawing_ms), ("things", times.things_ms), ("labels", times.labels_ms)];
    let parts = parts.into_iter().filter_map(|(name, ms)| Some(format!("{name} {:.0} ms", ms?)));
    let rate = facts.frames_per_s.map(|per_s| format!("{per_s:.0} frames/s"));
    rate.into_iter().chain(parts).collect::<Vec<_>>().join(" · ")
}

fn classes_ui(ui: &mut Ui) {
    ui.horizontal_wrapped(|ui| {
        for class in CLASSES {
            swatched(ui, class_color(class), class.name());
        }
    });
}

/// Shows the recorded pictures that a picture was made of.
fn made_of_ui(ui: &mut Ui, aspect: Aspect, facts: &Facts, archive: &Archive) {
    ui.horizontal_wrapped(|ui| match aspect {
        Aspect::Trust => {
            ui.weak("white: fully · black: not at all");
        }
        _ if facts.used.is_empty() => {
            ui.weak("made of no recorded picture");
        }
        _ => {
            ui.weak("made of");
            for (number, used) in facts.used.iter().enumerate() {
                if used.share >= LEAST_SHARE {
                    let frame = archive.images()[used.image as usize].frame_index;
                    let share = 100.0 * used.share;
                    let text = format!("frame {frame}, {:.0} px away: {share:.0} %", used.distance_px);
                    swatched(ui, hue(number), &text);
                }
            }
            if aspect == Aspect::Origins {
                swatched(ui, Color32::BLACK, "no recorded picture shows it");
            }
        }
    });
}

/// Shows words behind a colour swatch, in one row.
fn swatched(ui: &mut Ui, color: Color32, text: &str) {
    let row = egui::WidgetAtom::new((swatch(color), RichText::new(text).weak()));
    ui.add(row).widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, text));
}

#[cfg(test)]
mod tests {
    use super::{super::answer::Times, *};

    #[test]
    fn the_pace_names_only_parts_that_were_made() {
        let mut facts =
            Facts { times: Times { drawing_ms: Some(21.6), ..Times::default() }, ..Facts::default() };
        assert_eq!(pace(&facts), "drawing 22 ms");
        facts.times = Times { drawing_ms: None, things_ms: Some(4.2), labels_ms: Some(6.4) };
        facts.frames_per_s = Some(28.4);
        assert_eq!(pace(&facts), "28 frames/s · things 4 ms · labels 6 ms");
    }
}
