//! Neighbours of a pose, and reasons why there may be none.

/// Index of an image in the list from which a [`PoseIndex`](super::PoseIndex) was built.
pub type ImageIndex = u32;

/// Image near a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// Index of the image.
    pub image: ImageIndex,
    /// Distance that the picture moves from the image to the requested pose, root mean square pixels.
    pub distance_px: f64,
    /// Weight of the image; the weights of all neighbours sum to 1.
    pub weight: f64,
}

/// Reason why a pose has no neighbours.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoNeighbours {
    /// There are no images at all.
    #[error("there is no image: build the database from a recording first")]
    NoImages,
    /// The pose has a number that is not finite.
    #[error("the pose is not made of finite numbers")]
    NotFinite,
    /// Nothing was recorded near enough to reconstruct the picture.
    #[error(
        "nothing was recorded near this pose: the nearest picture is {distance_px:.0} px away, the limit is {limit_px:.0} px; record pictures there, or ask for the best effort"
    )]
    OutOfReach {
        /// Distance of the nearest image, root mean square pixels.
        distance_px: f64,
        /// Largest distance allowed, root mean square pixels.
        limit_px: f64,
    },
}
