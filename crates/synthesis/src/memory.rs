//! What the picture before tells of the next one: a camera that moves smoothly keeps its neighbours for some pictures.

use reality_sim_core::pose::CameraPose;
use reality_sim_db::{index::ImageIndex, metric::PixelMetric};

/// Distance from where neighbours were chosen up to which a camera keeps them, root mean square pixels: about a hundredth of the
/// width of a picture of 640 pixels. Chosen, not derived; what it costs in PSNR has not been measured.
const KEEP_PX: f64 = 8.0;

/// What a camera remembers of its last picture: which neighbours it was drawn from, and how bright they are. Pictures drawn
/// with a memory cost less where the camera moves smoothly, and do not flicker from one set of neighbours to another.
#[derive(Debug, Clone, Default)]
pub struct Memory {
    choice: Option<Choice>,
}

/// Neighbours chosen for a pose.
#[derive(Debug, Clone)]
pub(crate) struct Choice {
    /// Pose that they were chosen for.
    pub pose: CameraPose,
    /// Largest number of neighbours that was asked for.
    pub count: usize,
    /// The neighbours, the best first.
    pub images: Vec<ImageIndex>,
    /// Factors that match their brightness, for red, green and blue.
    pub gains: Vec<[f32; 3]>,
}

impl Memory {
    /// Returns the pose at which neighbours were chosen last; `None` if they never were.
    pub fn chosen_at(&self) -> Option<CameraPose> {
        self.choice.as_ref().map(|choice| choice.pose)
    }

    /// Forgets the last picture: the next one is drawn as if it were the first.
    pub fn forget(&mut self) {
        self.choice = None;
    }

    /// Returns the neighbours chosen last if they do for a pose.
    pub(crate) fn kept(&self, metric: &PixelMetric, pose: CameraPose, count: usize) -> Option<&Choice> {
        let does =
            |choice: &&Choice| choice.count == count && metric.distance_px(choice.pose, pose) <= KEEP_PX;
        self.choice.as_ref().filter(does)
    }

    /// Remembers a choice.
    pub(crate) fn keep(&mut self, choice: Choice) {
        self.choice = Some(choice);
    }
}
