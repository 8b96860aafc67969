//! Limits on the size of files: how much memory a file that anybody may have made can make the program take.

/// Maximum size of a TOML file, bytes. Its longest, a camera with its photometry, takes 2 kB; a parsed document takes some
/// fifty times its size.
pub(super) const MAX_TOML_BYTES: u64 = 1 << 20;

/// Maximum size of a table of frames or poses, bytes: a day at 30 frames a second fits.
pub(super) const MAX_TABLE_BYTES: u64 = 256 << 20;

/// Maximum size of a picture file, and of the memory for decoding it, bytes: five times what the largest camera needs at three
/// bytes for each pixel.
pub(super) const MAX_PICTURE_BYTES: u64 = 512 << 20;
