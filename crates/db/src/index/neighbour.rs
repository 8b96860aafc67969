//! An image near a pose, and why there may be none.

/// The index of an image in the list that a [`PoseIndex`](super::PoseIndex) was made of.
pub type ImageIndex = u32;

/// An image near a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// Which.
    pub image: ImageIndex,
    /// How far the picture moves from it to the pose asked for, root mean square pixels.
    pub distance_px: f64,
    /// Its share, of 1 over all neighbours.
    pub weight: f64,
}

/// Why a pose has no neighbours.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoNeighbours {
    /// There are no images at all.
    #[error("there is no image: build the database from a recording first")]
    NoImages,
    /// The pose is not made of finite numbers.
    #[error("the pose is not made of finite numbers")]
    NotFinite,
    /// Nothing recorded is near enough to reconstruct the picture from.
    #[error(
        "nothing was recorded near this pose: the nearest picture is {distance_px:.0} px away, the limit is {limit_px:.0} px; record pictures there, or ask for the best effort"
    )]
    OutOfReach {
        /// The nearest image's distance, root mean square pixels.
        distance_px: f64,
        /// The largest distance allowed.
        limit_px: f64,
    },
}
