//! Plan of a pipeline.

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

/// Recordings, where their poses come from, and what is done with them. Without a database the pipeline ends once it has
/// the poses.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Plan {
    /// Recordings, in the order in which they are stored.
    pub recordings: Vec<Arc<Sequence>>,
    /// Databases whose images are added before the recordings, in this order.
    pub databases: Vec<PathBuf>,
    /// Source of the recordings' poses.
    pub poses: PoseChoice,
    /// Configuration of the filter, where it is used.
    pub filter: FilterPlan,
    /// Path of the database, which is created if there is none.
    pub database: Option<PathBuf>,
    /// Whether the hall around the field is measured and stored.
    pub measures_hall: bool,
    /// Whether the clean stage is found and stored: the carpet without the things that stood on it, and where pictures show these.
    pub finds_clean_stage: bool,
    /// Frames that are not stored but kept for comparison.
    pub hold_back: Option<HoldBack>,
}

/// Source of poses.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PoseChoice {
    /// TUM file with the poses of the only recording.
    File(PathBuf),
    /// Reference poses of a recording that has any, and the particle filter for a recording that has none.
    ReferenceElseFilter,
    /// Particle filter.
    Filter,
}

/// Configuration of the particle filter.
#[derive(Clone)]
#[non_exhaustive]
pub struct FilterPlan {
    /// Settings of the localizer.
    pub config: LocalizerConfig,
    /// Opens the device that the filter runs on, when it is first needed.
    pub device: OpenDevice,
    /// Whether all poses of a recording are smoothed together.
    pub smooths: bool,
    /// Whether poses that the filter is not sure of are kept.
    pub keeps_unsure: bool,
    /// Name and version of the program, which the database records.
    pub program: String,
}

/// Function that opens a device.
pub type OpenDevice = Arc<dyn Fn() -> Result<Device, BackendError> + Send + Sync>;

/// Device with the name that the database records.
#[derive(Clone)]
pub struct Device {
    /// Name of the device.
    pub name: String,
    /// Backend of the device.
    pub backend: Arc<dyn Backend>,
}

/// Rule for held-back frames: every n-th of those with a pose, starting in the middle of the first n.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HoldBack {
    /// Interval n: one of n frames is held back.
    pub every: usize,
    /// Smallest number of poses; recordings with fewer need all of their frames.
    pub at_least: usize,
}

impl Plan {
    /// Makes a plan for recordings, without a database.
    pub fn new(recordings: impl IntoIterator<Item = Arc<Sequence>>, poses: PoseChoice) -> Self {
        let recordings = recordings.into_iter().collect();
        let filter = FilterPlan::default();
        Self {
            recordings,
            databases: Vec::new(),
            poses,
            filter,
            database: None,
            measures_hall: true,
            finds_clean_stage: true,
            hold_back: None,
        }
    }

    /// Sets the databases whose images are added.
    pub fn with_databases(self, databases: Vec<PathBuf>) -> Self {
        Self { databases, ..self }
    }

    /// Sets the configuration of the filter.
    pub fn with_filter(self, filter: FilterPlan) -> Self {
        Self { filter, ..self }
    }

    /// Sets the database, which is created if there is none.
    pub fn with_database(self, path: &Path) -> Self {
        Self { database: Some(path.to_path_buf()), ..self }
    }

    /// Sets whether the hall is measured.
    pub fn with_hall(self, measures_hall: bool) -> Self {
        Self { measures_hall, ..self }
    }

    /// Sets whether the clean stage is found.
    pub fn with_clean_stage(self, finds_clean_stage: bool) -> Self {
        Self { finds_clean_stage, ..self }
    }

    /// Sets the rule for held-back frames.
    pub fn with_hold_back(self, hold_back: HoldBack) -> Self {
        Self { hold_back: Some(hold_back), ..self }
    }
}

impl Default for FilterPlan {
    /// Default settings, on the processor, smoothed.
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
    /// Sets the settings of the localizer.
    pub fn with_config(self, config: LocalizerConfig) -> Self {
        Self { config, ..self }
    }

    /// Sets the device.
    pub fn with_device(self, device: OpenDevice) -> Self {
        Self { device, ..self }
    }

    /// Sets whether poses are smoothed.
    pub fn with_smoothing(self, smooths: bool) -> Self {
        Self { smooths, ..self }
    }

    /// Sets whether poses that the filter is not sure of are kept.
    pub fn with_unsure(self, keeps_unsure: bool) -> Self {
        Self { keeps_unsure, ..self }
    }

    /// Sets the name of the program.
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
