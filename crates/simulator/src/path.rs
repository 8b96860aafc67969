//! The path of a camera: what its last picture tells of the next one, and what is decoded ahead.

use std::sync::{Arc, OnceLock};

use reality_sim_core::pose::CameraPose;
use reality_sim_synthesis::{Ahead, Memory, Synthesizer};

/// Largest distance between two choices of neighbours of a camera that moves smoothly, root mean square pixels. A camera on a
/// smooth path chooses anew as soon as it has gone the distance for which neighbours are kept (8 pixels); one that has gone
/// several times as far has jumped, and where it goes next is not known.
const JUMP_PX: f64 = 40.0;

/// Path of one camera. Clones go on from the same place, each on its own.
#[derive(Debug, Clone, Default)]
pub(crate) struct Path {
    pub memory: Memory,
    /// Where neighbours were chosen last.
    chosen_at: Option<CameraPose>,
    /// Thread that decodes ahead, started when there is something to decode; clones share it.
    ahead: Option<Arc<OnceLock<Ahead>>>,
}

impl Path {
    /// Starts a path whose pictures are decoded ahead, or not.
    pub fn new(is_decoded_ahead: bool) -> Self {
        Self { ahead: is_decoded_ahead.then(Arc::default), ..Self::default() }
    }

    /// Forgets where the camera was.
    pub fn forget(&mut self) {
        self.memory.forget();
        self.chosen_at = None;
    }

    /// Goes on after a picture: where new neighbours were chosen for it, those of the next choice are decoded.
    pub fn go_on(&mut self, synthesizer: &Arc<Synthesizer>) {
        let now = self.memory.chosen_at();
        let before = std::mem::replace(&mut self.chosen_at, now);
        let (Some(before), Some(now), Some(ahead)) = (before, now, &self.ahead) else { return };
        if before == now {
            return;
        }
        let metric = synthesizer.archive().index().metric();
        if metric.distance_px(before, now) <= JUMP_PX {
            let ahead = ahead.get_or_init(|| Ahead::new(synthesizer.clone()));
            ahead.expect(now.with_planar(now.planar().moved(before.planar().motion_to(now.planar()))));
        }
    }
}
