//! Errors of a graphics device, each with its remedy.

/// Reason why a graphics device cannot be used, or can no longer be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No adapter was found.
    #[error(
        "no graphics adapter was found: install a Vulkan driver (on Debian and Ubuntu the package mesa-vulkan-drivers has one that runs on the processor), or use the CPU"
    )]
    NoAdapter,
    /// No adapter has this name.
    #[error("no graphics adapter is called {wanted}: there is {found}")]
    NoSuchAdapter {
        /// Name that was asked for.
        wanted: String,
        /// Names of the adapters that exist.
        found: String,
    },
    /// The adapter did not open a device.
    #[error("{adapter}: gives no device ({reason}): update its driver, or use the CPU")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// Message of the driver.
        reason: String,
    },
    /// Something exceeds a limit of the device.
    #[error(
        "{what} takes {bytes} bytes and the device allows {limit}: use fewer particles, smaller pictures, or the CPU"
    )]
    TooLarge {
        /// Name of what was to be stored.
        what: &'static str,
        /// Its size, bytes.
        bytes: u64,
        /// Limit of the device, bytes.
        limit: u64,
    },
    /// A picture has more columns or rows than the device allows.
    #[error(
        "a picture has {width} x {height} pixels and the device allows {limit} each way: scale it down, or use the CPU"
    )]
    TooManyPixels {
        /// Number of columns.
        width: u32,
        /// Number of rows.
        height: u32,
        /// Largest number of columns or rows that the device allows.
        limit: u32,
    },
    /// A texture cannot be drawn into.
    #[error(
        "a picture of {width} x {height} pixels cannot be drawn into a texture of {found}: make it with GpuWarper::texture, or in that size and the format Rgba8Unorm for use as STORAGE_BINDING"
    )]
    OtherTexture {
        /// Number of columns of the picture.
        width: u32,
        /// Number of rows of the picture.
        height: u32,
        /// Size and format of the texture.
        found: String,
    },
    /// A picture does not have one word for every pixel.
    #[error("a picture of {width} x {height} pixels has {words} words: give it one for every pixel")]
    NotAPicture {
        /// Number of columns.
        width: u32,
        /// Number of rows.
        height: u32,
        /// Number of words.
        words: usize,
    },
    /// Only the CPU can do this.
    #[error("{what} is not computed on the graphics device: use the CPU")]
    CpuOnly {
        /// Name of what was asked for.
        what: &'static str,
    },
    /// The device has no timestamp counter.
    #[error("{adapter}: has no timestamps: measure whole updates, or use another adapter")]
    CannotTime {
        /// Name of the adapter.
        adapter: String,
    },
    /// The device failed while it worked.
    #[error(
        "the graphics device failed ({reason}): use the CPU, or fewer particles where its memory was full"
    )]
    Failed {
        /// The first errors that the device reported, each once.
        reason: String,
    },
}
