//! Error of a library that reads or writes a file format.

use std::{error::Error, fmt};

use super::printable::one_line;

/// Error of a parser, decoder or encoder, with its message on one line. [`FormatError::get_ref`] returns that library's own
/// error.
#[derive(Debug)]
pub struct FormatError {
    message: String,
    error: Box<dyn Error + Send + Sync>,
}

impl FormatError {
    /// Wraps an error of a library, with the error's own message.
    pub fn new(error: impl Error + Send + Sync + 'static) -> Self {
        Self::with_message(error.to_string(), error)
    }

    /// Wraps an error of a library, with a message in place of the error's own, which may quote the file on several lines.
    pub fn with_message(message: impl fmt::Display, error: impl Error + Send + Sync + 'static) -> Self {
        Self { message: one_line(message), error: Box::new(error) }
    }

    /// Returns the library's own error.
    pub fn get_ref(&self) -> &(dyn Error + Send + Sync + 'static) {
        &*self.error
    }
}

impl fmt::Display for FormatError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.message)
    }
}

impl Error for FormatError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.error.source()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_s_error_is_kept_behind_a_message_of_one_line() {
        let error = toml::from_str::<toml::Table>("a = 1\na = 2").unwrap_err();
        assert!(error.to_string().contains('\n'));
        let wrapped = FormatError::new(error);
        assert!(!wrapped.to_string().contains('\n'));
        assert!(wrapped.get_ref().is::<toml::de::Error>());
    }
}
