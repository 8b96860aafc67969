//! From recordings to a database: poses, smoothing, storage, the hall around the field and the clean stage, as one stream of events.
//!
//! | type | purpose |
//! |---|---|
//! | [`Plan`] | which recordings and databases, where their poses come from, and what is done with them |
//! | [`Pipeline`] | a running plan: an iterator of [`Event`]s, cancelled by dropping it |
//! | [`PoseChoice`], [`FilterPlan`] | where poses come from |
//!
//! ```
//! use std::{path::Path, sync::Arc};
//!
//! use reality_sim_core::sequence::Sequence;
//! use reality_sim_pipeline::{Event, Plan, PoseChoice};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let file = folder.path().join("walk.db");
//! let walk = Arc::new(Sequence::open(Path::new("../../assets/walk"))?);
//! let plan = Plan::new([walk], PoseChoice::ReferenceElseFilter).with_database(&file);
//! for event in plan.start() {
//!     match event? {
//!         Event::Stored { done, of, .. } => assert!(done <= of),
//!         Event::Completed { images, hall } => assert!(images == 60 && hall.is_some()),
//!         _ => {}
//!     }
//! }
//! # Ok(())
//! # }
//! ```

mod error;
mod event;
mod outbox;
mod pipeline;
mod plan;
mod poses;
mod storage;

pub use self::{
    error::PipelineError,
    event::{CleanStageSummary, Event, FoundPoses},
    pipeline::Pipeline,
    plan::{Device, FilterPlan, HoldBack, OpenDevice, Plan, PoseChoice},
};

#[cfg(test)]
mod tests;
