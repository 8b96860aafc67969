//! Options and commands that remedy errors of the library, which knows nothing of a command line.

#[cfg(feature = "gpu")]
use reality_sim::gpu::GpuError;
use reality_sim::{
    LocalizationError, SynthesisError,
    backend::BackendError,
    db::{DbError, DbFault, index::NoNeighbours},
    gap::RecordingError,
    pipeline::PipelineError,
};
#[cfg(feature = "viewer")]
use reality_sim_viewer::ViewerError;

/// Returns what to type, in a few words; `None` if the message says everything.
pub fn advice(error: &anyhow::Error) -> Option<&'static str> {
    error.chain().find_map(|cause| {
        if let Some(error) = cause.downcast_ref() {
            return of_synthesis(error);
        }
        if let Some(error) = cause.downcast_ref() {
            return of_pipeline(error);
        }
        if let Some(RecordingError::TooFewFrames { .. }) = cause.downcast_ref() {
            return Some("`--frames`, `--poses`");
        }
        if let Some(LocalizationError::Backend(error)) = cause.downcast_ref() {
            return of_backend(error);
        }
        #[cfg(feature = "gpu")]
        if let Some(error) = cause.downcast_ref() {
            return of_graphics(error);
        }
        #[cfg(feature = "viewer")]
        if let Some(ViewerError::NoGraphics(_)) = cause.downcast_ref() {
            return Some("`reality-sim doctor` lists those that are there");
        }
        of_database(cause.downcast_ref()?)
    })
}

fn of_synthesis(error: &SynthesisError) -> Option<&'static str> {
    match error {
        SynthesisError::Database(error) => of_database(error),
        SynthesisError::Backend(error) => of_backend(error),
        SynthesisError::Empty { .. } => Some("`reality-sim build RECORDING --out DATABASE`"),
        SynthesisError::NoNeighbours { reason: NoNeighbours::OutOfReach { .. }, .. }
        | SynthesisError::TooLittleSeen { .. } => Some("`--best-effort`"),
        SynthesisError::OtherSize { .. } | SynthesisError::TooFewPoints { .. } => {
            Some("`--method plane` or `--method blend`")
        }
        _ => None,
    }
}

fn of_pipeline(error: &PipelineError) -> Option<&'static str> {
    match error {
        PipelineError::Database(error) => of_database(error),
        PipelineError::Hall(error) => of_synthesis(error),
        PipelineError::Device(error) | PipelineError::Localization(LocalizationError::Backend(error)) => {
            of_backend(error)
        }
        _ => None,
    }
}

#[cfg(feature = "gpu")]
fn of_backend(error: &BackendError) -> Option<&'static str> {
    error.get_ref().downcast_ref().and_then(of_graphics)
}

#[cfg(not(feature = "gpu"))]
fn of_backend(_: &BackendError) -> Option<&'static str> {
    None
}

fn of_database(error: &DbError) -> Option<&'static str> {
    match error {
        DbError::Database { fault: DbFault::Missing, .. } => {
            Some("`reality-sim build RECORDING --out DATABASE`")
        }
        DbError::Database { fault: DbFault::Older { .. }, .. } => {
            Some("`reality-sim build`, with one of its recordings, opens it for writing")
        }
        _ => None,
    }
}

#[cfg(feature = "gpu")]
fn of_graphics(error: &GpuError) -> Option<&'static str> {
    match error {
        GpuError::NoSuchAdapter { .. } => Some("`reality-sim doctor` lists them"),
        _ => Some("`--backend cpu`"),
    }
}

#[cfg(test)]
mod tests {
    use anyhow::Context;

    use super::*;

    #[test]
    fn an_option_of_the_command_is_found_behind_context_and_other_errors_have_none() {
        let empty = SynthesisError::Empty { database: "walk.db".to_owned() };
        let error = Err::<(), _>(empty).context("walk.db").expect_err("it is one");
        assert!(advice(&error).is_some_and(|words| words.contains("--out")));
        assert_eq!(advice(&anyhow::anyhow!("something else")), None);
    }
}
