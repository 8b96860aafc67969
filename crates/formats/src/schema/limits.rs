//! Limits of definitions.

/// Depth to which messages may be nested; real ones are nested six deep.
pub(super) const MAX_DEPTH: usize = 32;
