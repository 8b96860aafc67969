//! Comparison of a recording with a camera's model, as the program's `gap` does it: poses to compare at, and the analysis.
//!
//! ```
//! use std::path::Path;
//!
//! use reality_sim::{Sequence, comparison::{ComparisonSettings, compare}};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let sequence = Sequence::open(Path::new("../../assets/pitch"))?;
//! let settings = ComparisonSettings { frames: Some([0, 30]), ..ComparisonSettings::default() };
//! let comparison = compare(&sequence, &settings)?;
//! assert!(comparison.analysis.model.values("mount_pitch").is_some(), "the mount is pitched otherwise than its files say");
//! # Ok(())
//! # }
//! ```

mod compare;
mod error;
mod poses;
mod settings;

pub use self::{
    compare::{Comparison, compare},
    error::ComparisonError,
    poses::ReferencePoses,
    settings::ComparisonSettings,
};
