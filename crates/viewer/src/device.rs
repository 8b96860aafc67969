//! Devices that can run the filter and draw pictures, as the program offers them.

use std::{fmt, sync::Arc};

use eframe::egui::{ComboBox, Response, Ui};
use reality_sim_core::backend::{Backend, BackendError};

/// Device that the user can choose.
#[derive(Clone)]
pub struct Device {
    /// Name in the list.
    pub name: String,
    /// Opens the device; called by a thread that may wait.
    pub open: Arc<dyn Fn() -> Result<Arc<dyn Backend>, BackendError> + Send + Sync>,
}

/// Compares devices by name.
impl PartialEq for Device {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl fmt::Debug for Device {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("Device").field(&self.name).finish()
    }
}

/// Returns the device with this name, or the first device.
pub(crate) fn by_name<'a>(devices: &'a [Device], name: &str) -> Option<&'a Device> {
    devices.iter().find(|device| device.name == name).or(devices.first())
}

/// Shows a list for choosing a device by its name.
pub(crate) fn list_ui(ui: &mut Ui, devices: &[Device], chosen: &mut String, width: f32) -> Response {
    let shown = by_name(devices, chosen).map_or("", |device| &device.name).to_owned();
    let list = ComboBox::from_id_salt("device").selected_text(shown).width(width).truncate();
    let list = list.show_ui(ui, |ui| {
        for device in devices {
            ui.selectable_value(chosen, device.name.clone(), &device.name);
        }
    });
    list.response
}
