//! Devices that can run the filter and draw pictures, as the program offers them.

use std::{fmt, sync::Arc};

use eframe::egui::{ComboBox, Response, Ui};
use reality_sim_core::backend::{Backend, BackendError, CpuBackend, DeviceChoice};

/// Opens a device; called by a thread that may wait.
type Open = dyn Fn() -> Result<Arc<dyn Backend>, BackendError> + Send + Sync;

/// Device that the user can choose: the default one of a kind, or a graphics adapter.
#[derive(Clone)]
pub struct Device {
    choice: DeviceChoice,
    adapter: Option<String>,
    open: Arc<Open>,
}

impl Device {
    /// Makes the default device of a kind. `open` is called when the device is chosen, by a thread that may wait.
    pub fn new(
        choice: DeviceChoice,
        open: impl Fn() -> Result<Arc<dyn Backend>, BackendError> + Send + Sync + 'static,
    ) -> Self {
        Self { choice, adapter: None, open: Arc::new(open) }
    }

    /// Makes the graphics adapter with this name. `open` is called as by [`Device::new`].
    pub fn adapter(
        name: impl Into<String>,
        open: impl Fn() -> Result<Arc<dyn Backend>, BackendError> + Send + Sync + 'static,
    ) -> Self {
        Self { adapter: Some(name.into()), ..Self::new(DeviceChoice::Gpu, open) }
    }

    /// Makes the processor.
    pub fn processor() -> Self {
        Self::new(DeviceChoice::Cpu, || Ok(Arc::new(CpuBackend)))
    }

    /// Returns the name in the list: the adapter's, or the kind's as in the program's options.
    pub fn name(&self) -> &str {
        self.adapter.as_deref().unwrap_or(self.choice.name())
    }

    /// Opens the device, which may take a while.
    pub(crate) fn open(&self) -> Result<Arc<dyn Backend>, BackendError> {
        (self.open)()
    }
}

/// Compares devices by name.
impl PartialEq for Device {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl fmt::Debug for Device {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("Device").field(&self.name()).finish()
    }
}

/// Returns the device with this name, or the first device.
pub(crate) fn by_name<'a>(devices: &'a [Device], name: &str) -> Option<&'a Device> {
    devices.iter().find(|device| device.name() == name).or(devices.first())
}

/// Shows a list for choosing a device by its name.
pub(crate) fn list_ui(ui: &mut Ui, devices: &[Device], chosen: &mut String, width: f32) -> Response {
    let shown = by_name(devices, chosen).map_or("", Device::name).to_owned();
    let list = ComboBox::from_id_salt("device").selected_text(shown).width(width).truncate();
    let list = list.show_ui(ui, |ui| {
        for device in devices {
            ui.selectable_value(chosen, device.name().to_owned(), device.name())
                .on_hover_text(device.choice.description());
        }
    });
    list.response
}
