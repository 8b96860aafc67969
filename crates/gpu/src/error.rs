//! What can go wrong on a graphics card, and what to do about it.

/// A GPU that cannot be used, or no longer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// There is no adapter at all.
    #[error(
        "no graphics adapter was found: install a Vulkan driver (on Debian and Ubuntu the package mesa-vulkan-drivers has one that runs on the processor), or use the CPU"
    )]
    NoAdapter,
    /// There are adapters, but none of that name.
    #[error("no graphics adapter is called {wanted}: there is {found}")]
    NoSuchAdapter {
        /// The name asked for.
        wanted: String,
        /// The names of those there are.
        found: String,
    },
    /// The adapter gives no device.
    #[error("{adapter}: gives no device ({reason}): update its driver, or use the CPU")]
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// Something is larger than the device allows.
    #[error(
        "{what} takes {bytes} bytes and the device allows {limit}: use fewer particles, smaller pictures, or the CPU"
    )]
    TooLarge {
        /// What was to be stored.
        what: &'static str,
        /// Its size.
        bytes: u64,
        /// The device's limit.
        limit: u64,
    },
    /// A picture has more columns or rows than the device allows.
    #[error(
        "a picture has {width} x {height} pixels and the device allows {limit} each way: scale it down, or use the CPU"
    )]
    TooManyPixels {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// The device's limit.
        limit: u32,
    },
    /// A picture that has not a word for every pixel.
    #[error("a picture of {width} x {height} pixels has {words} words: give it one for every pixel")]
    NotAPicture {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Its words.
        words: usize,
    },
    /// What only the CPU does.
    #[error("{what} is not computed on the graphics device: use the CPU")]
    CpuOnly {
        /// What was asked for.
        what: &'static str,
    },
    /// The device has no clock of its own.
    #[error("{adapter}: has no time stamps: measure whole updates, or use another adapter")]
    CannotTime {
        /// The adapter's name.
        adapter: String,
    },
    /// The device failed while it worked.
    #[error(
        "the graphics device failed ({reason}): use the CPU, or fewer particles where its memory was full"
    )]
    Failed {
        /// The first things it said, each once.
        reason: String,
    },
}
