//! What a pipeline is to do.

use std::{
    fmt,
    path::{Path, PathBuf},
    sync::Arc,
};

use reality_sim_core::{
    backend::{Backend, BackendError, CpuBackend},
    localization::LocalizerConfig,
    sequence::Sequence,
};

/// Which recordings, where their poses come from, and what becomes of them. Without a database the pipeline ends with the
/// poses.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Plan {
    /// The recordings, in the order in which they are stored.
    pub recordings: Vec<Arc<Sequence>>,
    /// Where their poses come from.
    pub poses: PoseChoice,
    /// How the filter finds poses, where it does.
    pub filter: FilterPlan,
    /// The database's file; made where there is none.
    pub database: Option<PathBuf>,
    /// Measure the hall around the field and store it.
    pub measures_hall: bool,
    /// Frames that are not stored, to compare with.
    pub hold_back: Option<HoldBack>,
}

/// Where poses come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PoseChoice {
    /// A TUM file of the only recording's poses.
    File(PathBuf),
    /// The reference poses of a recording that has any, and the particle filter for those that have none.
    ReferenceElseFilter,
    /// The particle filter.
    Filter,
}

/// How the particle filter finds poses.
#[derive(Clone)]
#[non_exhaustive]
pub struct FilterPlan {
    /// Its settings.
    pub config: LocalizerConfig,
    /// Opens the device that it runs on, when it is first needed.
    pub device: OpenDevice,
    /// Smooth all poses of a recording together.
    pub smooths: bool,
    /// Keep poses that the filter is not sure of.
    pub keeps_unsure: bool,
    /// Name and version of the program, for the database.
    pub program: String,
}

/// Opens a device.
pub type OpenDevice = Arc<dyn Fn() -> Result<Device, BackendError> + Send + Sync>;

/// A device with the name that the database keeps.
#[derive(Clone)]
pub struct Device {
    /// What it is called.
    pub name: String,
    /// The device.
    pub backend: Arc<dyn Backend>,
}

/// Frames that are held back: every so many-th of those with a pose, counted from the middle of the first so many.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HoldBack {
    /// One of so many.
    pub every: usize,
    /// Recordings with fewer poses than this need all of their frames.
    pub at_least: usize,
}

impl Plan {
    /// A plan for recordings, without a database.
    pub fn new(recordings: impl IntoIterator<Item = Arc<Sequence>>, poses: PoseChoice) -> Self {
        let recordings = recordings.into_iter().collect();
        let filter = FilterPlan::default();
        Self { recordings, poses, filter, database: None, measures_hall: true, hold_back: None }
    }

    /// With these settings of the filter.
    pub fn with_filter(self, filter: FilterPlan) -> Self {
        Self { filter, ..self }
    }

    /// With a database; made where there is none.
    pub fn with_database(self, path: &Path) -> Self {
        Self { database: Some(path.to_path_buf()), ..self }
    }

    /// With or without measuring the hall.
    pub fn with_hall(self, measures_hall: bool) -> Self {
        Self { measures_hall, ..self }
    }

    /// With frames held back.
    pub fn with_hold_back(self, hold_back: HoldBack) -> Self {
        Self { hold_back: Some(hold_back), ..self }
    }
}

impl Default for FilterPlan {
    /// The usual settings, on this processor, smoothed.
    fn default() -> Self {
        Self {
            config: LocalizerConfig::default(),
            device: Arc::new(|| Ok(Device { name: "cpu".to_owned(), backend: Arc::new(CpuBackend) })),
            smooths: true,
            keeps_unsure: false,
            program: concat!("reality-sim-pipeline ", env!("CARGO_PKG_VERSION")).to_owned(),
        }
    }
}

impl FilterPlan {
    /// With other settings of the localizer.
    pub fn with_config(self, config: LocalizerConfig) -> Self {
        Self { config, ..self }
    }

    /// On another device.
    pub fn with_device(self, device: OpenDevice) -> Self {
        Self { device, ..self }
    }

    /// With or without smoothing.
    pub fn with_smoothing(self, smooths: bool) -> Self {
        Self { smooths, ..self }
    }

    /// With or without poses that the filter is not sure of.
    pub fn with_unsure(self, keeps_unsure: bool) -> Self {
        Self { keeps_unsure, ..self }
    }

    /// In the name of another program.
    pub fn with_program(self, program: &str) -> Self {
        Self { program: program.to_owned(), ..self }
    }
}

impl fmt::Debug for FilterPlan {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = formatter.debug_struct("FilterPlan");
        debug.field("config", &self.config).field("smooths", &self.smooths);
        debug.field("keeps_unsure", &self.keeps_unsure).field("program", &self.program);
        debug.finish_non_exhaustive()
    }
}

impl fmt::Debug for Device {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Device").field("name", &self.name).finish_non_exhaustive()
    }
}
