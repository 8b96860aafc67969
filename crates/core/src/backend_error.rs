//! Error of a device, whichever device it is.

use std::{error::Error, fmt, sync::Arc};

/// Error of a device that cannot do what was asked of it, or no longer works.
///
/// Message and sources are those of the device's own error; [`BackendError::get_ref`] returns that error.
#[derive(Debug, Clone)]
pub struct BackendError(Arc<dyn Error + Send + Sync>);

impl BackendError {
    /// Wraps the error of a device.
    pub fn new(error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self(Arc::from(error.into()))
    }

    /// Returns the device's own error.
    pub fn get_ref(&self) -> &(dyn Error + Send + Sync + 'static) {
        &*self.0
    }
}

impl fmt::Display for BackendError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(formatter)
    }
}

impl Error for BackendError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.0.source()
    }
}

#[cfg(test)]
mod tests {
    use std::io;

    use super::*;

    #[derive(Debug, thiserror::Error)]
    #[error("no answer")]
    struct NoAnswer(#[source] io::Error);

    #[test]
    fn a_device_s_error_is_kept_with_its_sources() {
        let error = BackendError::new(NoAnswer(io::ErrorKind::TimedOut.into()));
        assert_eq!(error.to_string(), NoAnswer(io::ErrorKind::Other.into()).to_string());
        assert!(error.get_ref().is::<NoAnswer>());
        assert!(error.source().is_some_and(<dyn Error>::is::<io::Error>));
    }
}
