//! Diverging colours for signed numbers, distinguishable with any colour vision: blue below zero, white at zero, red above.

use eframe::egui::{Align2, Color32, FontId, Rect, Role, Sense, Ui, WidgetInfo, lerp, pos2, vec2};
use reality_sim_gap::{
    Channel,
    report::text::{amount, channel_scale, digits},
};

/// Colours from the lowest value to the highest, evenly spaced.
const STOPS: [[u8; 3]; 5] =
    [[33, 102, 172], [146, 197, 222], [247, 247, 247], [244, 165, 130], [178, 24, 43]];
/// Share of the values within the limits; the others have the colours at the ends.
const WITHIN: f64 = 0.97;
/// Number of colours in the legend.
const STEPS: usize = 48;

/// Colours between two limits that are symmetric about zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    limit: f64,
}

impl Ramp {
    /// Chooses the limits so that few values lie beyond them. `None` if there are no values.
    pub fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let mut sizes: Vec<f64> = values.map(f64::abs).collect();
        sizes.sort_by(f64::total_cmp);
        let place = ((sizes.len() as f64 - 1.0) * WITHIN).max(0.0) as usize;
        sizes.get(place).map(|size| Self { limit: size.max(f64::MIN_POSITIVE) })
    }

    /// Returns the upper limit.
    pub fn limit(self) -> f64 {
        self.limit
    }

    /// Returns the colour of a value.
    pub fn color(self, value: f64) -> Color32 {
        let place = (0.5 + 0.5 * value / self.limit).clamp(0.0, 1.0) as f32 * (STOPS.len() - 1) as f32;
        let below = (place as usize).min(STOPS.len() - 2);
        let share = place - below as f32;
        let channel = |channel: usize| {
            lerp(f32::from(STOPS[below][channel])..=f32::from(STOPS[below + 1][channel]), share).round() as u8
        };
        Color32::from_rgb(channel(0), channel(1), channel(2))
    }

    /// Shows the colours with their values.
    pub fn legend_ui(self, ui: &mut Ui, channel: Channel, width: f32) {
        let number = digits(channel_scale(channel).0 * self.limit, 3);
        let limit = amount(channel, self.limit, channel.unit(), 3);
        let text = format!("−{number} to {limit}");
        let (rect, response) = ui.allocate_exact_size(vec2(width, 18.0), Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &text));
        let step = rect.width() / STEPS as f32;
        for place in 0..STEPS {
            let left = rect.left() + step * place as f32;
            let value = self.limit * (2.0 * (place as f64 + 0.5) / STEPS as f64 - 1.0);
            let strip = Rect::from_min_max(pos2(left, rect.top()), pos2(left + step + 0.5, rect.bottom()));
            ui.painter().rect_filled(strip.intersect(rect), 0.0, self.color(value));
        }
        let font = FontId::proportional(11.0);
        let ends = [
            (rect.left_center() + vec2(4.0, 0.0), Align2::LEFT_CENTER, format!("−{number}"), Color32::WHITE),
            (rect.center(), Align2::CENTER_CENTER, "0".to_owned(), Color32::BLACK),
            (rect.right_center() - vec2(4.0, 0.0), Align2::RIGHT_CENTER, format!("+{limit}"), Color32::WHITE),
        ];
        for (place, align, text, color) in ends {
            ui.painter().text(place, align, text, font.clone(), color);
        }
        response.on_hover_text(format!(
            "Measured minus simulated, {text}; what is beyond has the colours at the ends"
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_is_white_and_the_signs_are_blue_and_red_up_to_the_limits_and_beyond() {
        let ramp = Ramp { limit: 2.0 };
        assert_eq!(ramp.color(0.0), Color32::from_rgb(247, 247, 247));
        let [below, above] = [-1.0, 1.0].map(|value| ramp.color(value));
        assert!(below.b() > below.r() && above.r() > above.b());
        assert_eq!([ramp.color(-2.0), ramp.color(2.0)], [ramp.color(-9.0), ramp.color(9.0)]);
    }

    #[test]
    fn a_stray_value_does_not_bleach_the_others() {
        let values = (0..100).map(|number| if number == 50 { 1e6 } else { f64::from(number % 10) });
        assert_eq!(Ramp::of(values), Some(Ramp { limit: 9.0 }));
        assert_eq!(Ramp::of(std::iter::empty()), None);
        let zeros = Ramp::of([0.0, 0.0].into_iter()).unwrap();
        assert_eq!(zeros.color(0.0), Color32::from_rgb(247, 247, 247));
    }
}
