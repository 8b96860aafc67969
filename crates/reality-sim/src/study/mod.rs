//! Study of one recording: what `tag`, `gap`, `evaluate` and `dataset` make of it, with one or many settings. It is the unit of work of those who
//! have thousands of recordings: a function of files and settings alone, whose result depends neither on the machine nor on the number
//! of its threads, and holds no times. Nothing that is wrong with one recording, or with one of the settings, stops the others.
//!
//! ```
//! use std::path::Path;
//!
//! use reality_sim::study::{StudySettings, study};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let settings = [r#"{"job": "tag", "particles": 200}"#, r#"{"job": "gap", "frames": [0, 5]}"#];
//! let settings = settings.map(serde_json::from_str::<StudySettings>).into_iter().collect::<Result<Vec<_>, _>>()?;
//! let found = study(Path::new("../../assets/pitch"), &settings);
//! assert!(found[0].as_ref().is_ok_and(|tags| tags.figures["lines_within_10px"] > 0.9));
//! assert!(found[1].as_ref().is_err_and(|error| error.to_string().contains("5 frames")));
//! # Ok(())
//! # }
//! ```

mod built;
mod dataset;
mod error;
mod evaluate;
mod findings;
mod gap;
mod run;
mod settings;
mod tag;

pub use self::{
    dataset::PictureSetSettings,
    error::StudyError,
    evaluate::EvaluationSettings,
    findings::{About, Findings},
    run::study,
    settings::StudySettings,
};
