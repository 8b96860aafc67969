//! Pictures of a log, by their times.

/// Picture of a log, in a file of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shot {
    /// Time at which it was taken, nanoseconds.
    pub time_ns: i64,
    /// Time at which it was logged, nanoseconds.
    pub log_time_ns: i64,
    /// Number of its file.
    pub number: usize,
}
