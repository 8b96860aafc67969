//! The ways to a picture at a pose, behind one trait.

use reality_sim_core::pose::CameraPose;

use crate::{Blend, Nearest, Plane, Quadratic, Reconstruction, SynthesisError, Synthesizer};

/// A way to a picture at a pose from those recorded at others.
pub trait Method: Send + Sync {
    /// What it is called.
    fn name(&self) -> &'static str;

    /// The picture at a pose that has been checked, see [`Synthesizer::image_at`].
    fn reconstruct(&self, from: &Synthesizer, pose: CameraPose) -> Result<Reconstruction, SynthesisError>;
}

/// The methods that are told apart; [`crate::Auto`] chooses among them.
pub const METHODS: [&dyn Method; 4] = [&Nearest, &Quadratic, &Plane, &Blend];
