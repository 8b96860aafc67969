//! The kind of device that a person asks for.

use std::{fmt, str::FromStr};

use crate::names::{UnknownName, by_name};

/// Kind of device to compute on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DeviceChoice {
    /// A graphics card where there is one, else the processor.
    #[default]
    Auto,
    /// This processor.
    Cpu,
    /// A graphics card.
    Gpu,
}

impl DeviceChoice {
    /// All, in the order in which they are listed.
    pub const ALL: [Self; 3] = [Self::Auto, Self::Cpu, Self::Gpu];

    /// Its name in options and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
        }
    }

    /// Returns a description in one line.
    pub fn description(self) -> &'static str {
        match self {
            Self::Auto => "A graphics card where there is one, else the processor",
            Self::Cpu => "This processor",
            Self::Gpu => "A graphics card",
        }
    }
}

impl fmt::Display for DeviceChoice {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for DeviceChoice {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        by_name("device", &Self::ALL, Self::name, name)
    }
}
