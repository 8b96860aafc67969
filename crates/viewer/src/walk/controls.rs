//! Settings of the filter and of the layers. Changes take effect at once.

use eframe::egui::{self, Color32, ComboBox, DragValue, RichText, Ui};
use reality_sim_core::{filter::Resampling, observation::ObservationKind};

use super::settings::{FilterSettings, Layers, Veil};
use crate::{
    colors,
    device::{Device, list_ui},
};

/// Shows the filter's settings.
pub fn filter(ui: &mut Ui, settings: &mut FilterSettings, devices: &[Device]) {
    ui.strong("Filter");
    egui::Grid::new("filter").num_columns(2).spacing([8.0, 4.0]).show(ui, |ui| {
        model(ui, settings);
        row(ui, "Particle count", "How many poses are weighed against each picture", |ui| {
            ui.add(DragValue::new(&mut settings.particles).range(1..=100_000).speed(10))
        });
        row(ui, "Iterations", "Rounds of weighing and resampling a picture (the paper's T)", |ui| {
            ui.add(DragValue::new(&mut settings.iterations).range(1..=50).speed(0.1))
        });
        observation(ui, settings);
        resampling(ui, settings);
        row(ui, "Computed by", "Where particles are weighed", |ui| {
            list_ui(ui, devices, &mut settings.device, 110.0)
        });
    });
    ui.checkbox(&mut settings.odometry, "Use the odometry")
        .on_hover_text("Without it, the picture before alone predicts the next one, as in the paper");
    ui.checkbox(&mut settings.recovery, "Search when lost")
        .on_hover_text("Looks over the field where the lines do not fit any more");
    if ui.button("Defaults").on_hover_text("All of the filter's settings as they come").clicked() {
        *settings = FilterSettings::default();
    }
}

/// Shows a name and a widget labelled by it.
fn row(ui: &mut Ui, name: &str, explanation: &str, widget: impl FnOnce(&mut Ui) -> egui::Response) {
    let label = ui.label(name).on_hover_text(explanation);
    widget(ui).labelled_by(label.id).on_hover_text(explanation);
    ui.end_row();
}

fn model(ui: &mut Ui, settings: &mut FilterSettings) {
    let kind = settings.observation.kind;
    let mut chosen = kind;
    row(ui, "Model", "What a pose is weighed by", |ui| {
        let combo = ComboBox::from_id_salt("model").selected_text(kind.name()).show_ui(ui, |ui| {
            for kind in ObservationKind::ALL {
                ui.selectable_value(&mut chosen, kind, kind.name()).on_hover_text(kind.description());
            }
        });
        combo.response
    });
    if chosen != kind {
        settings.set_model(chosen);
    }
}

/// Shows the settings of the chosen observation model.
fn observation(ui: &mut Ui, settings: &mut FilterSettings) {
    let observation = &mut settings.observation;
    if observation.kind != ObservationKind::Distance {
        row(ui, "Blur, px", "Sigma of the Gaussian blur", |ui| {
            ui.add(
                DragValue::new(&mut observation.blur_sigma_px).range(0.0..=10.0).speed(0.02).max_decimals(2),
            )
        });
    }
    if observation.kind == ObservationKind::Contrast {
        row(ui, "Gain", "Log-weight of a line sample that is found", |ui| {
            ui.add(DragValue::new(&mut observation.contrast_gain).range(0.01..=10.0).speed(0.01))
        });
    } else {
        row(
            ui,
            "α",
            "Divides the sum along the lines: the smaller, the more the best particles count",
            |ui| ui.add(DragValue::new(&mut observation.alpha).range(1.0..=100_000.0).speed(2.0)),
        );
    }
}

fn resampling(ui: &mut Ui, settings: &mut FilterSettings) {
    row(ui, "Resampling", "How survivors are chosen", |ui| {
        let combo = ComboBox::from_id_salt("resampling").selected_text(settings.resampling.name()).show_ui(
            ui,
            |ui| {
                for scheme in Resampling::ALL {
                    ui.selectable_value(&mut settings.resampling, scheme, scheme.name());
                }
            },
        );
        combo.response
    });
}

/// Shows a switch for each layer, in the layer's colour.
pub fn layers(ui: &mut Ui, layers: &mut Layers, has_truth: bool) {
    let switch = |ui: &mut Ui, is_on: &mut bool, color: Color32, name: &str, explanation: &str| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let (rect, _) = ui.allocate_exact_size(egui::vec2(10.0, 10.0), egui::Sense::hover());
            ui.painter().circle_filled(rect.center(), 4.5, color);
            ui.checkbox(is_on, name).on_hover_text(explanation);
        });
    };
    ui.strong("Shown");
    switch(ui, &mut layers.pose, colors::POSE, "Pose found", "Both edges of the lines at the pose found");
    switch(
        ui,
        &mut layers.best_particle,
        colors::PARTICLE,
        "Best particle",
        "The filter's own pose, before the fit",
    );
    if has_truth {
        switch(
            ui,
            &mut layers.truth,
            colors::TRUTH,
            "Truth",
            "The lines' centres at the true pose, and the true way",
        );
    }
    switch(ui, &mut layers.border, colors::BORDER, "Field's border", "As it was found in the picture");
    switch(ui, &mut layers.particles, colors::PARTICLE, "Particles", "The heavier, the brighter and larger");
    switch(
        ui,
        &mut layers.inset,
        colors::PARTICLE,
        "Enlarged particles",
        "A small square of the field around the pose found, while the particles lie too close together to be told apart",
    );
    switch(ui, &mut layers.path, colors::POSE, "Way found", "The places found so far");
    switch(
        ui,
        &mut layers.odometry,
        colors::ODOMETRY,
        "Odometry alone",
        "Where dead reckoning from the first pose leads",
    );
    switch(ui, &mut layers.footprint, colors::BORDER, "Footprint", "The ground in view");
    ui.checkbox(&mut layers.follow, "Follow when enlarged").on_hover_text(
        "Keeps the pose found in the middle of the field's view while that is enlarged (wheel)",
    );
    veil(ui, layers);
}

fn veil(ui: &mut Ui, layers: &mut Layers) {
    ui.add_space(4.0);
    let label = ui.label("Over the picture");
    let combo = ComboBox::from_id_salt("veil").selected_text(layers.veil.name()).show_ui(ui, |ui| {
        for veil in Veil::ALL {
            ui.selectable_value(&mut layers.veil, veil, veil.name()).on_hover_text(veil.explanation());
        }
    });
    combo.response.labelled_by(label.id).on_hover_text(layers.veil.explanation());
    if layers.veil != Veil::None {
        let slider = egui::Slider::new(&mut layers.veil_opacity, 0.0..=1.0).show_value(false);
        ui.add(slider.text("opacity"));
    }
}

/// Shows a fact and its value.
pub fn fact(ui: &mut Ui, name: &str, value: impl Into<RichText>) {
    ui.label(RichText::new(name).weak());
    ui.label(value.into());
    ui.end_row();
}
